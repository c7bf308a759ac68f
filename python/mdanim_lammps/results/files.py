# SPDX-License-Identifier: GPL-2.0-only
"""The output folder: never overwritten unasked; every file appears under its name when it is whole and on the disk."""

from __future__ import annotations

import errno
import json
import os
import secrets
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from ..errors import OutputError

MARK = "manifest.json"
CHECKPOINT = "checkpoint"
"""Name of the file from which a run is resumed."""
PROGRAM = "mdanim-lammps"
"""Only a folder whose manifest says that this program made it is emptied by ``--force``."""


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
    if (path.parent / CHECKPOINT).exists():
        return "make room and resume"
    return "make room and repeat the command, with --force if it made this folder"


def open_folder(folder: Path, *, force: bool, keep: Sequence[str] = ()) -> None:
    """Make an output folder that is empty but for folders named in ``keep``.

    Raises OutputError when something is in the way and ``force`` is not given.
    """
    with disk_errors(folder):
        if folder.exists():
            if not folder.is_dir():
                raise OutputError(f"{folder} is a file; name another folder with -o DIR")
            found = [path for path in folder.iterdir() if path.name not in keep]
            ours, empty = _ours(folder), not found
            if not empty and not force:
                raise OutputError(f"{folder} exists; overwrite it with --force, or write elsewhere with -o DIR")
            if not empty and not ours:
                raise OutputError(
                    f"{folder} holds files that are no results of mdanim-lammps; --force does not delete "
                    "them: name another folder with -o DIR"
                )
            # The folder is no longer ours once this file is gone: it goes last, so that a deletion that fails can be repeated.
            for path in sorted(found, key=lambda path: path.name == MARK):
                shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
        folder.mkdir(parents=True, exist_ok=True)


def _ours(folder: Path) -> bool:
    try:
        return json.loads((folder / MARK).read_text(encoding="utf-8")).get("program") == PROGRAM
    except (OSError, ValueError, AttributeError):
        return False


def write_whole(path: Path, write: Callable[[Path], None] | str) -> None:
    """Write a file beside its final name, sync it and rename it: the name always holds a whole file, also after a loss of power.

    A failure leaves the former file and nothing else. Several writers of one name do not disturb each other: the last wins.

    Args:
        path: the final name.
        write: the text, or a function that writes the file whose path it is given.

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
            sync(part)
            rename(part, path)
        except BaseException:
            part.unlink(missing_ok=True)
            raise


def _new_part(path: Path) -> Path:
    """An empty file beside ``path`` with a name that no other writer has. Raises OSError."""
    part = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    os.close(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    return part


def remove_parts(folder: Path) -> None:
    """Remove what killed processes have left of files that were being written; only for a folder that no other process uses."""
    for part in folder.glob(".*.????????.part"):
        part.unlink(missing_ok=True)


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


def read_json(path: Path) -> dict:
    """Read a JSON file of an output folder. Raises OutputError when it is missing or broken."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(data, dict):
            raise ValueError("it holds no table of names and values")
        return data
    except (OSError, ValueError, RecursionError) as error:
        raise OutputError(f"{path} cannot be read ({error}); is this an output folder of mdanim-lammps?") from error
