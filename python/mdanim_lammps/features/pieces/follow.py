# SPDX-License-Identifier: GPL-2.0-only
"""Names of the pieces of objects, which joints, contacts and expectations may use."""

from __future__ import annotations

from typing import Any

from ...model.mesh import MeshError
from ...scene.meshes import beside, refusal_of_mesh
from ...scene.shapes import mesh_of, with_path
from .names import piece_name, seed_of


def explained() -> dict[str, str]:
    """Texts of ``explain``: none besides those of the words."""
    return {}


def fill(v: Any) -> None:
    """Put the names of pieces in place of those of objects; v is the scene/validate.Validator."""
    counts = {b.name: count for b in v.blocks("object") if b.first("pieces") is not None for count in [_count(v, b)] if count}
    if counts:
        pieces = {name: [piece_name(name, n) for n in range(count)] for name, count in counts.items()}
        v.names = dict.fromkeys(one for name in v.names for one in pieces.get(name, [name]))


def _count(v: Any, block: Any) -> int:
    """The number of pieces of an object; 0 where it has none that can be told."""
    from ...model import cut

    given, at = block.first("pieces"), block.first("shape")
    if at is None:
        return 0
    try:
        how, shape = given.record(), at.record()
        if (file := mesh_of(shape)) is not None:
            path = beside(at.entry.source.folder, file.path)
            if refusal_of_mesh(path, str(file.path)) is not None:
                return 0
            shape = with_path(shape, path)
        return cut.count(shape, how, seed_of(v, block.name))
    except (ValueError, MeshError):  # told where the record is made
        return 0
