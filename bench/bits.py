# SPDX-License-Identifier: GPL-2.0-only
"""Bits of runs: ``python bench/bits.py [--quick] [--write FILE] [--against FILE] [SCENE ...]``.

Every scene of scenes/ and of tests/reference, and the hard ones below, is run for some steps from its beginning and from a state
in its middle: by ``run_style verlet``, and by passes with each set of instructions that runs here, by 1, 2 and 4 threads,
some of that on 2 ranks. Told is the SHA-256 of positions, velocities, forces and of the records of fixes, which must be the same
in all of these ways, and that of the ledger, whose sums each way rounds in another order. A row names the ways that differ from
the first one. ``--write`` stores all hashes; ``--against`` compares with such a file and exits with 1, naming what differs.
``--quick`` takes the hard scenes and few ways, a minute; all takes about ten minutes of a core.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import one_thread  # noqa: F401
from step import WIDTHS, runs_here

ROOT = Path(__file__).resolve().parents[1]
STEPS = 200
EAGER = "2"
"""The least that a thread is asked for [ns]: threads share whatever they can."""
WARM_PART, WARM_PARTICLE_STEPS = 0.3, 6e6
"""The middle of a run: after this part of its steps, but no more of them than particles times steps come to."""
SAME, ROUNDED = ("x", "v", "f", "records"), ("ledger",)
"""Hashed arrays: the same by all ways, and sums that each way rounds by itself."""
ACCOUNTS = np.s_[16:48]
"""Bytes of the liquid's record that tell energies: they belong to the ledger (heads of automaton_basin_state.cpp and
wave_basin_state.cpp)."""
HEAD = "gravity (0, 0, -9.81)\n"
HARD, SOFT = "density 1000 elasticity 0.2 MPa", "density 1000 elasticity 0.2 MPa damping 0.1"
SPLASH = f"""
ground z 0 m
object a {{ shape box (11, 11, 9) cm position (0, 0, 16) cm {SOFT} friction 0.3 velocity (0.2, 0, -2) spin (0, 0, 2) }}
object b {{ shape box (5, 5, 5) cm position (1, 0, 23.15) cm {HARD} friction 0.3 velocity (0, 0, -3) }}
object c {{ shape sphere 3 cm position (-8, 5, 3) cm {HARD} friction 0.3 velocity (0, 1, 0) }}
liquid w {{ basin from (-16, -14, 0) cm to (16, 14, 30) cm density 1000 level 11 cm drag 2 model MODEL }}
control {{ time 0.5 s resolution 1 cm }}
"""
HEAP = f"""
ground z 0 m
walls from (-8, -8, -10) cm to (8.5, 20, 100) cm
repeat i in 0 .. 2 {{ repeat j in 0 .. 2 {{
  object a[3*i + j] {{ shape box (4, 4, 4) cm position (4.02*i - 4, 4*j - 4, 2) cm {HARD} friction 0.4
    velocity (rand(-1, 1), rand(-1, 1), -0.5) spin (0, 0, 9 * rand(-1, 1)) rad/s }}
  object b[3*i + j] {{ shape sphere 2 cm position (4*i - 4, 4*j - 4, 6.1) cm {SOFT} friction 0.3 velocity (0, 1, -1) }} }} }}
control {{ time 0.5 s resolution 1 cm }}
"""
BARRIER = f"""
walls from (-8, -8, -8) cm to (11, 8, 12) cm
object a {{ shape box (5, 5, 5) cm position (0, 0, 0) {SOFT} drag 0.3 velocity (2, 0, -2) }}
object b {{ shape box (5, 5, 5) cm position (6.5, 0, 2) cm {HARD} velocity (-1, 0, 1) }}
liquid w {{ basin from (-7, -7, -7) cm to (10, 7, 20) cm density 1000 level -5 cm drag 4 model surface }}
control {{ time 0.5 s resolution 1 cm contact-model paper }}
"""
TEXTS = {
    "a splash, waves": SPLASH.replace("MODEL", "waves"),
    "a splash, surface": SPLASH.replace("MODEL", "surface"),
    "a splash, paper": SPLASH.replace("MODEL", "paper"),
    "a heap": HEAP,
    "a heap in air": f"air {{ }}\n{HEAP}",
    "a splash in air": f"air {{ }}\n{SPLASH.replace('MODEL', 'waves')}",
    "contact of the paper": BARRIER,
}
"""Scenes in which much happens in a short time."""
QUICK = ("cards", "dam", "drop", "swell", "tower", "bounce", "meeting", "ring")
"""Files that the quick form has too."""


class Way(NamedTuple):
    """How steps are taken."""

    style: str
    ranks: int

    def __str__(self) -> str:
        return f"{self.style.removeprefix('verlet/mdanim width ')}, {self.ranks} rank{'s' * (self.ranks > 1)}"


def ways(quick: bool) -> list[Way]:
    """All of them, or those of the quick form."""
    widths = [width for width in WIDTHS if runs_here(width)]
    few = ["verlet", *(f"verlet/mdanim width {width} threads {n}" for width, n in zip(widths, (2, 4, 1)))]
    if quick:
        return [*(Way(style, 1) for style in few), Way(few[1], 2)]
    all_alone = ["verlet", *(f"verlet/mdanim width {width} threads {n}" for width in widths for n in (1, 2, 4))]
    return [*(Way(style, 1) for style in all_alone), *(Way(style, 2) for style in few)]  # ranks wait for each other


def files() -> dict[str, Path]:
    """Scenes by name. Those without a control block are parts of others."""
    paths = [*sorted((ROOT / "scenes").glob("**/*.txt")), *sorted((ROOT / "tests" / "reference").glob("*.txt"))]
    return {path.stem: path for path in paths if "control" in path.read_text(encoding="utf-8")}


def plan_of(name: str):
    """Plan to run for a scene."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene, parse_scene

    return prepare(parse_scene(HEAD + TEXTS[name]) if name in TEXTS else load_scene(files()[name])).plan


def middle_of(plan):
    """Step and state in the middle of a run."""
    from mdanim_lammps.engine.instance import Instance

    steps = int(min(WARM_PART * plan.certificate.steps, WARM_PARTICLE_STEPS / max(1, plan.system.particles)))
    with Instance(plan) as instance:
        instance.setup()
        instance.run(max(1, steps))
        return instance.step, instance.state()


def hashes(instance) -> dict[str, str]:
    """Hashes of all that a run comes to."""
    from mdanim_lammps.engine.state import NO_RECORDS
    from mdanim_lammps.run.energy import energies

    center = instance.plan.system.center_of_mass(instance.array("x"))
    ledger = np.array(list(energies(instance, center).values()))
    records = instance.records()
    liquid = records.pop("liquid", NO_RECORDS).data
    arrays = {
        **{name: [instance.array(name)] for name in "xvf"},
        "records": [a for _, r in sorted(records.items()) for a in (r.keys, r.first, r.data)] + [np.delete(liquid, ACCOUNTS)],
        "ledger": [ledger, liquid[ACCOUNTS]],
    }
    return {
        name: hashlib.sha256(b"".join(np.ascontiguousarray(a).tobytes() for a in some)).hexdigest()[:16]
        for name, some in arrays.items()
    }


def run(plan, middle, style: str, steps: int, comm) -> dict[str, str]:
    """Hashes after some steps from the beginning, and after as many from the middle."""
    from mdanim_lammps.engine.instance import Instance

    with Instance(plan, comm) as instance:
        instance.lammps.lmp.command(f"run_style {style}")
        instance.setup()
        instance.run(steps)
        found = {f"{name}, beginning": value for name, value in hashes(instance).items()}
        instance.put(*middle)
        instance.run(steps)
        return found | {f"{name}, middle": value for name, value in hashes(instance).items()}


def work(folder: Path, styles: list[str], steps: int) -> None:
    """Run all scenes whose plans lie in a folder, on the ranks that there are; one line of JSON for each on standard output."""
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    for path in sorted(folder.glob("*.plan")):
        name, plan, middle = pickle.loads(path.read_bytes())
        if comm.rank == 0:
            print(f"{name} on {comm.size} rank{'s' * (comm.size > 1)} ...", file=sys.stderr, flush=True)
        for style in styles:
            found = run(plan, middle, style, steps, comm)
            if comm.rank == 0:
                print(json.dumps([name, str(Way(style, comm.size)), found]), flush=True)


def measure(names: list[str], chosen: list[Way], steps: int) -> Iterator[tuple[str, str, dict[str, str]]]:
    """Scene, way and hashes, in the order in which they come."""
    os.environ["MDANIM_LEAST_TASK"] = EAGER
    with tempfile.TemporaryDirectory() as folder:
        for n, name in enumerate(names):
            print(f"{name} ...", file=sys.stderr, flush=True)
            plan = plan_of(name)
            Path(folder, f"{n:03}.plan").write_bytes(pickle.dumps((name, plan, middle_of(plan))))
        for ranks in sorted({way.ranks for way in chosen}):
            styles = [way.style for way in chosen if way.ranks == ranks]
            start = [str(Path(sys.executable).parent / "mpiexec"), "-n", str(ranks)] if ranks > 1 else []
            words = [sys.executable, "-m", "mpi4py", __file__, "--work", folder, "--styles", *styles, "--steps", str(steps)]
            with subprocess.Popen([*start, *words], stdout=subprocess.PIPE, text=True) as process:
                for line in process.stdout:
                    yield tuple(json.loads(line))
            if process.returncode:
                raise SystemExit(f"bits.py: the run on {ranks} ranks ended with exit code {process.returncode}")


def short(quantity: str, found: dict[str, dict[str, str]]) -> str:
    """The hash that all ways of a scene have, and those that have another."""
    first, *_ = (values[quantity] for values in found.values())
    others = [way for way, values in found.items() if values[quantity] != first]
    return first[:8] + (f" **not {'; '.join(others)}**" if others and quantity.startswith(SAME) else "")


def table(hashed: dict[str, dict[str, dict[str, str]]]) -> Iterator[str]:
    """Lines of a table in Markdown: a scene's hashes by the first way."""
    columns = [f"{name}, {where}" for where in ("beginning", "middle") for name in (*SAME, *ROUNDED)]
    yield f"| scene | {' | '.join(columns)} |"
    yield "|---" * (len(columns) + 1) + "|"
    for scene, found in hashed.items():
        yield f"| {scene} | {' | '.join(short(column, found) for column in columns)} |"


def apart(hashed: dict[str, dict[str, dict[str, str]]]) -> list[str]:
    """Scenes whose ways give other bits than one another."""
    wrong = []
    for scene, found in hashed.items():
        quantities = [q for q in next(iter(found.values())) if q.startswith(SAME)]
        if names := [q for q in quantities if len({values[q] for values in found.values()}) > 1]:
            wrong.append(f"{scene}: the ways differ in {'; '.join(names)}")
    return wrong


def compare(hashed: dict, stored: dict) -> list[str]:
    """Differences from the stored ones, of the scenes and ways that both have."""
    wrong, compared = [], 0
    for scene, found in hashed.items():
        for way, values in found.items():
            if known := stored.get(scene, {}).get(way):
                compared += 1
                if names := [q for q in values if values[q] != known.get(q)]:
                    wrong.append(f"{scene} by {way}: {'; '.join(names)}")
    return wrong if compared else ["nothing to compare: the file has none of these scenes and ways"]


def main() -> int:
    """Run, print the table, store or compare; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--write", type=Path, metavar="FILE")
    parser.add_argument("--against", type=Path, metavar="FILE")
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--work", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--styles", nargs="*", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        work(options.work, options.styles, options.steps)
        return 0
    known = [*TEXTS, *files()]
    if unknown := set(options.scenes) - set(known):
        parser.error(f"unknown: {', '.join(sorted(unknown))}; scenes are {', '.join(known)}")
    names = options.scenes or [name for name in known if not options.quick or name in TEXTS or name in QUICK]
    stored = json.loads(options.against.read_text()) if options.against else None
    hashed: dict[str, dict[str, dict[str, str]]] = {name: {} for name in names}
    for scene, way, found in measure(names, ways(options.quick), options.steps):
        hashed[scene][way] = found
    print("\n".join(table(hashed)))
    wrong = apart(hashed) + (compare(hashed, stored["hashes"]) if stored else [])
    if options.write:
        options.write.write_text(json.dumps({"steps": options.steps, "hashes": hashed}, indent=1) + "\n")
    if stored:
        print(f"\nas in {options.against}" if not wrong else "")
    print("\n".join(wrong), file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
