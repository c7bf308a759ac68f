# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/contact where objects, bodies, materials or groups are others than when it was set up."""

from dataclasses import replace

import contact_lab
import numpy as np
import plugin_lab as lab
import pytest
from contact_lab import PILE, Cuboid, State, load, pile

CUBES = (Cuboid((2, 2, 2), friction=0.3), Cuboid((2, 2, 2), (0.2, 0.1, 2.02), friction=0.3, velocity=(0.05, 0.02, -0.05)))


@pytest.fixture
def touching(tmp_path):
    """Two rough cubes that are in touch."""
    lmp = load(CUBES, tmp_path, dt=0.1)
    lmp.command("run 40 pre no post no")
    assert lmp.extract_fix("contact", 0, 1, 5) > 0.0
    yield lmp
    lmp.close()


# --- objects ---


@pytest.mark.parametrize(("at_first", "molecule"), [((1, 2), 9), ((1, 3), 2)])
def test_an_object_that_comes_during_a_run_is_refused(tmp_path, at_first, molecule):
    """A molecule ID above all others, and one between; lists are rebuilt as the bodies fly."""
    lmp = load(CUBES, tmp_path, setup=False)
    lmp.commands_list([f"set atom 28*54 mol {at_first[1]}", "velocity all set 0.9 0 0", "run 0", f"set atom 1*9 mol {molecule}"])
    with pytest.raises(Exception, match=rf"object {molecule} \(molecule ID\) has come since the setup of this run"):
        lmp.command("run 200 pre no post no")
    lmp.close()


def test_a_deposited_particle_is_refused(tmp_path):
    """LAMMPS's own fix gives it molecule ID 0, in the middle of a run."""
    lmp = load(CUBES, tmp_path, setup=False)
    lmp.command("region between block -0.9 0.9 -0.9 0.9 1.005 1.015")
    lmp.command("fix drop all deposit 1 1 50 4711 region between near 0.001")
    with pytest.raises(Exception, match="particle 55 belongs to no object"):
        lmp.command("run 200")
    lmp.close()


def test_particles_of_no_object_are_refused(tmp_path):
    """Molecule 0 of one cube or of all, at the setup; the rest of the message tells the way out."""
    lmp = load(CUBES, tmp_path, setup=False)
    for some in ("id 1:27", "all"):
        lmp.command(f"group some {some}" if some != "all" else "group some union all")
        lmp.command("set group some mol 0")
        with pytest.raises(Exception, match=r"belongs to no object, its molecule ID is 0; .*'set group … mol …'.* 'among GROUP'"):
            lmp.command("run 0")
    lmp.close()


def test_particles_of_no_object_may_be_left_out(tmp_path):
    """By `among`: they are not looked at."""
    words = "plane z lo -1.5 among mobile"
    lmp = load((replace(CUBES[0], held=True), CUBES[1]), tmp_path, words, setup=False)
    lmp.command("set atom 1*27 mol 0")
    lmp.command("run 5")
    lmp.close()


# --- bodies ---


def coarse() -> dict:
    """A body with as many particles and fewer points."""
    points = ("cell", "at", "centre", "normal", "area", "kind")
    return {name: array[:3] if name in points else array for name, array in CUBES[0].arrays.items()}


def test_a_body_with_fewer_points_takes_the_place_of_another(tmp_path):
    """The objects are near each other, not in touch; until the next setup the old body acts."""
    lmp = load((CUBES[0], Cuboid((2, 2, 2), (0.0, 0.0, 2.1))), tmp_path)
    contact_lab.give_body(lmp, "contact", 1, coarse())
    lmp.command("run 5 pre no post no")
    lmp.command("run 5 post no")
    assert lmp.extract_fix("contact", 0, 1, 6) == 1.0
    lmp.close()


def test_another_body_of_objects_in_touch_is_refused(touching):
    """Contacts remember points that are gone."""
    contact_lab.give_body(touching, "contact", 1, coarse())
    for _ in range(2):
        with pytest.raises(Exception, match=r"object 2 .* another body .*unfix"):
            touching.command("run 1")


def test_objects_in_touch_that_swap_their_numbers_are_refused(touching):
    """Molecule IDs tell objects apart, contacts are of particles."""
    for atoms, molecule in (("1*27", 3), ("28*54", 1), ("1*27", 2)):
        touching.command(f"set atom {atoms} mol {molecule}")
    with pytest.raises(Exception, match=r"object 1 .* other particles .*unfix"):
        touching.command("run 1")


def test_the_same_body_given_again_changes_nothing(touching):
    """Not even bits of a run."""
    state = State.of(touching)
    touching.command("run 0 post no")
    first = lab.by_tag(touching, "f")
    for n, cube in enumerate(CUBES):
        contact_lab.give_body(touching, "contact", n, cube.arrays)
    touching.command("run 0 post no")
    assert first.tobytes() == lab.by_tag(touching, "f").tobytes()
    assert State.of(touching).contacts.same(state.contacts)


# --- materials ---


@pytest.mark.parametrize("column", ["d_young", "d_friction", "rmass"])
def test_a_material_that_is_changed_acts_at_once(tmp_path, column):
    """Forces, and how it goes on, are those of a fresh instance with the new material and the same contacts; pairs and planes."""
    changed, fresh = (load(pile(1), tmp_path, setup=setup, **PILE) for setup in (True, False))
    changed.command("run 130 pre no post no")
    assert changed.extract_fix("contact", 0, 1, 5) > 4.0
    state, before = State.of(changed), lab.by_tag(changed, "f")
    for lmp in (changed, fresh):
        lmp.numpy.extract_atom(column)[: len(state.x)] *= 0.6
    state.put(fresh)
    fresh.command("run 0 post no")
    changed.command("run 0 post no")
    assert not np.array_equal(lab.by_tag(changed, "f"), before)
    for _ in range(2):
        for name in "xvf":
            assert lab.by_tag(changed, name).tobytes() == lab.by_tag(fresh, name).tobytes()
        for lmp in (changed, fresh):
            lmp.command("run 20 pre no post no")
    for lmp in (changed, fresh):
        lmp.close()
