# SPDX-License-Identifier: GPL-2.0-only
"""Thousands of objects of 27 particles: built, certified and run without a step that looks at all pairs."""

import numpy as np
import pytest
from crowd_text import TEXT
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene


@pytest.mark.parametrize(("model", "count"), [("paper", 50), pytest.param("paper", 100, marks=pytest.mark.soak), ("surface", 50)])
def test_thousands_of_objects_build_and_run(model, count):
    """Build, set up and advance a crowd until it has met ground and neighbours; a hidden N^2 would run into the time limit."""
    ready = prepare(
        parse_scene(TEXT.replace("0 .. 99", f"0 .. {count - 1}").replace("control {", f"control {{ contact-model {model} "))
    )
    system = ready.system
    assert len(system.names) == count**2 and system.particles == 27 * count**2
    touching, listed, deepest = {"paper": (2, 0, 4), "surface": (5, 6, 4)}[model]
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(40)
        x = instance.array("x")
        assert np.isfinite(x).all()
        assert instance.fix_value("contact", touching) > 100 and instance.fix_value("ground", deepest) > 1e-4
        # Only near ones can meet: the 8 neighbours in the square lattice, and few more as they move; all pairs are 3e6 or 5e7.
        assert instance.fix_value("contact", listed) < 12 * count**2
        assert x[:, 2].min() > -0.05
