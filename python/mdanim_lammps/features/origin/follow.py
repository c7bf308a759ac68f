# SPDX-License-Identifier: GPL-2.0-only
"""The position that follows from the origin of a file; files whose unit is perhaps not a metre."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...model import mesh, shapes
from ...scene.evaluated import EvaluatedBlock, EvaluatedSetting
from ...scene.formatting import say
from ...scene.keywords import KEYWORDS
from ...scene.meshes import beside, refusal_of_mesh
from ...scene.rotation import IDENTITY
from ...scene.shapes import Mesh, mesh_of, with_path

UNITS = {"millimetre": 1e-3, "centimetre": 1e-2}
"""Units of files in which objects are often larger than LARGE as they stand [m]."""
LARGE = 10.0
"""Longest side from which on the unit of a file without a scale is asked about [m]."""


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
        if form is not None and file is None:
            v.problem(origin.span(), f"origin file is for a mesh or a solid{block.where}", "write position")
            block.broken.add("position")
            continue
        path = beside(shape.entry.source.folder, file.path if file else Path())
        centre = np.zeros(3)
        if file is not None and refusal_of_mesh(path, str(file.path)) is None:  # else told where shapes are checked
            with suppress(mesh.MeshError):  # told where bodies are made, as that of a mesh with a position
                centre = shapes.centre_in_file(with_path(form, path))
        turn = np.array(_record(block, "orientation") or IDENTITY)
        at = np.array(block.first("position").values[0] if "position" in block.settings else (0.0, 0.0, 0.0))
        block.settings["position"] = [origin.following(KEYWORDS["object"]["position"], tuple((at + turn @ centre).tolist()))]
    _look_at_files(v)


def _look_at_files(v: Any) -> None:
    """Warn of each mesh without a scale that is larger than what is mostly modelled, and tell what is wrong with the others of a
    scene that has problems, beside those: one without any is told when its bodies are made."""
    files: dict[int, tuple[EvaluatedSetting, Any, Mesh, str]] = {}  # objects of a repeat have one
    wrong = bool(v.problems.errors)
    for block in v.blocks("object"):
        shape, form = block.first("shape"), _record(block, "shape")
        if shape is None or id(shape.entry) in files or (file := mesh_of(form)) is None:
            wrong |= form is None
            continue
        path = beside(shape.entry.source.folder, file.path)
        if refusal_of_mesh(path, str(path)) is None:
            files[id(shape.entry)] = shape, with_path(form, path), replace(file, path=path), block.name
        else:
            wrong = True
    for shape, form, _, name in files.values() if wrong else ():
        _tell_of(v, shape, form, name)
    asked: set[Path] = set()
    for shape, _, file, name in files.values():
        if file.scale == 1.0 and file.path not in asked:
            asked.add(file.path)
            _ask_of_unit(v, shape, file, name)


def _tell_of(v: Any, shape: EvaluatedSetting, form: Any, name: str) -> None:
    try:
        shapes.centre_in_file(form)
    except mesh.MeshError as error:
        v.problem(shape.span(), f"{name}: {error}", error.hint)


def _ask_of_unit(v: Any, shape: EvaluatedSetting, file: Mesh, name: str) -> None:
    with suppress(mesh.MeshError):
        size = float(np.ptp(mesh.load(file).points, axis=0).max())
        if size >= LARGE:
            ways = [f"scale {scale:g} if it is a {unit}, {say(size * scale, 'm')}" for unit, scale in UNITS.items()]
            cause = f"{name} is {say(size, 'm')} long if the unit of its file is a metre"
            v.problem(shape.span(), cause, f"write {' or '.join(ways)}", severity="warning")


def _record(block: EvaluatedBlock, word: str) -> Any:
    """The record that a setting becomes; None where it is absent or wrong, which is told later."""
    given = block.first(word)
    try:
        return None if given is None else given.record()
    except ValueError:
        return None
