# SPDX-License-Identifier: GPL-2.0-only
"""Ten thousand objects of 27 particles: built, certified and run without a step that looks at all pairs."""

import numpy as np
from crowd_text import TEXT
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene


def test_ten_thousand_objects_build_and_run():
    """Build, set up and advance a crowd until it has met ground and neighbours; a hidden N^2 would run into the time limit."""
    ready = prepare(parse_scene(TEXT))
    system = ready.system
    assert len(system.names) == 10_000 and system.particles == 270_000
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(40)
        x = instance.array("x")
        assert np.isfinite(x).all()
        assert instance.fix_value("contact", 2) > 100 and instance.fix_value("ground", 4) > 1e-4
        # Only near ones can meet: the 8 neighbours in the square lattice, and few more as they move; all pairs are 5e7.
        assert instance.fix_value("contact", 0) < 10 * 10_000
        assert x[:, 2].min() > -0.05
