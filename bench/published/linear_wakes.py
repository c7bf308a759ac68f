# SPDX-License-Identifier: GPL-2.0-only
"""Wakes of linear waves in a basin: of a body as a pressure on the water, and of a hull that the water follows.

``python bench/published/linear_wakes.py`` prints the angle and the height of the waves behind two bodies, and their resistance:
with the law of potential flow, and with that of the model of waves, (W5) with (W7) of docs/physics-liquid.md. Cells, fronts that
break and the motion of the water along the body are left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.fft import dctn, idctn
from scipy.interpolate import RegularGridInterpolator

G, DENSITY = 9.81, 1000.0
DEEP, SPEED, START = 0.2, 1.0, 0.5
"""Depth [m], speed and first place [m/s], [m]."""
LONG, WIDE, NX, NY = 5.5, 3.0, 330, 180
"""Sides of the basin [m], and places along them."""
BEHIND = np.arange(-3.2, 0.4, 0.01)
"""Places along the wake, from the middle of the body [m]."""
LATE, END, STEP = 3.9, 4.4, 0.01
"""From when on the pattern goes along with the body where it is measured, until when, and the step [s]."""
ANGLES = np.arange(5.0, 34.0, 0.25)
"""Directions from the course [deg]."""


@dataclass(frozen=True)
class Body:
    """The lower part of an ellipsoid."""

    radius: float
    high: float
    """Half axes [m]."""
    up: float
    """How far its middle is above the water [m]."""

    def below(self, at: float) -> np.ndarray:
        """How deep it is in the water with its middle at a place [m], shape (NY, NX)."""
        off = ((X - at) ** 2 + Y[:, None] ** 2) / self.radius**2
        return np.maximum(0.0, self.high * np.sqrt(np.maximum(0.0, 1.0 - off)) - self.up)


BUOY, DISH = Body(0.15, 0.07, 0.02), Body(0.3, 0.12, 0.1)
X, Y = (np.arange(NX) + 0.5) * LONG / NX, (np.arange(NY) + 0.5) * WIDE / NY - 0.5 * WIDE
K = np.hypot(*np.meshgrid(np.pi * np.arange(NX) / LONG, np.pi * np.arange(NY) / WIDE))


def potential(k: np.ndarray) -> np.ndarray:
    """Frequency of waves by potential flow [1/s]."""
    return np.sqrt(G * k * np.tanh(k * DEEP))


def model(k: np.ndarray) -> np.ndarray:
    """Frequency of waves by (W5) with (W7) [1/s]."""
    rises = 8.0 / 21.0 * (k * DEEP) ** 2
    return k * np.sqrt(G * DEEP * (1.0 - 7.0 / 8.0 * rises / (1.0 + rises)))


def mean_pattern(frames: list[tuple[float, np.ndarray]], x: np.ndarray) -> np.ndarray:
    """Elevations as the body sees them, shape (y, BEHIND) [m]: what changes from frame to frame is not the wake's."""
    seen = [[np.interp(START + SPEED * t + BEHIND, x, row) for row in z] for t, z in frames]
    mean = np.mean(seen, axis=0)
    return 0.5 * (mean + mean[::-1])


def by_direction(pattern: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Height of the waves 1 m to 2.6 m behind the body in each of ANGLES, times the root of the way, over the highest."""
    at = RegularGridInterpolator((y, BEHIND), pattern)
    far, angle = np.arange(1.0, 2.6, 0.01), np.radians(ANGLES)[:, None]
    high = np.sqrt((at((far * np.sin(angle), -far * np.cos(angle))) ** 2 * far).mean(axis=1))
    return high / high.max()


def _heads(coupling: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """p >= 0 with coupling p >= asked, and p = 0 where it is more: the water is pushed down and not pulled up."""
    acts, p = asked > 0.0, np.zeros_like(asked)
    for _ in range(60):
        p[:] = 0.0
        p[acts] = np.linalg.solve(coupling[np.ix_(acts, acts)], asked[acts])
        now = np.where(acts, p > 0.0, coupling @ p < asked - 1e-9)
        if (now == acts).all():
            break
        acts = now
    return np.maximum(p, 0.0)


def wake(body: Body, law: Callable[[np.ndarray], np.ndarray] = potential, hull: bool = False) -> tuple[np.ndarray, float]:
    """The pattern of linear waves in the basin, shape (NY, BEHIND) [m], and the resistance of the body from 2 s on [N].

    Each mode swings about the head that the body asks for: of its depth where it is a pressure, else the least one with which
    the water is not inside its hull.
    """
    turn = law(K)
    cos, sine = np.cos(turn * STEP), turn * np.sin(turn * STEP)
    middle = np.zeros_like(K)
    middle[NY // 2, NX // 2] = 1.0
    sinks = idctn(sine * dctn(middle, norm="ortho"), norm="ortho")  # by a head at one place, in a step
    rise, rate, frames, forces = -dctn(body.below(START), norm="ortho"), np.zeros_like(K), [], []
    for step in range(round(END / STEP)):
        pressed = body.below(START + SPEED * (step + 0.5) * STEP)
        if hull:
            deep, free = body.below(START + SPEED * (step + 1) * STEP), idctn(rate * cos - sine * rise, norm="ortho")
            j, i = np.nonzero(deep)
            coupling = sinks[NY // 2 + j[:, None] - j, NX // 2 + i[:, None] - i]
            pressed = np.zeros_like(deep)
            pressed[j, i] = _heads(coupling, (free + 0.5 * (deep + idctn(rise, norm="ortho")) / STEP)[j, i])
        forces.append(-G * DENSITY * (pressed * np.gradient(body.below(START + SPEED * (step + 1) * STEP), X, axis=1)).sum())
        head = dctn(pressed, norm="ortho")
        off = rise + head
        rise = off * cos + STEP * np.sinc(turn * STEP / np.pi) * rate - head
        rate = rate * cos - sine * off
        if (step + 1) % 4 == 0 and (step + 1) * STEP > LATE:
            frames.append(((step + 1) * STEP, idctn(rise, norm="ortho")))
    return mean_pattern(frames, X), float(np.mean(forces[round(2.0 / STEP) :])) * (LONG / NX) * (WIDE / NY)


if __name__ == "__main__":
    print("body, how it acts, law: angle of the highest waves, their root mean square from 1 m to 2.6 m behind it, resistance")
    for name, body in (("buoy", BUOY), ("dish", DISH)):
        for law in (potential, model):
            for hull in (False, True):
                pattern, drag = wake(body, law, hull)
                angle = ANGLES[by_direction(pattern, Y).argmax()]
                height = 1e3 * np.sqrt((pattern[:, (BEHIND > -2.6) & (BEHIND < -1.0)] ** 2).mean())
                told = f"{angle:.4g}°, {height:.3g} mm, {drag:.2g} N"
                print(f"{name}, {'hull' if hull else 'pressure'}, {law.__name__}: {told}", flush=True)
