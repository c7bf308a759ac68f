# SPDX-License-Identifier: GPL-2.0-only
"""Threads in a splash share passes, contact and the liquid, on one process and on ranks, also from a state in its middle:
as one thread, bit for bit."""

from pathlib import Path

import numpy as np
import pytest
from mdanim_lammps.engine.threads import LEAST
from ranks_lab import on_ranks
from splash_lab import EAGER, splash

SPLASH = Path(__file__).parents[2] / "lab" / "mpi" / "splash.py"
MODELS = ("waves", "surface")


@pytest.fixture(scope="module", autouse=True)
def eager():
    """Threads share whatever they can, in this process and in those of ranks."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(LEAST, EAGER)
        yield


@pytest.fixture(scope="module")
def alone():
    """By one thread of one process."""
    return {model: splash(model, 1) for model in MODELS}


def differing(found, expected) -> list[str]:
    """Names of what differs."""
    return [name for name in found if np.asarray(found[name]).tobytes() != np.asarray(expected[name]).tobytes()]


@pytest.mark.parametrize("threads", [2, 3, 4, 8])
@pytest.mark.parametrize("model", MODELS)
def test_threads_in_a_splash_change_no_bit(alone, model, threads):
    """Places, forces, surface, contacts and energies."""
    assert not differing(splash(model, threads), alone[model])
    assert (alone[model]["end raw"] != alone[model]["0 raw"]).any()
    assert sum(len(value) for name, value in alone[model].items() if name.endswith("contact")) > 1000


@pytest.mark.parametrize("model", MODELS)
def test_threads_go_on_from_the_middle_of_a_splash(alone, model):
    """Three threads take up what three have left."""
    assert not differing(splash(model, 3, resume=True), alone[model])


@pytest.mark.mpi
@pytest.mark.parametrize("resume", [0, 1])
@pytest.mark.parametrize("model", MODELS)
def test_ranks_with_threads_change_no_bit(alone, tmp_path, model, resume):
    """Two ranks with two threads each, as two ranks with one; contact on ranks adds up as on one."""
    found = {}
    for threads in (1, 2):
        on_ranks(SPLASH, 2, model, threads, resume, tmp_path / f"{threads}.npz")
        found[threads] = dict(np.load(tmp_path / f"{threads}.npz"))
    assert not differing(found[2], found[1])
    assert not differing(found[2], alone[model])
