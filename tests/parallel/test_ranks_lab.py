# SPDX-License-Identifier: GPL-2.0-only
"""Ranks that stand by for the programs of other tests: one program does not change the next, and a fault is told."""

import pytest
import ranks_lab
from ranks_lab import on_ranks

pytestmark = pytest.mark.mpi


@pytest.fixture
def program(tmp_path):
    """Write a program."""

    def write(text: str):
        path = tmp_path / "program.py"
        path.write_text("import os, sys, time\nfrom mpi4py import MPI\nworld = MPI.COMM_WORLD\n" + text)
        return path

    return write


def test_a_program_has_its_ranks_arguments_and_environment(program):
    """All ranks print, in their order; what one program changes of the environment is not there for the next."""
    path = program('print(world.rank, world.size, sys.argv[1:], os.environ.get("LEFT"))\nos.environ["LEFT"] = "behind"\n')
    for ranks in (2, 3, 1):
        expected = "".join(f"{rank} {ranks} ['a', '1'] None\n" for rank in range(ranks))
        assert on_ranks(path, ranks, "a", 1) == expected
    assert on_ranks(path, 1, more={"LEFT": "by a test"}) == "0 1 [] by a test\n"
    assert on_ranks(path, 1, own=True) == "0 1 [] None\n"


def test_a_fault_of_one_rank_is_told_and_ends_all(program):
    """The others would wait for it; the next program has other ranks."""
    with pytest.raises(AssertionError, match="out of the blue"):
        on_ranks(program('if world.rank == 1:\n    raise ValueError("out of the blue")\nworld.barrier()\n'), 3)
    assert on_ranks(program("print(world.rank)"), 2) == "0\n1\n"


def test_ranks_that_wait_for_ever_are_ended(program, monkeypatch):
    """Each tells where it is."""
    monkeypatch.setattr(ranks_lab, "GRACE", 0.5)
    with pytest.raises(AssertionError, match=r"Timeout \(.*\n(.*\n)*.*program\.py"):
        on_ranks(program("while world.rank == 0:\n    time.sleep(0.01)\n"), 2, timeout=0.5)
    assert on_ranks(program("print(world.size)"), 1) == "1\n"
