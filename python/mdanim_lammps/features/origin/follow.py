# SPDX-License-Identifier: GPL-2.0-only
"""The position that follows from the origin of a file."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np

from ...model import mesh, shapes
from ...scene.evaluated import EvaluatedBlock
from ...scene.keywords import KEYWORDS
from ...scene.meshes import beside, refusal_of_mesh
from ...scene.rotation import IDENTITY
from ...scene.shapes import mesh_of, with_path


def explained() -> dict[str, str]:
    """Texts of ``explain``: none besides that of the word."""
    return {}


def fill(v: Any) -> None:
    """Give objects with ``origin file`` the position of their centre of mass; v is the scene/validate.Validator.

    c = P + R x with the centre of mass x in the file and the place P of its origin.
    """
    for block in v.blocks("object"):
        origin = block.first("origin")
        if origin is None or origin.values[0] != "file" or (shape := block.first("shape")) is None:
            continue
        form = _record(block, "shape")
        file = mesh_of(form)
        if file is None:
            if form is not None:
                v.problem(origin.span(), f"origin file is for a mesh or a solid{block.where}", "write position")
            block.broken.add("position")
            continue
        path = beside(shape.entry.source.folder, file.path)
        centre = np.zeros(3)
        if refusal_of_mesh(path, str(file.path)) is None:  # else told where shapes are checked
            with suppress(mesh.MeshError):  # told where bodies are made, as that of a mesh with a position
                centre = shapes.centre_in_file(with_path(form, path))
        turn = np.array(_record(block, "orientation") or IDENTITY)
        at = np.array(block.first("position").values[0] if "position" in block.settings else (0.0, 0.0, 0.0))
        block.settings["position"] = [origin.following(KEYWORDS["object"]["position"], tuple((at + turn @ centre).tolist()))]


def _record(block: EvaluatedBlock, word: str) -> Any:
    """The record that a setting becomes; None where it is absent or wrong, which is told later."""
    given = block.first(word)
    try:
        return None if given is None else given.record()
    except ValueError:
        return None
