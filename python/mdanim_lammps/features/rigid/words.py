# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import Enum
from typing import Any, ClassVar

from ...records import dataclass
from ...scene.formatting import say
from ...scene.holding import all_held
from ...scene.schema import Words, setting
from ...scene.shapes import Box, holds_all

SWITCHES = {"rigid": "an object's `elasticity rigid`"}


@dataclass(frozen=True, slots=True)
class Rigid:
    """No elasticity: the object moves as a whole."""

    FORMS: ClassVar = ("rigid",)
    ABOUT: ClassVar = (
        "`rigid`: the object does not deform, has exactly the mass and the moments of inertia of its shape, and takes few "
        "particles; not with `damping`, nor where a part of it is held."
    )
    modulus: ClassVar = math.inf
    """[Pa]"""


ELASTICITIES = (Rigid,)


class Sleep(Enum):
    """Whether rigid objects that lie still cost nothing until something stirs them."""

    ON, OFF = "on", "off"


class SleepWords:
    """Settings of ``control``."""

    sleep: Sleep = setting(
        "<on|off>",
        "Rigid objects that lie still are put to rest, and take no time until the forces on them change: for heaps and rows of "
        "dominoes. What is in slow motion, as a ball that hardly rolls any more, then stops.",
        "on", default=Sleep.OFF, codec=Words(Sleep), after="restitution")  # fmt: skip


CONTROL = SleepWords

MARGINS = {
    "blow depth": "how deep rigid objects go into each other in the fastest blow; above a twentieth of their thickness it shows",
    "rest depth": "how deep a rigid object sinks in at rest by what it bears; above 1/200 of its thickness it shows",
}

LEDGER = {
    "contact_bound": "the largest dt^2 S/4 + dt D/2 of a rigid object since the start, with the sums S and D of stiffness and "
    "damping over its contacts [-]; up to 1 proves that the step is stable, and with up to 12 all has been seen to come to rest"
}
"""Columns of the ledger that are not energies."""

SENSELESS = {
    "damping": ("damping is that of springs, and a rigid object has none", "leave it out; contact-damping damps its blows")
}
"""Settings that a rigid object cannot have, with cause and way out."""


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Settings that make no sense in a rigid object."""
    if not isinstance(solid.elasticity, Rigid):
        return solid
    for word, (cause, way_out) in SENSELESS.items():
        if getattr(solid, word):
            v.problem(solid.spans[word], f"{solid.name} is rigid: {cause}", way_out)
    if solid.hold and not holds_all(solid.hold):
        cause = f"{solid.name} is rigid, so it cannot be held in a part of it while the rest moves"
        v.problem(solid.spans["hold"], cause, "write hold all, or give the object an elasticity")
    return solid


ONE_PLACE = 1e-6
"""Distance of two corners, over the diagonal, below which the fix takes them for one."""


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """Things that do not fit together, of all objects."""
    _check_thickness(v, held)
    _check_paper(v, held)
    _check_sleep(v, top, held)
    _check_colors(v, held)


def _check_thickness(v: Any, held: Mapping) -> None:
    """Corners of a cuboid that touches by its features are apart."""
    solids = held["solids"]
    if not any(isinstance(s.elasticity, Rigid) and not all_held(s) for s in solids):
        return
    for solid in (s for s in solids if isinstance(s.shape, Box)):
        thin, size = min(solid.shape.size), math.hypot(*solid.shape.size)
        if thin <= ONE_PLACE * size and (isinstance(solid.elasticity, Rigid) or holds_all(solid.hold)):
            cause = f"{solid.name} is {say(thin, 'm')} thin, less than a millionth of its size, {say(size, 'm')}"
            v.problem(solid.spans["shape"], cause, f"make it thicker than {say(1.01 * ONE_PLACE * size, 'm')}")


def _check_paper(v: Any, held: Mapping) -> None:
    """The contact of the paper is a barrier between particles of lattices with springs."""
    control = held["control"]
    if control is None or control.contact_model.value != "paper":
        return
    for solid in (s for s in held["solids"] if isinstance(s.elasticity, Rigid)):
        cause = f"{solid.name} is rigid; the contact of the paper follows from the elasticity of both objects"
        way_out = "take contact-model paper out of control, or give the object an elasticity"
        v.problem(solid.spans["elasticity"], cause, way_out, key="rigid-paper")


def _check_sleep(v: Any, top: Mapping, held: Mapping) -> None:
    """Objects that can lie still are rigid, and gravity keeps them where they are."""
    control = held["control"]
    if control is None or control.sleep is Sleep.OFF:
        return
    rigid = any(isinstance(s.elasticity, Rigid) and not all_held(s) for s in held["solids"])
    if not rigid or not any(map(any, (top.get("gravity", ()), *(g for _, g in top.get("gravity_path", ()))))):
        cause = f"sleep does nothing: {'there is no gravity' if rigid else 'no object that can move is rigid'}"
        v.problem(control.spans["sleep"], cause, "leave it out", severity="warning", key="sleep")


def _check_colors(v: Any, held: Mapping) -> None:
    """Colours of strain and stress are of what deforms."""
    render, solids = held["render"], held["solids"]
    word = render.color_by.value if render is not None and render.color_by else ""
    if solids and word in ("strain", "stress") and all(isinstance(s.elasticity, Rigid) or all_held(s) for s in solids):
        cause = f"color-by {word} shows nothing: no object deforms, as all are rigid or held"
        v.problem(render.spans["color-by"], cause, "write color-by speed, or give an object an elasticity", "warning")


CHECKS = {"object": check_object}
