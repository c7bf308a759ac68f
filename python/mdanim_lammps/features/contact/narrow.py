# SPDX-License-Identifier: GPL-2.0-only
"""Held things that are narrower than what meets them is resolved for, and slim tips: what ``check`` tells of them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ...effects.envelope import Envelope
from ...effects.margin import Margin
from ...model import shapes
from ...scene.formatting import at_least, at_most, number, say
from ...scene.scene import Cone
from .body import COARSEST, PLATE, is_flat
from .words import ContactModel

END = 1.0
"""Cells over the thickness of a rod that its end holds at a thirtieth of the wave speed; the edge of a plate holds COARSEST."""

SLIMMEST = 10.0 / 3.0
"""Height over radius of a cone whose tip holds a ball at a thirtieth of the wave speed, whatever its cells
(docs/physics-contact.md, "Narrow things")."""


def widest_cells(shape: shapes.Shape) -> float:
    """Cells [m] that an end or an edge of a held shape holds; infinite where the shape is not slender."""
    thin, (low, high) = shapes.thickness(shape), shapes.extent(shape)
    if (high - low).max() < PLATE * thin:
        return np.inf
    return thin * (COARSEST if is_flat(shape) else END)


def narrow(envelope: Envelope) -> list[Margin]:
    """The cells of what deforms beside those that a held thing holds that it may meet: where they are wider, few points of either
    meet, and one may go through the other."""
    scene, system, cells = envelope.scene, envelope.system, _cells(envelope)
    holds = {m: widest_cells(scene.solids[m].shape) for m in np.flatnonzero(system.held_whole).tolist()}
    worst = _worst(envelope, ((n, cells / wide) for n, wide in holds.items() if np.isfinite(wide)))
    if worst is None:
        return []
    used, m, n = worst
    own = "resolution" in scene.solids[m].spans
    return [
        Margin(
            "narrow part",
            system.names[m],
            float(cells[m]),
            holds[n],
            "m",
            f"{system.names[m]} may meet {system.names[n]} with cells of {say(float(cells[m]), 'm')}; an edge or an end of "
            f"{system.names[n]}, {say(shapes.thickness(scene.solids[n].shape), 'm')} thick, holds cells of "
            f"{say(holds[n], 'm')}, and may go through wider ones",
            envelope.place(m, "resolution", "shape") if own else scene.control.spans.get("resolution"),
            "warning" if used > 1.05 else "ok",
            hint=f"write resolution {say(at_most(holds[n]), 'm')} in {system.names[m]}, or a thicker {system.names[n]}, "
            "unless they meet at a broad side of it",
        )
    ]


def slim_tips(envelope: Envelope) -> list[Margin]:
    """The slimmest held cone that something that deforms may meet: one point of a tip acts along its axis."""
    scene, system, soft = envelope.scene, envelope.system, _cells(envelope) > 0.0
    shapes_of = {n: scene.solids[n].shape for n in np.flatnonzero(system.held_whole).tolist()}
    worst = _worst(envelope, ((n, soft * (s.height / s.radius)) for n, s in shapes_of.items() if isinstance(s, Cone)))
    if worst is None:
        return []
    slim, m, n = worst
    wide = say(at_least(slim * scene.solids[n].shape.radius / SLIMMEST), "m")
    return [
        Margin(
            "slim tip",
            system.names[n],
            slim,
            SLIMMEST,
            "",
            f"{system.names[n]} is {number(slim)} times as high as its radius; {system.names[m]} may fall on its tip, which may "
            f"go through it beyond {number(SLIMMEST)} times",
            envelope.place(n, "shape"),
            "warning" if slim > SLIMMEST else "ok",
            hint=f"write a radius of {wide} or more, unless they meet at its side",
        )
    ]


def _cells(envelope: Envelope) -> np.ndarray:
    """Width of the cells of each solid that deforms and touches by its surface [m], 0 for others, shape (M,)."""
    system, by_surface = envelope.system, envelope.scene.control.contact_model is ContactModel.SURFACE
    return np.where(system.rigid | system.held_whole | system.bare | (not by_surface), 0.0, np.cbrt(system.cell_volume))


def _worst(envelope: Envelope, parts: Iterable[tuple[int, np.ndarray]]) -> tuple[float, int, int] | None:
    """The largest number, what deforms and what it may meet; ``parts`` are held solids, each with a number for every solid, shape
    (M,), 0 for those that do not count. None where nothing meets."""
    worst: tuple[float, int, int] | None = None
    for n, numbers in parts:
        soft = np.flatnonzero(numbers > 0.0)
        met = soft[envelope.reach.region.may_touch(soft, np.full(len(soft), n))]
        if len(met) and (worst is None or numbers[met].max() > worst[0]):
            m = int(met[numbers[met].argmax()])
            worst = float(numbers[m]), m, n
    return worst
