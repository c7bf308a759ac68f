# SPDX-License-Identifier: GPL-2.0-only
"""Undeformed bodies reach the fixes that look them up: in a new instance, in one that is filled anew, and on ranks."""

from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.plan import Plan
from mdanim_lammps.errors import DivergedError, SetupError
from mpi.bodies import Surfaces, film, scene, with_surfaces
from paths import MPI
from ranks_lab import on_ranks


def block_momentum(plan, state) -> np.ndarray:
    """Momentum of the block [kg m/s], shape (3,)."""
    block = plan.system.object == 1
    return plan.system.mass[block] @ state[1][block]


def test_a_block_bounces_off_a_held_anvil(prepared):
    """It turns round, about upward, and the brick of the same shape as the anvil that stands aside is left alone. Contact sees
    the anvil as rigid, and the brick not."""
    plan = with_surfaces(prepared(scene()).plan)
    assert [body.frame is not None for body in plan.contact_bodies.values()] == [True, False, False]
    with Instance(plan) as instance:
        instance.setup()
        assert abs(instance.array("f")[plan.system.object == 2]).max() < 1e-9
        before = block_momentum(plan, [instance.array("x"), instance.array("v")])
        after = block_momentum(plan, film(instance))
    assert after[2] > -0.5 * before[2] > 0
    assert abs(after[:2]).max() < 0.02 * after[2]


def test_a_fix_without_its_bodies_refuses_to_run(prepared, monkeypatch):
    """Without its body an object is named by the fix, which shows why bodies are handed over."""
    plan = with_surfaces(prepared(scene()).plan)
    monkeypatch.setattr(Plan, "contact_bodies", property(lambda plan: {}))
    with Instance(plan) as instance, pytest.raises(DivergedError, match="no such body was given"):
        instance.setup()


def test_bodies_for_a_fix_of_another_style_are_refused(prepared):
    """The message names the body and the fix."""
    plan = with_surfaces(prepared(scene()).plan)
    effect = Surfaces()
    effect.fix = "leapfrog"
    with pytest.raises(SetupError, match="give body 0 to fix leapfrog"), Instance(replace(plan, effects=(effect,))):
        pass


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 3])
def test_every_rank_has_the_bodies(tmp_path, prepared, ranks):
    """The same bits as on one process."""
    plan = with_surfaces(prepared(scene()).plan)
    with Instance(plan) as instance:
        alone = film(instance)
    on_ranks(MPI / "bodies.py", ranks, tmp_path / "small.txt", tmp_path / "film.npy")
    assert np.array_equal(np.load(tmp_path / "film.npy"), alone)
