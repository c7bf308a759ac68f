# SPDX-License-Identifier: GPL-2.0-only
"""The lines that the command line prints: a scene, its effects, its certificate, its cost."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict
from pathlib import Path

from . import features
from .certificate import margin_lines, note_lines
from .cost.saving import Saving
from .cost.speedup_forecast import SpeedupForecast
from .effects import Verdict
from .effects.kept import records_of
from .engine.threads import ThreadChoice
from .errors import DivergedError, problem_json
from .model import work
from .model.spacing import plan_spacing
from .results.cost import Cost
from .results.timeline import Timeline
from .results.trajectory_file import trajectory_bytes
from .results.trajectory_metadata import kept_fields
from .run.energy import frame_fields
from .run.loop import Progress
from .run.prepare import Prepared
from .run.result import Result
from .scene.formatting import exact, number, say, whole
from .scene.scene import Accuracy, SceneRecord


def count(things: int, noun: str) -> str:
    """``1 object``, ``2 197 particles``."""
    return f"{whole(things)} {noun}" + ("" if things == 1 else "s")


WIDTH = 110
"""Columns that lists are broken at."""
MARGIN = " " * len("scene    ")
LONG = 60.0
"""Seconds from which `check` tells how a run gets quicker."""


def scene_lines(ready: Prepared) -> list[str]:
    """Lines on the contents of the scene; below them the effects that are on, and those that are off, with reasons."""
    on = [v.name for v in ready.verdicts.values() if v.on]
    reasons: dict[str, list[str]] = {}
    for v in ready.verdicts.values():
        if not v.on:
            reasons.setdefault(v.reason, []).append(v.name)
    off = [f"{', '.join(names)} ({reason})" for reason, names in reasons.items()]
    file = ready.scene.path.name if ready.scene.path else ready.scene.name
    title = f"'{ready.scene.title}'  " if ready.scene.title else ""
    return [
        f"scene    {file}  {title}{count(len(ready.system.names), 'object')} ({count(ready.system.particles, 'particle')})"
        f"{''.join(line for line, _ in _counted(ready))}",
        *_listed("effects: ", on or ["none"]),
        *_listed("off: ", off),
    ]


def _listed(head: str, items: list[str]) -> list[str]:
    """Lines of a list below the first words of a line, none broken within an item; none at all for an empty list."""
    lines: list[str] = []
    for item in items:
        if lines and len(lines[-1]) + len(f" {item},") <= WIDTH:
            lines[-1] += f" {item},"
        else:
            lines.append(MARGIN + (" " * len(head) if lines else head) + f"{item},")
    return [*lines[:-1], lines[-1].removesuffix(",")] if lines else []


LARGE = 1_000_000
"""Particles from which on modelling takes so long that a line before it says so."""
LONG_MODELLING = 4.0
"""Seconds of modelling from which on a line before it says so, however few the particles are."""


def size_line(scene: SceneRecord) -> str | None:
    """One line: how large the models of a scene will be, before they are made; None where that is soon done.
    Raises SceneError."""
    if not scene.solids:
        return None
    plan = plan_spacing(scene)
    if plan.total < LARGE and work.seconds(scene, plan.of, plan.particles) < LONG_MODELLING:
        return None
    return (
        f"size     about {number(plan.total / 1e6, 2)} million particles, spacing {say(plan.h, 'm')} set by {plan.set_by}: "
        f"{number(plan.memory * 1e-9, 2)} GB of {number(plan.available * 1e-9, 2)} GB free, "
        f"about {_about(work.seconds(scene, plan.of, plan.particles))} of modelling"
    )


def _counted(ready: Prepared) -> Iterator[tuple[str, dict]]:
    """Counts of effects, on or off: see `effects.Effect.counted`."""
    return (e.of(ready.scene).counted(ready.context) for e in features.effects())


def certificate_line(ready: Prepared) -> str:
    """One line: time step, bound and what sets it."""
    c = ready.certificate
    return f"certify  {c}   {count(c.steps, 'step')}, {c.steps_per_frame} per frame"


def output_line(ready: Prepared) -> str:
    """One line: how large the trajectory will be."""
    c, control = ready.certificate, ready.scene.control
    frames = 1 + c.last_frame
    fields = kept_fields(records_of(ready.scene, ready.plan.grid), frame_fields(ready.plan), ready.models, control.save)
    size = trajectory_bytes(ready.models, frames, control.save, control.single, fields)
    return f"output   {count(frames, 'frame')}, trajectory of {number(size / 1e6)} MB"


def effect_line(verdict: Verdict) -> str:
    """One line of ``check``: an effect, on or off, its reason and scene line."""
    place = f"  [{verdict.span}]" if verdict.span else ""
    return f"  {'on ' if verdict.on else 'off'}  {verdict.name:<11} {verdict.reason}{place}"


def progress_line(p: Progress) -> str:
    """The moving line of a run."""
    if p.paused:
        return f"t={p.time:.2f} s  paused; goes on when {p.paused} is deleted"
    each = p.seconds / max(1, p.step - p.first_step)
    left = each * (p.steps - p.step)
    counted = "" if p.gained is None else f"{p.counted} {exact(p.gained)}  "
    return (
        f"t={p.time:.2f} s  step {p.step}/{p.steps}  energy residual {number(p.residual, 2)}  {counted}"
        f"{1e3 * each:.2f} ms/step  {left:.0f} s left"
    )


def movie_line(done: int, total: int, seconds: float) -> str:
    """The moving line of a movie, ``done`` pictures of which have taken these seconds."""
    return f"frame {done}/{total}  {seconds / done * (total - done):.0f} s left"


def cost_line(result: Result, simulated: float) -> str:
    """One line: where the wall time went; ``simulated`` is how long the film is [s]."""
    total = result.cost.total
    parts = sorted(result.cost.parts.items(), key=lambda item: -item[1])
    shares = "  ".join(f"{name} {100 * s / total:.0f}%" for name, s in parts if s >= 0.005 * total)
    return f"cost     {shares}   total {total:.1f} s, {number(total / simulated, 2)} s of computing per second of film"


def executors_line(executors: int, control: str | None) -> str:
    """One line: how many executors run a scene, and what assigns objects to them; empty for a run in this process."""
    if executors == 1 and control is None:
        return ""
    decision = "each decides alike (--control peers)" if control == "peers" else "the supervisor decides (--control central)"
    return f"spread   over {count(executors, 'executor')} and a supervisor; {decision}"


def speedup_lines(p: SpeedupForecast) -> list[str]:
    """Below `executors_line`: the most that executors can bring at first, why it is not more, and what brings more."""
    when = "in the first second" if p.seconds == 1.0 else f"in the first {number(p.seconds, 2)} s"
    faster = "no faster than one" if p.faster < 1.05 else f"at most {number(p.faster, 2)} times as fast as one"
    if p.faster > 0.9 * p.executors:
        return [f"{MARGIN}{when} of the film {faster}"]
    work = "all" if p.share > 0.995 else f"{100.0 * p.share:.0f} %"
    what = (
        f"one object is {work} of the work"
        if p.largest == 1
        else (f"{p.largest} of {p.objects} objects, {work} of the work, are near each other and run together")
    )
    team = f", on {number(p.team, 2)} executors at once" if p.team > 1.0 else ""
    way_out = "on one host leave out -n: threads share such work on all cores"
    return [f"{MARGIN}{when} of the film {faster}:", f"{MARGIN}{what}{team}", f"{MARGIN}{way_out}"]


def spread_line(timeline: Timeline, folder: Path) -> str:
    """One line: what a run on several executors did, and how to see it."""
    again = sum(timeline.retries)
    return (
        f"spread   {count(timeline.executors, 'executor')}, {timeline.control}: "
        f"{count(sum(timeline.moves), 'object')} moved, {count(again, 'window')} begun again, "
        f"busy {100 * timeline.busy().mean():.0f} %   "
        f"trace: mdanim-lammps timeline {folder}"
    )


def forecast_line(cost: Cost | DivergedError | None) -> str:
    """One line of ``check``: what a run will cost on this machine, and most of it; or where the run will stop, and why."""
    if cost is None:
        return "cost     not known: the first steps of the run take longer than half a minute"
    if isinstance(cost, DivergedError):
        return f"stops    {cost.why}"
    setup = cost.other.get("setup", 0.0)
    parts = sorted(((name, s) for name, s in cost.parts.items() if name != "setup"), key=lambda item: -item[1])
    largest = ", ".join(f"{name} {_about(s)}" for name, s in parts if s >= 0.05 * (cost.total - setup))
    whole = [
        f"modelling {_about(setup)}",
        f"run {_about(cost.total - setup)}" + (f" ({largest})" if largest else ""),
        "movie not known, as this host cannot draw" if cost.movie is None else f"movie {_about(cost.movie)}",
    ]
    return f"cost     about {_about(cost.total + (cost.movie or 0.0))} here: {', '.join(whole)}"


def quicker_line(ready: Prepared, cost: Cost | DivergedError | None) -> str | None:
    """How a run of more than a minute gets quicker: cost goes with the fourth power of the spacing, and with the time step."""
    control = ready.scene.control
    if not isinstance(cost, Cost) or cost.total < LONG:
        return None
    ways, now = [], control.accuracy
    if control.resolution is None and now is not Accuracy.PREVIEW:
        less = (Accuracy.PREVIEW.cells / now.cells) ** 4 * now.fraction / Accuracy.PREVIEW.fraction
        ways.append(f"--accuracy preview about {_about(less * cost.total)}")
    edge = max((max(m.cell) for m in ready.models), default=0.0)
    if edge > 0.0:
        ways.append(f"resolution {say(1.5 * edge, 'm')} about {_about(cost.total / 1.5**4)}")
    return f"quicker  {', '.join(ways)}; thin and stiff objects make small cells and short steps" if ways else None


def saving_lines(savings: Iterable[Saving]) -> list[str]:
    """Lines on words that would save time: the objects that they are for, a line for each group, and how much it is."""
    lines = []
    for s in savings:
        lines.append(f"quicker  with {s.proposal.words} these would look the same ({s.proposal.how}):")
        lines += [f"{MARGIN}{name}: {why}" for name, why in s.proposal.groups]
        lines.append(
            f"{MARGIN}the run then takes about 1/{_rough(s.now / s.then):g} of the time, {_about(s.then)} of {_about(s.now)}; "
            f'blows may bounce otherwise: study --ladders "resolution, {s.proposal.ladder}"'
        )
    return lines


def _about(seconds: float) -> str:
    """A time in few digits."""
    units = (("h", 3600.0), ("min", 60.0), ("s", 1.0), ("ms", 1e-3))
    unit, size = next((u for u in units if seconds >= u[1]), units[-1])
    return f"{_rough(seconds / size):g} {unit}"


def _rough(value: float) -> float:
    """In one digit, two where the first is a 1: no forecast is better than that."""
    return float(f"{value:.{2 if f'{value:e}'.startswith('1') else 1}g}")


def threads_line(choice: ThreadChoice) -> str:
    """How many threads there will be, and why."""
    head = f"threads  {choice.threads}"
    if not choice.asked and choice.cores == 1:
        return f"{head}: there is one core for each process"
    head += ", as asked for" if choice.asked else f" of {choice.cores} cores"
    if choice.standard and not (choice.asked and choice.threads == 1):
        takes = f"with {' and '.join(choice.standard)} on LAMMPS takes its standard steps"
        return f"{head}: {takes}, of which threads share springs, contact and liquid alone"
    if choice.asked:
        return head
    pays = f"a thread pays from {count(choice.pays_from, 'particle')} on"
    of_pass = f"a pass over {count(choice.particles, 'particle')} takes {1e-3 * choice.step:.0f} us"
    return f"{head}: {of_pass}, {pays}"


def check_lines(
    ready: Prepared,
    forecast: Cost | DivergedError | None,
    threads: ThreadChoice,
    speedup: SpeedupForecast | None = None,
    savings: Iterable[Saving] = (),
) -> list[str]:
    """The output of ``check``: scene, certificate, limits, output, cost, threads, gain by executors, and every effect."""
    return [
        *scene_lines(ready),
        certificate_line(ready),
        "limits",
        *margin_lines(ready.certificate),
        *note_lines(ready.certificate),
        output_line(ready),
        forecast_line(forecast),
        *filter(None, [quicker_line(ready, forecast)]),
        *saving_lines(savings),
        threads_line(threads),
        *([] if speedup is None else [executors_line(speedup.executors, None), *speedup_lines(speedup)]),
        "effects",
        *map(effect_line, ready.verdicts.values()),
    ]


def check_json(
    ready: Prepared,
    forecast: Cost | DivergedError | None = None,
    threads: ThreadChoice | None = None,
    speedup: SpeedupForecast | None = None,
    savings: Iterable[Saving] = (),
) -> dict:
    """The output of ``check --json``; with the expected cost (cost/forecast.py), the number of threads
    (engine/threads.py), and the gain by executors (cost/speedup_forecast.py)."""
    return {
        "scene": str(ready.scene.path) if ready.scene.path else ready.scene.name,
        "objects": [
            {"name": m.name, "particles": len(m.position), "springs": len(m.spring), "cell": list(m.cell)} for m in ready.models
        ],
        **{key: value for _, told in _counted(ready) for key, value in told.items()},
        "effects": {
            v.name: {"on": v.on, "reason": v.reason, "place": str(v.span) if v.span else None} for v in ready.verdicts.values()
        },
        "certificate": ready.certificate.to_json(),
        "cost": forecast.to_json() if isinstance(forecast, Cost) else None,
        "stops": forecast.why if isinstance(forecast, DivergedError) else None,
        "threads": None if threads is None else asdict(threads),
        "spread": None if speedup is None else asdict(speedup),
        "proposals": [saving.to_json() for saving in savings],
        "problems": [problem_json(w) for w in ready.warnings],
        "warnings": [{"message": w.message, "hint": w.hint, "place": str(w.span) if w.span else None} for w in ready.warnings],
    }
