# SPDX-License-Identifier: GPL-2.0-only
"""Effects: on when the scene calls for them, with reason and line, and off without a trace."""

import pytest

from mdanim_lammps.effects import EFFECTS, decide
from mdanim_lammps.effects.contact import plane_stiffness
from mdanim_lammps.scene.parse import parse_scene

FULL = """gravity (0, 0, -9.81)
ground z 0
walls from (-1, -1, 0) to (1, 1, 2)
object a {
  shape sphere 0.1
  position (0, 0, 1)
  mass 1
  elasticity 1e5
  damping 0.1
  drag 0.2
}
object b {
  shape sphere 0.1
  position (0, 0, 0.5)
  mass 1
  elasticity 1e5
}
control { time 1 }
"""
BARE = "object a {\n shape sphere 0.1\n position (0, 0, 0)\n mass 1\n elasticity 1e5\n}\ncontrol { time 1 }\n"
LINES = {"springs": 8, "damping": 9, "gravity": 1, "contact": 12, "ground": 2, "walls": 3, "air-drag": 10}


def verdicts(text):
    """Verdicts and warnings for a scene text."""
    return decide(EFFECTS, parse_scene(text))


@pytest.mark.parametrize("effect", [e.name for e in EFFECTS])
def test_each_effect_is_called_for_by_its_line(effect):
    """Switch on with the line that calls for it."""
    verdict = verdicts(FULL)[0][effect]
    assert verdict.on and verdict.span.line == LINES[effect]


@pytest.mark.parametrize("effect", [e.name for e in EFFECTS if e.name != "springs"])
def test_each_effect_is_off_without_cause(effect):
    """Stay off, with a reason, in a scene of one free ball."""
    verdict = verdicts(BARE)[0][effect]
    assert not verdict.on and verdict.reason


@pytest.mark.parametrize("effect", [e.name for e in EFFECTS])
def test_a_needed_effect_switched_off_is_a_warning(effect):
    """Say what will look wrong."""
    found, warnings = verdicts(FULL + f"effects {{ {effect} off }}\n")
    assert not found[effect].on
    assert [w.severity for w in warnings] == ["warning"]
    assert next(e for e in EFFECTS if e.name == effect).lost in warnings[0].hint


def test_a_needless_effect_cannot_be_switched_on():
    """Warn instead of inventing a ground."""
    found, warnings = verdicts(BARE + "effects { ground on }\n")
    assert not found["ground"].on and "no ground" in warnings[0].message


@pytest.mark.parametrize("text", [
    pytest.param(BARE.replace("mass 1\n", "mass 1\n hold all\n"), id="one held object"),
])
def test_held_objects_need_no_springs(text):
    """Leave springs out when nothing can deform."""
    assert not verdicts(text)[0]["springs"].on


def test_plane_stiffness_bounds_every_depth():
    """Be at least the curvature of a particle at the surface (1.18) and below twice the pair's stiffness."""
    assert 1.5 < plane_stiffness(1.6) < 1.75
    assert plane_stiffness(1.9) > plane_stiffness(1.6)
