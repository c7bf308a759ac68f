# SPDX-License-Identifier: GPL-2.0-only
"""Commands about a run that there is: go on with it, draw it, look at it, take it elsewhere."""

from __future__ import annotations

import sys
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from ..errors import ExitCode, Problem, RefusedError, UsageError
from ..export import FORMATS
from ..terminal import progress_bar
from ..view.beside import Viewer, show_address
from .options import AllowUnstable, Executing, HandsOn, Look, OutFile, Quiet, RunFolder, View, whole_number
from .steps import adopt, announce, check_hands, draw_movie, frame_range, prepare, seconds_of, simulate_and_draw

if TYPE_CHECKING:
    from ..scene.render import Render


def resume(
    folder: Path,
    /,
    *,
    executing: Executing = Executing(),
    movie: Annotated[bool | None, Parameter(negative="--no-movie")] = None,
    view: View = False,
    hands: HandsOn = False,
    allow_unstable: AllowUnstable = False,
    trust: bool = False,
    quiet: Quiet = False,
) -> None:
    """Continue a run from its last checkpoint, as if it had never stopped.

    Parameters
    ----------
    folder
        The output folder of a run that was stopped.
    movie
        Make movie.mp4 at the end; if left out, where the run was to make one.
    trust
        Run the commands for LAMMPS that the scene has; what they have made begins anew.
    """
    from ..api.run import resumed

    executing.check()
    if hands:
        check_hands(executing)
    make = partial(prepare, allow_unstable=allow_unstable)
    with Viewer(view, hands=hands) as viewer, resumed(folder, make, trust) as (ready, checkpoint, draws):
        announce(ready, quiet, False, executing)
        viewer.start(folder)
        movie = draws if movie is None else movie
        simulate_and_draw(ready, folder, executing, quiet=quiet, movie=movie, resume=checkpoint, hands=hands)


def render(
    folder: RunFolder,
    /,
    *,
    look: Look = Look(),
    at: str | None = None,
    fps: float | None = None,
    output: OutFile = OutFile(),
    frames: bool = False,
    scene: Path | None = None,
    quiet: Quiet = False,
) -> None:
    """Draw the movie of an output folder again, with another size, rate or camera: movie.mp4 in the folder.

    Parameters
    ----------
    at
        Draw one picture instead, of the frame nearest to this time, e.g. "0.8 s": picture.png in the folder.
    fps
        Pictures per second of the movie.
    frames
        Write every picture to frames/ in the folder too.
    scene
        Take the render block (camera, background, speed) of this file instead; it need hold nothing else.
    """
    look.check()
    when = None if at is None else seconds_of("--at", at, zero=True)
    if when is not None and (frames or fps is not None):
        raise UsageError("--at draws one picture: leave out --fps and --frames")
    if fps is not None and not 0.0 < fps <= 1000.0:
        raise UsageError(f"--fps {fps:g}: must be above 0 and at most 1000, e.g. --fps 30")
    from ..run.folder import movie_file
    from ..scene.parse import load_render

    stored = adopt(folder, quiet=quiet)
    record = stored if scene is None else replace(stored, render=load_render(scene, [solid.name for solid in stored.solids]))
    record = look.of(record)
    if when is not None:
        path = output.place(folder / "picture.png")
        _draw_moment(folder, when, path, record.render, look.size)
        if not quiet:
            print(f"picture  {path}")
        return
    if scene is not None:
        _warn_of_slow_motion(record.render, stored.control.frames)
    path = output.place(movie_file(folder, record))
    draw_movie(folder, record, path, quiet=quiet, size=look.size, fps=fps, frames=folder / "frames" if frames else None)
    if not quiet:
        print(f"movie    {path}" + (f"   pictures in {folder / 'frames'}" if frames else ""))


def _draw_moment(folder: Path, when: float, path: Path, look: Render, size: tuple[int, int] | None) -> None:
    """Draw the frame nearest to a time [s]. Raises UsageError for one behind the last frame."""
    from ..picture.movie import render_still
    from ..results.trajectory import Trajectory
    from ..scene.formatting import number

    with Trajectory(folder) as trajectory:
        last = float(trajectory.times[-1])
        if when > last * (1.0 + 1e-9):
            raise UsageError(f"--at {number(when)} s: the last frame is at {number(last, 4)} s")
        render_still(trajectory, int(abs(trajectory.times - when).argmin()), path, look, size=size)


def _warn_of_slow_motion(render: Render, frames: float) -> None:
    """Say so where a run has too few frames per second for the speed of another render block."""
    from ..scene.formatting import number
    from ..scene.render import SMOOTH_RATE, few_pictures

    if cause := few_pictures(frames, render.speed):
        smooth = f"{number(SMOOTH_RATE / render.speed)} fps"
        way_out = (
            f"for smooth motion write speed {number(render.speed)} in the scene, no frames or frames {smooth}, and run it again"
        )
        print(Problem(render.spans.get("speed"), cause, way_out, "warning"), file=sys.stderr)


def view(
    folder: RunFolder,
    /,
    *,
    port: Annotated[int, Parameter(converter=whole_number)] = 0,
    open_: Annotated[bool, Parameter(name="--open", negative="--no-open")] = True,
    edit: bool = False,
) -> None:
    """Look at a run in a browser: one that goes on, with its controls, or one that has ended. Ctrl-C ends it.

    Parameters
    ----------
    port
        Port of this machine on which the page is served; a free one unless it is given.
    open
        Open a browser where there is a display.
    edit
        Let the page change the scene's text and run it again.
    """
    from ..view.__main__ import serve

    if not 0 <= port <= 65535:
        raise UsageError(f"--port {port}: must be between 0 (any that is free) and 65535")
    with suppress(KeyboardInterrupt):
        serve(folder, port=port, edit=edit, on_address=lambda address: show_address(address, browser=open_))


def report(folder: Path, /, *, output: OutFile = OutFile(), exact: bool = False, quiet: Quiet = False) -> None:
    """Write a run as one HTML file: replay, energies, cost, certificate, effects, scene. It opens from disk, without a network:
    report.html in the folder.

    Parameters
    ----------
    folder
        The output folder of a run that has ended.
    exact
        Positions in 16 bits instead of 12.
    """
    from ..view.export import write_report

    path = output.place(folder / "report.html")
    adopt(folder, quiet=quiet)
    with progress_bar("report", quiet=quiet) as bar:
        every = write_report(folder, path, exact=exact, on_progress=lambda done, total: bar(done, total, ""))
    if not quiet:
        print(f"report   {path}   {path.stat().st_size / 1e6:.1f} MB" + (f"   one of {every} frames" if every > 1 else ""))


def lesson(folder: Path, /, *, output: OutFile = OutFile(), quiet: Quiet = False) -> None:
    """Write a run as a lesson, one HTML file with the question of its scene, the movie if there is one, its records as curves,
    the answer, what was expected and found, and the scene: lesson.html in the folder.

    Parameters
    ----------
    folder
        The output folder of a run that has ended; a scene is run with `--lesson`.
    """
    from ..api.run import Run
    from ..run.folder import movie_file
    from ..view.lesson import write_lesson

    if not folder.is_dir():
        raise UsageError(f"{folder} is not the folder of a run; a scene is run with mdanim-lammps {folder} --lesson")
    path = output.place(folder / "lesson.html")
    run = Run(folder)
    scene = run.scene.record
    write_lesson(run, scene, path)
    if not quiet:
        more = "" if movie_file(folder, scene).is_file() else "   without a movie; mdanim-lammps render draws one"
        print(f"lesson   {path}   {path.stat().st_size / 1e6:.1f} MB{more}")


def export(
    folder: Path,
    /,
    *,
    to: Annotated[str, Parameter(help=" | ".join(FORMATS))],
    output: OutFile = OutFile(),
    objects: str = "",
    every: Annotated[int, Parameter(converter=whole_number)] = 1,
    frames: str = ":",
    quiet: Quiet = False,
) -> None:
    """Write a run as a file of another program: Blender, ParaView, OVITO, VMD, a spreadsheet.

    Parameters
    ----------
    folder
        The output folder of a run, also of one that was stopped.
    objects
        Only these, e.g. "cube, ball[2]"; without liquid.
    every
        Only every N-th frame.
    frames
        Only these, e.g. 30:90; what is left out is the start or the end.
    """
    from ..export.write import export as export_run

    chosen = frame_range(frames)
    adopt(folder, quiet=quiet)
    names = [name.strip() for name in objects.split(",") if name.strip()]
    with progress_bar("export", quiet=quiet) as bar:
        done = export_run(
            folder,
            to,
            output.out,
            objects=names,
            every=every,
            frames=chosen,
            force=output.force,
            on_progress=lambda n, total: bar(n, total, f"frame {n} of {total}"),
        )
    if quiet:
        return
    sizes = sum(p.stat().st_size for file in done.files for p in (file.iterdir() if file.is_dir() else [file]))
    print(f"export   {'  '.join(map(str, done.files))}   {done.frames} frames, {sizes / 1e6:.3g} MB")
    for note in done.notes:
        print(f"         {note}")


def timeline(folder: Path, /, *, output: OutFile = OutFile()) -> None:
    """Write what each executor did, and which objects it owned, in a run with -n, for https://ui.perfetto.dev: trace.json.

    Parameters
    ----------
    folder
        The output folder of a run with -n.
    """
    from ..results.timeline import TIMELINE, Timeline
    from ..results.trace import write_trace
    from ..run.folder import stored_scene

    scene = stored_scene(folder)
    if not (folder / TIMELINE).exists():
        raise RefusedError(
            f"{folder} was simulated by one process, so there is no {TIMELINE}; "
            "executors are asked for with -n: mdanim-lammps SCENE -n 2"
        )
    path = output.place(folder / "trace.json")
    write_trace(Timeline.read(folder), path, scene.title or scene.name)
    print(f"trace    {path}   open it in https://ui.perfetto.dev")


def compare(
    a: Path,
    b: Path,
    /,
    *,
    movie: bool = False,
    scene: Path | None = None,
    look: Look = Look(),
    output: OutFile = OutFile(),
    quiet: Quiet = False,
) -> None:
    """Find where two runs differ: first frame and object, in metres. Ends with 6 when they differ. Or show both side by side.

    Parameters
    ----------
    a
        An output folder.
    b
        Another.
    movie
        Draw both beside each other instead, with one camera and one clock, as compare.mp4 in the current folder; as the first
        scene says.
    scene
        Take the render block of this file for the movie; it need hold nothing else.
    """
    if movie:
        _side_by_side(a, b, scene, look, output, quiet)
        return
    if scene or look != Look() or output != OutFile():
        raise UsageError("compare: --scene, --size, --quality, --out and --force are those of the movie; write --movie")
    from ..results.compare import compare as compare_runs

    difference = compare_runs(a, b)
    print(difference)
    if not difference.equal:
        raise SystemExit(ExitCode.DIVERGED)


def _side_by_side(a: Path, b: Path, scene: Path | None, look: Look, output: OutFile, quiet: bool) -> None:
    from ..picture.side import render_side_by_side
    from ..scene.parse import load_render

    look.check()
    stored, _ = (adopt(folder, quiet=quiet) for folder in (a, b))
    record = stored if scene is None else replace(stored, render=load_render(scene, [solid.name for solid in stored.solids]))
    path = output.place(Path("compare.mp4"))
    draw_movie(a, look.of(record), path, quiet=quiet, draw=partial(render_side_by_side, a, b), size=look.size)
    if not quiet:
        print(f"movie    {path}")


COMMANDS = (resume, render, view, report, lesson, export, timeline, compare)
"""Commands of the command line, in the order of its help."""
