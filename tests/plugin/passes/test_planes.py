# SPDX-License-Identifier: GPL-2.0-only
"""Contacts with planes that passes compute: the bits of run_style verlet in motion, in forces and in what contacts remember."""

import ctypes

import numpy as np
import pytest
from filming import WIDTHS, supported
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

SOFT = "density 1000 elasticity 0.2 MPa"
ROOM = "ground z 0\nwalls from (-4, -4, -9) cm to (4, 4, 90) cm\n"
BOX = f"object a {{ shape box (7, 6, 5) cm position (0, 0.2, 2.7) cm {SOFT} velocity (2, -2, -1) spin (0, 0, 3) rad/s"
BALL = f"object b {{ shape sphere 1 cm position (2.95, -2, 7.3) cm {SOFT} }}\n"
SLIT = "walls from (-0.3, -30, 0) cm to (0.3, 30, 60) cm\n"
SHEET = "object a { shape sheet (9, 9) cm thickness 2 mm position (0, 0, 5) cm orientation axis (0, 1, 0) angle 90 deg"
SCENES = {
    "smooth": f"{ROOM}{BOX} }}\n",
    "rough, walls with a ball": f"{ROOM}{BALL}{BOX} friction 0.4 damping 0.05 }}\n",
    "a sheet between two planes": f"{SLIT}{SHEET} {SOFT} velocity (1, -2, 0) friction 0.2 }}\n",
}
"""A ball has points between its particles, so a fix that it is near keeps all contacts to itself."""


def run(plan, style: str) -> tuple[list[bytes], np.ndarray, set[int], int]:
    """Bits after each of several pieces, losses, sizes of the records, and points at planes of the last pass."""
    with Instance(plan) as instance:
        instance.lammps.lmp.command(f"run_style {style}")
        instance.setup()
        told, touching = [], set()
        for steps in (1, 29, 40):
            instance.run(steps)
            records = dict(sorted(instance.records().items()))
            told += [instance.array(a).tobytes() for a in "xvf"]
            told += [a.tobytes() for r in records.values() for a in (r.keys, r.first, r.data)]
            touching.add(len(records["walls"].data))
        losses = np.array([instance.fix_value("walls", n) for n in (1, 2, 4)])  # heat, loss of dashpots, deepest point
        count = instance.lammps.library.mdanim_points_at_planes
        count.restype = ctypes.c_long
        return told, losses, touching, count(instance.lammps.handle)


@pytest.mark.parametrize("name", SCENES)
def test_planes_in_passes_change_no_bit(name):
    """All widths, each with more threads; losses are the same by all of them."""
    plan = prepare(parse_scene(f"gravity (0, 0, -9.81)\n{SCENES[name]}control {{ time 10 s resolution 1 cm }}")).plan
    told, losses, touching, none = run(plan, "verlet")
    assert none == 0 and len(touching) > 1 and losses[2] > 0.0
    by_width = []
    for threads, width in enumerate(filter(supported, WIDTHS), 1):
        found, lost, _, points = run(plan, f"verlet/mdanim width {width} threads {threads}")
        assert points > 20 and found == told, width
        np.testing.assert_allclose(lost, losses, rtol=1e-11)
        by_width.append(lost.tobytes())
    assert len(set(by_width)) == 1
