# SPDX-License-Identifier: GPL-2.0-only
"""Forces and torques on objects as a whole, by ``fix mdanim/force`` (docs/physics-drives.md, "Forces and torques")."""

from __future__ import annotations

import math

import numpy as np

from ...effects.context import Verdict
from ...effects.effect import Effect
from ...model import shapes
from ...model.added import tensor_of
from ...reach import Throw
from ...scene.formatting import in_full
from ...scene.once import once_for
from ..rigid.effect import molecule_ranges

GROUP = "forced"
"""Group of the particles of all objects with a force or torque."""
FORCES = "forces"
"""Table of forces."""
WORK = "work"
"""Column of the ledger: energy that they have brought in."""


IN_A_WINDOW = 20.0
"""Steps in the time T that a force acts: energy and work differ by (dt/2T)^2 of it while it acts."""


class Forces(Effect):
    """f = m (F/M + (I^-1 T) x (x - c)) on each particle of an object with the mass M, the moments I and the centre of mass c [N]:
    their sum is F, that of their torques about c is T (docs/physics-drives.md, "Forces and torques").
    """

    styles = (("fix", "mdanim/force"),)
    name = "forces"
    fix = "force"
    order = 120
    if_off = "nothing pushes the objects that have a force or torque"

    def called_for(self, scene, reach):
        for solid in scene.solids:
            if pushed(solid):
                word = "force" if solid.force else "torque"
                return Verdict(self.name, True, f"{solid.name} has a {word}", solid.spans.get(word))
        return Verdict(self.name, False, "no object has a force or torque")

    def acts_on(self, context):
        return any(map(pushed, context.solids))

    def throws(self, scene):
        return throws(scene)

    def commands(self, context):
        forced = np.array([pushed(s) for s in context.solids], bool)
        return [f"group {GROUP} molecule {molecule_ranges(forced)}", f"fix {self.fix} {GROUP} mdanim/force forces table:{FORCES}"]

    def tables(self, context):
        lines = (f"{m + 1} {words_of(s)}\n" for m, s in enumerate(context.solids) if pushed(s))
        return {FORCES: "# Forces on objects, written by mdanim-lammps: molecule words\n" + "".join(lines)}

    def max_timestep(self, context):
        """A part of the shortest time that a force acts."""
        time = context.scene.control.time
        windows = (_seconds(one, time) for s in context.scene.solids for one in (*s.force, *s.torque))
        return min((w / IN_A_WINDOW for w in windows if w > 0.0), default=math.inf)

    def impulses(self, scene, mass, times, center):
        found = np.zeros((len(times), len(mass), 3))
        for m, solid in enumerate(scene.solids):
            for one in solid.force:
                begin, end = one.begin or 0.0, np.inf if one.end is None else one.end
                found[:, m] += np.clip(times - begin, 0.0, end - begin)[:, None] * np.array(one.vector)
        return found

    def sources(self, scene):
        return (WORK,)

    def lost(self, readings):
        return {WORK: readings.fix_value(self.fix, WORK)}


def pushed(solid) -> bool:
    """Whether an object has a force or torque."""
    return bool(solid.force or solid.torque)


def words_of(solid) -> str:
    """Its forces in the words of the fix."""
    return " ".join(
        f"{word} {in_full(one.vector)}"
        + "".join(f" {at} {t!r}" for at, t in (("from", one.begin), ("to", one.end)) if t is not None)
        for word in ("force", "torque")
        for one in getattr(solid, word)
    )


@once_for(lambda scene: scene)
def throws(scene) -> dict[int, Throw]:
    """The most speed, and the most acceleration, that forces give any point of each object that has some: those of a body that
    does not deform, all forces one way."""
    found = {}
    for m, solid in enumerate(scene.solids):
        if not pushed(solid):
            continue
        mass, arm = shapes.mass(solid), shapes.radius(solid.shape)
        most = [(float(np.linalg.norm(one.vector)) / mass, one) for one in solid.force]
        if solid.torque:
            least = float(np.linalg.eigvalsh(tensor_of(solid))[0])
            most += [(float(np.linalg.norm(one.vector)) / least * arm, one) for one in solid.torque]
        speed = sum(a * _seconds(one, scene.control.time) for a, one in most)
        lasting = sum(a * (math.inf if one.end is None else _seconds(one, one.end)) for a, one in most if a)
        word = "force" if solid.force else "torque"
        found[m] = Throw(
            float(speed),
            acceleration := float(sum(a for a, _ in most)),
            float(lasting),
            acceleration,
            f"the {word} of {solid.name}",
            f"write {word} … to T in {solid.name} with the time T at which it ends"
            if math.isinf(lasting)
            else f"write less {word}",
            solid.spans.get(word),
        )
    return found


def _seconds(one, time: float) -> float:
    """How long a force acts until the end [s]."""
    return max(0.0, (time if one.end is None else min(one.end, time)) - (one.begin or 0.0))


EFFECTS = (Forces(),)
