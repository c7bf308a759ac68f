# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/contact except GROUP: pairs and planes that are left to another fix."""

import contact_lab
import numpy as np
import plugin_lab as lab
import pytest
from contact_lab import Cuboid, State, load

WORDS = "objects plane z lo 0.0"


def apart() -> tuple[Cuboid, ...]:
    """Cubes just off each other and off the ground, on their way into both."""
    return (
        Cuboid((2, 2, 2), (0.0, 0.0, 1.01), velocity=(0.0, 0.0, -0.05)),
        Cuboid((2, 2, 2), (2.02, -0.1, 1.01), velocity=(-0.05, 0.0, -0.05)),
        Cuboid((2, 2, 2), (-0.1, 2.02, 1.01), velocity=(0.0, -0.05, -0.05)),
    )


def run(folder, molecules: str | None, words: str) -> set:
    """Pairs, and objects and planes, that touch after some steps; some molecules are a group."""
    lmp = load(apart(), folder, words, setup=False, before=() if molecules is None else (f"group few molecule {molecules}",))
    lmp.command("run 6 post no")
    found = set(contact_lab.contacts(State.of(lmp).contacts))
    lmp.close()
    return found


@pytest.mark.parametrize(
    ("molecules", "left"),
    [
        (None, {(0, 1), (1, 0), (0, 2), (2, 0), (0, -1), (1, -1), (2, -1)}),
        ("1 2", {(0, 2), (2, 0), (2, -1)}),
        ("3", {(0, 1), (1, 0), (0, 2), (2, 0), (0, -1), (1, -1)}),
        ("1 2 3", set()),
    ],
)
def test_pairs_of_the_group_and_planes_against_it_are_left_out(tmp_path, molecules, left):
    """All others touch as before."""
    words = WORDS if molecules is None else f"{WORDS} except few"
    assert run(tmp_path, molecules, words) == left


@pytest.mark.parametrize(("words", "left"), [("exclude 2 1", {(0, 2), (2, 0)}), ("exclude 1 2 exclude 1 3", set())])
def test_pairs_that_are_excluded_never_touch(tmp_path, words, left):
    """In either order; planes and other pairs are not concerned."""
    assert run(tmp_path, None, f"{WORDS} {words}") == left | {(0, -1), (1, -1), (2, -1)}


def test_the_rest_has_the_forces_of_a_fix_without_those_pairs(tmp_path):
    """Two fixes, of which each leaves to the other one, exert the forces of one that does all."""
    both = {}
    for name, words, more in (
        ("one", WORDS, ()),
        (
            "two",
            f"{WORDS} except few",
            ("fix rest mobile mdanim/contact d_body d_young d_friction objects plane z lo 0.0 among few",),
        ),
    ):
        lmp = load(apart(), tmp_path, words, setup=False, before=("group few molecule 1 2",), more=more)
        if more:
            for n, one in enumerate(apart()):
                contact_lab.give_body(lmp, "rest", n, one.arrays)
        lmp.command("run 60 post no")
        both[name] = lab.by_tag(lmp, "x")
        lmp.close()
    np.testing.assert_allclose(both["two"], both["one"], rtol=0, atol=1e-13)


def test_an_object_partly_in_the_group_is_refused(tmp_path):
    """The message counts its particles."""
    with pytest.raises(Exception, match=r"9 of the 27 particles of object 1 \(molecule ID\) are in the group that is excepted"):
        load(apart(), tmp_path, f"{WORDS} except few", before=("group few id 1:9",))
    with pytest.raises(Exception, match="few"):
        load(apart(), tmp_path, f"{WORDS} except few")
