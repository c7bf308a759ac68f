# SPDX-License-Identifier: GPL-2.0-only
"""Commands for LAMMPS in a scene: which lines are one command, and what is said where they may not be run."""

from __future__ import annotations

from collections.abc import Iterator

from ..errors import Problem, SceneError
from .evaluated import EvaluatedBlock
from .scene import Command, SceneRecord
from .tokens import Token


def commands(block: EvaluatedBlock) -> Iterator[Command]:
    """The commands of a block. A line that ends with & goes on in the next one; so does a text in triple quotes."""
    waiting: list[Token] = []
    for line in block.group.raw:
        if line.startswith("#") and not waiting:
            continue
        waiting.append(line)
        text = "\n".join(waiting)
        if not text.endswith("&") and text.count('"""') % 2 == 0:
            yield Command(text, block.group.source.span(waiting[0]))
            waiting = []
    if waiting:
        yield Command("\n".join(waiting), block.group.source.span(waiting[0]))


def check_trust(scene: SceneRecord) -> None:
    """Raise SceneError for a scene with commands for LAMMPS that nobody has trusted."""
    if scene.lammps and not scene.trusted:
        cause = "these are commands for LAMMPS, which can read and write files and start programs"
        way_out = "read them, and write --trust if they may be run"
        raise SceneError([Problem(scene.lammps[0].span, cause, way_out)])


def check_alone(scene: SceneRecord, executors: int, control: str | None) -> None:
    """Raise SceneError for a scene with such commands and a distributed run, which is central or among peers by ``control``."""
    if scene.lammps and (executors > 1 or control is not None):
        cause = "commands for LAMMPS act on all objects together, and each executor has only some of them"
        way_out = "leave out -n and --control: threads share the work" if executors > 1 else "leave out --control"
        raise SceneError([Problem(scene.lammps[0].span, cause, way_out)])


def note(scene: SceneRecord) -> list[Problem]:
    """Say about a scene with such commands that no promise is made for them."""
    if not scene.lammps:
        return []
    cause = "commands for LAMMPS are run as they stand: neither the bound on the time step nor the energies know what they do"
    return [Problem(scene.lammps[0].span, cause, "the residual of energy holds their work", "warning")]
