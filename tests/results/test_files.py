# SPDX-License-Identifier: GPL-2.0-only
"""Files of the output folder: whole or not there, on the disk before they have their name, and nothing left of a failure."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys

import pytest
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results import files
from mdanim_lammps.results.files import IN_USE, claimed, disk_errors, open_folder, remove_parts, write_whole


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
    """Parts of files go, files stay."""
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


HOLD = """
import sys, time
from pathlib import Path
from mdanim_lammps.results.files import claimed
with claimed(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def holder(tmp_path):
    """Another process that writes into the folder."""
    path = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, tmp_path], stdout=subprocess.PIPE, text=True, env={**os.environ, **path}
    )
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


def test_a_folder_is_one_runs_at_a_time(tmp_path, holder, monkeypatch):
    """The second is refused, and nothing of the first is deleted; when that is killed, its lock is in nothing's way."""
    monkeypatch.setattr(files, "PATIENCE", 0.1)
    write_whole(tmp_path / files.MARK, f'{{"program": "{files.PROGRAM}"}}')
    for way in (claimed(tmp_path), open_folder(tmp_path, force=True)):
        with pytest.raises(OutputError, match=r"another run is writing into this folder; .*touch .*/stop.* write elsewhere"), way:
            pass
    assert sorted(os.listdir(tmp_path)) == sorted([IN_USE, files.MARK])
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    assert (tmp_path / IN_USE).exists()
    with open_folder(tmp_path, force=True):
        assert os.listdir(tmp_path) == [IN_USE]
    assert os.listdir(tmp_path) == []


def test_a_folder_that_is_free_soon_is_waited_for(tmp_path, holder):
    """A run that was killed may take a moment to end."""
    killer = subprocess.Popen(["sh", "-c", f"sleep 0.3; kill -9 {holder.pid}"])
    with claimed(tmp_path):
        assert killer.wait() == 0 and holder.wait() == -signal.SIGKILL


def test_threads_of_a_process_are_kept_apart_too(tmp_path, monkeypatch):
    """Two runs of one process in one folder."""
    monkeypatch.setattr(files, "PATIENCE", 0.1)
    with claimed(tmp_path), pytest.raises(OutputError, match="another run"), claimed(tmp_path):
        pass
    assert os.listdir(tmp_path) == []


def test_the_lock_of_a_folder_that_was_made_anew_is_left_alone(tmp_path, monkeypatch):
    """Where a folder was deleted under a run and another run has it now, the end of the first does not take away the lock."""
    monkeypatch.setattr(files, "PATIENCE", 0.1)
    first = claimed(tmp_path)
    first.__enter__()
    (tmp_path / IN_USE).unlink()
    with claimed(tmp_path):
        first.__exit__(None, None, None)
        with pytest.raises(OutputError, match="another run"), claimed(tmp_path):
            pass


def test_a_lock_is_not_opened_through_a_link(tmp_path):
    """It would make a file elsewhere."""
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / IN_USE).symlink_to(tmp_path / "elsewhere")
    with pytest.raises(OutputError, match="cannot be written"), claimed(tmp_path / "run"):
        pass
    assert not (tmp_path / "elsewhere").exists()


def test_a_file_system_without_locks_is_written_to(tmp_path, monkeypatch):
    """There, two runs are not told apart."""

    def none(*_):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(files.fcntl, "flock", none)
    with claimed(tmp_path):
        pass
