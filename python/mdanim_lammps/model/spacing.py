# SPDX-License-Identifier: GPL-2.0-only
"""The particle spacing of a scene (Wcislo 1999, sec. 5.2) and of objects with one of their own, and whether the scene fits in
memory."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..bodies import kind_of, kinds
from ..errors import Problem, SceneError
from ..features import facets
from ..processes import available_memory
from ..records import dataclass
from ..scene.formatting import at_most, number, say, whole
from ..scene.scene import Box, Mesh, SceneRecord, Shape, Solid
from . import shapes, work
from .limits import check_places, check_sparse
from .mesh import MeshError, read_ahead


@dataclass(frozen=True, slots=True)
class Spacing:
    """The spacing of a scene, what asked for it, and what it costs."""

    h: float
    """Particle spacing of all that has none of its own [m]."""
    of: tuple[float, ...]
    """Particle spacing of each solid [m]."""
    set_by: str
    """Name of the solid with the thinnest part, ``resolution``, or what a scene without solids goes by."""
    particles: tuple[int, ...]
    """Estimated number of particles of each solid, in the order of the scene."""
    memory: float
    """Estimated memory of all solids [bytes]."""
    available: float
    """Memory that this machine has free [bytes]."""

    @property
    def total(self) -> int:
        """Estimated number of particles in all."""
        return sum(self.particles)


def plan_spacing(scene: SceneRecord) -> Spacing:
    """Choose the spacing: ``resolution``, else the thinnest part of all solids over the cells that accuracy
    asks.

    Raises SceneError, with a problem for every solid that is thinner than the spacing, too far from the origin or too sparse in
    its bounding box, or whose mesh is not a body, and where the particles would not fit in memory.
    """
    h, set_by, thin = choose_spacing(scene)
    of = spacings(scene, h)
    problems = check_places(scene, of)
    too_thin: dict[tuple, list[str]] = {}  # objects of a repeat are one problem
    for solid, own, t in zip(scene.solids, of, thin):
        kind = kind_of(solid)
        if own * kind.least(scene, solid) > t * (1 + 1e-9):
            enough = at_most(t / min(2.0, kind.cells(scene, solid)))
            too_thin.setdefault((_span(solid), t, own, enough, solid.resolution is None), []).append(solid.name)
    for (span, t, own, enough, shared), names in too_thin.items():
        more = f" and {whole(len(names) - 1)} more" if len(names) > 1 else ""
        problems.append(
            Problem(
                span,
                f"{names[0]}{more}: thinner than the spacing allows, {say(t, 'm')} at its thinnest, spacing {say(own, 'm')}",
                f"write resolution {say(enough, 'm')} {'in control' if shared else 'in it'}, or make it thicker",
            )
        )
    if problems:
        raise SceneError(problems)
    particles = tuple(estimate_particles(solid.shape, own) if kind_of(solid).fills else 0 for solid, own in zip(scene.solids, of))
    filled = [
        (s, own, n) for s, own, n in zip(scene.solids, of, particles) if (kind := kind_of(s)).fills and not kind.bare(scene, s)
    ]
    if sparse := [p for s, own, n in filled if (p := check_sparse(s, own, n))]:
        raise SceneError(sparse)
    particles = tuple(kind_of(s).particles(scene, s, n, own) for s, n, own in zip(scene.solids, particles, of))
    plan = Spacing(h, of, set_by, particles, work.memory(scene, of, particles), available_memory())
    if plan.memory > plan.available:
        raise SceneError([too_large(scene, plan)])
    return plan


def choose_spacing(scene: SceneRecord) -> tuple[float, str, list[float]]:
    """The spacing of the scene [m], what asked for it, and the thinnest part of every solid [m]; whether it will do is not looked
    at. Solids with a spacing of their own do not ask for one, unless all have one: then the least is that of the scene.

    Raises SceneError with a problem for every solid whose mesh is not a body.
    """
    problems = []
    thin = []
    read_ahead(solid.shape for solid in scene.solids)
    for solid in scene.solids:
        try:
            thin.append(shapes.thickness(solid.shape))
        except MeshError as error:
            problems.append(Problem(_span(solid), f"{solid.name}: {error}", error.hint))
    if problems:
        raise SceneError(problems)
    return *_choose(scene, thin), thin


def spacings(scene: SceneRecord, h: float) -> tuple[float, ...]:
    """Spacing of each solid [m]: its own, where its kind of body has one, or else what that takes where that of the scene is h
    [m]."""
    of = {kind: (kind.spacing(scene, h), kind.has_spacing(scene)) for kind in kinds()}
    found = []
    for solid in scene.solids:
        usual, has_own = of[kind_of(solid)]
        found.append(solid.resolution if has_own and solid.resolution is not None else usual(solid))
    return tuple(found)


def scaled(scene: SceneRecord, factor: float | None) -> SceneRecord:
    """The scene with the spacings that solids have of their own times a factor; None takes them away."""
    own = lambda s: s.resolution and (None if factor is None else factor * s.resolution)
    return replace(scene, solids=tuple(s if s.resolution is None else replace(s, resolution=own(s)) for s in scene.solids))


def _choose(scene: SceneRecord, thin: list[float]) -> tuple[float, str]:
    control = scene.control
    if control.resolution is not None:
        return control.resolution, "resolution"
    if thin:
        needed = [t / kind_of(s).cells(scene, s) for s, t in zip(scene.solids, thin)]
        asks = {kind: kind.asks(scene) for kind in kinds()}
        sets = [s.resolution is None and asks[kind_of(s)](s) for s in scene.solids]
        wanted = np.where(sets, needed, np.inf)
        if not any(sets):
            counts = [kind_of(s).fills for s in scene.solids]
            needed = np.where(counts, needed, np.inf) if any(counts) else needed
            wanted = [own if s.resolution is None else s.resolution for s, own in zip(scene.solids, needed)]
        k = int(np.argmin(wanted))
        return float(wanted[k]), scene.solids[k].name
    for words in facets("words"):
        if hasattr(words, "width") and (found := words.width(scene)):
            return found[0] / control.accuracy.cells, found[1]
    raise nothing_in(scene)


def nothing_in(scene: SceneRecord) -> SceneError:
    """The error of a scene in which there is nothing to simulate."""
    way_out = "write an object, e.g.  object ball { shape sphere 10 cm  position (0, 0, 1) m  material rubber }"
    return SceneError([Problem(next(iter(scene.spans.values()), None), "there is nothing in the scene", way_out)])


@lru_cache(maxsize=4096)
def estimate_particles(shape: Shape, h: float) -> int:
    """Estimated number of particles of a shape at spacing h [m]: exact for a cuboid that h divides.

    A cell has one particle of its own, and a face on the surface half of one more. The staircase of a surface
    that is turned every way is 3/2 as large as the surface.
    """
    if isinstance(shape, Box):
        return int(np.prod(np.rint(np.array(shape.size) / h) + 1))
    return int(shapes.volume(shape) / h**3 + 0.5 * 1.5 * shapes.area(shape) / h**2) + 8


def too_large(scene: SceneRecord, plan: Spacing) -> Problem:
    """The problem of a scene that does not fit in memory, and how it would."""
    found = (
        f"about {whole(plan.total) if plan.total < 1e9 else number(plan.total)} particles at a spacing of {say(plan.h, 'm')} "
        f"need {_gigabytes(plan.memory)} GB, {_gigabytes(plan.available)} GB are free"
    )
    if plan.memory <= plan.available:
        found += ", and memory has run out all the same"
    # Particles go with 1/h^3; a tenth on top, because surfaces go with 1/h^2 only.
    factor = 1.1 * max(1.0, plan.memory / max(plan.available, 1e6)) ** (1 / 3)
    coarser, most = plan.h * factor, int(np.argmax(plan.particles)) if plan.particles else None
    if most is not None and (own := scene.solids[most].resolution) is not None:
        span = scene.solids[most].spans.get("resolution")
        return Problem(span, f"{scene.solids[most].name}: {found}", f"try resolution {say(own * factor, 'm')} in it")
    if plan.set_by == "resolution":
        return Problem(scene.control.spans.get("resolution"), found, f"try resolution {say(coarser, 'm')}")
    if mesh := _without_scale(scene, plan):
        low, high = shapes.extent(mesh.shape)
        return Problem(
            _span(mesh),
            f"{mesh.name} is {say(float((high - low).max()), 'm')} long, as its mesh file is read in metres: {found}",
            "if the file is in mm or cm, write scale 0.001 or scale 0.01 after its name",
        )
    solid = next(s for s in scene.solids if s.name == plan.set_by)
    return Problem(
        _span(solid),
        f"{solid.name} sets the spacing: {found}",
        f"make it thicker, use fewer objects or a lower accuracy, or try resolution {say(coarser, 'm')}",
    )


def _without_scale(scene: SceneRecord, plan: Spacing) -> Solid | None:
    """The object with most particles, if its mesh file is read in metres and another object sets the spacing; else None."""
    largest = scene.solids[int(np.argmax(plan.particles))]
    in_metres = isinstance(largest.shape, Mesh) and largest.shape.scale == 1.0
    return largest if in_metres and largest.name != plan.set_by else None


def _gigabytes(size: float) -> str:
    size *= 1e-9
    return f"{size:.1f}" if size < 1e6 else number(size)


def _span(solid: Solid):
    return solid.spans.get("shape") or solid.spans.get("object")
