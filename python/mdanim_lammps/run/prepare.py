# SPDX-License-Identifier: GPL-2.0-only
"""From a scene to a plan that can run: models, geometry, effects, certificate. Nothing is written, nothing is run."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from .. import features
from ..bodies import kinds
from ..certificate import Certificate, certify
from ..certificate import warnings as margin_warnings
from ..effects import Context, Resolved, Verdict, resolve
from ..engine.overlaps import Overlaps
from ..engine.plan import Plan, make_plan
from ..errors import Problem, RefusedError, SceneError
from ..model.build import build_models
from ..model.grid import Grid
from ..model.model import Model
from ..model.overlap import check_geometry
from ..model.spacing import Spacing, nothing_in, plan_spacing, too_large
from ..model.system import System, as_parts, assemble
from ..reach import Reach
from ..records import dataclass
from ..results.quantities import unmeasured
from ..scene.lammps_lines import check_trust, note
from ..scene.lock import lock_text
from ..scene.meshes import mesh_files
from ..scene.scene import Expect, SceneRecord


@dataclass(frozen=True)
class Prepared:
    """A scene that is ready to run."""

    context: Context
    warnings: tuple[Problem, ...]
    certificate: Certificate
    plan: Plan
    insist: bool = False
    """Whether a time step above the bound was asked for all the same (``--allow-unstable``)."""

    @property
    def scene(self) -> SceneRecord:
        return self.context.scene

    @property
    def models(self) -> tuple[Model, ...]:
        """Models of all solids, in the order of the scene."""
        return self.context.models

    @property
    def system(self) -> System:
        """All solids as particles."""
        return self.context.system

    @property
    def resolved(self) -> Resolved:
        return self.context.resolved

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """Verdicts on all effects, by their names."""
        return self.resolved.verdicts

    @cached_property
    def lock(self) -> str:
        """The text of scene.lock.txt: what the run is made from."""
        return lock_text(self.scene, mesh_files(self.scene))


def prepare(scene: SceneRecord, *, allow_unstable: bool = False) -> Prepared:
    """Build, check and certify a scene.

    Raises SceneError with all problems of its geometry, RefusedError when it does not fit in memory or its time step is
    above the bound.
    """
    check_trust(scene)
    spacing = plan_spacing(scene)
    try:
        return _prepare(scene, spacing, allow_unstable)
    except MemoryError:
        raise SceneError([too_large(scene, spacing)]) from None


def _prepare(scene: SceneRecord, spacing: Spacing, allow_unstable: bool) -> Prepared:
    resolved = resolve(features.effects(), scene, spacing.of)
    grid = next((cells for e in resolved.effects if (cells := e.grid(scene, spacing.h))), None)
    drives = {m for e in resolved.effects for m in e.drives(scene)}
    models = build_models(scene, spacing.of, driven=drives)
    if not models and grid is None:
        raise nothing_in(scene)
    planes = [p for e in features.effects() for p in e.of(scene).planes(scene)]  # also of those that are off
    contact = next((e.of(scene) for e in features.effects() if e.keeps_apart), None)
    passing = _Passing(resolved)
    overlaps = Overlaps(lambda m: next((line for e in resolved.effects if (line := e.outline(scene, m)) is not None), None))
    problems = check_geometry(scene, models, planes, contact, passing, overlaps) + [
        p for e in resolved.effects for p in e.problems(resolved, models, grid)
    ]
    problems += _unmeasurable(resolved) + _undriven(resolved, models)
    if problems:
        # A wrong scale comes before where it leads.
        raise SceneError(sorted([*problems, *scene.warnings], key=lambda problem: problem.order))
    context = _context(resolved, models, spacing, grid)
    if any(model.held.all() and not len(model.hexahedron) for model in models) and any(
        e.needs_inside(context) for e in resolved.effects
    ):
        context = _context(resolved, build_models(scene, spacing.of, driven=drives, inside=True), spacing, grid)
    if fitted := {m: model for kind in kinds() for m, model in kind.fitted(context).items()}:
        fit = [fitted.get(m, model) for m, model in enumerate(context.models)]
        context = _context(resolved, fit, spacing, grid)
    certificate = certify(context, allow_unstable=allow_unstable)
    if not allow_unstable:
        _refuse(certificate)
    plan = make_plan(context, certificate)
    warnings = [*scene.warnings, *note(scene), *resolved.warnings, *(w for e in resolved.effects for w in e.warnings(context))]
    return Prepared(context, (*warnings, *margin_warnings(certificate)), certificate, plan, allow_unstable)


class _Passing(Container):
    """Pairs of solids i < j that may be in each other: an effect says so, or both move as one rigid body."""

    def __init__(self, resolved: Resolved):
        self.pairs = {pair for e in resolved.effects for pair in e.passes(resolved.scene)}
        self.body = {m: group[0] for e in resolved.effects for group in e.unites(resolved.scene) for m in group}

    def __contains__(self, pair: Any) -> bool:
        return pair in self.pairs or (pair[0] in self.body and self.body[pair[0]] == self.body.get(pair[1]))


def _refuse(certificate: Certificate) -> None:
    """Raise RefusedError where limits are passed with which no run goes well."""
    passed = [
        Problem(m.span, m.text, f"{m.hint}, or insist with --allow-unstable")
        for m in certificate.margins
        if m.severity == "refused"
    ]
    if passed:
        raise RefusedError("\n".join(map(str, passed)))


def _context(resolved: Resolved, models: Sequence[Model], spacing: Spacing, grid: Grid | None) -> Context:
    system = assemble(models, resolved.scene)
    reach = Reach(resolved.scene, resolved.effects, spacing.of, system)
    return Context(resolved, system, as_parts(models, system), spacing, reach, grid)


def _unmeasurable(resolved: Resolved) -> list[Problem]:
    """A problem for every quantity that is asked for and that of an effect that is off, or that frames do not tell."""
    wanted = [of for of in resolved.scene.asked if isinstance(of, Expect) or not of.optional]
    off = [
        Problem(
            of.span,
            f"{of.subject}.{of.quantity} needs the {needs}, which is off ({resolved.verdicts[needs].reason})",
            f"take this line out, or switch the {needs} on",
        )
        for of in wanted
        if (needs := of.kind.needs) and not resolved.on(needs)
    ]
    return [*off, *unmeasured(resolved.scene, wanted), *_no_arrows(resolved.scene)]


def _no_arrows(scene: SceneRecord) -> list[Problem]:
    """A problem for each line of arrows of all objects that would show none."""
    names = [solid.name for solid in scene.solids]
    found = []
    for line in (one for one in scene.render.arrows if one.name is None):
        problems = unmeasured(scene, line.asked(names))
        if len(problems) == len(names):  # the components of an arrow have one
            found.append(replace(problems[0], hint="take this line out, or show another one, e.g. arrows velocity"))
    return found


def _undriven(resolved: Resolved, models: Sequence[Model]) -> list[Problem]:
    """A problem for each solid that cannot be driven: nothing of it is held, or two effects would move it."""
    found: list[Problem] = []
    by: dict[int, str] = {}
    for effect in resolved.effects:
        for m, drive in effect.drives(resolved.scene).items():
            solid, name = resolved.scene.solids[m], resolved.scene.solids[m].name
            cause = ""
            if not models[m].held.any() and models[m].pinned is None:
                cause = f"nothing of {name} is held, so nothing of it can be driven or released"
                way_out = "write hold all, or hold face -x for a part of it"
            elif m in by:
                cause, way_out = f"{name} is driven by {by[m]} and by {effect.name}", "leave one of them out"
            if cause:
                place = drive.span or solid.spans.get("hold", solid.spans.get("object"))
                found.append(Problem(place, cause, way_out))
            by[m] = effect.name
    return found
