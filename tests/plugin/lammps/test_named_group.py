# SPDX-License-Identifier: GPL-2.0-only
"""Groups that styles are told besides their own are known by name: one that gets the bit of a deleted one is not taken for it."""

import contact_lab
import plugin_lab as lab
import pytest
from contact_lab import Cuboid
from liquid_lab import BASIN, POOL


def with_contact(folder):
    """Two cubes of the group `those` in touch."""
    cubes = (Cuboid((2, 2, 2)), Cuboid((2, 2, 2), (0.2, 0.1, 2.02), velocity=(0.0, 0.0, -0.05)))
    more = ("group those union all", "fix second mobile mdanim/contact d_body d_young d_friction objects among those")
    lmp = contact_lab.load(cubes, folder, "plane z lo -50", more=more, setup=False)
    for n, cube in enumerate(cubes):
        contact_lab.give_body(lmp, "second", n, cube.arrays)
    return lmp


def with_barrier(folder, words):
    """Two particles in reach."""
    body = lab.particles([[0.0, 0, 0], [1.0, 0, 0]], boundary=(True, False))
    groups = ["group those union all", "group rest subtract all those"]
    return lab.load(body, folder, [*groups, f"fix second all mdanim/barrier {words}", "fix run all mdanim/leapfrog"])


def with_liquid(folder):
    """A particle that is held in a liquid."""
    body = lab.particles([[0.3, -0.2, 5.0]])
    commands = [
        "group those union all",
        *BASIN,
        POOL.replace("fix water", "fix second") + " still those",
        "fix run all mdanim/leapfrog",
    ]
    return lab.load(body, folder, commands)


STYLES = {
    "contact: among": with_contact,
    "barrier: boundary": lambda folder: with_barrier(folder, "those inner 1.0 1.5"),
    "barrier: inner": lambda folder: with_barrier(folder, "boundary those 1.0 1.5"),
    "barrier: thin": lambda folder: with_barrier(folder, "boundary inner 1.0 1.5 thin those 0.8"),
    "liquid: still": with_liquid,
}


@pytest.mark.parametrize("style", STYLES)
def test_a_deleted_group_is_missed(tmp_path, style):
    """Though another one has its bit; when it is made again the run goes on."""
    lmp = STYLES[style](tmp_path)
    lmp.command("run 1")
    lmp.commands_list(["group those delete", "group other id 1"])
    with pytest.raises(Exception, match="group those has been deleted; make it again, or define the fix anew"):
        lmp.command("run 1")
    lmp.commands_list(["group those union all", "run 1"])
    lmp.close()
