# SPDX-License-Identifier: GPL-2.0-only
"""Rigid bodies in touch, naively: boxes and balls on the floor z = 0, balls on balls; docs/fix_mdanim_rigid.md.

Rotations are matrices, and a free rotation takes many small steps of Euler's equations by Runge and Kutta, so nothing of it is
that of the plugin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

STICK = 0.8


def rotated_freely(turn: np.ndarray, angular: np.ndarray, moments: np.ndarray, dt: float, parts: int = 4) -> np.ndarray:
    """Axes of a body, the columns, after dt with its angular momentum in space, shape (3, 3)."""

    def rate(axes):
        return np.cross(axes @ (axes.T @ angular / moments), axes.T).T

    h = dt / parts
    for _ in range(parts):
        a = rate(turn)
        b = rate(turn + 0.5 * h * a)
        c = rate(turn + 0.5 * h * b)
        d = rate(turn + h * c)
        turn = turn + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        u, _, v = np.linalg.svd(turn)
        turn = u @ v
    return turn


@dataclass
class TwinBody:
    """One body; points of a box are its corners."""

    mass: float
    moments: np.ndarray
    x: np.ndarray
    v: np.ndarray
    turn: np.ndarray
    angular: np.ndarray
    points: np.ndarray
    """Corners in the body, shape (P, 3); one at the centre of a ball."""
    radius: float
    mu: float
    beta: float
    yields: float = 0.0
    force: np.ndarray = field(default_factory=lambda: np.zeros(3))
    torque: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def spin(self) -> np.ndarray:
        """Angular velocity in space."""
        return self.turn @ (self.turn.T @ self.angular / self.moments)

    def velocity(self, at: np.ndarray) -> np.ndarray:
        """Velocity of the point at this place."""
        return self.v + np.cross(self.spin(), at - self.x)

    def mobility(self, at: np.ndarray, n: np.ndarray) -> float:
        """1/m + (r x n) I^-1 (r x n)."""
        t = self.turn.T @ np.cross(at - self.x, n)
        return 1.0 / self.mass + (t**2 / self.moments).sum()

    def push(self, at: np.ndarray, force: np.ndarray) -> None:
        """Adds a force that acts at a place."""
        self.force = self.force + force
        self.torque = self.torque + np.cross(at - self.x, force)


def apart(velocities: Sequence[np.ndarray]) -> np.ndarray:
    """Velocity of the first of two bodies over the second, or of one over the floor."""
    return velocities[0] - velocities[1] if len(velocities) > 1 else velocities[0]


@dataclass
class TwinTouch:
    """The memory of a contact."""

    k: float
    eta: float
    mobility: float
    depth: float
    away: np.ndarray
    """From the anchor to the point."""
    pull: np.ndarray
    at: np.ndarray
    earlier: float | None = None
    """Depth a step before the last one; None in the first step."""
    press: float = 0.0
    more: float = 0.0
    """The part of the force beside spring and dashpot, for the work of beginning, onset and end."""
    owed: float = 0.0
    met: float = 0.0
    """Way of its bodies towards each other along n, in the last step."""
    n: np.ndarray = field(default_factory=lambda: np.zeros(3))
    point: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """Normal and place of the last step."""
    follows: bool = False
    """Whether it was there in the step before the last one."""
    rests: bool = False
    """Whether it has gone deeper again after it came back."""

    def look_back(self, now: float, dt: float, work: float, bodies: Sequence[TwinBody]) -> float:
        """Books the last step, whose way ends here; the change of depth by other forces in it."""
        if self.earlier is None:
            return 0.0
        meets = -dt * self.n @ apart([b.velocity(self.point + dt * b.v) for b in bodies])  # of what was at that point
        unlike = meets - (now - self.depth)
        if self.follows:
            unlike += self.met - (self.depth - self.earlier)
        self.follows = True
        self.owed += work - 0.5 * (self.more * (now - self.earlier) + self.press * unlike)
        return now - 2.0 * self.depth + self.earlier + dt * dt * self.mobility * self.press

    def force_over(self, work: float, came: float, goes: float) -> float:
        """The force that does this work over both ways."""
        both = abs(came) + abs(goes)
        if work == 0.0 or abs(came + goes) <= 0.5 * both:
            return 0.0
        return float(np.clip(2.0 * work / (came + goes), -0.5 * self.k * both, 0.5 * self.k * both))


class TwinWorld:
    """Bodies that step by step follow the law."""

    def __init__(self, bodies: list[TwinBody], frequency: float, onset: float, gravity, dt: float):
        self.bodies, self.frequency, self.onset, self.dt = bodies, frequency, onset, dt
        self.gravity = np.asarray(gravity, float)
        self.touches: dict[tuple, TwinTouch] = {}
        self._forces(0.0)

    def energy_and_force(self, depth: float) -> tuple[float, float]:
        """g and its slope."""
        if depth <= 0.0:
            return 0.0, 0.0
        if depth < self.onset:
            return depth**3 / (6.0 * self.onset), depth**2 / (2.0 * self.onset)
        return (depth - self.onset / 2.0) ** 2 / 2.0 + self.onset**2 / 24.0, depth - self.onset / 2.0

    def _missing(self, a: float, b: float) -> float:
        """Energy over the way from depth a to b, less the mean of the forces at both ends times the way."""
        if abs(b - a) < 1e-4 * self.onset or min(a, b) >= self.onset:
            return 0.0
        (ga, sa), (gb, sb) = self.energy_and_force(a), self.energy_and_force(b)
        return gb - ga - 0.5 * (b - a) * (sa + sb)

    def _touch(self, key, a: TwinBody, b: TwinBody | None, at, n, depth: float, dt: float) -> None:
        touch = self.touches.get(key)
        if depth <= 0.0:
            if touch is not None:
                self.touches.pop(key)
                self._last_push(touch, a, b, at, n, depth)
            return
        two = [a, b] if b else [a]
        way = apart([body.velocity(at) for body in two])
        mu = np.sqrt(a.mu * b.mu) if b else a.mu
        if touch is None:
            mobility = a.mobility(at, n) + (b.mobility(at, n) if b else 0.0)
            k = self.frequency**2 / (a.yields + (b.yields if b else 0.0))
            beta = max(a.beta, b.beta) if b else a.beta
            eta = 2.0 * beta * np.sqrt(k / mobility)
            touch = TwinTouch(k, eta, mobility, min(0.0, depth + dt * way @ n), np.zeros(3), np.zeros(3), at)
            self.touches[key] = touch
        last, now, k = touch.depth, depth, touch.k
        others = touch.look_back(now, dt, k * self._missing(last, now) if now < last else 0.0, two)
        energy, force = self.energy_and_force(now)
        press = k * force
        touch.rests = touch.rests or (touch.earlier is not None and last < touch.earlier and now > last)
        share = 1.0 if touch.rests else force / np.sqrt(2.0 * energy)
        press += max(share * touch.eta * (now - last) / dt, -press)
        if now > last:
            touch.owed += k * self._missing(last, now)
        more = 0.0
        for _ in range(3):
            goes = now - last + others - dt * dt * touch.mobility * (press + more)
            work = touch.owed + (k * self._missing(now, now + goes) if goes < 0.0 else 0.0)
            more = max(touch.force_over(work, now - last, goes), -press)
        press += more
        touch.earlier, touch.more, touch.press = last, more, press
        touch.met, touch.n, touch.point = -dt * way @ n, n, at
        touch.depth = now
        force = press * n
        if mu > 0.0:
            stick, before = STICK * k, touch.away
            # A corner stays the same point; the point of a ball moves over it, so the ways of both materials are added up.
            away = before + (at - touch.at if a.radius == 0.0 else dt * way)
            away = away - (away @ n) * n
            pull, more = stick * np.linalg.norm(away), away + touch.pull / stick
            slips = pull > mu * press
            left = away * (mu * press / pull) if slips else away
            drag = np.zeros(3) if slips else -0.5 * touch.eta * np.sqrt(STICK) / dt * (more - (more @ n) * n)
            force = force - stick * left + drag
            touch.away, touch.pull, touch.at = left, -stick * left, at
        a.push(at, force)
        if b:
            b.push(at, -force)

    def _last_push(self, touch: TwinTouch, a: TwinBody, b: TwinBody | None, at, n, depth: float) -> None:
        """Gives what is owed when both have parted."""
        now, last = min(depth, touch.depth), touch.depth
        others = touch.look_back(now, self.dt, touch.k * self._missing(last, now), [a, b] if b else [a])
        push = touch.force_over(touch.owed, now - last, now - last + others)
        a.push(at, push * n)
        if b:
            b.push(at, -push * n)

    def _forces(self, dt: float) -> None:
        up = np.array([0.0, 0.0, 1.0])
        for body in self.bodies:
            body.force, body.torque = body.mass * self.gravity, np.zeros(3)
        if dt == 0.0:
            return  # nothing touches at the start
        for n, body in enumerate(self.bodies):
            for p, own in enumerate(body.points):
                at = body.x + body.turn @ own - body.radius * up
                self._touch((n, -1, p), body, None, at, up, -at[2], dt)
        for i, a in enumerate(self.bodies):
            for j in range(i + 1, len(self.bodies)):
                b = self.bodies[j]
                if a.radius and b.radius:
                    between = a.x - b.x
                    far = np.linalg.norm(between)
                    n = between / far
                    both = a.radius + b.radius
                    self._touch((i, j, 0), a, b, a.x - a.radius * far / both * n, n, both - far, dt)

    def step(self) -> None:
        """One step of the leap-frog."""
        h = 0.5 * self.dt
        for b in self.bodies:
            b.v, b.angular = b.v + h / b.mass * b.force, b.angular + h * b.torque
            b.x, b.turn = b.x + self.dt * b.v, rotated_freely(b.turn, b.angular, b.moments, self.dt)
        self._forces(self.dt)
        for b in self.bodies:
            b.v, b.angular = b.v + h / b.mass * b.force, b.angular + h * b.torque
