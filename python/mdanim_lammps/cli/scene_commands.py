# SPDX-License-Identifier: GPL-2.0-only
"""Commands about a scene: run, check and draw it, write it for LAMMPS, study what its accuracy costs."""

from __future__ import annotations

import shlex
import sys
import time
from dataclasses import replace
from json import dumps
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from ..errors import ExitCode, Problem, RefusedError, SceneError, UsageError, problem_json
from ..scene.formatting import number, say
from ..scene.lammps_lines import check_alone
from ..terminal import progress_bar
from ..view.beside import Viewer
from . import run_commands
from .options import (
    AllowUnstable,
    Executing,
    Executors,
    HandsOn,
    Look,
    OutFile,
    OutFolder,
    Quiet,
    Reading,
    SceneFile,
    Verbose,
    View,
)
from .steps import (
    STARTED,
    announce,
    check_hands,
    lmp_command,
    percent_of,
    prepare,
    print_lines,
    print_warnings,
    seconds_of,
    simulate_and_draw,
)


def run(
    scene: SceneFile,
    /,
    *,
    reading: Reading = Reading(),
    executing: Executing = Executing(),
    output: OutFolder = OutFolder(),
    movie: Annotated[bool, Parameter(negative="--no-movie")] = True,
    lesson: bool = False,
    view: View = False,
    edit: bool = False,
    hands: HandsOn = False,
    allow_unstable: AllowUnstable = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Check, build and run a scene; leave a movie, a trajectory and a summary.

    Parameters
    ----------
    movie
        Make movie.mp4 at the end.
    lesson
        Write lesson.html, too: a page with the question of the scene, the movie, curves of the records, and the answer.
    edit
        Let the page change the scene's text and run it again; implies --view.
    """
    from ..cost.speedup_forecast import forecast_speedup
    from ..report import speedup_lines
    from ..run.folder import check_room, open_run, output_folder

    executing.check()
    record = reading.load(scene)
    if lesson:
        from ..view.lesson import check_asks

        check_asks(record)
    if hands:
        check_hands(executing, edit)
        record = replace(record, steerable=True)
    check_alone(record, executing.executors, executing.control)
    out = output_folder(record, output.out)
    check_room(out, force=output.force)
    ready = prepare(record, allow_unstable=allow_unstable)
    announce(ready, quiet, verbose, executing)
    if executing.executors > 1 and not quiet:
        print("\n".join(speedup_lines(forecast_speedup(ready, executing.executors))), flush=True)
    try:
        with (
            Viewer(view, scene if edit else None, hands=hands) as viewer,
            open_run(ready, out, force=output.force, draws=movie) as folder,
        ):
            viewer.start(folder)
            simulate_and_draw(ready, folder, executing, quiet=quiet, movie=movie, hands=hands)
    except SystemExit as end:
        if lesson and end.code == ExitCode.DIVERGED:  # an expectation was missed: its page tells it
            run_commands.lesson(out, quiet=quiet)
        raise
    if lesson:
        run_commands.lesson(out, quiet=quiet)


def check(
    scene: SceneFile,
    /,
    *,
    reading: Reading = Reading(),
    executors: Executors = 1,
    strict: bool = False,
    allow_unstable: AllowUnstable = False,
    json: bool = False,
    format: Annotated[Literal["text", "json"] | None, Parameter(show=False)] = None,
) -> None:
    """List the effects of a scene with reasons and certify its time step; of the run only some first steps, which tell its cost.

    Parameters
    ----------
    strict
        Bare numbers need a unit.
    json
        For programs; also of problems.
    """
    if format:
        way_out = "write --json" if format == "json" else "leave it out"
        print(f"note: --format {format} is an old spelling; {way_out}", file=sys.stderr)
    told = json or format == "json"
    try:
        _check(scene, reading, executors, strict, allow_unstable, told)
    except (SceneError, RefusedError) as error:
        if not told:
            raise
        problems = error.problems if isinstance(error, SceneError) else [Problem(None, str(error))]
        print(dumps({"problems": [problem_json(p) for p in problems]}, indent=1))
        raise SystemExit(error.exit_code) from None


def _check(scene: Path, reading: Reading, executors: int, strict: bool, allow_unstable: bool, as_json: bool) -> None:
    from ..cost.forecast import forecast
    from ..cost.saving import before_run
    from ..cost.speedup_forecast import forecast_speedup
    from ..engine.threads import choose_threads
    from ..processes import cores
    from ..report import check_json, check_lines

    Executing(executors=executors).check()
    record = reading.load(scene, strict=strict)
    check_alone(record, executors, None)
    ready = prepare(record, allow_unstable=allow_unstable)
    setup = time.perf_counter() - STARTED
    cost = forecast(ready, setup=setup)
    threads = choose_threads(ready.plan, max(1, cores() // executors))
    spread = forecast_speedup(ready, executors) if executors > 1 else None
    savings = before_run(ready, cost)
    if as_json:
        print(dumps(check_json(ready, cost, threads, spread, savings), indent=1))
        return
    print_warnings(ready)
    print("\n".join(check_lines(ready, cost, threads, spread, savings)))


def picture(
    scene: SceneFile,
    /,
    *,
    reading: Reading = Reading(),
    at: str | None = None,
    output: OutFile = OutFile(),
    look: Look = Look(),
    names: bool = False,
    springs: bool = False,
    boxes: bool = False,
    quiet: Quiet = False,
) -> None:
    """Draw a scene before it is run, with the scene's camera: SCENE.png beside the scene.

    Parameters
    ----------
    at
        The moment that is drawn, e.g. "0.8 s": a quick, coarse preview run goes there first.
    names
        Write each object's name above it.
    springs
        Draw the springs of the particle models instead of the surfaces.
    boxes
        Draw the bounding box of each object.
    """
    from ..api.scene import draw_picture
    from ..picture.marks import Marks
    from ..report import progress_line

    look.check()
    time = 0.0 if at is None else seconds_of("--at", at)
    record = reading.load(scene)
    path = output.place(scene.with_suffix(".png"))
    with progress_bar("preview", quiet=quiet or not time) as bar:
        draw_picture(
            look.of(record),
            path,
            at=time,
            size=look.size,
            marks=Marks(names, springs, boxes),
            on_progress=lambda p: bar(p.frame, p.frames, progress_line(p)),
        )
    if not quiet:
        print(f"picture  {path}")


def build(
    scene: SceneFile,
    /,
    *,
    reading: Reading = Reading(),
    output: OutFolder = OutFolder(),
    allow_unstable: AllowUnstable = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Write data.NAME and in.NAME only; 'lmp -in in.NAME' then runs without Python."""
    from ..run.folder import check_room, open_run, output_folder

    record = reading.load(scene)
    out = output_folder(record, output.out)
    check_room(out, force=output.force)
    ready = prepare(record, allow_unstable=allow_unstable)
    announce(ready, quiet, verbose)
    with open_run(ready, out, force=output.force, draws=None) as folder:
        pass  # all of it is known before the run
    if not quiet:
        print(f"built    cd {shlex.quote(str(folder))} && {lmp_command()} -in {shlex.quote(f'in.{ready.plan.name}')}")


def study(
    scene: SceneFile,
    /,
    *,
    reading: Reading = Reading(),
    budget: str = "2 min",
    output: OutFolder = OutFolder(),
    ladders: str = "",
    target: str | None = None,
    quiet: Quiet = False,
) -> None:
    """Measure what accuracy costs in time: ladders of settings around the scene's own, with a table, a plot and advice.

    With --target the cheapest setting that has this error, and what to write into the scene for it.
    Points that were measured before are not measured again: the same command continues where it was stopped.

    Parameters
    ----------
    budget
        Wall time, e.g. "30 s"; if left out, 2 min.
    ladders
        Only these, e.g. "time step, resolution"; known are time step, resolution, sweeps, contact, rigid.
    target
        An error, e.g. "2 %".
    """
    from ..run.folder import STUDY, output_folder
    from ..study.report import order_lines, table
    from ..study.study import run_study

    seconds = seconds_of("--budget", budget)
    if target is not None:
        if ladders or reading.accuracy:
            raise UsageError("--target chooses the setting itself: leave out --ladders and --accuracy")
        _aim(reading.load(scene), percent_of("--target", target), output, seconds, quiet)
        return
    record = reading.load(scene)
    only = [name.strip() for name in ladders.split(",") if name.strip()]
    done = run_study(
        record,
        output_folder(record, output.out) / STUDY,
        budget=seconds,
        only=only,
        force=output.force,
        on_progress=print_lines("study", quiet),
    )
    if quiet:
        return
    from rich.console import Console

    Console(width=None if sys.stdout.isatty() else 140).print(table(done))
    for line in order_lines(done):
        print(line)
    print(f"advice   {done.advice}")
    print(f"output   {done.folder}/study.json, study.csv, study.png")


def _aim(record, error: float, output: OutFolder, budget: float, quiet: bool) -> None:
    """Print the cheapest setting with an error, and what to write for it; with ``quiet`` only that."""
    from ..api import Scene

    found = Scene(record).setting_for(
        error, output.out, budget=budget, force=output.force, on_progress=print_lines("study", quiet)
    )
    if not quiet:
        print(f"target   {number(100 * error)} %: {found}, {say(found.seconds, 's', 2)}")
    print(f"{'' if quiet else 'write    '}{found.words}")
    if not found.met:
        hint = "give it more time with --budget, or ask for less"
        text = f"an error of {number(100 * error)} % is not reached in the time given; this is the best that was found"
        print(Problem(None, text, hint, severity="warning"), file=sys.stderr)


COMMANDS = (run, check, picture, build, study)
"""Commands of the command line, in the order of its help."""
