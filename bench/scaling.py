# SPDX-License-Identifier: GPL-2.0-only
"""Speed over executors, the paper's fig. 18: ``python bench/scaling.py [run|plot|goals|supervisor|model] [options]``.

run: scenes/crowd.txt and a hail of 64 blocks by 1000 particles, in one process and on executors under both controls, in
interleaved rounds; prints a table of medians, writes scaling.json and docs/images/scaling.png (plot draws it again). goals: 64
blocks that meet nothing, and one object of 64 000 particles that two executors run as a team. supervisor: what a frame takes of
the supervisor, for few and many particles and objects; into scaling.json too. model: what scaling.json says about more ranks than
are here.

Options: ``--executors 1,2,4``, ``--rounds 3``, ``--frames 14`` (of the hail; four times as many of the crowd), ``--json FILE``,
``--plot FILE``.

Speed is told in two ways: frames per second of wall time, from the end of frame 1 to the last, with all that is written; and
frames per second of processor time of the executor that takes most, which other programs on the machine change less.
"""

import argparse
import json
import math
import multiprocessing
import os
import pickle
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

HERE = Path(__file__).parent
GRAVITY = "gravity (0, 0, -9.81) m/s^2\n"
BLOCK = """
  object block[{n}] {{
    shape      box ({edge}, {edge}, {edge}) cm
    position   {place} m
    density    900
    elasticity 300 kPa
    {more}
  }}
"""
END = """
control {
  time       4 s
  frames     50 fps
  resolution 1 cm
}
"""
ROWS = "repeat i in 0 .. 7 {{ repeat j in 0 .. 7 {{" + BLOCK + "}} }}"
SCENES = {
    "crowd": (HERE.parent / "scenes" / "crowd.txt").read_text().replace('include "rubber.txt"', "let rubber = 150 kPa"),
    "hail": GRAVITY
    + "ground z 0 m\n"
    + ROWS.format(
        n="i*8 + j",
        place="(i*0.3, j*0.3, 0.3 + 0.1*((i + 2*j) mod 5))",
        edge=9,
        more="velocity (rand(-1.5, 1.5), rand(-1.5, 1.5), 0) m/s",
    )
    + END,
    "blocks": GRAVITY + ROWS.format(n="i*8 + j", place="(i, j, 0)", edge=9, more="") + END,
    "one": GRAVITY + BLOCK.format(n=0, place="(0, 0, 0)", edge=39, more="") + END,
}
GOALS = {"blocks": 1.8, "one": 1.4}
"""Speed of two executors over that of one process, by processor time of the rank that takes most."""
LONGER = {"crowd": 4}
"""So many times as many frames: balls have met only after the first ones."""
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
    """What a case is called in a table."""
    return "one process" if case[0] == 0 else f"{case[0]}, {case[1]}"


def middle(runs: list[dict], what: str) -> float:
    """Median over rounds."""
    return statistics.median(r[what] for r in runs)


def ratio(runs: list[dict], base: list[dict], what: str) -> float:
    """Median of the ratios within rounds: what the machine does meanwhile falls out in part."""
    return statistics.median(r[what] / b[what] for r, b in zip(runs, base))


def table(runs: dict, known: dict, cases) -> str:
    """Markdown."""
    lines = []
    for name, of in runs.items():
        k = known[name]
        lines += [
            f"{name}: {k['objects']} objects, {k['particles']} particles, {k['steps']} steps per frame, "
            f"{of[cases[0]][0]['frames']} frames",
            "",
            "| executors | frames/s, wall | times | frames/s of the busiest processor | times | moved | again | supervisor [s] |",
            "|---|---|---|---|---|---|---|---|",
        ]
        base = of[cases[0]]
        for case in cases:
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


def draw(runs: dict, path: Path, note: str) -> None:
    """Times as fast over the number of executors, a panel for each scene."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.4 * len(runs), 3.9), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (name, of) in zip(figure.subplots(1, len(runs), squeeze=False)[0], runs.items()):
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
    figure.supxlabel(note, fontsize=6, x=0.995, ha="right", color="#707880")
    figure.savefig(path, dpi=130, metadata={"Software": None})


def run(options) -> None:
    """Measure, print, write."""
    cases = [(0, ""), *((k, control) for k in options.executors for control in COLORS)]
    load_before = os.getloadavg()[0]
    runs, known = rounds_of(["crowd", "hail"], cases, options.rounds, options.frames)
    note = (
        f"{os.cpu_count()} cores, {options.rounds} rounds, load of the machine {load_before:.1f} before "
        f"and {os.getloadavg()[0]:.1f} after"
    )
    print(table(runs, known, cases))
    print(note)
    data = stored(options) | {
        "note": note,
        "known": known,
        "runs": {name: {f"{k} {c}".strip(): r for (k, c), r in of.items()} for name, of in runs.items()},
    }
    options.json.write_text(json.dumps(data, indent=1) + "\n")
    plot(options)


def stored(options) -> dict:
    """What other parts have written."""
    return json.loads(options.json.read_text()) if options.json.exists() else {}


def plot(options) -> None:
    """The picture of scaling.json."""
    data = json.loads(options.json.read_text())
    runs = {
        name: {(int(case.split()[0]), case.partition(" ")[2]): r for case, r in of.items()} for name, of in data["runs"].items()
    }
    draw(runs, options.plot, data["note"])
    print(f"{options.json}   {options.plot}")


def goals(options) -> None:
    """Two executors against one process, and what is asked of them."""
    cases = [(0, ""), (2, "central"), (2, "peers")]
    runs, known = rounds_of(list(GOALS), cases, options.rounds, options.frames)
    print(table(runs, known, cases))
    for name, goal in GOALS.items():
        for case in cases[1:]:
            found = ratio(runs[name][case], runs[name][cases[0]], "by_cpu")
            verdict = "met" if found >= goal else "missed"
            print(f"{name}, {label(case)}: {found:.2f} times as fast by processor time, goal {goal}: {verdict}")


# --- supervisor -------------------------------------------------------------------------------------------------------

SHARES = {"few": (8, 4), "large": (8, 16), "many": (32, 2)}
"""Blocks along a side of a field of blocks that meet nothing, and edge of each [cm]."""


def supervisor(options) -> None:
    """Processor time that a frame takes of the supervisor of two executors, besides looks for messages while there is none."""
    runs: dict[str, list[dict]] = {name: [] for name in SHARES}
    for _ in range(options.rounds):
        for name in SHARES:
            runs[name].append(_share(*SHARES[name], options.frames))
    print("| objects | particles | steps | supervisor, median of a frame [ms] | least |\n|---|---|---|---|---|")
    for found in runs.values():
        seconds = [s for r in found for s in r["seconds"]]
        print(
            f"| {found[0]['objects']} | {found[0]['particles']} | {found[0]['steps']} | {1e3 * statistics.median(seconds):.2f} "
            f"| {1e3 * min(seconds):.2f} |"
        )
    options.json.write_text(json.dumps(stored(options) | {"supervisor": runs}, indent=1) + "\n")


def _share(side: int, edge: int, frames: int) -> dict:
    """A run of two executors: seconds of each frame but the first ones and the last, which is kept."""
    rows = ROWS.replace("0 .. 7", f"0 .. {side - 1}").format(n=f"i*{side} + j", place="(i, j, 0)", edge=edge, more="")
    with tempfile.TemporaryDirectory() as where:
        (Path(where) / "blocks.txt").write_text(GRAVITY + rows + END.replace("4 s", f"{frames / 50} s"))
        command = [Path(sys.executable).parent / "mpiexec", "-n", "3", sys.executable, "-m", "mpi4py", __file__, "--rank", where]
        subprocess.run(list(map(str, command)), check=True)
        return json.loads((Path(where) / "seconds.json").read_text())


def rank(folder: Path) -> None:
    """What every rank of such a run does."""
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
    supervisor.KEEP_SECONDS = math.inf  # a checkpoint is no part of a frame
    source, ends = supervisor.Distributed(ready, MPI.COMM_WORLD, "central", PlannerOptions()), []
    simulate(ready, folder, source=source, on_progress=lambda _: ends.append(source.cpu))
    known = {"objects": len(ready.system.names), "particles": ready.system.particles, "steps": ready.certificate.steps_per_frame}
    (folder / "seconds.json").write_text(json.dumps(known | {"seconds": np.diff(ends)[2:-1].tolist()}))


# --- model ------------------------------------------------------------------------------------------------------------


def model(options) -> None:
    """t_frame = max(work/K imbalance + plan + exchange + moves, supervisor): terms measured, then carried on to 10^3 ranks.

    A frame is one window. Supervisor and executors work at the same time, so the slower of them sets the pace. Plans are made
    here, for a crowd of as many objects and executors: their time and the imbalance that they leave are those of the program.
    """
    data = json.loads(options.json.read_text())
    cost = fit(data)
    print("\n".join(f"{name:<12} {value:.3g} {unit}" for name, (value, unit) in cost.items()))
    print(
        "\n| particles | executors | work/K, balanced | imbalance | plan, exchange | moves | supervisor | frame [s] | "
        "times as fast | bound by | were it not for the supervisor |\n|---|---|---|---|---|---|---|---|---|---|---|"
    )
    for objects, size in ((1_000, 1_000), (10_000, 1_000), (100_000, 1_000)):
        for executors in (1, 16, 128, 1_024):
            if objects < 4 * executors:
                continue
            print(row(objects, size, executors, {name: value for name, (value, _) in cost.items()}))


def fit(data: dict) -> dict:
    """Costs per unit, out of the runs where they show, else measured now."""
    from mdanim_lammps.parallel.plan.orders import Order
    from scipy.optimize import nnls

    hail, crowd = (data["runs"][name] for name in ("hail", "crowd"))
    known = data["known"]
    work = statistics.median(r["cpu"] / r["frames"] / known["hail"]["particles"] for r in hail["0"])
    distributed = {
        name: [(int(case.split()[0]), r) for case, runs in of.items() if case != "0" for r in runs]
        for name, of in (("hail", hail), ("crowd", crowd))
    }
    # Of the supervisor: so much for a frame, for an object in it, and for a particle.
    seen = np.array([(1, r[0]["objects"], r[0]["particles"]) for r in data["supervisor"].values()])
    medians = np.array([statistics.median(s for r in runs for s in r["seconds"]) for runs in data["supervisor"].values()])
    per_frame, per_object, per_particle = nnls(seen / medians[:, None], np.ones(len(medians)))[0].tolist()
    moving = statistics.median(r["spent"][1] * k / r["moves"] for k, r in distributed["crowd"] if r["moves"])
    scene, order = load("crowd", 4), _plan(10_000, 8)[0]
    message = Order(order, np.zeros((10_000, 3)), np.zeros((10_000, 3)), 100, True)
    seconds = least(lambda: pickle.loads(pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)))
    return {
        "work": (work, "s of processor time per particle and frame (hail)"),
        "per_particle": (per_particle, "s of the supervisor per particle and frame"),
        "per_object": (per_object, "s of the supervisor per object and frame"),
        "per_frame": (per_frame, "s of the supervisor per frame, besides"),
        "moved": (moving, "s of executors for an object that moves, with instances built anew (crowd, wall time)"),
        "order": (seconds / 10_000, "s to pack and unpack an order, per object (central: once for each executor)"),
        "memory": (
            len(pickle.dumps(scene.plan)) / scene.system.particles + 72,
            "bytes of every executor per particle of the scene",
        ),
        "latency": (LATENCY, "s for a message between hosts (assumed)"),
        "wire": (1.0 / BANDWIDTH, "s per byte between hosts (assumed)"),
    }


LATENCY, BANDWIDTH = 2e-4, 1e9
"""Of a message [s]: mostly the nap of the process that waits for it (messages.NAP); of a network of ten gigabit [bytes/s]."""
SHARE = 120
"""Bytes of an executor's share of a frame for each of its objects."""
MOVES = 0.004
"""Part of the objects that move in a frame: crowds of a thousand, `python bench/planning.py crowd`."""


def _plan(objects: int, executors: int):
    """The second plan of a crowd, one object in a volume of 30 of them, after all have gone on a little; and its seconds."""
    from mdanim_lammps.parallel.plan import frame_plan as planning

    rng = np.random.default_rng(objects)
    low = rng.uniform(0.0, (30.0 * objects) ** (1.0 / 3.0), (objects, 3))
    edge, d = rng.uniform(0.5, 1.0, (objects, 3)), np.full(objects, 0.05)
    cost = (1e4 * rng.uniform(0.9, 1.1, objects)).astype(np.int64)
    known = dict(particles=np.full(objects, 1000), still=np.zeros(objects, bool), gap=0.1)
    first = planning.plan(low, low + edge, d, cost, np.full(objects, -1), executors, **known)
    low += rng.normal(0.0, 0.1, low.shape)
    begin = time.process_time()
    second = planning.plan(low, low + edge, d, cost, first.owner, executors, previous=first, **known)
    return second, time.process_time() - begin


def least(work, turns: int = 5) -> float:
    """Seconds of a call, the least of some."""
    spent = []
    for _ in range(turns):
        start = time.process_time()
        work()
        spent.append(time.process_time() - start)
    return min(spent)


def row(objects: int, size: int, executors: int, cost: dict) -> str:
    """A line of the table, under the control that is faster there."""
    particles = objects * size
    plan, planning = _plan(objects, executors)
    imbalance = float(plan.load.max() / plan.load.mean())
    work = cost["work"] * particles / executors
    report, order = 64.0 * objects, 100.0 * objects  # bytes
    steps = np.ceil(np.log2(max(2, executors)))
    exchange = {
        "central": planning + executors * (cost["order"] * objects + order * cost["wire"]) + 2 * cost["latency"],
        "peers": planning + report * cost["wire"] + steps * cost["latency"] + cost["order"] * objects,
    }
    if executors == 1:
        exchange = {"central": 0.0}
    control = min(exchange, key=exchange.get)
    moves = MOVES * objects / executors * cost["moved"] * (executors > 1)
    told = (cost["per_object"] + SHARE * cost["wire"]) * objects
    supervisor = cost["per_frame"] + told + cost["per_particle"] * particles
    mine = work * imbalance + exchange[control] + moves
    frame = max(mine, supervisor)
    terms = {"work": work * imbalance, f"exchange ({control})": exchange[control], "moves": moves}
    bound = "supervisor" if supervisor > mine else max(terms, key=terms.get)
    return (
        f"| {particles:,} | {executors:,} | ".replace(",", " ")
        + f"{work:.3g} | {imbalance:.2f} | {exchange[control]:.2g} | {moves:.2g} | {supervisor:.2g} "
        + f"| {frame:.3g} | {cost['work'] * particles / frame:.3g} | {bound} | "
        f"{cost['work'] * particles / mine:.3g} |"
    )


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("part", nargs="?", choices=("run", "plot", "goals", "supervisor", "model"), default="run")
    cores = os.cpu_count() or 1
    default = sorted({k for k in (1, 2, 4, 8, 12, 15) if k <= max(2, cores - 1)})
    parser.add_argument("--executors", type=lambda text: [int(k) for k in text.split(",")], default=default)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--frames", type=int, default=14)
    parser.add_argument("--json", type=Path, default=HERE / "scaling.json")
    parser.add_argument("--plot", type=Path, default=HERE.parent / "docs" / "images" / "scaling.png")
    options = parser.parse_args()
    {"run": run, "plot": plot, "goals": goals, "supervisor": supervisor, "model": model}[options.part](options)


if __name__ == "__main__":
    rank(Path(sys.argv[2])) if sys.argv[1:2] == ["--rank"] else main()
