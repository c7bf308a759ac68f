# SPDX-License-Identifier: GPL-2.0-only
"""Requests of a page to a run: to pause, to go on, to stop. They change two files of the output folder, and nothing else."""

from __future__ import annotations

import os
from pathlib import Path

from ..results.files import PAUSE, STOP, disk_errors

COMMANDS = ("pause", "go", "stop")


def command(folder: Path, what: str) -> None:
    """Ask the run of a folder to do one of `COMMANDS`. Raises ValueError for another word, OutputError."""
    if what not in COMMANDS:
        raise ValueError(what)
    path = folder / (STOP if what == "stop" else PAUSE)
    with disk_errors(path):
        if what == "go":
            path.unlink(missing_ok=True)
        else:
            os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666))
