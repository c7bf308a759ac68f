# SPDX-License-Identifier: GPL-2.0-only
"""``scene.lock.txt``: a scene written out in full, defaults and repeats, and read back the same."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from .keywords import BLOCKS, KEYWORDS, Block
from .scene import SceneRecord
from .shapes import PieceShape, mesh_of, with_path

LOCK = "scene.lock.txt"


def lock_text(scene: SceneRecord, meshes: Mapping[Path, str] | None = None) -> str:
    """The scene as a text in SI units whose floats are exact: ``parse_scene(lock_text(s), s.name) == s``.

    ``meshes`` are the names of mesh files in the output folder; without it their paths are absolute.
    Raises ValueError for a text that the language cannot hold (one with a quote or a line break in it).
    """
    settings = {name: k.lines(scene) for name, k in KEYWORDS[""].items()}
    lines = [
        f"# {scene.name}: the whole scene as it was run, in SI units, with every default written out.",
        "# Written by mdanim-lammps; it can be run again as it stands.",
        "",
        *(f"{name} {text}" for name, texts in settings.items() if not KEYWORDS[""][name].many for text in texts),
    ]
    for block in (block for block in reversed(BLOCKS.values()) if block.field):
        held = getattr(scene, block.field)
        for record in _as_written(held) if block.many else (held,):
            lines += _block(block, _with_mesh(record, meshes or {}))
    if scene.lammps:
        lines += ["", "lammps {", *(f"  {line}" for command in scene.lammps for line in command.text.split("\n")), "}"]
    checks = [f"{name} {text}" for name, texts in settings.items() if KEYWORDS[""][name].many for text in texts]
    return "\n".join([*lines, *(["", *checks] if checks else [])]) + "\n"


def _as_written(records: Iterable[Any]) -> Iterator[Any]:
    """Records, of the pieces of an object the object itself, once."""
    last = None
    for record in records:
        shape = getattr(record, "shape", None)
        if not isinstance(shape, PieceShape):
            yield record
        elif shape.whole is not last:
            last = shape.whole
            yield last


def _with_mesh(record: Any, meshes: Mapping[Path, str]) -> Any:
    """The object with the name that its mesh has in the output folder."""
    shape = getattr(record, "shape", None)
    mesh = mesh_of(shape)
    return replace(record, shape=with_path(shape, meshes[mesh.path])) if mesh is not None and meshes else record


def _block(block: Block, record: Any) -> list[str]:
    """Lines of a block, values in one column; none for what the scene does not have."""
    if block.raw:
        return []
    if block.record is None:
        settings = [(word, member.value) for word, member in record.items()]
    else:
        settings = (
            [] if record is None else [(word, text) for word, k in KEYWORDS[block.name].items() for text in k.lines(record)]
        )
    if not settings and not block.many:
        return []
    head = " ".join((block.name, *([record.kind] if block.kinds else []), *(getattr(record, name) for name in block.names)))
    width = max((len(word) for word, _ in settings), default=0)
    return ["", head + " {", *(f"  {word:<{width}} {text}" for word, text in settings), "}"]
