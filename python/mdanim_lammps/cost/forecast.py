# SPDX-License-Identifier: GPL-2.0-only
"""Forecast of the cost of a run: its first steps are run, and all others are assumed to cost as much."""

from __future__ import annotations

import signal
import tempfile
import time
from dataclasses import replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

from ..effects.readings import LEAPFROG
from ..errors import DivergedError, MdanimError, SetupError
from ..results.cost import Cost
from ..results.files import STOP
from ..run.prepare import Prepared
from .later import later
from .movie_forecast import movie_seconds

REST = "rest of the step"
ENOUGH = 0.4
"""Seconds of the processor after which no more frames are run."""
FRAMES = 3, 30
"""Fewest and most frames that are run."""
PARTICLE_STEPS, STEPS = 500_000, 10
"""Most work of a frame, and its fewest steps: the energies of a frame take as long as one more."""
WORTH = 0.3
"""Seconds of a run from which on its later steps are looked at too."""
PATIENCE = 30.0
"""Seconds after which a forecast is given up."""


def forecast(ready: Prepared, *, setup: float = 0.0, movie: bool = True) -> Cost | DivergedError | None:
    """The expected cost of a run, with that of its movie or without; ``setup`` is what loading and modelling have taken already
    [s].

    The steps are run in a process of their own, so that the caller's neither loads LAMMPS nor ends with it. The error where they
    are stopped, as the run will be; None where they take longer than PATIENCE. Raises SetupError when LAMMPS or the plugin
    cannot be used, OutputError when the folder for temporary files is full.
    """
    context = get_context("fork")
    answer, send = context.Pipe(duplex=False)
    with tempfile.TemporaryDirectory(prefix="mdanim-") as folder:
        child = context.Process(target=_tell, args=(send, ready, Path(folder), setup), daemon=True)
        child.start()
        send.close()
        try:
            found = answer.recv() if answer.poll(PATIENCE) else None
            if isinstance(found, Cost) and movie:
                found = _with_movie(found, answer)
        except EOFError:
            raise SetupError("the first steps cannot be run: LAMMPS ended the process") from None
        finally:
            child.kill()
            child.join()
    if isinstance(found, MdanimError) and not isinstance(found, DivergedError):
        raise found
    return found


def _with_movie(cost: Cost, answer: Connection) -> Cost | MdanimError:
    """The cost with that of the movie, which is not known where drawing takes longer than PATIENCE or has ended the process."""
    try:
        movie = answer.recv() if answer.poll(PATIENCE) else None
    except EOFError:
        movie = None
    return movie if isinstance(movie, MdanimError) else replace(cost, movie=movie)


def _tell(send: Connection, ready: Prepared, folder: Path, setup: float) -> None:
    """Send the cost, then that of the movie, or the error through a pipe."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the caller's, which ends this process
    try:
        send.send(whole(ready, folder, setup=setup))
        send.send(movie_seconds(ready, folder))
    except MdanimError as error:
        send.send(error)


def whole(ready: Prepared, folder: Path, *, setup: float = 0.0) -> Cost:
    """The expected cost of a run, that at surfaces by a coarse run of all steps; arguments and errors as of `extrapolate`."""
    cost = extrapolate(ready, folder, setup=setup)
    if cost.total - cost.other["setup"] < WORTH:
        return cost
    (aside := folder / "coarse").mkdir()
    found = later(ready, aside)
    effects = {name: replace(part, seconds=found.get(name, part.seconds)) for name, part in cost.effects.items()}
    more = sum(part.seconds for part in effects.values()) - sum(part.seconds for part in cost.effects.values())
    return replace(cost, wall=cost.wall + more, effects=effects)


def extrapolate(ready: Prepared, folder: Path, *, setup: float = 0.0) -> Cost:
    """Run the first steps in this process and in an empty folder; arguments and errors as of `forecast`. Raises DivergedError
    too."""
    from ..run.loop import Interrupted, Progress, simulate

    c, particles = ready.certificate, ready.system.particles
    steps = min(max(PARTICLE_STEPS // max(1, particles), STEPS), c.steps_per_frame)
    frames = min(max(c.steps // steps, FRAMES[0]), FRAMES[1])
    marks: list[tuple[float, float, float]] = []

    def mark(progress: Progress) -> None:
        marks.append((time.perf_counter(), time.thread_time(), progress.seconds))
        if len(marks) >= FRAMES[0] and marks[-1][1] - marks[0][1] > ENOUGH:
            (folder / STOP).touch()

    began = time.thread_time()
    short = replace(ready, certificate=replace(c, steps_per_frame=steps, frames=frames, last_steps=0))
    try:
        cost = simulate(short, folder, on_progress=mark).cost
    except Interrupted as stopped:
        if len(marks) < FRAMES[0]:
            raise  # by a signal
        cost = stopped.cost
    assert cost is not None, "a run that has ended or stopped has a cost"
    whole_own = time.thread_time() - began
    # Work that a run does once, before its first frame and after its last one, is not in these differences.
    wall, own, simulated = (last - first for first, last in zip(marks[0], marks[-1]))
    # Processor time of other programs is not part of a run. Time is that of this thread: others share its work.
    share = own / wall
    counted = sum(part.seconds for part in cost.effects.values()) + cost.other[LEAPFROG] + cost.other[REST]
    of_step = share * simulated / ((len(marks) - 1) * steps) * c.steps / counted
    once = whole_own - own - own / (len(marks) - 1) - share * cost.other["setup"]
    effects = {name: replace(part, seconds=of_step * part.seconds, clocks={}) for name, part in cost.effects.items()}
    other = {
        **{name: of_step * cost.other[name] for name in (LEAPFROG, REST)},
        "setup": setup + share * cost.other["setup"],
        "output": share * (wall - simulated) / (len(marks) - 1) * (1 + c.last_frame) + max(0.0, once),
    }
    return Cost(sum(part.seconds for part in effects.values()) + sum(other.values()), c.steps, particles, effects, other)
