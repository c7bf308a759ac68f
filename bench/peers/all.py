# SPDX-License-Identifier: GPL-2.0-only
"""Other programs on our scenes: ``python bench/peers/all.py [--write] [--quick] [--limit SECONDS] [--rounds N] [SCENE ...]``.

Scenes: the keys of CASES. Every program runs alone in a process of its own, on one thread, for a limit of processor seconds or
until the scene is over; ours by the Python that runs this, others by .venv-peers. A program that ends soon runs again, in turns.
One that cannot run, or takes too long to begin, has a row that says why.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import one_thread  # noqa: E402, F401
from timing import markdown, replace_between  # noqa: E402
from timoshenko import mean_sag  # noqa: E402

PAGE = HERE.parent.parent / "docs" / "performance.md"
PEERS = HERE.parent.parent / ".venv-peers" / "bin" / "python"
BEGIN = 150.0
"""Wall seconds that a contender may take beyond its limit, building and compiling included."""
CUBE = dict(young=5e5, density=1000.0, z=0.6, time=1.0)
BAR = dict(length=1.0, thickness=0.1, young=5e6, density=1000.0, gravity=1.0, time=0.43)
"""Half a period: the bar, let go, hangs lowest."""
BAR["exact"] = float(mean_sag(BAR["time"], **{k: BAR[k] for k in ("length", "thickness", "young", "density", "gravity")}))
"""Mean sag then [m], of a Timoshenko beam."""
POOL = dict(width=1.0, level=0.6, side=0.3, middle=0.5, z=0.85, density=500.0, time=1.0)
CASES = {
    "cube": (
        "A cube of 1 m, E 5e5 Pa, 1000 kg/m³, falls 0.1 m onto the ground, 10 648 nodes; ours and MuJoCo at half of the "
        "largest step they bear, other springs at our step",
        CUBE | {"h": 1.0 / 21.0, "fraction": 0.5},
        {
            "ours": 1.0,
            "mujoco_flex": 40.0,
            "taichi_springs": 2.0,
            "taichi_springs, serial": None,
            "openmm_springs": None,
            "pybullet_soft": None,
        },
    ),
    "cube, largest step": (
        "The same at the largest step they bear: ours is the certified bound, MuJoCo's was found by trying",
        CUBE | {"h": 1.0 / 21.0, "fraction": 1.0},
        {"ours": 1.0, "mujoco_flex": 40.0},
    ),
    "cantilever": (
        "A bar of 1 m × 0.1 m × 0.1 m, E 5e6 Pa, clamped and let go under 1 m/s², 4 cells thick; error of the mean "
        "sag after half a period",
        BAR | {"h": 0.025},
        {"ours": 1.0, "mujoco_flex": None},
    ),
    "cantilever, 2 cells": ("The same 2 cells thick", BAR | {"h": 0.05}, {"ours": 1.0, "mujoco_flex": None}),
    "cantilever, 8 cells": ("The same 8 cells thick", BAR | {"h": 0.0125}, {"ours": 1.0, "mujoco_flex": None}),
    "float": (
        "A box of 0.3 m, 500 kg/m³, dropped into 1 m × 1 m × 0.6 m of water, spacing 0.0288 m",
        POOL | {"h": 0.0288},
        {"ours": 1.0, "lammps_sph": 300.0},
    ),
    "dominoes": (
        "Nine rigid dominoes of 6 × 20 × 40 cm and a ball that pushes the first, four seconds",
        {"time": 4.0},
        {"ours": 1.0, "mujoco_rigid": None, "pybullet_rigid": None},
    ),
    "heap": (
        "A thousand rigid boxes of 10 cm fall into a heap, the first second",
        {"time": 1.0, "bodies": 1000},
        {"ours": 1.0, "ours, 0.25": None, "mujoco_rigid": 1.0, "mujoco_rigid, CG": 1.0, "pybullet_rigid": None},
    ),
}
"""Title, numbers of the scene, and contenders with the goal: how many times as much as ours they take. A contender is a file
here, and which of its ways to do it if there are several."""


def contender(name: str, scene: str, case: dict) -> dict:
    """Figures of one contender, or why there are none."""
    file, _, way = name.partition(", ")
    python = Path(sys.executable) if file == "ours" else PEERS
    if not python.exists():
        return {"failed": "not installed: there is no .venv-peers, see `make bench-peers`"}
    alone = {"OMP_NUM_THREADS": "1", "OPENMM_CPU_THREADS": "1", "TI_LOG_LEVEL": "error"}
    try:
        with tempfile.TemporaryDirectory() as folder:  # some leave files where they run
            words = [python, HERE / f"{file}.py", scene.split(",")[0], json.dumps(case | {"way": way})]
            done = subprocess.run(
                words, capture_output=True, text=True, timeout=case["limit"] + BEGIN, env=os.environ | alone, cwd=folder
            )
    except subprocess.TimeoutExpired:
        return {"failed": f"no figure within {case['limit'] + BEGIN:.0f} s"}
    lines = done.stdout.strip().splitlines()
    if done.returncode or not lines:
        return {"failed": (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1][:150]}
    return json.loads(lines[-1])


def measure(scene: str, limit: float, rounds: int) -> list[dict]:
    """One row for each contender of a scene: the median over as many rounds as fit the limit, of one at least."""
    _, case, contenders = CASES[scene]
    with tempfile.TemporaryDirectory() as folder:
        case = case | {"limit": limit}
        shared = case | ({"lattice": str(Path(folder) / "lattice.npz")} if scene == "cube" else {})
        rows = [{"contender": name, "goal": goal} | contender(name, scene, shared) for name, goal in contenders.items()]
        costs = [[r["cost"]] if "cost" in r else [] for r in rows]
        for _ in range(rounds - 1):
            for row, found in zip(rows, costs):
                if found and not row["extrapolated"] and rounds * found[0] * case["time"] < limit:
                    again = contender(row["contender"], scene, shared)
                    found += [again["cost"]] if "cost" in again else []
    return [r | ({"cost": statistics.median(c), "least": min(c), "rounds": len(c)} if c else {}) for r, c in zip(rows, costs)]


def equal_error(found: dict[str, list[dict]]) -> str:
    """For each peer's row with an error: what ours takes for an error that is no larger, at its cheapest."""
    rows = [r for scene in found.values() for r in scene if r.get("error") is not None]
    ours = [r for r in rows if r["contender"] == "ours"]
    lines = []
    for peer in (r for r in rows if r["contender"] != "ours"):
        enough = [r for r in ours if abs(r["error"]) <= abs(peer["error"])]
        if enough:
            best = min(enough, key=lambda r: r["cost"])
            lines.append(
                (
                    peer["contender"],
                    peer["nodes"],
                    f"{100 * peer['error']:+.1f} %",
                    peer["cost"],
                    best["nodes"],
                    f"{100 * best['error']:+.1f} %",
                    best["cost"],
                    peer["cost"] / best["cost"],
                )
            )
    return (
        markdown(
            [
                "peer",
                "its nodes",
                "its error",
                "processor seconds per simulated second",
                "our nodes",
                "our error",
                "ours",
                "peer over ours",
            ],
            lines,
        )
        if lines
        else ""
    )


def table(rows: list[dict]) -> str:
    """In Markdown."""
    ours = next((r.get("cost") for r in rows if r["contender"] == "ours"), None)
    lines = []
    for r in rows:
        if "failed" in r:
            lines.append((r["contender"], "", "", "", f"**no figure:** {r['failed']}", "", "", "", ""))
            continue
        about = "~" if r["extrapolated"] else ""
        error = f"{100 * r['error']:+.1f} %" if r.get("error") is not None else ""
        ratio = f"{about}{r['cost'] / ours:.3g}" if ours else ""
        size = f"{r['nodes']:,}" + (f" + {r['cells']:,} cells" if "cells" in r else "")
        name = r["contender"].partition(",")[0]
        goal = f"≥ {r['goal']:g}" if r["goal"] and name != "ours" else ""
        lines.append(
            (
                f"{name} {r['version']}" + (f", {r['note']}" if "note" in r else ""),
                size,
                r["dt"],
                r["steps"],
                f"{about}{r['cost']:.3g} ({r['least']:.3g})",
                r["rounds"],
                ratio,
                goal,
                error,
            )
        )
    return markdown(
        [
            "contender",
            "nodes",
            "step [s]",
            "steps taken",
            "processor seconds per simulated second, median (least)",
            "rounds",
            "over ours",
            "goal",
            "error",
        ],
        lines,
    )


def main() -> None:
    """Measure, print, and write if asked to."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=list(CASES))
    parser.add_argument("--limit", type=float)
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--quick", action="store_true", help="3 seconds for each, one round")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if unknown := set(options.scenes) - CASES.keys():
        parser.error(f"unknown: {', '.join(sorted(unknown))}; scenes are {', '.join(CASES)}")
    limit, rounds = options.limit or (3.0 if options.quick else 30.0), options.rounds or (1 if options.quick else 5)
    busy = os.getloadavg()[0] / os.cpu_count()
    text = (
        f"`python bench/peers/all.py`, {limit:g} processor seconds at most for each, {rounds} rounds where they fit, load at "
        f"the start {busy:.1f} per core"
        + (" (**a busy machine**)" if busy > 0.3 else "")
        + "; ~ extrapolated from the part of the scene that fitted.\n"
    )
    found, start = {}, time.perf_counter()
    for scene in options.scenes:
        found[scene] = measure(scene, limit, rounds)
        part = f"**{CASES[scene][0]}**\n\n{table(found[scene])}\n"
        print(part, flush=True)
        text += "\n" + part
    if equal := equal_error(found):
        part = f"**The bars at equal error: what ours takes, at its cheapest, to be no farther off**\n\n{equal}\n"
        print(part, flush=True)
        text += "\n" + part
    print(f"{time.perf_counter() - start:.0f} s in all")
    if options.write:
        replace_between(PAGE, "peers", text)


if __name__ == "__main__":
    main()
