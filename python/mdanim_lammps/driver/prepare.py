# SPDX-License-Identifier: GPL-2.0-only
"""From a scene to a plan that can run: models, geometry, effects, certificate. Nothing is written, nothing is run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from ..certificate import STRONG, Certificate, certify, hard_landing, strong_drag
from ..effects import EFFECTS, Verdict, decide
from ..engine.plan import Plan, make_plan
from ..errors import Problem, SceneError
from ..model.build import build_models
from ..model.model import Model
from ..model.overlap import check_geometry
from ..model.system import System, assemble
from ..scene.lock import lock_text
from ..scene.scene import Scene


@dataclass(frozen=True)
class Prepared:
    """A scene that is ready to run."""

    scene: Scene
    models: tuple[Model, ...]
    system: System
    verdicts: dict[str, Verdict]
    warnings: tuple[Problem, ...]
    certificate: Certificate
    plan: Plan

    @cached_property
    def lock(self) -> str:
        """The text of scene.lock.txt: what the run is made from."""
        return lock_text(self.scene)


def prepare(scene: Scene, *, allow_unstable: bool = False, progress: Callable[[int, int], None] | None = None) -> Prepared:
    """Build, check and certify a scene.

    Raises SceneError with all problems of its geometry, RefusedError when it does not fit in memory or its time step is
    above the bound.
    """
    if scene.liquid is not None:
        raise SceneError([Problem(
            scene.liquid.spans.get("liquid"),
            f"liquid '{scene.liquid.name}' is read, but liquid is not built yet",
            "take the liquid block out to run the solids alone",
        )])
    if not scene.solids:
        raise SceneError([Problem(
            None, "the scene has no object, so there is nothing to animate",
            "write one, e.g.  object cube { shape box (10, 10, 10) cm  density 1000  elasticity 100 kPa }",
        )])
    models = build_models(scene, progress=progress)
    problems = check_geometry(scene, models)
    errors = [p for p in problems if p.severity == "error"]
    if errors:
        raise SceneError(problems)
    system = assemble(models)
    verdicts, warnings = decide(EFFECTS, scene)
    certificate = certify(scene, system, verdicts, allow_unstable=allow_unstable)
    if verdicts["air-drag"].on and (phi := strong_drag(system, certificate.timestep)):
        warnings.append(Problem(
            verdicts["air-drag"].span,
            f"air drag is strong for this time step (phi = {phi:.2g} > {STRONG}, eq. (3.13))",
            "the exponential form is used instead of the paper's implicit one: same terminal speed, no overshoot",
            severity="warning",
        ))
    if (verdicts["springs"].on and (warning := hard_landing(scene, system))):
        warnings.append(warning)
    return Prepared(scene, tuple(models), system, verdicts, (*scene.warnings, *problems, *warnings), certificate,
                    make_plan(scene, system, verdicts, certificate))
