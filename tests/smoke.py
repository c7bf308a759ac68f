# SPDX-License-Identifier: GPL-2.0-only
"""First steps of a stranger with an installed package and nothing else: ``python tests/smoke.py`` (``make smoke``)."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import mdanim_lammps
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.export.write import export

BIN = Path(sys.executable).parent
TEXT = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object cube { shape box (10, 10, 10) cm  position (0, 0, 20) cm  mass 1 kg  elasticity 300 kPa }
control { time 0.3 s  resolution 5 cm }
render { size (640, 360) }
expect energy.residual = 0 +- 1e-2
"""


def run(*command) -> str:
    """A command of the environment, by its name."""
    done = subprocess.run([BIN / command[0], *command[1:]], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
    return done.stdout


def main() -> None:
    """Each step prints a line."""
    installed = Path(mdanim_lammps.__file__).parent
    assert installed.is_relative_to(sys.prefix), f"{installed} is not what was installed into {sys.prefix}"
    assert (installed / "py.typed").exists() and (installed / "view" / "web" / "index.html").exists()
    print(run("mdanim-lammps", "doctor"), end="")
    assert run("mdanim-lammps", "--version").strip() == mdanim_lammps.__version__
    run("mdanim-lammps", "init", "first")
    run("mdanim-lammps", "check", "first.txt")
    Path("cube.txt").write_text(TEXT)
    run("mdanim-lammps", "cube.txt")
    assert Path("cube.out/movie.mp4").stat().st_size > 10_000
    with Trajectory("cube.out") as t:
        assert len(t) == 10 and t.objects["cube"].center_of_mass[-1, 2] < 0.2
    run("mdanim-lammps", "cube.txt", "-n", "2", "-o", "two.out", "--no-movie")
    assert "every bit" in run("mdanim-lammps", "compare", "cube.out", "two.out")
    run("mdanim-lammps", "report", "cube.out")
    run("mdanim-lammps", "export", "cube.out", "--to", "csv")
    for to in ("gltf", "vtk", "xyz", "xtc", "lammpstrj"):
        assert export("cube.out", to).frames == 10
    run("mdanim-lammps", "build", "cube.txt", "-o", "plain.out")
    subprocess.run([BIN / "lmp", "-in", "in.cube"], cwd="plain.out", check=True, capture_output=True)
    assert Path("plain.out/cube.lammpstrj").read_bytes()[:5000].count(b"ITEM") > 3
    assert abs(Scene.load("cube.txt").run("again.out").ledger.residual) < 1e-2
    print(f"mdanim-lammps {mdanim_lammps.__version__} works in {sys.prefix}, Python {sys.version.split()[0]}")


if __name__ == "__main__":
    import os

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main()
        os.chdir("/")
