# SPDX-License-Identifier: GPL-2.0-only
"""Advice of studies and settings for a target, beside runs that are finer in everything."""

import sys
from dataclasses import replace

import pytest
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.study import bench
from mdanim_lammps.study.error import distance, extent
from mdanim_lammps.study.measure import measure
from mdanim_lammps.study.setting import finer
from mdanim_lammps.study.target import find_choice
from paths import REPOSITORY

sys.path.append(str(REPOSITORY / "bench"))
from advice import SCENES, check


def test_advice_on_a_bounce_is_not_refuted(monkeypatch):
    """Errors of cells and contact have opposite signs where a cube bounces: a study that adds the limits of its ladders says
    that the own setting is half as far off as it is, and that stiffer contact helps."""
    monkeypatch.setattr(bench, "REPEATS", 1)
    found = check("a bounce", only=("resolution", "contact"))
    assert [line for t in found for line in t.refuted] == []
    assert found[0].doubt < 0.5 * found[0].own[0]
    assert "opposite signs" in found[0].advice


@pytest.mark.soak
@pytest.mark.parametrize("name", SCENES)
def test_advice_is_not_refuted(name):
    """Run ten scenes finer in everything than any run of their studies, whole ones and those that a budget cuts short."""
    assert [line for t in check(name) for line in t.refuted] == []


def test_a_target_counts_cells_and_contact(tmp_path):
    """Find a setting for 10 % that is as far as told from a run with twice its cells; more cells alone are farther off."""
    scene = parse_scene(SCENES["a bounce"])
    choice = find_choice(scene, 0.1, budget=60.0)
    assert choice.met and choice.cells > 2
    own = choice.setting
    run, truth, alone = (
        measure(scene, s, tmp_path).center for s in (own, finer(own, 2.0 * own.cells), replace(own, cells=8.0, contact=1.0))
    )
    off = distance(run, truth) / extent(truth)
    assert abs(off - choice.reached) <= choice.doubt
    assert off < 0.1 < distance(alone, truth) / extent(truth)
