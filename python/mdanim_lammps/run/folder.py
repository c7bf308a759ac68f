# SPDX-License-Identifier: GPL-2.0-only
"""The output folder of a run: which it is, how it is begun, the scene that it keeps, where its movie goes."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from ..errors import OutputError
from ..results.files import MARK, check_free, disk_errors, open_folder, write_json
from ..results.stored import read_manifest
from ..results.untrusted import check_folder, check_plain
from ..scene.meshes import mesh_files
from ..scene.parse import load_scene, name_of
from ..scene.scene import SceneRecord
from .loop import write_inputs
from .manifest import manifest
from .prepare import Prepared

STUDY = "study"
"""Folder of a study inside the output folder."""


def output_folder(record: SceneRecord, out: str | Path | None = None) -> Path:
    """The output folder of a run (None: the default one), refused where ``--force`` would delete what is not a result.

    Raises OutputError for the current folder, for one that holds it, and for one that holds the scene.
    """
    if out is None:
        path = default_folder(record)
        check_plain(path)
    else:
        path, folder, here = Path(out), Path(out).resolve(), Path.cwd().resolve()
        if here.is_relative_to(folder):
            what = "is the current folder" if here == folder else "holds the current folder"
            raise OutputError(
                f"-o {out}: the output folder {what}, and --force would delete it; name one inside, e.g. -o {record.name}.out"
            )
        if record.path and record.path.resolve().is_relative_to(folder):
            raise OutputError(f"-o {out}: the output folder holds the scene, and --force would delete it; name another folder")
        path = folder if ".." in path.parts else path
    # In a folder without a manifest nothing is read or deleted, except a study.
    check_plain(path / STUDY)
    check_folder(path if os.path.lexists(path / MARK) else path / STUDY)
    return path


def check_room(folder: Path, *, force: bool) -> None:
    """Raises OutputError where results stand in the way of those of a run: to be told before its scene is prepared."""
    with disk_errors(folder):
        check_free(folder, force=force, keep=(STUDY,))


def default_folder(record: SceneRecord) -> Path:
    """``SCENE.out`` beside the scene file."""
    return (record.path.parent if record.path else Path.cwd()) / f"{record.name}.out"


@contextmanager
def open_run(ready: Prepared, folder: str | Path | None, *, force: bool, draws: bool | None = True) -> Iterator[Path]:
    """Make the output folder (None: the default one) with all that is known before the run, and keep other runs out of it.
    Raises OutputError."""
    folder = output_folder(ready.scene, folder)
    movie_file(folder, ready.scene)
    if force and (own := [p.name for p in mesh_files(ready.scene) if p.resolve().is_relative_to(folder.resolve())]):
        raise OutputError(f"{folder} holds the mesh {own[0]} of this scene and cannot be emptied; write elsewhere with -o DIR")
    with open_folder(folder, force=force, keep=(STUDY,)):
        write_json(folder / MARK, manifest(ready.scene, ready.lock, sys.argv, draws=draws))
        write_inputs(ready, folder)
        yield folder


def movie_file(folder: Path, record: SceneRecord) -> Path:
    """Where the movie goes: ``render { movie "NAME" }``, taken from the output folder, or movie.mp4.

    Raises OutputError for a file outside of the output folder, also where a link leads outside, and for one that is not a .mp4.
    """
    name = record.render.movie or "movie.mp4"
    path = folder / name
    if Path(name).is_absolute() or ".." in Path(name).parts or not path.resolve().is_relative_to(folder.resolve()):
        raise OutputError(
            f'render {{ movie "{name}" }}: lies outside of the output folder {folder}; write a name such as movie.mp4'
        )
    if path.suffix.lower() != ".mp4":
        raise OutputError(f'render {{ movie "{name}" }}: a movie is written as .mp4; write a name such as movie.mp4')
    return path


def check_run(folder: Path) -> None:
    """Raises OutputError for a folder that has no run in it, or links."""
    check_folder(folder)
    if not (folder / MARK).is_file():
        what = (
            "has no run in it"
            if folder.is_dir()
            else "is a file, not the output folder of a run"
            if folder.exists()
            else "does not exist"
        )
        raise OutputError(f"{folder} {what}; name the folder that a run has written, NAME.out beside NAME.txt or what -o said")


def stored_scene(folder: Path) -> SceneRecord:
    """The scene of an output folder, under its own name. Raises OutputError, also for a folder with links, and SceneError."""
    check_run(folder)
    name = read_manifest(folder).get("scene")
    scene = load_scene(folder / "scene.lock.txt")
    return replace(scene, name=name_of(name if isinstance(name, str) and name else str(folder.resolve())))
