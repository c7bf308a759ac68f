# SPDX-License-Identifier: GPL-2.0-only
"""Objects that are held as a whole: what they need not say."""

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.rigid.words import Rigid
from mdanim_lammps.scene.parse import parse_scene

BALL = "object ball { shape sphere 1 cm position (0, 0, 1) m density 1000 kg/m^3 elasticity rigid }\ncontrol { time 1 s }\n"


def held(words):
    return parse_scene(f"object step {{ {words} position (0, 0, 0) m hold all }}\n{BALL}", "small").solids[0]


def test_it_is_rigid_and_its_mass_is_asked_by_nothing():
    """A word of its own stays."""
    step = held("shape box (1, 1, 1) m")
    assert isinstance(step.elasticity, Rigid) and step.density == 1000.0 and step.mass is None
    assert held("shape box (1, 1, 1) m mass 2 kg").density is None
    assert held("shape box (1, 1, 1) m elasticity 2 MPa").elasticity.modulus == 2e6
    assert held("shape box (1, 1, 1) m material rubber").elasticity.modulus < 1e8


@pytest.mark.parametrize("words", ["shape sheet (1, 1) m thickness 1 mm", "shape box (1, 1, 1) m release 0.5 s"])
def test_what_bends_or_is_let_go_says_both(words):
    with pytest.raises(SceneError, match=r"no elasticity(.|\n)*no mass or density"):
        held(words)
