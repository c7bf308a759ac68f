# SPDX-License-Identifier: GPL-2.0-only
"""Which effects are on in a scene, and why."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import Problem
from ..reach import Reach
from ..scene.scene import SceneRecord, Switch
from .context import Resolved, Verdict
from .effect import Effect


def resolve(effects: tuple[Effect, ...], scene: SceneRecord, h: Sequence[float] | None = None) -> Resolved:
    """Decide on every effect of a scene, whose particle spacing is h [m] where that is known: by what the scene calls for and by
    its own switches, with warnings about needed ones switched off.

    Raises SceneError for a mesh that is not a closed solid.
    """
    effects = tuple(e.of(scene) for e in effects)
    verdicts: dict[str, Verdict] = {}
    warnings: list[Problem] = []
    reach = Reach(scene, acting(effects, scene), h)
    for effect in effects:
        own = effect.called_for(scene, reach)
        switch = scene.effects.get(effect.name, Switch.AUTO)
        span = scene.spans.get(f"effects.{effect.name}")
        if switch is Switch.OFF and own.on:
            warnings.append(
                Problem(
                    span,
                    f"{effect.name} is switched off, but the scene calls for it ({own.reason})",
                    effect.if_off,
                    severity="warning",
                )
            )
            own = Verdict(effect.name, False, f"switched off; {effect.if_off}", span)
        elif switch is Switch.ON and not own.on:
            warnings.append(
                Problem(
                    span,
                    f"{effect.name} cannot be switched on: {own.reason}",
                    "an effect is on if the contents of the scene call for it",
                    severity="warning",
                )
            )
        verdicts[effect.name] = own
    for effect in effects:
        missing = next((name for name in effect.needs if not verdicts[name].on), None)
        if (own := verdicts[effect.name]).on and missing:
            verdicts[effect.name] = Verdict(effect.name, False, f"{missing} is off", own.span)
    return Resolved(scene, verdicts, tuple(e for e in effects if verdicts[e.name].on), tuple(warnings))


def acting(effects: tuple[Effect, ...], scene: SceneRecord) -> tuple[Effect, ...]:
    """Effects that a scene does not switch off, neither themselves nor those that they require."""
    off: set[str] = set()
    for effect in effects:
        if scene.effects.get(effect.name) is Switch.OFF or off.intersection(effect.needs):
            off.add(effect.name)
    return tuple(e.of(scene) for e in effects if e.name not in off)
