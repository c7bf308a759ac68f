# SPDX-License-Identifier: GPL-2.0-only
"""Ten thousand objects of 27 particles: built, certified and run without a step that looks at all pairs."""

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

TEXT = """
gravity (0, 0, -9.81)
ground z 0
repeat i in 0 .. 99 {
  repeat j in 0 .. 99 {
    object b[100*i + j] {
      shape box (10, 10, 10) cm
      position (0.13*i, 0.13*j, 0.0502 + 0.002*((i + j) mod 2)) m
      density 1000
      elasticity 100 kPa
      velocity (rand(-1, 1), rand(-1, 1), -1)
    }
  }
}
control {
  time 1 s
  resolution 5 cm
}
"""


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
