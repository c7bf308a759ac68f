# SPDX-License-Identifier: GPL-2.0-only
"""Files of the output folder: whole or not there, on the disk before they have their name, and nothing left of a failure."""

from __future__ import annotations

import errno
import os

import pytest
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results import files
from mdanim_lammps.results.files import disk_errors, remove_parts, write_whole


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt(), ValueError("NaN")])
def test_a_failed_write_leaves_the_former_file_and_nothing_else(tmp_path, error):
    """A disk that becomes full, Ctrl-C and an error of the caller alike."""
    write_whole(tmp_path / "ledger.csv", "old")

    def fail(part):
        part.write_text("half of the n")
        raise error

    with pytest.raises((OutputError, KeyboardInterrupt, ValueError)):
        write_whole(tmp_path / "ledger.csv", fail)
    assert os.listdir(tmp_path) == ["ledger.csv"]
    assert (tmp_path / "ledger.csv").read_text() == "old"


def test_a_file_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    """Contents, then name, then folder: a loss of power leaves the old file or the new one."""
    done = []

    def note(name):
        real = getattr(os, name)

        def noted(what, *rest):
            path = os.readlink(f"/proc/self/fd/{what}") if isinstance(what, int) else what
            done.append((name, "folder" if str(path) == str(tmp_path) else "file"))
            return real(what, *rest)

        monkeypatch.setattr(files.os, name, noted)

    note("fsync")
    note("replace")
    write_whole(tmp_path / "checkpoint", "state")
    assert done == [("fsync", "file"), ("replace", "file"), ("fsync", "folder")]


def test_two_writers_of_one_name_do_not_share_a_file(tmp_path):
    """The first is still writing when the second has finished: the last to finish wins, whole."""

    def write(part):
        part.write_text("first")
        write_whole(tmp_path / "summary.json", "second, and longer")
        assert part.read_text() == "first"

    write_whole(tmp_path / "summary.json", write)
    assert os.listdir(tmp_path) == ["summary.json"]
    assert (tmp_path / "summary.json").read_text() == "first"


def test_a_file_has_the_rights_that_the_user_gives(tmp_path):
    """The mask of the process counts, as for every other file."""
    former = os.umask(0o027)
    try:
        write_whole(tmp_path / "summary.json", "text")
    finally:
        os.umask(former)
    assert (tmp_path / "summary.json").stat().st_mode & 0o777 == 0o640


def test_what_a_killed_writer_leaves_can_be_removed(tmp_path):
    """SubPlans of files go, files stay."""
    with pytest.raises(SystemExit):
        write_whole(tmp_path / "checkpoint", lambda part: (_ for _ in ()).throw(SystemExit))
    part = files._new_part(tmp_path / "checkpoint")
    for name in ("checkpoint", "trajectory.h5.part", "movie.mp4"):
        (tmp_path / name).touch()
    remove_parts(tmp_path)
    assert not part.exists()
    assert sorted(os.listdir(tmp_path)) == ["checkpoint", "movie.mp4", "trajectory.h5.part"]


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EFBIG])
def test_resume_is_advised_where_there_is_a_checkpoint(tmp_path, number):
    """Before the first checkpoint there is nothing to resume from: the command has to be repeated."""
    for cure in ("make room and repeat the command", "make room and resume"):
        with pytest.raises(OutputError, match=cure), disk_errors(tmp_path / "data.beam"):
            raise OSError(number, os.strerror(number))
        (tmp_path / "checkpoint").touch()
