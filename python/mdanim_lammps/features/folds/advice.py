# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on layers that may meet so fast that they pass through each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...effects.context import Context
from ...effects.envelope import Envelope
from ...errors import Problem
from ...model.triangles import areas
from ...records import dataclass
from ...scene.formatting import number, say
from ...scene.once import once_for
from ..contact.words import CONTACT_STIFFNESS
from .layers import LayerPair, layers, pairs

EFFECT = "folds"
"""The effect that has layers touch."""
ONSET = 0.2
"""Part of the reach over which the push of a contact begins, as in plugin/folds/law.h."""
DEPTH = 0.5 * (1.0 - 0.5 * ONSET) ** 2 + ONSET**2 / 24.0
"""g(R)/R^2, the energy of a contact at the distance 0, over k R^2."""


def passing_speeds(context: Context, these: Sequence[LayerPair]) -> tuple[np.ndarray, np.ndarray]:
    """Relative speeds from which on parts of two layers pass through each other [m/s], if neither yields before, each of shape
    (P,): a particle that comes alone, m v^2/2 = w k g(R), the least of both; and all of two sheets that meet flat, where
    the mass per area is mu = a b/(a + b) and both push: mu v^2/2 = k g(R) (W_A + W_B), with the sum W of weights per area. Else
    both are equal."""
    of = _loads(context)
    one, other = ([of[m] for m in ends] for ends in zip(*((pair.first, pair.second) for pair in these)))
    reach = np.array([pair.reach for pair in these])
    energy = 2.0 * DEPTH * np.array([pair.stiffness for pair in these])
    alone = reach * np.sqrt(energy / [max(a.heaviest, b.heaviest) for a, b in zip(one, other)])
    weights = np.array([a.weight + b.weight for a, b in zip(one, other)])
    per_mass = np.array([a.per_mass + b.per_mass for a, b in zip(one, other)])
    sheets = np.array([a.is_sheet and b.is_sheet for a, b in zip(one, other)])
    return alone, np.where(sheets, np.maximum(alone, reach * np.sqrt(energy * weights * per_mass)), alone)


@dataclass(frozen=True, slots=True)
class _Load:
    """The mass of a layer and its weights."""

    heaviest: float
    """Largest mass of a particle over its weight [kg]; 0 of what never moves."""
    is_sheet: bool
    per_mass: float = 0.0
    """Area of a sheet over its mass [m^2/kg]; 0 of one that never moves."""
    weight: float = 0.0
    """Sum of the weights of a sheet over its area [1/m^2]."""


@once_for(lambda context: context.system)
def _loads(context: Context) -> dict[int, _Load]:
    """Masses and weights of all `layers`."""
    system, found = context.system, {}
    for m, layer in layers(context).items():
        mass, still = system.mass[system.first[m] + layer.particle], bool(system.still[m])
        heaviest = 0.0 if still else float((mass / layer.weight).max())
        if layer.element.shape[1] == 3 and layer.half > 0.0:
            area = float(areas(layer.rest, layer.element).sum())
            per_mass = 0.0 if still else area / float(mass.sum())
            found[m] = _Load(heaviest, True, per_mass, float(layer.weight.sum()) / area)
        else:
            found[m] = _Load(heaviest, False)
    return found


def notes(envelope: Envelope) -> list[Problem]:
    """The two layers, or the one, that come the most too fast for their contact: a warning if they pass flat, a note if only
    single particles do, or if it takes a tear first."""
    if not any(effect.name == EFFECT for effect in envelope.on):
        return []
    context, these = envelope.context, pairs(envelope.context)
    if not these:
        return []
    meeting, passing = _Meeting(envelope), passing_speeds(context, these)
    speeds = meeting.of(these)
    n = int(np.argmax(speeds / passing[0]))
    pair, (fastest, alone, flat) = these[n], (float(row[n]) for row in (speeds, *passing))
    if fastest <= alone:
        return []
    one, other = (envelope.system.names[m] for m in (pair.first, pair.second))
    word = "parts" if pair.apart else "pieces"
    both = f"{word} of {one}" if pair.first == pair.second else f"{one} and {other}"
    through = f"layers that meet flat pass through each other from {say(flat, 'm/s')} on, " if flat > alone else ""
    singly = f"single particles get through from {say(alone, 'm/s')} on, and may stay there"
    cause = f"{both} may meet at {say(fastest, 'm/s')}: {through}{singly}"
    over = fastest / alone
    ways = [f"write a speed or a height for less than {say(alone, 'm/s')}"]
    thick = 1.02 * pair.reach * over
    both_layers = [layers(context)[m] for m in (pair.first, pair.second)]
    if all(one.half for one in both_layers) and thick <= max(one.spacing for one in both_layers):
        ways.append(f"a thickness of {say(thick, 'm')}" + ("" if one == other else " for both"))
    if (stiff := 1.02 * envelope.scene.control.contact_stiffness * over**2) <= CONTACT_STIFFNESS.most:
        ways.append(f"contact-stiffness {number(stiff)} in control")
    severity = "warning" if fastest > flat and not any(one.element.shape[1] == 8 for one in both_layers) else "note"
    comes = max(pair.first, pair.second, key=lambda m: (meeting.speed[m], -m))
    return [Problem(envelope.place(comes, "velocity", "position"), cause, ", or ".join(ways), severity=severity)]


class _Meeting:
    """How fast layers may meet, by heights and velocities at the start."""

    def __init__(self, envelope: Envelope):
        reach, system = envelope.reach, envelope.system
        self.g, self.fall, self.speed = reach.g, np.maximum(0.0, reach.fall), reach.speed
        self.low, self.high = system.bounds(system.velocity)
        below, above = system.bounds(system.position)
        self.tall = np.where(system.still, 0.0, (above - below)[:, 2])
        self.free = reach.free
        self.driven = reach.acting.driven_at + reach.acting.given + reach.acting.thrown_at

    def of(self, these: Sequence[LayerPair]) -> np.ndarray:
        """[m/s], shape (P,); parts of one object meet where some of it has been stopped, and the rest falls by its
        own height, too."""
        i, j = np.array([(pair.first, pair.second) for pair in these]).T
        apart = np.maximum(0.0, np.maximum(self.high[i] - self.low[j], self.high[j] - self.low[i]))
        start = np.linalg.norm(apart, axis=1) + self.driven[i] + self.driven[j]
        fall = np.where(self.free, self.fall, 0.0)
        itself = i == j
        start = np.where(itself, self.speed[i], start)
        return np.sqrt(start**2 + 2.0 * self.g * np.where(itself, self.tall[i], np.maximum(fall[i], fall[j])))
