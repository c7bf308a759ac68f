# SPDX-License-Identifier: GPL-2.0-only
"""Remarks of ``check`` on mesh files of several parts."""

from __future__ import annotations

from collections.abc import Iterator

from ...effects.envelope import Envelope
from ...errors import Problem
from ...model import mesh
from ...model.mesh_parts import told
from ...scene.shapes import Mesh


def notes(envelope: Envelope) -> Iterator[Problem]:
    """Which parts a file names of which all are one object; once for each file."""
    known = set()
    for m, solid in enumerate(envelope.scene.solids):
        shape = solid.shape
        if type(shape) is not Mesh or shape.part is not None or shape.path in known:
            continue
        known.add(shape.path)
        if names := mesh.load(shape).names:
            cause = f"{solid.name}: {shape.path.name} has {len(names)} parts, which are one object: {told(names)}"
            hint = f"for one of them write part {_first(names)} behind the file, and origin file to keep its place"
            yield Problem(envelope.place(m, "shape"), cause, hint, severity="note")


def _first(names: tuple[str, ...]) -> str:
    return f'"{names[0]}"' if names[0] else "1"
