# SPDX-License-Identifier: GPL-2.0-only
"""Whether a change makes scenes slower: ``python bench/against.py OTHER [scene ...]``.

OTHER is a clone of another version with a plugin that was built there. Both run the first moments of its scenes side by side, on
one thread each and piece by piece in turns, so that both see the same machine. Printed are processor seconds to the first step,
steps to the end, as a time step may have changed, and the time of a step. A frame's output is not in it.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import one_thread  # noqa: F401
from timing import markdown

OURS = Path(__file__).resolve().parent.parent
SECONDS = {
    "beam": 1.0, "crowd": 0.3, "pile": 0.3, "float": 0.6, "densities": 0.6, "dominoes": 1.0, "cards": 0.3, "wake": 0.5,
    "dam": 0.5, "billiard": 0.5, "plates": 0.2, "seesaw": 0.5, "flag": 0.2, "tower": 0.3, "bowling": 0.5,
}  # fmt: skip
"""How much of each scene is run [s]."""
PIECES = 24


def serve(path: Path, seconds: float) -> None:
    """Prepare the scene, then run a piece of it for each line that is read; answers are lines of JSON."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    plan = prepare(load_scene(path)).plan
    steps = round(seconds / plan.certificate.timestep)
    with Instance(plan) as instance:
        instance.setup()
        print(json.dumps({"start": time.process_time(), "steps": steps}), flush=True)
        for piece, _ in enumerate(sys.stdin):
            count = steps * (piece + 1) // PIECES - steps * piece // PIECES
            start = time.process_time()
            instance.run(count)
            print(json.dumps((time.process_time() - start) / count), flush=True)


def started(tree: Path, path: Path, seconds: float, compiled: str) -> subprocess.Popen:
    """A process that serves the scene with the program of a tree, whose compiled modules lie in a folder."""
    package = tree / "python"
    settings = {
        "PYTHONPATH": f"{package}:{OURS / 'bench'}", "LAMMPS_PLUGIN_PATH": str(package / "mdanim_lammps" / "plugin"),
        "PYTHONPYCACHEPREFIX": compiled, "PYTHONDONTWRITEBYTECODE": "",
    }  # fmt: skip
    code = f"import against; from pathlib import Path; against.serve(Path({str(path)!r}), {seconds})"
    return subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=os.environ | settings
    )


def compared(other: Path, name: str, compiled: str) -> tuple:
    """Row of a scene."""
    processes = [started(tree, other / "scenes" / f"{name}.txt", SECONDS[name], compiled) for tree in (other, OURS)]
    before, now = (json.loads(process.stdout.readline()) for process in processes)
    took: list[list[float]] = [[], []]
    for piece in range(PIECES):
        for process, own in list(zip(processes, took))[:: 1 if piece % 2 == 0 else -1]:
            process.stdin.write("\n")
            process.stdin.flush()
            own.append(1e6 * json.loads(process.stdout.readline()))
    for process in processes:
        process.communicate()
    ratio = statistics.median(b / a for a, b in zip(*took))
    means = [statistics.mean(own) for own in took]
    return (
        name, f"{before['start']:.2f}", f"{now['start']:.2f}", before["steps"], now["steps"], *(f"{m:.0f}" for m in means),
        f"{means[1] / means[0]:.2f}", f"{ratio:.2f}",
    )  # fmt: skip


def main() -> None:
    """Print a row for each scene that OTHER has."""
    other, rows = Path(sys.argv[1]).resolve(), []
    with tempfile.TemporaryDirectory() as compiled:
        for tree in (other, OURS):
            started(tree, other / "scenes" / "float.txt", 0.0, compiled).communicate()
        for name in sys.argv[2:] or [name for name in SECONDS if (other / "scenes" / f"{name}.txt").exists()]:
            rows.append(compared(other, name, compiled))
            print(*rows[-1], file=sys.stderr, flush=True)
    heads = ["scene", "start before [processor s]", "now", "steps before", "now", "a step before, mean [us]", "now"]
    print(markdown([*heads, "ratio", "median of pieces"], rows))


if __name__ == "__main__":
    main()
