# SPDX-License-Identifier: GPL-2.0-only
"""Whether a change makes scenes slower: ``python bench/against.py OTHER [rounds]``.

OTHER is a clone of another version with a plugin that was built there. The first moments of scenes of OTHER are run by both, in
turns, each on one thread without a movie and without what the scene expects; printed are processor seconds of whole runs, start
included, the least of all rounds.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import one_thread  # noqa: F401
from around import spent
from timing import interleaved, markdown

OURS = Path(__file__).resolve().parent.parent
SECONDS = {
    "beam": 0.5, "crowd": 0.15, "pile": 0.1, "float": 0.3, "densities": 0.3, "dominoes": 1.0, "cards": 0.3, "wake": 0.5,
    "dam": 0.2, "billiard": 0.5, "plates": 0.1, "seesaw": 0.5, "flag": 0.1, "tower": 0.2, "bowling": 0.5,
}  # fmt: skip
"""How much of each scene is run [s]."""


def shortened(text: str, seconds: float) -> str:
    """A scene that ends earlier and expects nothing."""
    text = re.sub(r"(control\s*\{[^}]*?\btime\s+)[^\n}]*?m?s\b", rf"\g<1>{seconds} s", text, count=1)
    return "\n".join(line for line in text.split("\n") if not line.strip().startswith("expect"))


def run(tree: Path, scene: Path, out: Path) -> float:
    """Processor seconds of a run by the program of a tree."""
    package = tree / "python"
    paths = {"PYTHONPATH": str(package), "LAMMPS_PLUGIN_PATH": str(package / "mdanim_lammps" / "plugin")}
    settings = {"MDANIM_THREADS": "1", "PYTHONPYCACHEPREFIX": str(out.parent / "compiled"), "PYTHONDONTWRITEBYTECODE": ""}
    words = [sys.executable, "-m", "mdanim_lammps", str(scene), "-o", str(out), "--force", "--no-movie", "-q"]
    start = spent()
    subprocess.run(words, check=True, timeout=600, env=os.environ | paths | settings, cwd=out.parent)
    return spent() - start


def main() -> None:
    """Print a row for each scene."""
    other, rounds = Path(sys.argv[1]).resolve(), int(sys.argv[2]) if len(sys.argv) > 2 else 3
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, seconds in SECONDS.items():
            scene = other / "scenes" / f"against-{name}.txt"  # beside the files that it names
            scene.write_text(shortened((other / "scenes" / f"{name}.txt").read_text(), seconds))
            try:
                outs = {tree: Path(folder) / tree.name / name for tree in (other, OURS)}
                for out in outs.values():
                    out.parent.mkdir(exist_ok=True)
                found = interleaved({tree: lambda tree=tree: run(tree, scene, outs[tree]) for tree in outs}, rounds)
            finally:
                scene.unlink()
            steps = json.loads((outs[OURS] / "cost.json").read_text())["steps"]
            before, now = found[other].least, found[OURS].least
            rows.append((name, seconds, steps, f"{before:.2f}", f"{now:.2f}", f"{now / before:.2f}"))
            print(*rows[-1], file=sys.stderr, flush=True)
    print(markdown(["scene", "of it [s]", "steps", "before [processor s]", "now", "ratio"], rows))


if __name__ == "__main__":
    main()
