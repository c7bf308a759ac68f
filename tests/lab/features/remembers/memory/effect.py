# SPDX-License-Identifier: GPL-2.0-only
"""Forces with a memory, by ``fix mdanim/test/memory``."""

from mdanim_lammps.effects import Effect, Verdict


class Memory(Effect):
    """Always on."""

    name = "memory"

    def called_for(self, scene, reach):
        return Verdict(self.name, True, "a test wants it")

    def commands(self, context):
        # Objects farther apart than contact reaches must not matter to each other.
        reach = 0.4 * float(context.system.spacing.max())
        return [f"fix memory mobile mdanim/test/memory {reach!r} 1e-4 1e-3"]


EFFECTS = (Memory(),)
