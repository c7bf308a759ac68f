# SPDX-License-Identifier: GPL-2.0-only
"""Which files a command may overwrite: pictures, movies and pages that this program has made, which say so in themselves. For any
other file ``--force`` is asked for."""

from __future__ import annotations

import mmap
import os
from pathlib import Path

from ..errors import OutputError

MADE = "Made by mdanim-lammps"
"""Stands in every picture, movie and page."""


def check_overwriting(path: Path, *, force: bool, other: str = "FILE") -> None:
    """Refuse to overwrite a file that this program has not made; -o takes the ``other`` place. Raises OutputError."""
    if not os.path.lexists(path) or is_made_here(path):
        return
    if path.is_dir():
        raise OutputError(f"{path} is a folder; write elsewhere with -o {other}")
    if not force:
        raise OutputError(
            f"{path} exists, and is not of this program; overwrite it with --force, or write elsewhere with -o {other}"
        )


def is_made_here(path: Path) -> bool:
    """Whether a picture, a movie or a page says that this program has made it."""
    try:
        with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            return content.find(MADE.encode()) >= 0
    except (OSError, ValueError):  # an empty file, a folder, a device
        return False
