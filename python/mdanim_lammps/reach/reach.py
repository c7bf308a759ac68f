# SPDX-License-Identifier: GPL-2.0-only
"""Where the solids of a scene can be, until when, and how fast: every question of that kind is asked here."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np

from ..model.spacing import choose_spacing, spacings
from ..model.system import System
from ..scene.scene import SceneRecord, Solid
from . import region
from .acting import Acting, Hung, Motion, thrown_within
from .flight import Flight
from .standing import standing


def wave_speed(system: System) -> np.ndarray:
    """Speed of longitudinal waves in each solid, sqrt(1.2 E / rho) [m/s], shape (M,)."""
    return np.sqrt(1.2 * system.young / system.density)


class Reach:
    """Bounds on the motion that effects allow the solids of a scene.

    ``region`` and ``closest`` are never too small, hold until the end of the scene, and need no models. ``fall``, ``speed`` and
    ``closing`` are compared with limits: by energy, from the particles at the start. ``flight`` gives the places of solids at a
    time when each flies alone, and `window` (reach/window.py) the margin by which boxes are widened until the next look at them.

    Args:
        scene: of the solids.
        effects: that act on them.
        h: particle spacing of each solid [m]; None is what the scene asks for.
        system: the solids as particles; None before they are made.
    """

    def __init__(
        self, scene: SceneRecord, effects: Iterable[Motion], h: Sequence[float] | None = None, system: System | None = None
    ):
        self.scene, self.acting, self._h, self._system = scene, Acting(scene, effects), h, system

    # --- never too small, before models are made ------------------------------------------------------------------------

    @cached_property
    def region(self) -> region.Sweeps:
        """A box for each solid that holds it at all times. Raises SceneError for a mesh that is not a closed solid."""
        of = spacings(self.scene, choose_spacing(self.scene)[0]) if self._h is None else self._h
        return region.sweeps(self.acting, np.array(of), self.body)

    def closest(self) -> tuple[Solid, Solid, float]:
        """Two solids of which one can move, and the least distance that remains between their boxes, along one axis [m]; see
        `region.closest`."""
        return region.closest(self.scene, self.region)

    # --- by energy, from the start --------------------------------------------------------------------------------------

    @property
    def system(self) -> System:
        """The solids as particles. Raises ValueError before they are made."""
        if self._system is None:
            raise ValueError("this is asked of models, and none are made yet")
        return self._system

    @property
    def g(self) -> float:
        """Acceleration downwards [m/s^2]."""
        return self.acting.g

    @cached_property
    def body(self) -> np.ndarray:
        """Number of the first solid of the rigid body that each solid is a part of, its own of most, shape (M,)."""
        found = np.arange(len(self.scene.solids))
        for group in (group for e in self.acting.effects for group in e.unites(self.scene)):
            found[list(group)] = group[0]
        return found

    @cached_property
    def hung(self) -> np.ndarray:
        """Number of the heaviest solid of what each solid hangs together with for good, its `body` of most, shape (M,)."""
        found = self.body.copy()
        for group in self._groups:
            found[list(group.sinks)] = group.first
        return found

    @cached_property
    def _groups(self) -> list[Hung]:
        return [group for e in self.acting.effects for group in e.hangs(self.scene)]

    @cached_property
    def moving(self) -> np.ndarray:
        """Solids of which something can move, bool, shape (M,)."""
        return ~self.system.still

    @cached_property
    def free(self) -> np.ndarray:
        """Solids of which something moves as forces make it, bool, shape (M,): what is held and driven does not."""
        return ~np.logical_and.reduceat(self.system.held, self.system.first[:-1])

    @cached_property
    def wave(self) -> np.ndarray:
        """Speed of waves in each solid, see `wave_speed` [m/s], shape (M,)."""
        return wave_speed(self.system)

    @cached_property
    def stands(self) -> np.ndarray:
        """Solids that stand still on something at the start, bool, shape (M,); see `standing`."""
        return standing(self.acting, self.system)

    @cached_property
    def heights(self) -> tuple[np.ndarray, float]:
        """Height of the lowest point of each solid [m], shape (M,), and of the lowest solid or floor [m]."""
        bottom = np.minimum.reduceat(self.system.position[:, 2], self.system.first[:-1])
        return bottom, min([bottom.min(), *(p.least for p in self.acting.planes if p.axis == 2 and p.sign > 0)])

    @cached_property
    def farthest_down(self) -> np.ndarray:
        """Height by which each solid may come down at most, by what holds it [m], shape (M,); infinite without that."""
        return np.maximum(0.0, self.system.center_of_mass(self.system.position)[:, 2] - self.acting.room[0][:, 2])

    @cached_property
    def drop(self) -> np.ndarray:
        """Height of each solid's fall through air [m], shape (M,), as if nothing stood; none where all solids stand or are held,
        as nothing comes that might throw one of them down."""
        bottom, floor = self.heights
        falls = bottom - (bottom if (self.stands | ~self.free).all() else floor)
        return np.minimum(falls, self.farthest_down) if self.acting.leashes else falls

    @cached_property
    def fall(self) -> np.ndarray:
        """Height of each solid's fall [m], shape (M,), down to the ground, the floor of the basin, or the lowest object; 0 for
        solids that stand still at the start.

        As if through air: in a liquid, heights count by the part of the weight that it leaves. Below the surface a light solid
        gains height; where there are others it may meet them at the surface already. What is part of a body that floats, as a
        sail on a hull, comes down as far as that does, and on a hinge it has what energy that lets all lose that hang on it.
        """
        (bottom, floor), surface = self.heights, self.acting.surface
        bottom = np.where(self.stands, np.minimum(bottom, floor), bottom)
        if surface is None:
            return np.minimum(bottom - floor, self.farthest_down) if self.acting.leashes else bottom - floor
        weight, body = self.weight_left, self.hung
        lowest = bottom.copy()
        np.minimum.at(lowest, body, bottom)
        above = np.where(weight < 0.0, lowest[body], bottom) - surface
        in_air, below = np.maximum(0.0, above), np.minimum(bottom, surface) - floor
        sinks = np.zeros(len(bottom))
        for group in self._groups:
            sinks[list(group.sinks)] = list(group.sinks.values())
        return (
            in_air
            + np.where(weight < 0.0, sinks, 0.0)
            + below * (weight if len(self.system.names) == 1 else np.maximum(0.0, weight))
        )

    @cached_property
    def weight_left(self) -> np.ndarray:
        """Part of the weight of each solid, or of what it hangs together with, that the liquid leaves when that is immersed [-];
        below 0 where it floats, shape (M,)."""
        of_body = lambda values: np.bincount(self.hung, values, len(values))[self.hung]
        return 1.0 - of_body(self.acting.lift(self.system)) / of_body(self.system.mass_of)

    @cached_property
    def speed(self) -> np.ndarray:
        """Largest speed that each solid may reach by its start and its fall [m/s], shape (M,)."""
        return self.speed_after(self.fall)

    def speed_after(self, fall: np.ndarray, thrown: np.ndarray | None = None) -> np.ndarray:
        """The start's speed, with that of a fall [m], shape (M,), at which it is driven, and what pushes give, as `closing` has
        them."""
        start = np.maximum.reduceat((self.system.velocity**2).sum(1), self.system.first[:-1])
        fallen = np.sqrt(np.maximum(0.0, start + 2.0 * self.g * fall)) + self.acting.swing
        given = self.acting.given + (self.acting.thrown_at if thrown is None else thrown)
        return np.where(self.free, fallen + given, 0.0) + self.acting.driven_at

    @cached_property
    def thrown_across(self) -> np.ndarray:
        """Speed that each solid is given by what pushes it wherever it is, on its way to the farthest other one as they are at
        the start [m/s], shape (M,). What is pushed for longer is on its way with the others; no speed depends on the end."""
        low, high = self.system.bounds(self.system.position)
        apart = np.maximum(largest_of_others(low) - high, low + largest_of_others(-high))
        return thrown_within(self.acting, np.sqrt((np.maximum(apart, 0.0) ** 2).sum(axis=1)))

    def closing(self, fall: np.ndarray, thrown: np.ndarray | None = None) -> np.ndarray:
        """Speed at which each solid may meet another [m/s], shape (M,): all fall alike, so only the start tells them apart until
        one has landed; ``fall`` [m], shape (M,), is how far. ``thrown`` is what pushes give each [m/s], shape (M,): all that
        they may until the end where it is None."""
        low, high = self.system.bounds(self.system.velocity)
        apart = np.maximum(high + largest_of_others(-low), largest_of_others(high) - low)
        moved = self.acting.driven_at + self.acting.given + (self.acting.thrown_at if thrown is None else thrown)
        driven = moved + largest_of_others(moved)
        apart = np.sqrt((np.maximum(apart, 0.0) ** 2).sum(1)) + driven
        fall = np.where(self.free, np.maximum(0.0, fall), 0.0)
        return np.where(self.system.still, 0.0, np.sqrt(apart**2 + 2.0 * self.g * fall) + self.acting.swing)

    # --- at a time ------------------------------------------------------------------------------------------------------

    def flight(self) -> Flight:
        """The solids at the start, to be followed as each flies alone."""
        return Flight(self.acting, self.system)


def largest_of_others(values: np.ndarray) -> np.ndarray:
    """The largest value of each column in all rows but one's own; shape (M,) or (M, K)."""
    order = np.argsort(values, axis=0)[::-1]
    largest = np.broadcast_to(np.take_along_axis(values, order[:1], 0), values.shape).copy()
    if len(values) > 1:
        np.put_along_axis(largest, order[:1], np.take_along_axis(values, order[1:2], 0), 0)
    return largest
