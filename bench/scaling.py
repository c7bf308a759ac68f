# SPDX-License-Identifier: GPL-2.0-only
"""Speed over executors and threads, the paper's fig. 18: ``python bench/scaling.py [PART] [options]``.

run         scenes/crowd.txt and a hail of 64 blocks by 1000 particles, in one process and on executors under both controls, in
            interleaved rounds, and then what threads has; writes scaling.json and docs/images/scaling.png
executors   the first half of run
threads     the second half: crowd, heap, hail, one object and a float by one thread and by several, and Amdahl's law beyond
plot        draws the picture again
goals       64 blocks that meet nothing, and one object of 64 000 particles that two executors run as a team
supervisor  what a frame takes of the supervisor, for few and many particles and objects
model       what scaling.json says about more ranks than are here
tables      the tables of scaling.json, nothing is measured
all         run, goals, supervisor and model

``--write`` puts tables into docs/beyond-one-host.md, and the picture into docs/; all but model and plot put what they measure
into scaling.json. Figures of another machine stand in a file of their own, such as scaling_16_cores.json: ``tables --json FILE
--plot FILE --write`` writes them between marks that end as its name does. Options: ``--executors 1,2,4``, ``--rounds 3``,
``--frames 14`` (of the hail; four times as many of the crowd), ``--json FILE``, ``--plot FILE``.

Speed on executors is told in two ways: frames per second of wall time, from the end of frame 1 to the last, with all that is
written; and frames per second of processor time of the executor that takes most, which other programs on the machine change less.
Processor time is that of all threads, so it does not show what a team on one host brings.
"""

import argparse
import json
import math
import multiprocessing
import os
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import one_thread  # noqa: F401

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):  # before numpy: executors have one thread each too
    os.environ[name] = "1"

import numpy as np  # noqa: E402
import scaling_model  # noqa: E402
import scaling_threads  # noqa: E402
from mdanim_lammps.processes import cores  # noqa: E402
from scene_texts import BLOCK, END, GRAVITY, hail, rows  # noqa: E402
from timing import machine, replace_between  # noqa: E402

HERE = Path(__file__).parent
PAGE = HERE.parent / "docs" / "beyond-one-host.md"
SCENES = {
    "crowd": (HERE.parent / "scenes" / "crowd.txt").read_text().replace('include "rubber.txt"', "let rubber = 150 kPa"),
    "hail": hail(8),
    "blocks": GRAVITY + rows(8, "(i, j, 0)", 9) + END,
    "one": GRAVITY + BLOCK.format(n=0, place="(0, 0, 0)", edge=39, more="") + END,
}
GOALS = {"blocks": ("by_cpu", 1.8), "one": ("by_wall", 1.4)}
"""Speed of two executors over that of one process: by processor time of the rank that takes most, or, where one has threads for
both, by wall time."""
LONGER = {"crowd": 4}
"""Factor of the number of frames: balls have met only after the first ones."""
LONGER_GOALS = 7
"""The same factor for the goals."""
COLORS = {"central": "#0072b2", "peers": "#d55e00"}


def load(name: str, frames: int):
    """The scene, cut to so many frames, ready to run."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    scene = parse_scene(SCENES[name])
    return prepare(replace(scene, control=replace(scene.control, time=frames / scene.control.frames), expects=()))


def measure(ready, executors: int, control: str) -> dict:
    """One run: frames per second by both clocks, and what the log says."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as fresh:
        return fresh.submit(_measure, ready, executors, control).result()


def _measure(ready, executors: int, control: str) -> dict:
    """``executors`` 0: the program in one process, whose clock stands while it does what a supervisor would do."""
    from mdanim_lammps.parallel.runtime.launch import simulate_on
    from mdanim_lammps.results.timeline import Timeline
    from mdanim_lammps.run.frame_source import Sequential
    from mdanim_lammps.run.loop import simulate

    class Clocked(Sequential):
        """Sums the processor time of what an executor would do, its own rows of frames among that."""

        cpu = 0.0

        def __enter__(self):
            return self.timed(super().__enter__)

        def begin(self, resume, rows):
            return self.timed(super().begin, resume, rows)

        def advance(self, frame, steps):
            return self.timed(super().advance, frame, steps)

        def timed(self, work, *arguments):
            start = time.process_time()
            try:
                return work(*arguments)
            finally:
                self.cpu += time.process_time() - start

    ends = []
    with tempfile.TemporaryDirectory() as name:
        folder, clock = Path(name), Clocked(ready.plan)
        told = {"on_progress": lambda p: ends.append(time.perf_counter())}
        if executors == 0:
            simulate(ready, folder, source=clock, **told)
            found = {"cpu": clock.cpu}
        else:
            simulate_on(executors, control, ready, folder, **told)
            log = Timeline.read(folder)
            found = {
                "cpu": max(log.cpu),
                "supervisor_cpu": log.supervisor_cpu,
                "moves": sum(log.moves),
                "again": sum(log.retries),
                "busy": float(log.busy().mean()),
                "spent": log.spent().mean(axis=0).tolist(),
            }
    frames = len(ends)
    return found | {"by_wall": (frames - 1) / (ends[-1] - ends[0]), "by_cpu": frames / found["cpu"], "frames": frames}


def rounds_of(names, cases, rounds: int, frames: int) -> tuple[dict, dict]:
    """All runs of all cases (executors, control), interleaved; and what is known of each scene."""
    ready = {name: load(name, frames * LONGER.get(name, 1)) for name in names}
    known = {
        name: {"objects": len(r.system.names), "particles": r.system.particles, "steps": r.certificate.steps_per_frame}
        for name, r in ready.items()
    }
    runs = {name: {case: [] for case in cases} for name in names}
    for turn in range(rounds):
        for name in names:
            for case in cases if turn % 2 == 0 else cases[::-1]:
                runs[name][case].append(measure(ready[name], *case))
                speed = runs[name][case][-1]["by_wall"]
                print(f"round {turn + 1}: {name}, {label(case)}: {speed:.2f} frames/s", file=sys.stderr, flush=True)
    return runs, known


def label(case) -> str:
    """Name of a case in a table."""
    return "one process" if case[0] == 0 else f"{case[0]}, {case[1]}"


def middle(runs: list[dict], what: str) -> float:
    """Median over rounds."""
    return statistics.median(r[what] for r in runs)


def ratio(runs: list[dict], base: list[dict], what: str) -> float:
    """Median of the ratios within rounds: what the machine does meanwhile falls out in part."""
    return statistics.median(r[what] / b[what] for r, b in zip(runs, base))


def table(runs: dict, known: dict) -> str:
    """Markdown."""
    lines = []
    for name, of in runs.items():
        k = known[name]
        lines += [
            f"{name}: {k['objects']} objects, {k['particles']} particles, {k['steps']} steps per frame, "
            f"{of[0, ''][0]['frames']} frames",
            "",
            "| executors | frames/s, wall | times | frames/s of the busiest processor | times | moved | again | supervisor [s] |",
            "|---|---|---|---|---|---|---|---|",
        ]
        base = of[0, ""]
        for case in sorted(of):
            rest = ""
            if case[0]:
                rest = " | ".join(
                    f"{middle(of[case], what):.{n}f}" for what, n in (("moves", 0), ("again", 0), ("supervisor_cpu", 2))
                )
            lines.append(
                f"| {label(case)} | {middle(of[case], 'by_wall'):.2f} | {ratio(of[case], base, 'by_wall'):.2f} | "
                f"{middle(of[case], 'by_cpu'):.2f} | {ratio(of[case], base, 'by_cpu'):.2f} | {rest or ' | | '} |"
            )
        lines.append("")
    return "\n".join(lines)


def draw(runs: dict, path: Path, note: str, threads: dict | None) -> None:
    """Times as fast over the number of executors, a panel for each scene, and over the number of threads."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.4 * len(runs), 9.0 if threads else 3.9), layout="constrained")
    FigureCanvasAgg(figure)
    upper, *lower = figure.subfigures(2 if threads else 1, 1, squeeze=False)[:, 0]
    for axes, (name, of) in zip(upper.subplots(1, len(runs), squeeze=False)[0], runs.items()):
        base = of[(0, "")]
        most = max(k for k, _ in of)
        axes.plot([1, most], [1, most], color="#b0b7bd", linewidth=1.0, label="as many times as executors")
        for control, color in COLORS.items():
            count = sorted(k for k, c in of if c == control)
            for what, style, told in (("by_wall", "s:", "wall"), ("by_cpu", "o-", "busiest processor")):
                ratios = [[r[what] / b[what] for r, b in zip(of[k, control], base)] for k in count]
                axes.plot(
                    count, [statistics.median(r) for r in ratios], style, color=color, markersize=5, label=f"{control}, {told}"
                )
                if what == "by_cpu":
                    axes.vlines(count, [min(r) for r in ratios], [max(r) for r in ratios], color=color, linewidth=0.8)
        axes.set(title=name, xlabel="executors", ylabel="frames per second over one process", ylim=(0.0, None))
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.grid(alpha=0.25)
        axes.legend(fontsize=7)
    small = dict(fontsize=6, x=0.995, ha="right", color="#707880")
    upper.supxlabel(note.replace("*", ""), **small)
    for part in lower:
        scaling_threads.draw(part.subplots(), threads)
        part.supxlabel(threads["note"].replace("*", ""), **small)
    figure.savefig(path, dpi=130, metadata={"Software": None})


def run(options) -> dict[str, str]:
    """Measure speed over executors and over threads."""
    return executors(options) | threads(options)


def executors(options) -> dict[str, str]:
    """Measure speed over executors."""
    cases = [(0, ""), *((k, control) for k in options.executors for control in COLORS)]
    note = f"{options.rounds} rounds. {machine()}"
    runs, known = rounds_of(["crowd", "hail"], cases, options.rounds, options.frames)
    note += f"; load after {os.getloadavg()[0] / (os.cpu_count() or 1):.1f} per core"
    store(options, {"note": note, "known": known, "runs": named(runs)})
    return told_of(options, "executors")


def threads(options) -> dict[str, str]:
    """Measure speed over threads."""
    counts = scaling_threads.counts_of(cores())
    store(options, {"threads": scaling_threads.measure(list(scaling_threads.SCENES), counts, options.rounds)})
    return told_of(options, "threads")


def named(runs: dict) -> dict:
    """Cases as words, as JSON has them."""
    return {name: {f"{k} {c}".strip(): r for (k, c), r in of.items()} for name, of in runs.items()}


def cases_of(runs: dict) -> dict:
    """The same back."""
    return {name: {(int(case.split()[0]), case.partition(" ")[2]): r for case, r in of.items()} for name, of in runs.items()}


def stored(options) -> dict:
    """Figures that parts have written."""
    return json.loads(options.json.read_text()) if options.json.exists() else {}


def store(options, found: dict) -> None:
    """Put it there."""
    options.json.write_text(json.dumps(stored(options) | found, indent=1) + "\n")


def told_of(options, *parts: str) -> dict[str, str]:
    """Figures of scaling.json for a part, as on the page; empty if it has none."""
    data, told = stored(options), {}
    for part in parts:
        text = f"`python bench/scaling.py {part}`"
        if part == "executors" and "runs" in data:
            runs = cases_of(data["runs"])
            told[part] = f"{text}: {data['note']}.\n\n{table(runs, data['known'])}"
        elif part == "threads" and "threads" in data:
            told[part] = f"{text}: {data['threads']['note']}.\n\n{scaling_threads.table(data['threads'])}"
        elif part == "goals" and "goals" in data:
            told[part] = f"{text}: {data['goals']['note']}.\n\n{goals_table(data['goals'])}"
        elif part == "supervisor" and "supervisor" in data:
            told[part] = f"{text}: {data['supervisor_note']}.\n\n{shares(data['supervisor'])}"
    return told


def tables(options) -> dict[str, str]:
    """All of them."""
    return told_of(options, "executors", "threads", "goals", "supervisor")


def everything(options) -> dict[str, str]:
    """Measure all, in turns."""
    return run(options) | goals(options) | supervisor(options) | model(options)


def plot(options) -> dict[str, str]:
    """The picture of scaling.json."""
    data = stored(options)
    draw(cases_of(data["runs"]), options.plot, data["note"], data.get("threads"))
    print(f"{options.json}   {options.plot}", file=sys.stderr)
    return {}


def goals(options) -> dict[str, str]:
    """Two executors against one process, and what is asked of them."""
    cases = [(0, ""), (2, "central"), (2, "peers")]
    note = f"{options.rounds} rounds, {LONGER_GOALS * options.frames} frames. {machine()}"
    runs, known = rounds_of(list(GOALS), cases, options.rounds, LONGER_GOALS * options.frames)
    store(options, {"goals": {"note": note, "known": known, "runs": named(runs)}})
    return told_of(options, "goals")


def goals_table(data: dict) -> str:
    """Markdown, with what is asked."""
    runs = cases_of(data["runs"])
    lines = [table(runs, data["known"])]
    for name, of in runs.items():
        for case in list(of)[1:]:
            what, goal = GOALS[name]
            found, time = ratio(of[case], of[0, ""], what), {"by_cpu": "processor time", "by_wall": "wall time"}[what]
            verdict = "met" if found >= goal else "missed"
            lines.append(f"{name}, {label(case)}: {found:.2f} times as fast by {time}, goal {goal}: {verdict}.  ")
    return "\n".join(lines)


# --- supervisor -------------------------------------------------------------------------------------------------------

SHARES = {"few": (8, 4), "large": (8, 16), "many": (32, 2)}
"""Blocks along a side of a field of blocks that meet nothing, and edge of each [cm]."""


def supervisor(options) -> dict[str, str]:
    """Processor time that a frame takes of the supervisor of two executors, besides looks for messages while there is none."""
    note = f"{options.rounds} rounds. {machine()}"
    runs: dict[str, list[dict]] = {name: [] for name in SHARES}
    for _ in range(options.rounds):
        for name in SHARES:
            runs[name].append(_share(*SHARES[name], options.frames))
    store(options, {"supervisor": runs, "supervisor_note": note})
    return told_of(options, "supervisor")


def shares(runs: dict[str, list[dict]]) -> str:
    """Markdown."""
    lines = ["| objects | particles | steps | supervisor, median of a frame [ms] | least |", "|---|---|---|---|---|"]
    for found in runs.values():
        seconds = [s for r in found for s in r["seconds"]]
        lines.append(
            f"| {found[0]['objects']} | {found[0]['particles']} | {found[0]['steps']} | {1e3 * statistics.median(seconds):.2f} "
            f"| {1e3 * min(seconds):.2f} |"
        )
    return "\n".join(lines)


def _share(side: int, edge: int, frames: int) -> dict:
    """A run of two executors: seconds of each frame but the first ones and the last, which is kept."""
    blocks = rows(side, "(i, j, 0)", edge)
    with tempfile.TemporaryDirectory() as where:
        (Path(where) / "blocks.txt").write_text(GRAVITY + blocks + END.replace("4 s", f"{frames / 50} s"))
        command = [Path(sys.executable).parent / "mpiexec", "-n", "3", sys.executable, "-m", "mpi4py", __file__, "--rank", where]
        subprocess.run(list(map(str, command)), check=True)
        return json.loads((Path(where) / "seconds.json").read_text())


def rank(folder: Path) -> None:
    """Work of every rank of such a run."""
    from mdanim_lammps.parallel.plan.frame_plan import PlannerOptions
    from mdanim_lammps.parallel.runtime import supervisor
    from mdanim_lammps.parallel.runtime.executor import serve
    from mdanim_lammps.run.loop import simulate
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene
    from mpi4py import MPI

    if MPI.COMM_WORLD.rank:
        serve(MPI.COMM_WORLD)
        return
    ready = prepare(load_scene(folder / "blocks.txt"))
    supervisor.KEEP_SECONDS = math.inf  # a checkpoint is not part of a frame
    source, ends = supervisor.Distributed(ready, MPI.COMM_WORLD, "central", PlannerOptions()), []
    simulate(ready, folder, source=source, on_progress=lambda _: ends.append(source.cpu))
    known = {"objects": len(ready.system.names), "particles": ready.system.particles, "steps": ready.certificate.steps_per_frame}
    (folder / "seconds.json").write_text(json.dumps(known | {"seconds": np.diff(ends)[2:-1].tolist()}))


def model(options) -> dict[str, str]:
    """More ranks than are here."""
    return {"model": f"`python bench/scaling.py model`:\n\n{scaling_model.table(stored(options), load('crowd', 4))}"}


PARTS = {
    "run": run,
    "executors": executors,
    "threads": threads,
    "plot": plot,
    "goals": goals,
    "supervisor": supervisor,
    "model": model,
    "tables": tables,
    "all": everything,
}


def main() -> None:
    """Read the command line, do a part, print and write what it tells."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("part", nargs="?", choices=PARTS, default="run")
    default = sorted({k for k in (1, 2, 4, 8, 12, 15) if k <= max(2, (os.cpu_count() or 1) - 1)})
    parser.add_argument("--executors", type=lambda text: [int(k) for k in text.split(",")], default=default)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--frames", type=int, default=14)
    parser.add_argument("--json", type=Path, default=HERE / "scaling.json")
    parser.add_argument("--plot", type=Path, default=HERE.parent / "docs" / "images" / "scaling.png")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    told = PARTS[options.part](options)
    print("\n\n".join(text.rstrip() for text in told.values()))
    if options.part in ("run", "executors", "threads", "all") or (options.part == "tables" and options.write):
        plot(options)
    if options.write:
        for part, text in told.items():
            replace_between(PAGE, part + options.json.stem.removeprefix("scaling"), text)


if __name__ == "__main__":
    rank(Path(sys.argv[2])) if sys.argv[1:2] == ["--rank"] else main()
