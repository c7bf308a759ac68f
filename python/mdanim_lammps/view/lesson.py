# SPDX-License-Identifier: GPL-2.0-only
"""A run as a lesson: one HTML file with the question of its scene, the movie, curves, the answer, and the scene itself."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import numpy as np

from ..errors import OutputError, UsageError
from ..picture.curves import tints
from ..picture.layer import Color
from ..picture.palette import object_colors
from ..picture.plot import own_style, span_of
from ..results.expect import Outcome
from ..results.files import write_whole
from ..results.html import plain_table
from ..results.overwriting import MADE
from ..results.records import Records
from ..results.trajectory import Trajectory
from ..run.folder import movie_file
from ..scene.formatting import number
from ..scene.scene import SceneRecord

MOST_MOVIE = 50_000_000
"""Bytes of a movie that the file takes in."""
WHITE = (1.0, 1.0, 1.0)
RULES = "default-src 'none'; media-src data:; img-src data:; style-src 'unsafe-inline'"
STYLE = """
body { font: 17px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; color: #20242a; }
video, img { width: 100%; border-radius: 6px; }
table { border-collapse: collapse; } td, th { padding: .2rem .8rem; text-align: left; }
.question { font-size: 1.25rem; font-weight: 600; } details { margin: 1rem 0; } summary { cursor: pointer; color: #1c6ea4; }
pre { background: #f3f5f7; padding: 1rem; overflow: auto; font-size: 13px; }
@media (prefers-color-scheme: dark) { body { background: #16191d; color: #e6e9ec; } pre { background: #22262b; } }
"""


class LessonRun(Protocol):
    """The parts of an `api.run.Run` that the page tells."""

    folder: Path
    records: Records
    outcomes: list[Outcome]
    trajectory: Trajectory


def write_lesson(run: LessonRun, scene: SceneRecord, path: Path) -> None:
    """Write the page of a run that has ended, with its movie if it has one. It opens from disk, has no script, and asks no host
    for anything.

    Raises UsageError for a scene without a question, OutputError where the movie is too large or the file cannot be written.
    """
    folder = run.folder
    check_asks(scene)
    movie = movie_file(folder, scene)
    there = movie.is_file()
    if there and movie.stat().st_size > MOST_MOVIE:
        raise OutputError(f"{movie} is too large for a page; draw it smaller: mdanim-lammps render {folder} --size 640 360")
    write_whole(path, page_of(run, scene, movie.read_bytes() if there else b""))


def check_asks(scene: SceneRecord) -> None:
    """Raises UsageError for a scene without a question."""
    if not scene.question:
        raise UsageError(f'{scene.name} asks nothing; write question "..." and answer "..." in its scene and run it')


def page_of(run: LessonRun, scene: SceneRecord, movie: bytes) -> str:
    """The page as HTML; all words of the scene are text in it. An empty movie is left out."""
    title = html.escape(scene.title or scene.name)
    parts = [f"<h1>{title}</h1>", f'<p class="question">{html.escape(scene.question)}</p>']
    if movie:
        parts.append(f'<video controls loop src="data:video/mp4;base64,{base64.b64encode(movie).decode()}"></video>')
    if scene.records:
        subjects, metadata = {of.what: of.subject for of in scene.records}, run.trajectory.metadata
        found = object_colors(metadata.colors, metadata.still) / 255.0
        colors = dict(zip(metadata.names, map(tuple, found)))
        curves = base64.b64encode(drawn_curves(run.records, subjects, colors)).decode()
        parts.append(f'<p><img alt="curves of the records over time" src="data:image/png;base64,{curves}"></p>')
    if scene.answer:
        parts.append(f"<details><summary>Answer</summary><p>{html.escape(scene.answer)}</p></details>")
    if run.outcomes:
        rows = [
            (
                one.what,
                f"{one.asked} {one.expect.unit}",
                f"{number(one.found, 6)} {one.expect.unit}",
                "met" if one.met else "missed",
            )
            for one in run.outcomes
        ]
        table = plain_table(("quantity", "expected", "found", ""), rows)
        parts.append(f"<details><summary>Measured in this run</summary>{table}</details>")
    text = run.trajectory.metadata.scene_text
    parts.append(f"<details><summary>The scene, with all defaults</summary><pre>{html.escape(text)}</pre></details>")
    head = f'<meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="{RULES}"><title>{title}</title>'
    head += f'<meta name="viewport" content="width=device-width"><style>{STYLE}</style>'
    parts.append(f"<p><small>{MADE}</small></p>")
    return f'<!doctype html><html lang="en"><head>{head}</head><body>{"".join(parts)}</body></html>\n'


@own_style()
def drawn_curves(records: Records, subjects: Mapping[str, str], colors: Mapping[str, Color]) -> bytes:
    """All records over time as a PNG, those of one unit on one axis, in the colours of their objects; ``subjects`` are names of
    these by the names of records."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    names = [name for name in records if name != "time"]
    units = list(dict.fromkeys(records.units[name] for name in names))
    figure = Figure(figsize=(9.0, 2.6 * len(units)), dpi=110, layout="constrained")
    for n, unit in enumerate(units, 1):
        axes = figure.add_subplot(len(units), 1, n)
        own = [name for name in names if records.units[name] == unit]
        for name, color in zip(own, tints([subjects.get(name, "") for name in own], colors, WHITE, n - 1)):
            axes.plot(records["time"], np.asarray(records[name]), color=color, label=name.replace("$", r"\$"))
        axes.set_xlim(0.0, records["time"][-1] or 1.0)
        axes.set_ylim(*span_of([np.asarray(records[name]) for name in own], unit))
        axes.ticklabel_format(useOffset=False)
        axes.set_ylabel(unit or "-")
        axes.grid(alpha=0.3)
        # Above the axes, where no curve is.
        axes.legend(fontsize="small", loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, frameon=False, borderaxespad=0.0)
    axes.set_xlabel("time [s]")
    file = io.BytesIO()
    FigureCanvasAgg(figure).print_png(file)
    return file.getvalue()
