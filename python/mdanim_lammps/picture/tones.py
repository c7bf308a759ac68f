# SPDX-License-Identifier: GPL-2.0-only
"""Colours that tell a quantity of the material."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .. import features
from ..effects import acting
from ..effects.fields import GONE, GROWN
from ..errors import UsageError
from ..features.springs.measure import stresses, von_mises
from ..model.build import build_models
from ..model.spacing import plan_spacing
from ..model.system import System, assemble
from ..results.trajectory import Trajectory
from ..results.trajectory_metadata import springs_gone
from ..scene.shown import ColorBy
from .plot import own_style

SAMPLES, AMONG = 24, 0.98
"""Frames in which the value of the last colour is looked for: the largest that this share of a frame's values do not exceed."""
STEPS = 256


class Tones:
    """Colours of the vertices of surfaces by a quantity of particles, from 0 to one that few values exceed.

    Args:
        runs: what is drawn, and a run beside it or None.
        by: the quantity.
    """

    def __init__(self, runs: tuple[Trajectory, Trajectory | None], by: ColorBy):
        import matplotlib

        trajectory, beside = runs
        self._trajectory, self.name = trajectory, by.value
        self.unit = {ColorBy.SPEED: "m/s", ColorBy.STRAIN: "", ColorBy.STRESS: "Pa"}[by]
        with own_style():
            self._colors = np.round(255.0 * matplotlib.colormaps["turbo"](np.linspace(0.04, 0.96, STEPS))[:, :3]).astype(np.uint8)
        if by is ColorBy.STRAIN:
            m, start = trajectory.metadata, trajectory.position(0)
            self._bond = np.searchsorted(m.id, m.bond).reshape(-1, 2)
            self._rest = self._lengths(start)
        if by is ColorBy.STRESS:
            self._system = _system_of(trajectory)
        self._find = {ColorBy.SPEED: self._speed, ColorBy.STRAIN: self._strain, ColorBy.STRESS: self._stress}[by]
        frames = np.unique(np.linspace(0, len(trajectory) - 1, SAMPLES).astype(int))
        self.most = max((float(np.quantile(self._find(int(n)), AMONG)) for n in frames), default=0.0) or 1.0
        if beside is not None:
            self.most = max(self.most, Tones((beside, None), by).most)

    def of_particles(self, frame: int) -> np.ndarray:
        """Values at all stored particles in a frame, shape (N,)."""
        return self._find(frame)

    def colors(self, values: np.ndarray) -> np.ndarray:
        """Colours of values, uint8, shape (V, 3)."""
        return self._colors[np.clip(values / self.most * (STEPS - 1) + 0.5, 0, STEPS - 1).astype(int)]

    def bar(self) -> Iterator[tuple[float, float, float]]:
        """Colours from 0 to the last one."""
        return (tuple(color / 255.0) for color in self._colors[::4])

    def _speed(self, frame: int) -> np.ndarray:
        return np.linalg.norm(self._trajectory.velocity(frame), axis=1)

    def _strain(self, frame: int) -> np.ndarray:
        """Largest |r/r0 - 1| of the springs of each particle; r0 is the length in the first frame."""
        t = self._trajectory
        stretch = np.abs(self._lengths(t.position(frame)) / self._rest - 1.0)
        gone = springs_gone(t.metadata, lambda _: t.field(GONE, frame))
        if gone is not None:
            stretch[gone] = 0.0
        strain = np.zeros(len(t.metadata.id))
        for end in self._bond.T:
            np.maximum.at(strain, end, stretch)
        return strain

    def _stress(self, frame: int) -> np.ndarray:
        """Stress of each particle by von Mises [Pa]; 0 of what is rigid."""
        t, system = self._trajectory, self._system
        position = np.asarray(t.position(frame), dtype=np.float64)
        has = {field.name for field in t.metadata.fields if field.per == "bond"}
        gone = t.field(GONE, frame) > 0.0 if GONE in has else None
        grown = t.field(GROWN, frame) if GROWN in has else None
        found = np.zeros(len(position))
        for solid, (first, last) in enumerate(zip(system.first, system.first[1:])):
            own = system.springs_of(solid)
            parts = (None if of is None else np.asarray(of)[own] for of in (gone, grown))
            found[first:last] = von_mises(stresses(system, solid, position, *parts))
        return found

    def _lengths(self, position: np.ndarray) -> np.ndarray:
        return np.linalg.norm(position[self._bond[:, 0]] - position[self._bond[:, 1]], axis=1)


def _system_of(trajectory: Trajectory) -> System:
    """The particles and springs of a run, made again from its scene. Raises UsageError where they are not those of the frames."""
    scene, m = trajectory.scene, trajectory.metadata
    if scene is not None and len(m.id) == m.total:
        spacing = plan_spacing(scene)
        driven = {n for effect in acting(features.effects(), scene) for n in effect.drives(scene)}
        system = assemble(build_models(scene, spacing.of, driven=driven), scene)
        if np.array_equal(system.first, m.first) and np.array_equal(system.spring + 1, m.bond):
            return system
    raise UsageError(
        f"{trajectory.path} does not hold all that stress is found from: it needs all particles (no save boundary) and a scene "
        "that can be read here; color-by strain needs neither"
    )
