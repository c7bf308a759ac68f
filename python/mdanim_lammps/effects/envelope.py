# SPDX-License-Identifier: GPL-2.0-only
"""How fast and how far the objects of a scene may get by their start and their fall: what limits are compared with."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Span
from ..model.planes import Plane
from ..model.shapes import thickness
from ..model.system import System
from ..scene.formatting import say
from .margin import Margin
from .support import standing

if TYPE_CHECKING:
    from .effect import Resolved


def wave_speed(system: System) -> np.ndarray:
    """Speed of longitudinal waves in each solid, sqrt(1.2 E / rho) [m/s], shape (M,)."""
    return np.sqrt(1.2 * system.young / system.density)


def heights(system: System, planes: Iterable[Plane]) -> tuple[np.ndarray, float]:
    """Height of the lowest point of each solid [m], shape (M,), and of the lowest solid or floor [m]."""
    bottom = np.minimum.reduceat(system.position[:, 2], system.first[:-1])
    return bottom, min([bottom.min(), *(p.at for p in planes if p.axis == 2 and p.sign > 0)])


class Envelope:
    """What a scene may reach at a time step, before the first step."""

    def __init__(self, resolved: Resolved, system: System, rates: Mapping[str, np.ndarray], timestep: float):
        self.scene, self.on, self.planes = resolved.scene, resolved.effects, resolved.planes
        self.system, self.rates, self.dt = system, rates, timestep
        """``rates`` are the shares of effects in the bound, by name [1/s^2], each of shape (N,)."""
        self.surface = next((z for e in self.on if (z := e.surface(self.scene)) is not None), None)
        """Height below which something carries objects [m]; None where nothing does."""
        self.moving = ~system.still
        """Solids of which something can move, bool, shape (M,)."""
        self.wave = wave_speed(system)
        self.speed = self.speed_after(self.fall())
        """Largest speed that each solid may reach by its start and its fall [m/s], shape (M,)."""

    def own_step(self, name: str, rate: np.ndarray) -> list[Margin]:
        """What a single effect would bear, by its share in the bound [1/s^2], shape (N,)."""
        free = np.where(self.system.held, 0.0, rate)
        if not free.any():
            return []
        i = int(np.argmax(free))
        m = int(self.system.object[i])
        alone = 2.0 / math.sqrt(free[i])
        return [
            Margin(
                name,
                self.system.names[m],
                self.dt,
                alone,
                "s",
                f"{name} alone would bear a time step of {say(alone, 's')} at {self.system.names[m]}",
                self.place(m, "elasticity"),
                "refused" if self.dt > alone * (1.0 + 1e-12) else "ok",
                hint="write 'timestep auto'",
            )
        ]

    def place(self, m: int, *keywords: str) -> Span | None:
        """Where the first of these keywords of a solid stands; its name where there is none."""
        spans = self.scene.solids[m].spans
        return next((spans[k] for k in (*keywords, "object") if k in spans), None)

    def speed_after(self, fall: np.ndarray) -> np.ndarray:
        """The start's speed, with that of a fall [m], shape (M,)."""
        start = np.maximum.reduceat((self.system.velocity**2).sum(1), self.system.first[:-1])
        return np.where(self.moving, np.sqrt(np.maximum(0.0, start + 2.0 * self.g * fall)), 0.0)

    @property
    def g(self) -> float:
        """What pulls down [m/s^2]."""
        return sum(e.pull(self.scene) for e in self.on)

    def fall(self) -> np.ndarray:
        """Height of each solid's fall [m], shape (M,), down to the ground, the floor of the basin, or the lowest object; none of
        what stands still at the start.

        As if through air: in a liquid, heights count by what it leaves of the weight. Below the surface a light solid gains
        height; where there are others it may meet them at the surface already.
        """
        bottom, floor = heights(self.system, self.planes)
        bottom = np.where(self.stands, np.minimum(bottom, floor), bottom)
        if self.surface is None:
            return bottom - floor
        in_air, in_liquid = np.maximum(0.0, bottom - self.surface), np.minimum(bottom, self.surface) - floor
        weight = self.weight_left()
        return in_air + in_liquid * (weight if len(self.system.names) == 1 else np.maximum(0.0, weight))

    def weight_left(self) -> np.ndarray:
        """What the liquid leaves of each solid's weight when it is immersed, over its weight; below 0 where it floats,
        shape (M,)."""
        return (
            1.0 - sum((e.lift(self.scene, self.system) for e in self.on), np.zeros(len(self.system.names))) / self.system.mass_of
        )

    @cached_property
    def stands(self) -> np.ndarray:
        """Solids that stand still on something at the start, bool, shape (M,); see `standing`."""
        return standing(self.scene, self.system, self.planes)

    @cached_property
    def cells(self) -> np.ndarray:
        """Cells across the thinnest part of each solid [-], shape (M,)."""
        system, known = self.system, {}
        thin = np.array(
            [known[s.shape] if s.shape in known else known.setdefault(s.shape, thickness(s.shape)) for s in self.scene.solids]
        )
        return thin / np.cbrt(system.cell_volume)
