# SPDX-License-Identifier: GPL-2.0-only
"""Which files a command may overwrite: pictures, movies and pages that this program has made, which say so in themselves. For any
other file ``--force`` is asked for."""

from __future__ import annotations

import mmap
import os
from pathlib import Path

from ..errors import OutputError, UsageError

MADE = "Made by mdanim-lammps"
"""Stands in every picture, movie and page."""


def check_overwriting(path: Path, *, force: bool, other: str = "FILE") -> None:
    """Refuse to overwrite a file that this program has not made. Raises OutputError, which offers ``-o other``."""
    if not os.path.lexists(path) or is_made_here(path):
        return
    if path.is_dir():
        raise OutputError(f"{path} is a folder; write elsewhere with -o {other}")
    if not force:
        raise OutputError(
            f"{path} exists, and is not of this program; overwrite it with --force, or write elsewhere with -o {other}"
        )


def output_file(default: Path, out: str | Path | None, *, force: bool) -> Path:
    """`place_of` the one file that a command makes. Raises what that does, and OutputError where it is not to be overwritten."""
    path = place_of(default, out)
    check_overwriting(path, force=force)
    return path


def place_of(default: Path, out: str | Path | None, what: str = "this file") -> Path:
    """Where a file goes: ``default``, or what -o names, a file of that kind or a folder for it. Raises UsageError for another
    kind, and OutputError where its folder is not there."""
    if out is None:
        return default
    path = Path(out) / default.name if Path(out).is_dir() else Path(out)
    if path.suffix.lower() != default.suffix.lower():
        name = f"{path.stem or default.stem}{default.suffix}"
        raise UsageError(f"-o {path}: {what} is written as {default.suffix}; give it a name such as {name}")
    if not path.parent.is_dir():
        raise OutputError(f"-o {path}: there is no folder {path.parent}; make it first, or name another")
    return path


def is_made_here(path: Path) -> bool:
    """Whether a picture, a movie or a page says that this program has made it."""
    try:
        with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            return content.find(MADE.encode()) >= 0
    except (OSError, ValueError):  # an empty file, a folder, a device
        return False
