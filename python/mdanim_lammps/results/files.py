# SPDX-License-Identifier: GPL-2.0-only
"""The output folder: never overwritten unasked, and every file appears under its name only when whole."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import OutputError

MARK = "manifest.json"
PROGRAM = "mdanim-lammps"
"""Only a folder whose manifest says that this program made it is emptied by ``--force``."""


@contextmanager
def disk_errors(what: Path) -> Iterator[None]:
    """Turn OSError into OutputError that names the file and a way out."""
    try:
        yield
    except OSError as error:
        full = error.errno == 28
        cure = "make room and resume" if full else "check the folder and its permissions, or write elsewhere with -o DIR"
        raise OutputError(f"{what}: cannot be written: {error.strerror or error}; {cure}") from error


def open_folder(folder: Path, *, force: bool) -> None:
    """Make an empty output folder. Raises OutputError when something is in the way and ``force`` is not given."""
    with disk_errors(folder):
        if folder.exists():
            if not folder.is_dir():
                raise OutputError(f"{folder} is a file; name another folder with -o DIR")
            ours, empty = _ours(folder), not any(folder.iterdir())
            if not empty and not force:
                raise OutputError(f"{folder} exists; overwrite it with --force, or write elsewhere with -o DIR")
            if not empty and not ours:
                raise OutputError(
                    f"{folder} holds files that are no results of mdanim-lammps; --force does not delete "
                    "them: name another folder with -o DIR"
                )
            if not empty:
                shutil.rmtree(folder)
        folder.mkdir(parents=True, exist_ok=True)


def _ours(folder: Path) -> bool:
    try:
        return json.loads((folder / MARK).read_text(encoding="utf-8")).get("program") == PROGRAM
    except (OSError, ValueError, AttributeError):
        return False


def write_whole(path: Path, write: Callable[[Path], None] | str) -> None:
    """Write a file beside its final name and rename it when it is whole. Raises OutputError."""
    part = path.with_name(path.name + ".part")
    with disk_errors(path):
        if isinstance(write, str):
            part.write_text(write, encoding="utf-8")
        else:
            write(part)
        os.replace(part, path)


def write_json(path: Path, data: dict) -> None:
    """Write plain data as JSON that every reader can read; numbers in it are finite."""
    write_whole(path, json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def read_json(path: Path) -> dict:
    """Read a JSON file of an output folder. Raises OutputError when it is missing or broken."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be read ({error}); is this an output folder of mdanim-lammps?") from error
