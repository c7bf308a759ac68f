# SPDX-License-Identifier: GPL-2.0-only
"""Tops, coins and tippe tops on the ground, with what is known of their motion."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rigid_lab as lab

G = 9.81


def leaning(lean: float, rate: float, spin: float) -> dict[str, np.ndarray]:
    """Attitude and angular velocity of a body whose axis leans towards x and goes around at a rate, and which spins about it."""
    axis = np.array([np.sin(lean), 0.0, np.cos(lean)])
    return {"q": lab.about((0, 1, 0), lean), "spin": spin * axis + rate * np.array([0.0, 0.0, 1.0])}


def top(lean: float, spin: float, radius: float = 0.06, height: float = 0.05) -> tuple[lab.Rigid, float]:
    """A cone on its tip, and the slow one of the two rates W at which its axis goes around:
    (I1 - I3) cos(lean) W^2 - I3 spin W + m g l = 0, moments about the tip, l from there to the centre of mass."""
    cone = lab.cone(radius, height, mu=1.0)
    arm = 0.75 * height
    level = (cone.moments[0] + cone.mass * arm**2 - cone.moments[2]) * np.cos(lean)
    push = cone.moments[2] * spin
    rate = (push - np.sqrt(push**2 - 4.0 * level * cone.mass * G * arm)) / (2.0 * level)
    way = leaning(lean, rate, spin)
    at = arm * np.array([np.sin(lean), 0.0, np.cos(lean)])
    down = lab.times(way["q"], lab.about((0, 1, 0), np.pi))  # the tip of a cone is above its base
    return cone.put(at=at, q=down, spin=way["spin"], v=np.cross((0.0, 0.0, rate), at)), rate


def coin(lean: float, rate: float, radius: float = 0.05, height: float = 0.01) -> tuple[lab.Rigid, float]:
    """A coin that rolls on its rim, and how far the middle of its circle is from its centre of mass, along x.

    With the arm r from the centre of mass to the rim, the acceleration a = W (W r_x + spin R) towards the middle of the
    circle, and the moments I1 and I3: W sin(lean) (I3 (spin + W cos(lean)) - I1 W cos(lean)) = m (r_z a - r_x g).
    """
    body = lab.cylinder(radius, height, mu=2.0)
    sine, cosine = np.sin(lean), np.cos(lean)
    first, third = body.moments[0], body.moments[2]
    out, down = radius * cosine - 0.5 * height * sine, -radius * sine - 0.5 * height * cosine
    right = body.mass * out * (down * rate**2 - G) - rate**2 * sine * cosine * (third - first)
    spin = right / (rate * (sine * third - body.mass * down * radius))
    speed = -(rate * out + spin * radius)
    return body.put(at=(0, 0, -down), v=(0.0, speed, 0.0), **leaning(lean, rate, spin)), -speed / rate


RADIUS, LOW, LEAN = 0.02, 0.004, np.radians(6.0)
"""Radius of a tippe top, how far its centre of mass is below its middle [m], how far it leans at first."""


def tippe_top(spin: float = 250.0) -> lab.Rigid:
    """A ball whose centre of mass is low, turning about the vertical."""
    at = (0.0, 0.0, RADIUS - LOW * np.cos(LEAN))
    return lab.ball(RADIUS, 1000.0, mu=0.3, offset=LOW, at=at, q=lab.about((0, 1, 0), LEAN), spin=(0.0, 0.0, spin))


def tippe_leans(folder: Path, times: list[float], step: float = 0.35) -> tuple[list[float], float]:
    """How far its axis leans at these times, the first one 0 [degrees]: above 90 it has turned over; and the largest change of
    Jellett's integral, L (R z - a e), over its value: no force at the ground changes it."""
    body, leans, jellett = tippe_top(), [], []
    with lab.World(folder, [body], frequency=lab.frequency_of(1.0, body.thin), objects=False, step=step) as world:
        row, done = world.rows()[0], 0
        carried = lab.matrix(row[6:10]).T @ lab.matrix(body.q)[:, 2]  # the axis in the principal axes of the body
        for time in times:
            world.run(round(time / world.dt) - done)
            done, row = round(time / world.dt), world.rows()[0]
            axis = lab.matrix(row[6:10]) @ carried
            leans.append(float(np.degrees(np.arccos(np.clip(axis[2], -1.0, 1.0)))))
            jellett.append(row[10:13] @ (RADIUS * np.array([0.0, 0.0, 1.0]) - LOW * axis))
    return leans, float(np.abs(np.array(jellett) / jellett[0] - 1.0).max())


def turned(
    folder: Path, body: lab.Rigid, middle: tuple[float, float], seconds: float, speed: float
) -> tuple[float, float, float]:
    """The rate at which the centre of mass of a body goes around a middle [rad/s]; by how much its height and its distance from
    there change, over those at the start."""
    with lab.World(folder, [body], frequency=lab.frequency_of(speed, body.thin), objects=False) as world:
        angle, last, every = 0.0, np.array(body.at[:2]) - middle, max(1, round(0.02 / world.dt))
        steps = round(seconds / world.dt / every)
        for _ in range(steps):
            world.run(every)
            now = world.rows()[0, :2] - middle
            angle += np.arctan2(last[0] * now[1] - last[1] * now[0], last @ now)
            last = now
        rise = world.rows()[0, 2] / body.at[2] - 1.0
        grown = np.linalg.norm(last) / np.linalg.norm(np.array(body.at[:2]) - middle) - 1.0
        return angle / (steps * every * world.dt), rise, grown
