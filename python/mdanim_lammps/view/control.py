# SPDX-License-Identifier: GPL-2.0-only
"""Requests of a page to a run: to pause, to go on, to stop. They change two files of the output folder, and nothing else."""

from __future__ import annotations

import os
from pathlib import Path

from ..results.files import PAUSE, STOP, disk_errors

COMMANDS = ("pause", "go", "stop")


def command(folder: Path, what: str) -> None:
    """Ask the run of a folder to do one of `COMMANDS`. Raises ValueError for another word, OutputError."""
    if what == "pause":
        _make(folder / PAUSE)
    elif what == "go":
        _remove(folder / PAUSE)
    elif what == "stop":
        _make(folder / STOP)
    else:
        raise ValueError(what)


def _make(path: Path) -> None:
    with disk_errors(path):
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666))


def _remove(path: Path) -> None:
    with disk_errors(path):
        path.unlink(missing_ok=True)
