# SPDX-License-Identifier: GPL-2.0-only
"""The way in: a scene file, or its text, to a SceneRecord."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ..errors import Problem, SceneError, Span, escaped
from .expand import Expander
from .limits import MOST_BYTES, MOST_BYTES_OF_LOCK
from .lock import LOCK
from .scene import Render, SceneRecord
from .source import Problems, SceneFile, UnreadableFile, read_text
from .statements import parse
from .validate import validate, validate_render

Overrides = Mapping[str, str | float]


def load_scene(
    path: str | os.PathLike, overrides: Overrides | None = None, strict: bool = False, trust: bool = False
) -> SceneRecord:
    """Read a scene file.

    ``overrides`` are the values of ``--set name=value``: numbers, or text such as ``"12 cm"``. ``strict`` refuses numbers that
    have a dimension but no unit. ``trust`` lets its commands for LAMMPS be run. Raises SceneError with every problem of the file.
    """
    source = _file(path)
    return _scene(source, name_of(source.name), overrides, strict, trust)


def name_of(path: str) -> str:
    """The name of a scene in a file: without folder and suffix."""
    return escaped(Path(path).stem)


def load_render(path: str | os.PathLike, names: Sequence[str]) -> Render:
    """The ``render`` block of a file, which may be all that it has, for a scene with objects of these names.

    Raises SceneError with every problem of the file, and for one that has no such block.
    """
    source = _file(path)
    problems = Problems()
    body, shared = parse(source, problems)
    out = Expander(shared, None, False).scene(body)
    if out is None or any(block.block != "render" for block in out.blocks):
        return _scene(source, name_of(source.name), None, False).render
    render = validate_render(out, problems, names, source)
    if render is None and not problems.errors:
        problems.add(Span(source.name, 1, 1), "the file has no render block", "write render { camera from ... look ... }")
    problems.stop()
    return render


def _file(path: str | os.PathLike) -> SceneFile:
    shown = escaped(os.fspath(path))
    try:
        file = Path(path).absolute()
        text = read_text(file, MOST_BYTES_OF_LOCK if file.name == LOCK else MOST_BYTES, shown)
    except UnreadableFile as e:
        raise SceneError([Problem(e.span, f"{shown} {e}")]) from None
    except OSError as e:
        raise SceneError([Problem(None, f"{shown} cannot be read: {e.strerror}")]) from None
    return SceneFile(shown, text, Path(os.path.realpath(file)))


def parse_scene(
    text: str,
    name: str = "scene",
    overrides: Overrides | None = None,
    strict: bool = False,
    folder: str | os.PathLike | None = None,
    trust: bool = False,
) -> SceneRecord:
    """Read a scene from a text; ``folder`` is where its includes and meshes are (default: the current one).

    ``trust`` lets its commands for LAMMPS be run; ``name`` stands in for the file name. Raises SceneError with every problem of
    the text.
    """
    source = SceneFile(name, text, folder=Path(folder) if folder is not None else None)
    return _scene(source, name, overrides, strict, trust)


def _scene(source: SceneFile, name: str, overrides: Overrides | None, strict: bool = False, trust: bool = False) -> SceneRecord:
    problems = Problems()
    if not source.text.strip():
        place = Span(source.name, 1, 1)
        raise SceneError([Problem(place, f"{source.name} is empty", "a scene has at least an object and a control block")])
    body, shared = parse(source, problems)
    out = Expander(shared, overrides, strict).scene(body)
    scene = validate(out, problems, name, source) if out is not None else None
    problems.stop()
    return replace(scene, trusted=trust)
