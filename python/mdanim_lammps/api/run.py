# SPDX-License-Identifier: GPL-2.0-only
"""A run by its folder: how far it is, what it has left, and what can be made of it."""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING
from weakref import ref

from ..engine.threads import asked_choice
from ..errors import MdanimError, OutputError, Problem, RefusedError
from ..parallel.frames import run_frames
from ..records import dataclass
from ..report import progress_line, threads_line
from ..results.checkpoint import Checkpoint
from ..results.cost import Cost
from ..results.expect import Outcome
from ..results.files import CHECKPOINT, RECORDS, SUMMARY, claimed, in_use, read_json
from ..results.html import THUMBNAIL, CellPage, html_table
from ..results.ledger import Ledger
from ..results.overwriting import output_file
from ..results.progress import ENDED, ProgressTail
from ..results.records import Records
from ..results.stored import SUMMARY as SUMMARY_FILE
from ..results.stored import read_manifest
from ..results.timeline import Timeline
from ..results.trajectory import Trajectory
from ..run.adopt import adopt_dump
from ..run.folder import check_run, movie_file, stored_scene
from ..run.loop import Progress
from ..run.prepare import Prepared, prepare
from ..run.result import Result
from ..scene.formatting import number
from ..scene.render import Quality
from ..scene.scene import SceneRecord
from ..terminal import in_notebook, progress_bar

if TYPE_CHECKING:
    from ..export.write import Exported
    from .scene import Scene

STAY_OPEN = 32
"""Trajectories of runs that stay open: a process has some 1000 files."""
_recent: deque[Trajectory] = deque(maxlen=STAY_OPEN)


@dataclass(frozen=True, slots=True)
class RunStatus:
    """How far a run is."""

    state: str
    """``built`` (not begun), ``preparing``, ``running``, ``paused``, ``stopped``, ``failed``, ``killed`` or ``done``."""
    frames: int
    """Frames in the trajectory."""
    total: int
    """Frames of the whole run; 0 while that is not known."""
    message: str = ""
    """Why it was stopped, or has failed."""

    def __str__(self) -> str:
        return f"{self.state}, {self.frames} of {self.total} frames" if self.total else self.state


class Run:
    """A run by its folder: one that goes on, was stopped, has failed or is complete. `Scene.run` and `Scene.sweep` return it.

    What is read from the folder is read when it is asked for.

    Args:
        folder: the output folder.
        values: of the scene's ``let`` names that were given for this run.

    Raises OutputError for a folder that has no run in it.
    """

    def __init__(self, folder: str | Path, values: Mapping[str, float | str] | None = None):
        self.folder, self.values = Path(folder), dict(values or {})
        check_run(self.folder)
        self._result: Result | None = None
        self._opened: ref[Trajectory] | None = None

    # --- what it has left -------------------------------------------------------------------------------------------

    @cached_property
    def scene(self) -> Scene:
        """The scene as the folder keeps it, with everything expanded. Raises SceneError, OutputError."""
        from .scene import Scene

        return Scene(stored_scene(self.folder))

    @property
    def status(self) -> RunStatus:
        """How far the run is now. Raises OutputError."""
        tail = ProgressTail(self.folder)
        try:
            tail.read()
        except OSError as error:
            raise OutputError(f"{tail.path} cannot be read: {error.strerror or error}") from error
        finally:
            tail.close()
        state = tail.state
        if not tail.lives:
            begun = "preparing" if in_use(self.folder) else "killed"
            only_built = read_manifest(self.folder).get("draws") is None
            state = "done" if (self.folder / SUMMARY).exists() else "built" if only_built else begun
        elif state not in ENDED and not in_use(self.folder):
            state = "killed"
        return RunStatus(state, tail.count, tail.total, tail.message)

    @property
    def ledger(self) -> Ledger:
        """Energies of each frame. Raises OutputError."""
        return self._result.ledger if self._result else Ledger.read(self.folder / "ledger.csv")

    @property
    def records(self) -> Records:
        """The quantities of the scene's ``record`` lines, at every frame; of a run that was stopped, up to then.

        Raises OutputError as long as the run goes on, where it was killed, and where the scene records nothing.
        """
        path = self.folder / RECORDS
        if not path.exists():
            missing = "the run is not complete" if not (self.folder / SUMMARY).exists() else "the scene has no record line"
            raise OutputError(f"{self.folder} has no {RECORDS}: {missing}; write e.g. record ball.speed in the scene, and run it")
        return Records.read(path)

    @property
    def outcomes(self) -> list[Outcome]:
        """Results of the ``expect`` lines; empty as long as the run is not complete. Raises OutputError, SceneError."""
        if self._result:
            return self._result.outcomes
        if not (self.folder / SUMMARY).exists():
            return []
        expects, rows = self.scene.record.expects, read_json(self.folder / SUMMARY, SUMMARY_FILE).get("expect", ())
        if len(expects) != len(rows):
            raise OutputError(f"{self.folder / SUMMARY} has {len(rows)} expectations, the scene {len(expects)}: one is damaged")
        return [Outcome(e, float("nan") if r["found"] is None else r["found"]) for e, r in zip(expects, rows)]

    @property
    def missed(self) -> list[Outcome]:
        """Outcomes that were not met."""
        return [o for o in self.outcomes if not o.met]

    @property
    def cost(self) -> Cost | None:
        """Seconds per effect and per other piece of work; None as long as the run has not ended. Raises OutputError."""
        path = self.folder / "cost.json"
        return self._result.cost if self._result else Cost.read(path) if path.exists() else None

    @property
    def warnings(self) -> list[Problem]:
        """Problems seen in the run that do not stop it; known only in the program that has run it."""
        return self._result.warnings if self._result else []

    @property
    def timeline(self) -> Timeline | None:
        """Activities of executors over time; None for a run in one process. Raises OutputError."""
        return Timeline.left_in(self.folder)

    @property
    def trajectory(self) -> Trajectory:
        """The frames; opened when they are first asked for, and closed with nothing left that refers to them. The last few that
        were opened stay open. Raises OutputError."""
        found = self._opened() if self._opened else None
        if found is None:
            found = Trajectory(self.folder)
            self._opened = ref(found)
            _recent.append(found)
        return found

    # --- what can be done with it -----------------------------------------------------------------------------------

    def resume(
        self,
        *,
        executors: int = 1,
        threads: int | None = None,
        control: str | None = None,
        movie: bool | None = None,
        allow_unstable: bool = False,
        trust: bool = False,
        progress: bool | None = None,
        on_progress: Callable[[Progress], None] | None = None,
    ) -> Run:
        """Go on from the last checkpoint, as if the run had never stopped; returns this run.

        ``movie`` draws a movie at the end, None where the run was to make one. ``trust`` lets the commands for LAMMPS that the
        scene has be run again: what they have made begins anew. Other arguments are those of `Scene.run`.
        Raises RefusedError for a run that is complete, OutputError where there is no checkpoint, and what `Scene.run` raises.
        """
        make = partial(prepare, allow_unstable=allow_unstable)
        with resumed(self.folder, make, trust) as (ready, checkpoint, draws):
            return self.go(
                ready,
                movie=draws if movie is None else movie,
                progress=progress,
                on_progress=on_progress,
                executors=executors,
                threads=threads,
                control=control,
                resume=checkpoint,
            )

    def go(
        self, ready: Prepared, *, movie: bool, progress: bool | None, on_progress: Callable[[Progress], None] | None, **options
    ) -> Run:
        """Simulate into the folder, which this process has claimed; see `Scene.run` and `run_frames`."""
        self._result = self._opened = None
        choice = asked_choice(ready.plan, options["threads"])
        if choice and choice.standard and choice.threads > 1:
            warnings.warn(threads_line(choice), stacklevel=3)
        with progress_bar("run", quiet=quiet_unless(progress)) as bar:

            def tell(now: Progress) -> None:
                bar(now.frame, now.frames, progress_line(now))
                if on_progress:
                    on_progress(now)

            self._result = run_frames(ready, self.folder, on_progress=tell, **options)
        if movie:
            self.render(progress=False, force=True)
        return self

    def render(
        self,
        path: str | Path | None = None,
        *,
        size: tuple[int, int] | None = None,
        fps: float | None = None,
        quality: str | None = None,
        force: bool = False,
        progress: bool | None = None,
    ) -> Path:
        """Draw the movie.

        Args:
            path: its file, ``.mp4``, or a folder for it; None is the one that the scene names in the output folder.
            size: width and height in pixels; None is that of the scene.
            fps: pictures per second; None is that of the scene.
            quality: ``draft`` or ``final``; None is that of the scene.
            force: overwrite a file that this program has not made.
            progress: shows a bar, by default in a notebook only.

        Raises SetupError, OutputError, UsageError.
        """
        from ..picture.movie import render_movie

        self.adopt()
        record = self.scene.record
        render = record.render if quality is None else replace(record.render, quality=Quality(quality))
        file = output_file(movie_file(self.folder, record), path, force=force)
        with progress_bar("movie", quiet=quiet_unless(progress)) as bar:
            return render_movie(
                self.folder, render, file, size=size, fps=fps, on_progress=lambda done, all: bar(done, all, f"{done} of {all}")
            )

    def show(self, *, height: int = 540) -> CellPage:
        """The page of the run for a cell of a notebook, of this height [pixels]: the film to turn, with energies and cost, as
        `mdanim-lammps report` writes it. It is in the cell as a whole, and needs no server and no network.

        Raises OutputError for a run without frames, and RefusedError for one that goes on.
        """
        from ..view.export import write_report

        with TemporaryDirectory(prefix="mdanim-page-") as name:
            page = Path(name) / "report.html"
            write_report(self.folder, page)
            return CellPage(page.read_text(encoding="utf-8"), height)

    def export(self, to: str, path: str | Path | None = None, **options) -> Exported:
        """Write the run as a file of another program; arguments and errors are those of `mdanim_lammps.export.write.export`."""
        from ..export.write import export

        self.adopt()
        return export(self.folder, to, path, **options)

    def adopt(self) -> str:
        """Make a trajectory of the dump that plain ``lmp`` has left in the folder, if there is one and no trajectory; returns a
        line that says so, or an empty text. Raises OutputError, SceneError, RefusedError."""
        return adopt_dump(self.folder, self.scene.record)

    def __getstate__(self) -> dict:
        return {name: value for name, value in self.__dict__.items() if name != "scene"} | {"_opened": None}

    def __repr__(self) -> str:
        values = "".join(f"{name}={value}, " for name, value in self.values.items())
        if not self._result:
            return f"<Run {self.folder}: {values}{self.status}>"
        missed = f", {len(self.missed)} of {len(self.outcomes)} expectations missed" if self.missed else ""
        residual = number(self.ledger.residual, 3)
        return f"<Run {self.folder}: {values}{len(self.ledger.rows)} frames, energy residual {residual}{missed}>"

    def _repr_html_(self) -> str:
        from ..picture.movie import render_still

        rows = [
            (
                o.expect.what,
                f"{'' if o.expect.relation == '=' else o.expect.relation + ' '}{number(o.expect.value, 4)}",
                number(o.found, 4),
                "met" if o.met else "MISSED",
            )
            for o in self.outcomes
        ]
        picture = None
        with TemporaryDirectory(prefix="mdanim-picture-") as name, suppress(MdanimError):
            render = self.scene.record.render
            picture = render_still(self.trajectory, -1, Path(name) / "end.png", render, size=THUMBNAIL).read_bytes()
        return html_table(repr(self)[1:-1], ("expected", "value", "found", ""), rows, picture)


def quiet_unless(progress: bool | None) -> bool:
    """Whether no bar is shown: None shows one in a notebook only."""
    return not (in_notebook() if progress is None else progress)


@contextmanager
def resumed(
    folder: Path, make: Callable[[SceneRecord], Prepared], trust: bool = False
) -> Iterator[tuple[Prepared, Checkpoint, bool]]:
    """Claim the folder of a run that was stopped; gives its scene as `make` prepares it, where it goes on, and whether it was to
    end with a movie. ``trust`` lets its commands for LAMMPS be run. Raises RefusedError for a run that is complete, OutputError,
    SceneError, and what ``make`` raises."""
    scene = replace(stored_scene(folder), trusted=trust)
    with claimed(folder):
        if (folder / SUMMARY).exists():
            raise RefusedError(f"{folder} is complete; draw it again with 'mdanim-lammps render {folder}'")
        checkpoint = Checkpoint.read(folder / CHECKPOINT)
        yield make(scene), checkpoint, read_manifest(folder).get("draws") is not False
