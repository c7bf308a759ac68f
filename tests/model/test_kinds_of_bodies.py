# SPDX-License-Identifier: GPL-2.0-only
"""A kind of body is one folder, tests/lab/features/coarse/crates: its own spacing, particles, masses and memory."""

import json
import subprocess
import sys

import pytest
from mdanim_lammps.bodies import kind_of, kinds
from mdanim_lammps.scene.scene import Box
from model_samples import scene, solid
from paths import LAB


def test_kinds_are_asked_in_their_order():
    """The lattice takes what no other kind does."""
    assert [kind.name for kind in kinds()] == ["rope", "sheet", "rigid", "held", "lattice"]
    made = scene(solid(Box((1.0, 1.0, 1.0))))
    assert kind_of(made.solids[0]).name == "lattice"


def test_a_folder_is_a_kind_of_body():
    """It makes its objects, and no other object is resolved otherwise because of them."""
    done = subprocess.run([sys.executable, LAB / "crates.py"], capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["asked"] == ["crate", "rope", "sheet", "rigid", "held", "lattice"] and found["kinds"] == ["lattice", "crate"]
    assert found["h"] == pytest.approx(0.05) and found["of"] == pytest.approx([0.05, 0.1])
    assert found["particles"] == [0, 125, 133] and found["memory"] == [8 * (5000.0 - 1500.0)]
    assert found["mass"] == pytest.approx([0.5, 4.0])
    assert found["fallen"] == pytest.approx([0.05, 0.05], rel=0.02)  # its springs hold it together
