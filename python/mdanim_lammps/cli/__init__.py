# SPDX-License-Identifier: GPL-2.0-only
"""The command line: ``mdanim-lammps SCENE`` and its subcommands (docs/command-line.md)."""

from .app import app, main

__all__ = ["app", "main"]
