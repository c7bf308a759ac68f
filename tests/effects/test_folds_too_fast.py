# SPDX-License-Identifier: GPL-2.0-only
"""Layers that come so fast that they pass through each other: the speed by the law, as runs have it, and what ``check`` says."""

import re

import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.folds.advice import passing_speeds
from mdanim_lammps.features.folds.layers import pairs
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

BLOW = """object lower {{ shape sheet (0.3, 0.3) m thickness {t} m  position (0, 0, 0.5) m  density 400  elasticity {young} kPa
  resolution {h} m {lower} }}
object upper {{ shape sheet (0.25, 0.25) m thickness {t} m  position (0.003, 0.004, {z}) m  velocity (0, 0, {speed}) m/s
  density {density}  elasticity {young} kPa  resolution {h} m }}
control {{ time 1 s  accuracy preview {more} }}
"""


def blow(speed, t=0.004, young=500.0, h=0.016, density=400.0, lower="hold all", more=""):
    gap = max(t, h / 3.0)
    text = BLOW.format(t=t, young=young, h=h, density=density, z=0.5 + 1.2 * gap, speed=-speed, lower=lower, more=more)
    return prepare(parse_scene(text)), gap


def passed(case: dict, speed: float) -> float:
    """Part of the particles of the upper sheet below the lower one, after it came by two reaches more than to it."""
    ready, gap = blow(speed, **case)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(round(2.5 * gap / speed / ready.certificate.timestep))
        x, k = instance.array("x"), ready.system.first[1]
        return float((x[k:, 2] < x[:k, 2].mean()).mean())


@pytest.mark.parametrize(
    "case", [{}, {"t": 0.001, "young": 50.0, "h": 0.02}, {"t": 0.012, "young": 2000.0, "h": 0.02}, {"density": 1600.0}]
)
def test_sheets_that_meet_flat_pass_from_the_speed_of_the_law_on(case):
    """On a held one: none passes below, nine of ten above; borders, which have half of the weight or none of it below them, come
    a little later or sooner. A particle alone has 1/sqrt(2) of that where both are as fine, less for m/w at borders."""
    ready, _ = blow(1.0, **case)
    (alone,), (flat,) = passing_speeds(ready.context, pairs(ready.context))
    assert alone == pytest.approx(flat / 2.0**0.5, rel=0.12)
    assert passed(case, 0.9 * alone) == 0.0
    assert passed(case, 1.15 * flat) > 0.8


@pytest.mark.parametrize(("part", "severity"), [(0.97, None), (1.03, "note"), (1.6, "note"), (2.4, "warning")])
def test_check_tells_of_it(part, severity):
    """Two free sheets that meet at parts of the speed of a particle alone; flat they pass from twice that on."""
    ready, _ = blow(1.0, lower="")
    (alone,), (flat,) = passing_speeds(ready.context, pairs(ready.context))
    assert flat == pytest.approx(2.0 * alone, rel=0.12)
    ready, _ = blow(part * alone, lower="")
    found = [n for n in ready.certificate.notes if "lower and upper may meet" in n.message]
    assert [n.severity for n in found] == ([severity] if severity else [])


def test_each_way_out_that_check_names_is_enough():
    """A thickness for both, and a stiffness of contact."""
    ready, _ = blow(10.0)
    (said,) = [n for n in ready.certificate.notes if "may meet" in n.message]
    thick, stiff = re.search(r"a thickness of ([\d.]+) mm for both, or contact-stiffness ([\d.]+) in control", said.hint).groups()
    assert said.line == 3
    for way_out in ({"t": float(thick) / 1000.0}, {"more": f"contact-stiffness {stiff}"}):
        assert not [n for n in blow(10.0, **way_out)[0].certificate.notes if "may meet" in n.message]
