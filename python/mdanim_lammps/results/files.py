# SPDX-License-Identifier: GPL-2.0-only
"""The output folder: never overwritten unasked, used by one run at a time; every file appears under its name when it is whole
and on the disk."""

from __future__ import annotations

import errno
import fcntl
import glob
import json
import os
import re
import secrets
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import OutputError
from .forms import Form, strict_json, table
from .overwriting import is_made_here
from .untrusted import check_room

MARK = "manifest.json"
SUMMARY = "summary.json"
"""Written last: a folder that has it holds a complete run."""
CHECKPOINT = "checkpoint"
"""Name of the file from which a run is resumed."""
RECORDS = "records.csv"
"""Quantities that the scene records, of a complete run."""
PROGRAM = "mdanim-lammps"
"""Only a folder whose manifest says that this program made it is emptied by ``--force``."""
STOP = "stop"
"""A file of this name in the run's folder stops the run as Ctrl-C does."""
PAUSE = "pause"
"""While a file of this name is in the run's folder, the run begins no further frame."""
HANDS = "hands.txt"
"""Lines of a scene with what hands did in a run."""
HAND = "hand.json"
"""State of the hand of a page, which the run reads before each frame."""
JOB = ".ranks-"
"""Beginning of the name of the file by which a run is handed to its ranks, readable for its owner alone. The supervising rank
empties the file when it has read it; the process that has started the ranks deletes it when it has the result."""
IN_USE = ".in-use"
"""A file of this name is locked while a run writes into the folder. The lock ends with the processes of the run: a file that a
killed run leaves is in nothing's way."""
PATIENCE = 2.0
"""Seconds for which a lock is waited for: processes of a run that was killed may take as long to end."""
NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)
"""Errors of a file system that has no locks: there, two runs in one folder are not noticed."""
MOST_BYTES_OF_JSON = 1 << 28
"""Largest size of a JSON file: a certificate has 250 bytes for each object."""
MEMORY_OF_JSON = 30
"""Bytes of memory that a byte of JSON can take, as in a list of empty tables."""
claims: set[int] = set()
"""Descriptors of the locks of this process. The ranks of a run are given them, so that a lock lasts until all have ended."""


SCRIPT = "# Written by mdanim-lammps"
"""Beginning of a line near the top of in.NAME."""
INPUTS = ("in.", "data.", "contact.", "columns.")
"""Beginnings of the names of files for ``lmp``; the scene's name follows."""
RESULTS = (
    *(
        "scene.lock.txt",
        "certificate.json",
        "trajectory.h5",
        "trajectory.h5.part",
        "ledger.csv",
        RECORDS,
        CHECKPOINT,
        "cost.json",
    ),
    *(SUMMARY, "progress.jsonl", "timeline.json", "edited.txt", HANDS, HAND, STOP, PAUSE, "log.lammps"),
)
"""Files of every run."""
PICTURES = ("trace.json", "movie.mp4", "report.html", "lesson.html")
"""Are of a run where they say so in themselves; others may have put theirs there."""
MESHES, FRAMES = ("meshes", r"[0-9a-f]{32}\.(stl|obj|ply)"), ("frames", r"frame-\d+\.png")
"""Folders of a run, and what the names of its files in them are."""


@contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """Turn OSError into OutputError that names the file and a way out."""
    try:
        yield
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}; {_way_out(path, error)}") from error


def _way_out(path: Path, error: OSError) -> str:
    if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        return "check the folder and its permissions, or write elsewhere with -o DIR"
    room = "raise the limit of the size of files (ulimit -f) or make room" if error.errno == errno.EFBIG else "make room"
    if not _is_of_a_run(path.name):
        return f"{room} and repeat the command"
    if (path.parent / CHECKPOINT).exists():
        return f"{room} and resume"
    return f"{room} and repeat the command, with --force if it made this folder"


def _is_of_a_run(name: str) -> bool:
    """Whether a run writes a file of this name, not what is made of a run: an export, a page, a picture."""
    return name in (*RESULTS, MARK) or name.startswith((*INPUTS, "table.")) or bool(re.fullmatch(MESHES[1], name))


@contextmanager
def open_folder(folder: Path, *, force: bool, keep: Sequence[str] = ()) -> Iterator[None]:
    """Make an output folder that holds no results but folders named in ``keep``, and claim it.

    Raises OutputError when something is in the way and ``force`` is not given, and when another run writes into the folder.
    """
    with disk_errors(folder):
        check_free(folder, force=force, keep=keep)  # refused before anything is made in a folder that is not ours
        folder.mkdir(parents=True, exist_ok=True)
    with claimed(folder):
        with disk_errors(folder):
            if check_free(folder, force=force, keep=keep):
                delete_results(folder)
        yield


def check_free(folder: Path, *, force: bool, keep: Sequence[str] = ()) -> bool:
    """Whether the folder holds anything. Raises OutputError where that stands in the way, and OSError."""
    if not folder.exists():
        return False
    if not folder.is_dir():
        raise OutputError(f"{folder} is a file; name another folder with -o DIR")
    found = [path for path in folder.iterdir() if path.name not in (*keep, IN_USE)]
    if found and not force:
        raise OutputError(f"{folder} exists; overwrite it with --force, or write elsewhere with -o DIR")
    if found and not _is_ours(folder):
        raise OutputError(
            f"{folder} holds files that are not results of mdanim-lammps; --force does not delete "
            "them: name another folder with -o DIR"
        )
    return bool(found)


def _is_ours(folder: Path) -> bool:
    try:
        return read_json(folder / MARK).get("program") == PROGRAM
    except OutputError:
        return False


def delete_results(folder: Path) -> None:
    """Delete what a run, a build, a movie, a report and a timeline have written into an output folder, the manifest last and
    only where nothing else stays: by it the folder is ours until the next one replaces it. Raises OSError."""
    for path in _results(folder):
        path.unlink(missing_ok=True)
    for name, _ in (MESHES, FRAMES):
        remove_empty(folder / name)
    if {path.name for path in folder.iterdir()} <= {MARK, IN_USE}:
        (folder / MARK).unlink(missing_ok=True)


def _results(folder: Path) -> Iterator[Path]:
    yield from (folder / name for name in RESULTS if not _is_folder(folder / name))
    pictures = [folder / name for name in (*PICTURES, *_movie(folder))] + _inside(folder, *FRAMES)
    yield from (path for path in pictures if is_made_here(path))
    yield from _inside(folder, *MESHES)
    for script in folder.glob("in.*"):
        if script.is_file() and _is_script(script):
            name = script.name.removeprefix("in.")
            yield from (folder / f"{kind}{name}" for kind in INPUTS)
            yield folder / f"{name}.lammpstrj"  # which `lmp` leaves: it would be taken for the dump of the new run
            yield from (table for table in folder.glob(f"table.*.{glob.escape(name)}") if table.is_file())


def _inside(folder: Path, name: str, own: str) -> list[Path]:
    """Files of a folder in an output folder whose names are those of a run."""
    if not _is_folder(folder / name):
        return []
    return [path for path in (folder / name).iterdir() if re.fullmatch(own, path.name) and not _is_folder(path)]


def _is_script(path: Path) -> bool:
    with open(path, encoding="utf-8", errors="replace") as file:
        return any(line.startswith(SCRIPT) for line in file.read(1 << 16).splitlines()[:5])


def _movie(folder: Path) -> list[str]:
    """Where the scene of the folder wants its movie."""
    try:
        name = json.loads((folder / MARK).read_text(encoding="utf-8")).get("movie")
    except (OSError, ValueError, AttributeError):
        return []
    inside = isinstance(name, str) and name.endswith(".mp4") and not Path(name).is_absolute() and ".." not in Path(name).parts
    return [name] if inside else []


def _is_folder(path: Path) -> bool:
    return path.is_dir() and not path.is_symlink()


def remove_empty(folder: Path) -> None:
    """Remove a folder that is there and holds nothing."""
    with suppress(OSError):
        folder.rmdir()


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """Keep other runs out of an output folder, and remove what killed runs have left there of unfinished files.

    Raises OutputError when another run writes into it.
    """
    path = folder / IN_USE
    descriptor = _locked(path)
    claims.add(descriptor)
    try:
        with disk_errors(folder):
            remove_parts(folder)
            remove_left(folder)
        yield
    finally:
        claims.remove(descriptor)
        with suppress(OSError):
            if _is_open_as(path, descriptor):  # the folder may have been deleted, and be another run's now
                path.unlink()
        os.close(descriptor)


def _locked(path: Path) -> int:
    """A descriptor of a file that no other process has locked. Raises OutputError."""
    deadline = time.monotonic() + PATIENCE
    with disk_errors(path):
        while True:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if _is_open_as(path, descriptor):  # else the process that had it has deleted it meanwhile
                    return descriptor
            except BlockingIOError as error:
                if time.monotonic() > deadline:
                    os.close(descriptor)
                    raise OutputError(
                        f"{path.parent}: another run is writing into this folder; wait for its end, "
                        f"stop it with 'touch {path.parent / STOP}', or write elsewhere with -o DIR"
                    ) from error
            except OSError as error:
                if error.errno in NO_LOCKS:
                    return descriptor
                os.close(descriptor)
                raise
            os.close(descriptor)
            time.sleep(0.05)


def _is_open_as(path: Path, descriptor: int) -> bool:
    """Whether a path names the file that is open."""
    return path.exists() and os.path.samestat(path.stat(), os.fstat(descriptor))


def in_use(folder: Path) -> bool:
    """Whether processes of a run are alive that write into a folder; False on file systems without locks."""
    try:
        descriptor = os.open(folder / IN_USE, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError as error:
        if error.errno not in NO_LOCKS:
            raise
    finally:
        os.close(descriptor)
    return False


def write_whole(path: Path, write: Callable[[Path], None] | str, *, lasting: bool = True) -> None:
    """Write a file beside its final name, sync it and rename it: the name always holds a whole file, also after a loss of power.

    A failure leaves the former file and nothing else. Several writers of one name do not disturb each other: the last wins.

    Args:
        path: the final name.
        write: the text, or a function that writes the file whose path it is given.
        lasting: wait for the disk; without it a loss of power may leave the name with no file or a damaged one.

    Raises:
        OutputError: the file cannot be written, e.g. because the disk is full.
    """
    with disk_errors(path):
        part = _new_part(path)
        try:
            if isinstance(write, str):
                part.write_text(write, encoding="utf-8")
            else:
                write(part)
            if lasting:
                sync(part)
                rename(part, path)
            else:
                os.replace(part, path)
        except BaseException:
            part.unlink(missing_ok=True)
            raise


def _new_part(path: Path) -> Path:
    """An empty file beside ``path`` with a name that no other writer has. Raises OSError."""
    part = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    os.close(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    return part


def remove_parts(folder: Path) -> None:
    """Remove what killed processes have left: jobs, and parts of files that were being written. Only for a folder that no other
    process uses."""
    for pattern in (".*.????????.part", f"{JOB}*"):
        for part in folder.glob(pattern):
            part.unlink(missing_ok=True)


@contextmanager
def scratch(folder: Path, kind: str) -> Iterator[Path]:
    """A folder ``.KIND-...`` in another one for what is being written; those that killed processes have left are removed.

    It is locked while it is used, as `IN_USE` of an output folder. Raises OutputError.
    """
    remove_left(folder)
    place = folder / f".{kind}-{secrets.token_hex(4)}"
    with disk_errors(place):
        place.mkdir(parents=True)
        lock = os.open(place / IN_USE, os.O_RDWR | os.O_CREAT, 0o666)
        with suppress(OSError):  # without locks: what is left stays
            fcntl.flock(lock, fcntl.LOCK_EX)
    try:
        yield place
    finally:
        shutil.rmtree(place, ignore_errors=True)
        os.close(lock)


def remove_left(folder: Path) -> None:
    """Remove what killed processes have left of `scratch`."""
    for place in folder.glob(".*-????????"):
        if not _is_folder(place) or not re.fullmatch(r"\..+-[0-9a-f]{8}", place.name):
            continue
        try:
            lock = os.open(place / IN_USE, os.O_RDWR | os.O_NOFOLLOW)
        except OSError:
            continue
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(place, ignore_errors=True)
        except BlockingIOError:
            pass
        except OSError as error:
            if error.errno not in NO_LOCKS:
                raise
        finally:
            os.close(lock)


def sync(path: Path) -> None:
    """Return when a file's contents, or a folder's names, are on the disk. Raises OSError."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def rename(source: Path, target: Path) -> None:
    """Rename a file in its folder, replacing what has that name, and return when this is on the disk. Raises OSError."""
    os.replace(source, target)
    sync(target.parent)


def write_json(path: Path, data: dict) -> None:
    """Write plain data as JSON that every reader can read; numbers in it are finite."""
    write_whole(path, json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


ANY = table(lambda value: value)
"""A table of whatever there is."""


def read_json(path: Path, form: Form = ANY, most: int = MOST_BYTES_OF_JSON) -> dict:
    """Read a JSON file of an output folder.

    Args:
        path: the file.
        form: what it must hold; what it holds besides is left out.
        most: bytes that it has at most; of less than that too it must fit in memory.

    Raises:
        OutputError: the file is missing, broken or too large, or holds something else.
    """
    try:
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            if size > most:
                raise OutputError(f"{path} has {size} bytes, no run writes more than {most}: it is damaged")
            check_room(MEMORY_OF_JSON * size, path)
            return form(strict_json(file.read(size).decode("utf-8")))
    except (OSError, ValueError, RecursionError) as error:
        raise OutputError(f"{path} cannot be read ({error}); is this an output folder of mdanim-lammps?") from error
