# SPDX-License-Identifier: GPL-2.0-only
"""Motions of rigid bodies that are known in closed form, and how they come out of fix mdanim/rigid."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import plugin_lab
import rigid_lab as lab
from mdanim_lammps.features.contact.restitution import damping_for
from rigid_samples import G
from scipy.special import ellipk

PLACES = np.array([[s * (axis == k) for k in range(3)] for axis in range(3) for s in (1.0, -1.0)])


def with_moments(moments, spin, mass: float = 6.0) -> plugin_lab.Body:
    """Six particles on the axes of a body with these principal moments, which turns about its centre."""
    moments = np.asarray(moments, float)
    x = PLACES * np.sqrt(3.0 * (moments.sum() / 2.0 - moments) / mass)
    return plugin_lab.particles(x, np.ones(6, int), v=np.cross(spin, x), mass=np.full(6, mass / 6.0))


def half_period(moments, spin) -> float:
    """Time between two flips of a body with principal moments (3,) and a spin (3,) in its frame (Landau, Lifshitz, 37)."""
    order = np.argsort(moments)
    (a, b, c), w = np.asarray(moments, float)[order], np.asarray(spin, float)[order]
    energy, square = (np.array([a, b, c]) * w**2).sum(), ((np.array([a, b, c]) * w) ** 2).sum()
    one, other = (c - b) * (square - energy * a), (b - a) * (energy * c - square)
    if square <= energy * b:
        one, other = other, one
    return float(2.0 * ellipk(other / one) * np.sqrt(a * b * c / one))


def flips(folder: Path, spin: Sequence[float], steps_of_a_turn: int = 300) -> tuple[np.ndarray, float]:
    """Times between crossings of the middle axis of a free body with moments 1, 2, 3, and the period in closed form."""
    moments, dt, looks = (1.0, 2.0, 3.0), 2.0 * np.pi / steps_of_a_turn, []
    period = 2.0 * half_period(moments, spin)
    lmp = plugin_lab.load(with_moments(moments, spin), folder, ["fix r all mdanim/rigid", f"timestep {dt}", "run 0"])
    for _ in range(2 * int(period / dt / 4) + 40):  # two periods, a look every eight steps
        lmp.command("run 8 pre no post no")
        row = np.array([lmp.extract_fix("r", 0, 2, 0, column) for column in range(13)])
        looks.append((lab.matrix(row[6:10]).T @ row[10:])[1])
    lmp.close()
    looks = np.array(looks)
    (n,) = np.nonzero((looks[:-1] > 0) & (looks[1:] <= 0))
    return np.diff(8 * dt * (n + 1 + looks[n] / (looks[n] - looks[n + 1]))), period


def housner(share: float, alpha: float, count: int) -> list[float]:
    """Amplitudes over alpha of a rocking block that is let go at this share: 1 - (1 - a)^2 falls by r^2 = (1 - 3/2 sin^2)^2."""
    r, found = 1.0 - 1.5 * np.sin(alpha) ** 2, []
    for _ in range(count):
        share = 1.0 - np.sqrt(1.0 - (1.0 - (1.0 - share) ** 2) * r * r)
        found.append(share)
    return found


def rocking(folder: Path, width: float = 0.1, height: float = 0.4, share: float = 0.6) -> tuple[float, np.ndarray, np.ndarray]:
    """The first fall of a block that is let go at this share of alpha, over Housner's acosh(1/(1 - a))/p, p^2 = 3 g/4R (1963);
    its next three amplitudes over alpha, and his. Blows of 0.5 % of the width."""
    alpha, radius = np.arctan(width / height), np.hypot(width, height) / 2.0
    q = lab.about((0, 1, 0), share * alpha)
    corner = lab.matrix(q) @ (width / 2, 0.0, -height / 2)
    block = lab.box((width, 0.3, height), at=(-corner[0], 0.0, -corner[2]), q=q, mu=10.0)
    every, axes, times = 20, [], []
    with lab.World(folder, [block], frequency=lab.frequency_of(1.0, width, 0.005), thin=width) as world:
        for n in range(round(1.6 / world.dt / every)):
            world.run(every)
            axes.append(lab.matrix(world.rows()[0, 6:10]))
            times.append((n + 1) * every * world.dt)
        look = every * world.dt
    axes = np.array(axes)
    k = np.argmax(np.abs(axes[0][0]))  # the principal axis that was along x at first
    lean = np.arcsin(axes[:, 2, k] * -np.sign(axes[0, 0, k]))
    crossings = np.flatnonzero(np.sign(lean[1:]) != np.sign(lean[:-1]))
    fall = times[crossings[0]] + look * lean[crossings[0]] / (lean[crossings[0]] - lean[crossings[0] + 1])
    found = [np.abs(lean[a:b]).max() / alpha for a, b in zip(crossings + 1, crossings[1:] + 1)]
    law = np.arccosh(1.0 / (1.0 - share)) / np.sqrt(3.0 * G / (4.0 * radius))
    return fall / law, np.array(found[:3]), np.array(housner(share, alpha, 3))


LANDING = {
    "ball on floor": (lab.ball(0.05), None),
    "face": (lab.box((0.1, 0.1, 0.1)), (0, 0, -0.05)),
    "edge": (lab.box((0.1, 0.1, 0.1), q=lab.about((1, 0, 0), np.pi / 4)), (0, 0, -0.05 * 2**0.5)),
    "end of a column": (lab.box((0.04, 0.04, 0.2)), (0, 0, -0.1)),
    "corner": (lab.box((0.4, 0.2, 0.02), q=lab.about((1, 2, 0), 0.3)), "lowest"),
}


def bounced(folder: Path, case: str, e: float, speed: float = 1.0) -> float:
    """Speed after a blow over that before, of the point that meets the floor first, with the dashpot for e: the mean of five
    bodies that meet it at other times within a step, because a blow takes nine steps and the dashpot lags by half of one. The
    speed is over the fastest one of the scene, 1 m/s; a blow within the onset takes longer by its third root."""
    body, low = LANDING[case]
    corners = lab.SIGNS * body.spread @ lab.matrix(body.q).T
    arm = corners[np.argmin(corners[:, 2])] if isinstance(low, str) else np.array(low or (0, 0, -0.05))
    frequency, beta = lab.frequency_of(1.0, body.thin), damping_for(e)
    start = [(n, 0, (10 + n / 5) * speed * 0.35 / frequency - arm[2]) for n in range(5)]
    bodies = [body.put(at=at, v=(0, 0, -speed), mu=0.0, beta=beta) for at in start]
    with lab.World(folder, bodies, frequency=frequency, gravity=(0, 0, 0)) as world:
        world.run(round(40 / speed ** (1 / 3)))
        assert world.number("touching") == 0 and world.number("deepest") > 0.0
        return float(np.mean([(row[3:6] + np.cross(row[10:], arm))[2] for row in world.rows()])) / speed


class LongBody(NamedTuple):
    """A body with two ends, `half` to each side of its centre along y where it lands flat, and `low` below it."""

    body: lab.Rigid
    turn: np.ndarray
    half: float
    low: float


LONG = {
    "log": LongBody(lab.cylinder(0.1, 0.8), lab.about((1, 0, 0), np.pi / 2), 0.4, 0.1),
    "column": LongBody(lab.box((0.04, 0.04, 0.2)), lab.about((1, 0, 0), 0.0), 0.02, 0.1),
}


def leaning(folder: Path, case: str, e: float, degrees: float) -> np.ndarray:
    """Speed up and spin [rad/s] after the blows of what falls at 1 m/s and leans, without friction and gravity: the mean of five
    that meet the floor at other times within a step."""
    body, turn, half, low = LONG[case]
    angle, frequency = np.radians(degrees), lab.frequency_of(1.0, body.thin)
    height = low * np.cos(angle) + half * np.sin(angle)
    start = [(n, 0, height + (10 + n / 5) * 0.35 / frequency) for n in range(5)]
    q = lab.times(lab.about((1, 0, 0), -angle), turn)
    bodies = [body.put(at=at, q=q, v=(0, 0, -1), mu=0.0, beta=damping_for(e)) for at in start]
    with lab.World(folder, bodies, frequency=frequency, gravity=(0, 0, 0)) as world:
        world.run(round((0.05 + 5.0 * half * np.sin(angle)) / world.dt))
        assert world.number("touching") == 0 and world.number("deepest") > 0.0
        return world.rows()[:, [5, 10]].mean(axis=0)


def blow_by_blow(case: str, e: float, degrees: float) -> np.ndarray:
    """The same by Newton's law, one blow after the other: the end that is lower first, then each that comes down. They are so
    short that it does not turn meanwhile."""
    body, _, half, low = LONG[case]
    over, angle = body.mass / body.moments.max(), np.radians(degrees)
    arms = half * np.cos(angle) * np.array([1.0, -1.0]) - low * np.sin(angle)
    speed, spin, end = -1.0, 0.0, 0
    while (rates := speed + arms * spin).min() < 0.0:
        if rates[end] < 0.0:
            push = -(1.0 + e) * rates[end] / (1.0 + over * arms[end] ** 2)
            speed, spin = speed + push, spin + over * arms[end] * push
        end = 1 - end
    return np.array([speed, spin])


def falls_back(folder: Path, e: float, stiffness: float, degrees: float = 8.0) -> float:
    """Speed of the edge of a column that lands, as it falls back from a lean, after the blow over that before; 20 cm high, in a
    scene whose fastest blow is at 0.5 m/s, at this `contact-stiffness`."""
    body, _, half, low = LONG["column"]
    frequency, q = np.sqrt(stiffness) * lab.frequency_of(0.5, body.thin), lab.about((1, 0, 0), np.radians(degrees))
    start = body.put(at=-lab.matrix(q) @ (0, -half, -low), q=q, mu=10.0, beta=damping_for(e))
    speeds, looks = [], 0.01
    with lab.World(folder, [start], frequency=frequency) as world:
        for _ in range(round(0.26 / world.dt)):
            world.run(1)
            row = world.rows()[0]
            speeds.append(row[5] + half * row[10])
        lands = int(np.argmin(speeds))
        return float(-max(speeds[lands : lands + round(looks / world.dt)]) / speeds[lands])
