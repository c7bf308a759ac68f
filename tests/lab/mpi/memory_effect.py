# SPDX-License-Identifier: GPL-2.0-only
"""An effect that only tests know: forces depend on the history of particles and of pairs of objects (tests/lab/plugin).

To be imported before everything that looks at the table of effects. Nothing else in the package knows this effect.
"""

import os
import sys

import plugin_library
from mdanim_lammps import effects
from mdanim_lammps.engine.plugin import folder

assert "mdanim_lammps.run.prepare" not in sys.modules, "too late: the table of effects has been read"


class Memory(effects.Effect):
    name = "memory"
    fix_id = "memory"

    def called_for(self, scene, reach):
        return effects.Verdict(self.name, True, "a test wants it")

    def commands(self, context):
        reach = 0.4 * float(
            context.system.spacing.max()
        )  # objects farther apart than contact reaches must not matter to each other
        return [f"fix {self.fix_id} mobile mdanim/test/memory {reach!r} 1e-4 1e-3"]


effects.EFFECTS = (*effects.EFFECTS, Memory())
os.environ["LAMMPS_PLUGIN_PATH"] = ":".join([folder(), str(plugin_library.build().parent)])
