# SPDX-License-Identifier: GPL-2.0-only
"""The interface of a kind of body, and which kind an object is of."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from .. import features
from ..features import facets
from ..scene.holding import all_held
from ..scene.once import once_for
from ..scene.scene import Box, SceneRecord, Solid


class BodyKind:
    """A kind of body: how finely its objects are resolved, what that takes, and how their models are made.

    A subclass is in the module ``body`` of a feature's folder, which has KINDS, an instance of each. Of those that `takes` an
    object, the one of the lowest ``order`` makes it.
    """

    name = ""
    order = 1000
    deforms = True
    """Whether its particles move against each other, so that it can ring, break or fold inside out."""
    fills = True
    """Whether its particles fill its volume, so that cells across its thinnest part count, and others may touch it anywhere."""
    sets_spacing = True
    """Whether the thinnest part of such an object may set the spacing of the scene."""
    particle_bytes = 1500.0
    """Memory of a particle in models and LAMMPS together [bytes]."""
    particle_seconds = 4.5e-6
    """Processor time that it takes to make one [s] (`bench/modelling.py forecast`)."""

    def takes(self, solid: Solid) -> bool:
        """Whether an object is of this kind."""
        raise NotImplementedError

    def cells(self, scene: SceneRecord, solid: Solid) -> float:
        """Cells across its thinnest part that it should have. One that never moves need not bend, so two, the least that have an
        inside, are enough."""
        wanted = scene.control.accuracy.cells
        return min(wanted, 2) if all_held(solid) else wanted

    def asks(self, scene: SceneRecord) -> Callable[[Solid], bool]:
        """Which of its objects have a part in setting the spacing of a scene, by their thinnest parts."""
        return lambda solid: self.sets_spacing

    def spacing(self, scene: SceneRecord, h: float) -> Callable[[Solid], float]:
        """Particle spacing [m] of its objects that have no ``resolution`` of their own, where that of the scene is h [m]."""
        return lambda solid: h

    def least(self, scene: SceneRecord, solid: Solid) -> float:
        """Cells across its thinnest part that one of its objects has at least; 0 where it may be as thin as it likes."""
        return 1.0 if self.fills else 0.0

    def has_spacing(self, scene: SceneRecord) -> bool:
        """Whether something reads particles or points of them as far apart as their spacing, so that ``resolution`` sets it."""
        return True

    def particles(self, scene: SceneRecord, solid: Solid, lattice: float, h: float) -> float:
        """Estimated number of particles of an object at a spacing h [m]; ``lattice`` is that of a lattice that fills it, 0 of a
        kind that does not."""
        return lattice

    def bare(self, scene: SceneRecord, solid: Solid) -> bool:
        """Whether nothing reads cells of an object nor points of its surface, so that its spacing costs nothing."""
        return False

    def make(self, solid: Solid, h: float, shared: Any) -> Any:
        """The model (model/model.py) of an object at a particle spacing h [m]; ``shared`` makes what equal objects share
        (model/build.py).

        Raises cells.TooThin, mesh.MeshError, build.NothingHeld.
        """
        raise NotImplementedError

    def fitted(self, context: Any) -> dict[int, Any]:
        """Models of its objects that are others once it is known what they may meet, by numbers of objects, in the context
        (effects/context.py) of a scene."""
        return {}


def only_features(scene: SceneRecord) -> bool:
    """Whether all contacts of a scene are found from features of shapes alone: a module ``body`` may have a function
    `by_features` that says so. Then nothing reads points of surfaces, nor particles inside."""
    return any(facet.by_features(scene) for facet in facets("body") if hasattr(facet, "by_features"))


def driven(scene: SceneRecord) -> set[int]:
    """Numbers of the objects whose held particles some effect moves, if it is on. Known before effects are decided on, for which
    the spacing is needed."""
    return {m for effect in features.effects() for m in effect.of(scene).drives(scene)}


def unguided(scene: SceneRecord) -> set[int]:
    """Numbers of those of `driven` that no fix tells the places of (reach.Motion.guides)."""
    effects = (effect.of(scene) for effect in features.effects())
    return {m for effect in effects if not effect.guides for m in effect.drives(scene)}


BENEATH = 8
"""Cells across what bears lines or sheets of particles and does not have the shape of a cuboid, at least: the depth below its
surface is then true to a thousandth of its thickness (tests/model/test_depth_beneath.py)."""


def beneath(scene: SceneRecord, solid: Solid) -> int:
    """Cells across an object that does not deform that lines and sheets of particles ask for; 0 where there are none, and of a
    cuboid, whose depth is exact."""
    return BENEATH if not isinstance(solid.shape, Box) and has_bare(scene) else 0


@once_for(lambda scene: scene)
def has_bare(scene: SceneRecord) -> bool:
    """Whether an object is a line or a sheet of particles."""
    return any(not kind_of(s).fills for s in scene.solids)


@lru_cache(maxsize=1)
def kinds() -> tuple[BodyKind, ...]:
    """All kinds of bodies, in the order in which they are asked."""
    return tuple(sorted((kind for facet in facets("body") for kind in facet.KINDS), key=lambda kind: (kind.order, kind.name)))


def kind_of(solid: Solid) -> BodyKind:
    """The kind of body that an object is."""
    return next(kind for kind in kinds() if kind.takes(solid))
