# SPDX-License-Identifier: GPL-2.0-only
"""Forces on objects by their momenta: the mean resultant of a frame's time, and the part of it that is of contact."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ..reach import Acting
from ..scene.scene import SceneRecord


class Balance:
    """Momentum of each object since the start, and what of it contact has given.

    No frame holds forces. But the leap-frog adds them up: a force has made exactly the change of momentum that all others have
    not made. Those that are functions of time and place alone, such as weight, are known (`Motion.impulses`); the rest is
    contact where nothing else acts (`Motion.untold`). So the numbers cost nothing in a run. A single object that is held gets the
    opposite of the force of contact on all others, where there are no planes.

    Args:
        scene: of the run.
        effects: all that there are, for the scene.
        mass: of the objects [kg], shape (M,).
        times: of the frames [s], shape (F,).
        center, velocity: centres of mass [m] and their velocities [m/s], shape (F, M, 3).
    """

    def __init__(
        self,
        scene: SceneRecord,
        effects: Sequence[Any],
        mass: np.ndarray,
        times: np.ndarray,
        center: np.ndarray,
        velocity: np.ndarray,
    ):
        self.scene, self.effects, self.mass, self.times = scene, effects, mass, times
        self.center, self.velocity = center, velocity
        self.untold = untold(scene, effects)
        """Reasons why contact of an object is not told, by its number."""
        self._alone = [m for m, solid in enumerate(scene.solids) if solid.hold and m not in self.untold]

    @cached_property
    def resultant(self) -> np.ndarray:
        """Sum of all forces on each object, mean since the frame before [N], shape (F, M, 3); NaN in the first frame."""
        return self._over_time(self.mass[:, None] * self.velocity)

    @cached_property
    def contact(self) -> np.ndarray:
        """Force of contact with objects, ground and walls on each object, mean since the frame before [N], shape (F, M, 3);
        NaN in the first frame, and for objects of which it is `untold`."""
        return self._known(self.untold)

    @cached_property
    def _rest(self) -> np.ndarray:
        """The same with forces that are not told from it, shape (F, M, 3)."""
        momentum = self.mass[:, None] * self.velocity
        for effect in self.effects:
            given = effect.impulses(self.scene, self.mass, self.times, self.center)
            momentum = momentum if given is None else momentum - given
        found = self._over_time(momentum)
        found[:, self._alone] = -np.delete(found, self._alone, axis=1).sum(axis=1, keepdims=True)
        return found

    @cached_property
    def on_world(self) -> np.ndarray:
        """Force of contact on ground, walls and all that is held together, mean since the frame before [N], shape (F, 3): the
        reaction to that on all others; NaN in the first frame, and where it is `untold` of one of these."""
        free = [m for m, solid in enumerate(self.scene.solids) if not solid.hold]
        return -self._known(untold(self.scene, self.effects, in_sum=True))[:, free].sum(axis=1)

    def _known(self, reasons: dict[int, str]) -> np.ndarray:
        """Forces of contact, shape (F, M, 3), NaN for objects with such a reason."""
        found = self._rest.copy()
        found[:, list(reasons)] = np.nan
        return found

    def _over_time(self, momentum: np.ndarray) -> np.ndarray:
        found = np.full(momentum.shape, np.nan)
        found[1:] = np.diff(momentum, axis=0) / np.diff(self.times)[:, None, None]
        return found


HELD = "it is held, and what holds it is not told from contact"


def untold(scene: SceneRecord, effects: Sequence[Any], *, in_sum: bool = False) -> dict[int, str]:
    """Reasons why frames do not tell the force of contact on an object, by its number, ascending; with ``in_sum`` why they do not
    tell its part of the sum over all objects, to which forces between some of these add nothing."""
    held = [m for m, solid in enumerate(scene.solids) if solid.hold]
    found, mutual = dict.fromkeys(held, HELD), dict[int, str]()
    for effect in effects:
        inner = effect.mutual(scene)
        for m, why in effect.untold(scene).items():
            (mutual if m in inner else found).setdefault(m, why)
    if len(held) == len(found) == 1 and len(scene.solids) > 1 and not Acting(scene, effects).planes:
        found = {}
    return dict(sorted((found if in_sum else mutual | found).items()))
