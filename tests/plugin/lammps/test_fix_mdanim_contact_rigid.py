# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/contact with bodies that do not deform: held ones against the same bodies found by their cells, free ones that fix
mdanim/rigid moves."""

from dataclasses import replace
from functools import cached_property

import contact_lab
import numpy as np
import plugin_lab as lab
import pytest
import state_lab
from contact_lab import ARRAYS, Cuboid, State, load
from mdanim_lammps.model.contact_body import frame_of, make_contact_body
from mdanim_lammps.model.lattice import Cells
from mdanim_lammps.scene.shapes import Sphere

CORNER = {"axis": (1.0, -1.0, 0.0), "angle": 54.7356}
TURNED = {"axis": (1.0, 0.4, 0.2), "angle": 31.0}


class Ball(Cuboid):
    """A ball in the cells of a cube."""

    @cached_property
    def arrays(self) -> dict:
        half = np.array(self.cells) / 2 * self.spacing
        body = make_contact_body(Sphere(float(half[0])), Cells(np.ones(self.cells, bool), -half, half))
        return {name: getattr(frame_of(body) if self.rigid else body, name) for name in ARRAYS}


HELD = {
    "cube on a plate": (Cuboid((3, 3, 1), held=True, friction=0.4, **TURNED), Cuboid((2, 2, 2), (0.5, 0.3, 1.6), friction=0.4)),
    "plate on a corner": (Cuboid((2, 2, 2), held=True, **CORNER), Cuboid((3, 3, 1), (0.2, 0.1, 2.28))),
    "ball on a plate": (Cuboid((3, 3, 1), held=True, friction=0.3), Ball((2, 2, 2), (0.2, 0.1, 1.52), friction=0.5)),
    "cube on a ball": (Ball((3, 3, 3), held=True, friction=0.3, **TURNED), Cuboid((2, 2, 2), (0.2, 0.1, 2.52), friction=0.5)),
    "ball on a ball": (Ball((3, 3, 3), held=True, friction=0.3, **TURNED), Ball((2, 2, 2), (0.2, 0.1, 2.52), friction=0.5)),
}


def fall(folder, held: Cuboid, free: Cuboid, steps: int = 120):
    """Places, what contacts remember, and what the fix tells, after the free one fell on the held one."""
    lmp = load((held, replace(free, velocity=(0.03, 0.01, -0.06))), folder, dt=0.15)
    lmp.command(f"run {steps} pre no post no")
    told = [lmp.extract_fix("contact", 0, 1, n) for n in (1, 2, 3, 4)]
    found = lab.by_tag(lmp, "x"), contact_lab.contacts(state_lab.pack(lmp, "contact")), told
    lmp.close()
    return found


@pytest.mark.parametrize("name", HELD)
def test_a_held_body_is_met_as_its_cells_are(tmp_path, name):
    """All that is found agrees but for rounding: a lattice that is not deformed is the exact map."""
    held, free = HELD[name]
    by_cells, by_frame = fall(tmp_path, held, free), fall(tmp_path, replace(held, rigid=True), free)
    assert by_cells[2][3] > 0.02 and set(by_frame[1]) == set(by_cells[1])
    np.testing.assert_allclose(by_frame[0], by_cells[0], rtol=0, atol=1e-6)  # the cells' search ends 1e-3 cells off
    np.testing.assert_allclose(by_frame[2], by_cells[2], rtol=1e-5, atol=1e-9)
    for pair, rows in by_cells[1].items():
        assert by_frame[1][pair]["point"].tolist() == rows["point"].tolist()
        for value in ("X", "anchor", "depth", "offset", "pull"):
            np.testing.assert_allclose(by_frame[1][pair][value], rows[value], rtol=0, atol=1e-6)


FREE = {
    "cubes": (Cuboid((2, 2, 2), rigid=True, friction=0.4, **TURNED), Cuboid((2, 2, 2), (0.4, 0.2, 2.9), rigid=True, **CORNER)),
    "stone on a soft cube": (
        Cuboid((3, 3, 2), friction=0.5),
        Cuboid((2, 2, 2), (0.3, 0.2, 2.78), rigid=True, friction=0.4, **CORNER),
    ),
    "soft cube on a stone": (
        Cuboid((3, 3, 2), rigid=True, friction=0.5),
        Cuboid((2, 2, 2), (0.3, 0.2, 2.78), friction=0.4, **CORNER),
    ),
    "balls": (Ball((2, 2, 2), rigid=True, friction=0.4, **TURNED), Ball((2, 2, 2), (0.5, 0.3, 1.95), rigid=True, friction=0.4)),
    "soft ball on a stone": (Ball((3, 3, 3), rigid=True, friction=0.4, **TURNED), Ball((2, 2, 2), (0.5, 0.3, 2.5), friction=0.4)),
}


@pytest.mark.parametrize("name", FREE)
def test_momentum_stays_where_both_are_free(tmp_path, name):
    """Momentum and angular momentum of particles, to rounding, through a blow with friction and dashpots."""
    one, other = FREE[name]
    pair = one, replace(other, velocity=(0.02, 0.0, -0.08))
    body, _ = contact_lab.scene(pair)
    lmp = load(pair, tmp_path, dt=0.1)
    momenta = lambda x, v: np.concatenate([body.mass @ v, np.cross(x, body.mass[:, None] * v).sum(0)])
    start, deepest = momenta(body.x, body.v), 0.0
    for _ in range(6):
        lmp.command("run 50 pre no post no")
        assert np.abs(momenta(lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v")) - start).max() < 3e-13
        deepest = max(deepest, lmp.extract_fix("contact", 0, 1, 4))
    assert deepest > 0.03
    lmp.close()


@pytest.mark.parametrize("name", FREE)
def test_energy_stays_in_a_blow_without_losses(tmp_path, name):
    """The energy that leap-frog keeps, over that at the start; and half the step brings a quarter of what it misses."""
    one, other = (replace(body, friction=0.0) for body in FREE[name])
    pair = one, replace(other, velocity=(0.02, 0.0, -0.08))
    body, _ = contact_lab.scene(pair)
    missed = []
    for dt in (0.1, 0.05):
        lmp = load(pair, tmp_path, dt=dt, more=["fix_modify contact energy yes"], setup=False)
        lmp.command("thermo_style custom step ebond pe")
        lmp.command("thermo_modify norm no")
        lmp.command("run 0 post no")
        start = lab.kinetic(body, body.v)
        worst = 0.0
        for _ in range(round(30 / dt / 20)):
            lmp.command("run 20 pre no post no")
            lmp.command("run 0 post no")
            worst = max(worst, abs(lab.kinetic(body, lab.by_tag(lmp, "v")) + lmp.get_thermo("pe") - start) / start)
        assert lmp.extract_fix("contact", 0, 1, 3) == 0.0
        missed.append(worst)
        lmp.close()
    assert missed[1] < 2e-3, missed


def test_a_state_is_taken_up_in_the_middle_of_a_blow(tmp_path):
    """In the instance that went on, with the same bits."""
    one, other = FREE["soft ball on a stone"]
    lmp = load((replace(one, held=True), replace(other, velocity=(0.02, 0.0, -0.08))), tmp_path, dt=0.1)
    lmp.command("run 40 pre no post no")
    kept = State.of(lmp)
    assert contact_lab.contacts(kept.contacts)
    lmp.command("run 60 pre no post no")
    end = State.of(lmp)
    kept.put(lmp)
    lmp.command("run 60 pre no post no")
    assert State.of(lmp).same(end)
    lmp.close()


def coarse(one: Cuboid, particles: int) -> dict:
    """The body of a cuboid whose particles are the corners of one cell around it."""
    body = one.arrays
    frame_at = np.vstack([np.zeros(3), np.diag(body["count"].astype(float))])
    return body | {"frame": np.array([0, 1, 2, 4], np.int32), "frame_at": frame_at, "node": np.arange(particles, dtype=np.int32)}


def test_a_held_body_needs_no_particle_but_its_corners(tmp_path):
    """Eight particles in place of 27, the same points: what falls on it has the same path to rounding."""
    fine = Cuboid((2, 2, 2), held=True, friction=0.4, rigid=True)
    free = replace(HELD["cube on a plate"][1], centre=(0.5, 0.3, 2.1))
    expected = fall(tmp_path, fine, free)[0][27:]
    few = Cuboid((1, 1, 1), spacing=2.0, held=True, friction=0.4, rigid=True)
    pair = few, replace(free, velocity=(0.03, 0.01, -0.06))
    lmp = load(pair, tmp_path, dt=0.15, setup=False)
    contact_lab.give_body(lmp, "contact", 0, coarse(fine, 8))
    lmp.command("run 120 post no")
    np.testing.assert_allclose(lab.by_tag(lmp, "x")[8:], expected, rtol=0, atol=1e-12)
    lmp.close()


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"frame": np.array([0, 2, 1, 9], np.int32)}, "particles of its frame do not ascend"),
        ({"frame": np.array([0, 1, 2, 27], np.int32)}, "particles of its frame do not ascend"),
        ({"frame_at": np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]])}, "its frame is flat"),
        ({"frame_at": np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, np.nan]])}, "a particle of its frame is nowhere"),
    ],
)
def test_frames_that_are_none_are_refused(tmp_path, change, why):
    """Before a run begins."""
    one = Cuboid((2, 2, 2), rigid=True)
    lmp = load((one,), tmp_path, "plane z lo -2.0", setup=False)
    with pytest.raises(RuntimeError, match=why):
        contact_lab.give_body(lmp, "contact", 0, one.arrays | change)
    lmp.close()
