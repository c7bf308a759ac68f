# SPDX-License-Identifier: GPL-2.0-only
"""A checkpoint gives back what it was given, also the state of a liquid, and refuses what it cannot be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.engine.state import NO_RECORDS, StateRecords
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results import checkpoint
from mdanim_lammps.results.checkpoint import Checkpoint


def state(liquid=None):
    x, v, f = np.random.default_rng(1).normal(size=(3, 7, 3))
    whole = np.zeros((1, 2), np.int32)
    records = {} if liquid is None else {"liquid": StateRecords(whole, np.array([0, len(liquid)]), liquid)}
    return Checkpoint(120, 12, x, v, f, {"drag_loss": 0.1, "seconds": 3.5}, "run", records=records)


@pytest.mark.parametrize("liquid", [None, np.repeat(np.arange(256, dtype=np.uint8), 400), np.zeros(0, np.uint8)])
def test_state_comes_back(tmp_path, liquid):
    """Every bit, with and without a liquid."""
    written = state(liquid)
    written.write(tmp_path / "checkpoint")
    read = Checkpoint.read(tmp_path / "checkpoint")
    assert (read.step, read.frame, read.carried, read.run) == (120, 12, written.carried, "run")
    for name in "xvf":
        np.testing.assert_array_equal(getattr(read, name), getattr(written, name))
    assert read.records == written.records
    assert all(found.data.dtype == np.uint8 for found in read.records.values())


def test_records_of_all_fixes_come_back(tmp_path):
    """Records are of objects and pairs, of two fixes, one of which has none now."""
    rub = StateRecords(np.array([[1, 0], [1, 3]], np.int32), np.array([0, 2, 5]), np.arange(5, dtype=np.uint8))
    written = replace(state(None), records={"rub": rub, "heat": NO_RECORDS})
    written.write(tmp_path / "checkpoint")
    assert Checkpoint.read(tmp_path / "checkpoint").records == written.records


def test_a_liquid_takes_little_room(tmp_path):
    """A million equal cells take a hundredth of their bytes."""
    state().write(tmp_path / "dry")
    state(np.ones(1_000_000, np.uint8)).write(tmp_path / "wet")
    assert (tmp_path / "wet").stat().st_size - (tmp_path / "dry").stat().st_size < 10_000


@pytest.mark.parametrize("version", [1, 2, 3])
def test_an_older_version_is_refused(tmp_path, monkeypatch, version):
    """A checkpoint of an earlier program says which version it is and what to do."""
    with monkeypatch.context() as patch:
        patch.setattr(checkpoint, "VERSION", version)
        state().write(tmp_path / "checkpoint")
    with pytest.raises(
        OutputError, match=f"of version {version}, this program reads 4: go on with .* or run .* again with force=True"
    ):
        Checkpoint.read(tmp_path / "checkpoint")


def test_damaged_liquid_is_refused(tmp_path):
    """Bytes that do not unpack are named with the file."""
    with open(tmp_path / "checkpoint", "wb") as file:
        fields = dict(version=4, run="r", step=1, frame=1, ledger=0, x=1, v=1, f=1, keys=[], values=[], fixes=["liquid"])
        np.savez(file, **fields, keys0=[[0, 0]], first0=[0, 9], data0=np.ones(9, np.uint8))
    with pytest.raises(OutputError, match="checkpoint cannot be read"):
        Checkpoint.read(tmp_path / "checkpoint")
