# SPDX-License-Identifier: GPL-2.0-only
"""All scenes of a folder as one page with their movies."""

from __future__ import annotations

import html
import sys
import urllib.parse
from pathlib import Path

from ..api import Run, Scene
from ..errors import MdanimError, OutputError
from ..picture.movie import render_movie
from ..results.files import CHECKPOINT, MARK, SUMMARY, disk_errors, write_whole
from ..results.overwriting import MADE, check_overwriting
from ..results.stored import read_manifest
from ..run.folder import movie_file, output_folder
from ..run.loop import Interrupted
from ..scene.scene import SceneRecord
from .steps import load, with_accuracy

STYLE = (
    "body{font:16px sans-serif;margin:2em;background:#f8fafb}figure{margin:0}video{width:100%}code{color:#555}"
    "main{display:grid;grid-template-columns:repeat(auto-fill,minmax(22em,1fr));gap:1.5em}"
)


def make_gallery(folder: Path, out: Path, *, accuracy=None, size=None, overrides=(), force=False, quiet=False) -> tuple[int, int]:
    """Run every ``NAME.txt`` of a folder into ``out``/NAME, and write ``out``/index.html; returns how many, and how many failed.

    A run that is complete is kept unless ``force`` is given, one that was stopped goes on, or begins again where it has left no
    checkpoint. A scene that fails does not stop the others: its message is on the page. Raises Interrupted, and OutputError where
    there are no scenes or no page can be written.
    """
    scenes = sorted(folder.glob("*.txt"))
    if not scenes:
        raise OutputError(f"{folder} holds no scenes, files NAME.txt; name a folder that does")
    check_overwriting(out / "index.html", force=force, other="DIR")
    with disk_errors(out):
        out.mkdir(parents=True, exist_ok=True)
    cells, failed = [], 0
    for number, path in enumerate(scenes, 1):
        if not quiet:
            print(f"gallery  {number} of {len(scenes)}: {path}", file=sys.stderr, flush=True)
        title = path.stem
        try:
            record = with_accuracy(load(path, overrides), accuracy)
            title = record.title or path.stem
            place = output_folder(record, out / path.stem)
            movie = movie_file(place, record)
            if _run(record, place, force=force) or not movie.exists():
                render_movie(place, record.render, movie, size=size)
            address = urllib.parse.quote(movie.relative_to(out).as_posix())
            shown = f'<video src="{address}" controls loop muted></video>'
        except Interrupted:
            raise
        except MdanimError as error:
            failed += 1
            print(error, file=sys.stderr)
            shown = f"<pre>{html.escape(str(error))}</pre>"
        words = f"{html.escape(title)} <code>{html.escape(path.name)}</code>"
        cells.append(f"<figure>{shown}<figcaption>{words}</figcaption></figure>")
    head = f'<meta charset="utf-8"><meta name="generator" content="{MADE}"><title>Gallery</title><style>{STYLE}</style>'
    page = f"<!doctype html>{head}<main>{''.join(cells)}</main>"
    write_whole(out / "index.html", page + "\n")
    return len(scenes), failed


def _is_without_a_state(place: Path) -> bool:
    """Whether a folder is of a run that was stopped before its first checkpoint: nothing is lost where it begins again."""
    if (place / CHECKPOINT).exists() or not (place / MARK).exists():
        return False
    return read_manifest(place).get("draws") is not None


def _run(record: SceneRecord, place: Path, *, force: bool) -> bool:
    """Have a complete run of a scene in a folder; returns whether anything had to be run. Raises what `Scene.run` does."""
    if not force and (place / SUMMARY).exists():
        return False
    anew = force or _is_without_a_state(place)
    if anew or not (place / MARK).exists():
        Scene(record).run(place, force=anew)
    else:
        Run(place).resume(movie=False, progress=False)
    return True
