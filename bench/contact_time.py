# SPDX-License-Identifier: GPL-2.0-only
"""Time of contact in scenes where objects lie on each other: ``python bench/contact_time.py [rounds [scene ...]]``, with
``--against FOLDER`` beside another build, FOLDER being that of its package. A scene is its name, with more lines of text behind a
comma: ``"plates, air { }"`` takes standard steps.

Each scene runs to its middle, then rounds of steps from there on take turns: processor time of a step on one thread, looks at
points that touch nothing, and points in contact. A round has several short runs, of which the quickest counts: others on the
machine stretch the rest.
"""

from __future__ import annotations

import hashlib
import json
import pickle
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import one_thread  # noqa: F401
from timing import markdown

SCENES = Path(__file__).resolve().parent.parent / "scenes"
NAMES = ("pile", "plates", "billiard", "crowd")
MIDDLE, STEPS, RUNS, ROUNDS = 0.5, 12, 10, 15
"""Part of a scene, steps of a run, runs of a round, rounds."""
TOUCHING, LOOKS = 5, 14
"""Entries of the vector of fix mdanim/contact."""


def serve(name: str, state: Path) -> None:
    """Run a scene to its middle, or from there where a build before has left its state; then a round for each line that is read,
    whose figures are a line of JSON."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    scene, _, more = name.partition(", ")
    plan = prepare(parse_scene((SCENES / f"{scene}.txt").read_text(encoding="utf-8") + more, folder=SCENES)).plan
    middle = round(MIDDLE * plan.certificate.steps)
    with Instance(plan) as instance:
        instance.lammps.lmp.command("run_style verlet/mdanim threads 1")
        instance.setup()
        if not state.exists():
            instance.run(middle)
            state.write_bytes(pickle.dumps(instance.state()))
        instance.put(middle, pickle.loads(state.read_bytes()))
        print("ready", flush=True)
        for _ in sys.stdin:
            took, before = [], instance.fix_value("contact", LOOKS)
            for _ in range(RUNS):
                start = time.process_time()
                instance.run(STEPS)
                took.append(1e6 * (time.process_time() - start) / STEPS)
            now = instance.state()
            figures = {
                "particles": plan.system.particles,
                "took": min(took),
                "looks": (instance.fix_value("contact", LOOKS) - before) / STEPS / RUNS,
                "touching": instance.fix_value("contact", TOUCHING),
                "bits": hashlib.sha1(now.x.tobytes() + now.v.tobytes()).hexdigest(),
            }
            print(json.dumps(figures), flush=True)


def start(name: str, state: Path, folder: str) -> subprocess.Popen:
    """A process that serves a scene with the package in this folder."""
    words = [sys.executable, "-c", f"import sys; sys.path[:0] = {[folder, str(Path(__file__).parent)]!r}; import contact_time"]
    words[-1] += f"; from pathlib import Path; contact_time.serve({name!r}, Path({str(state)!r}))"
    process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    if process.stdout.readline() != "ready\n":
        raise SystemExit(f"{name}: the package in {folder} does not run it")
    return process


def measure(name: str, rounds: int, folders: list[str]) -> list[str]:
    """Row of one scene."""
    with tempfile.TemporaryDirectory() as temporary:
        processes = [start(name, Path(temporary) / "state", folder) for folder in folders]
        found: list[list[dict]] = [[] for _ in processes]
        for n in range(rounds):
            for process, own in list(zip(processes, found))[:: 1 if n % 2 == 0 else -1]:
                process.stdin.write("\n")
                process.stdin.flush()
                own.append(json.loads(process.stdout.readline()))
        for process in processes:
            process.communicate()
    took = [[one["took"] for one in own] for own in found]
    row = [name, str(found[0][0]["particles"]), *(f"{statistics.median(t):.0f} ({min(t):.0f})" for t in took)]
    row += [f"{statistics.mean(one[what] for one in found[-1]):.0f}" for what in ("looks", "touching")]
    if len(took) > 1:
        same = all(a["bits"] == b["bits"] for a, b in zip(*found))
        row += [f"{statistics.median(a / b for a, b in zip(took[1], took[0])):.3f}", "same" if same else "others"]
    return row


def main(words: list[str]) -> None:
    """Print a table in Markdown."""
    import mdanim_lammps

    folders = [str(Path(mdanim_lammps.__file__).resolve().parent.parent)]
    if "--against" in words:
        at = words.index("--against")
        folders.insert(0, str(Path(words[at + 1]).resolve()))
        words = words[:at] + words[at + 2 :]
    columns = ["scene", "particles", *(["us per step, the other, median (least)"] if len(folders) > 1 else [])]
    columns += ["us per step, median (least)", "looks per step", "in contact"]
    columns += ["ratio, median of rounds", "bits"] if len(folders) > 1 else []
    rounds = int(words[0]) if words else ROUNDS
    print(markdown(columns, [measure(name, rounds, folders) for name in words[1:] or NAMES]))


if __name__ == "__main__":
    main(sys.argv[1:])
