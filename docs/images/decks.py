# SPDX-License-Identifier: GPL-2.0-only
"""Make the pictures of the input scripts in scenes/lammps: ``python docs/images/decks.py [NAME ...]`` runs them; default all."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyvista
from mdanim_lammps.engine.plugin import open_library
from mdanim_lammps.picture.palette import OBJECTS, STILL

HERE = Path(__file__).parent
DECKS = HERE.parent.parent / "scenes" / "lammps"
PICTURES = {
    "two_blocks": 0.6,
    "two_cubes": 0.6,
    "pool": 1.0,
    "cantilever": 1.0,
    "bowl": 1.0,
    "tumble": 0.6,
    "shaker": 0.5,
    "crank": 0.3,
    "ropes": 0.6,
    "air": 0.5,
    "satellite": 0.5,
}
"""Script, and which part of its run has passed in the picture."""
SIZE = (480, 360)


def draw(name: str, part: float) -> None:
    """Run a script and write lammps-NAME.png: particles as balls, a colour for each molecule, held ones grey."""
    with tempfile.TemporaryDirectory() as folder:
        for file in DECKS.iterdir():
            shutil.copy(file, folder)
        subprocess.run([Path(sys.executable).parent / "lmp", "-in", f"in.{name}"], cwd=folder, check=True, capture_output=True)
        blocks = (Path(folder) / f"{name}.lammpstrj").read_text().split("ITEM: TIMESTEP\n")[1:]
    lines = blocks[round(part * (len(blocks) - 1))].split("ITEM: ATOMS")[1].splitlines()[1:]
    table = np.array([line.split() for line in lines], float)
    picture = pyvista.Plotter(off_screen=True, window_size=SIZE)
    picture.set_background("white")
    for molecule in np.unique(table[:, 1]):
        for kind in (1, 2):
            found = table[(table[:, 1] == molecule) & (table[:, 2] == kind), 3:6]
            color = STILL if name == "cantilever" and kind == 2 else OBJECTS[int(molecule) % len(OBJECTS)]
            if len(found):
                picture.add_mesh(
                    pyvista.PolyData(found).glyph(geom=pyvista.Sphere(radius=0.42), scale=False, orient=False), color=color
                )
    if name == "bowl":
        bowl = pyvista.Sphere(radius=12, center=(0, 0, 6), theta_resolution=60, phi_resolution=60).clip("z", origin=(0, 0, 3))
        picture.add_mesh(bowl, color="#c9d4dc", opacity=0.35)
    if name == "pool":
        picture.add_mesh(pyvista.Box((0, 20, 0, 16, 0, 8)), color="#2a8fb8", opacity=0.35)
    picture.camera_position = "xz"
    picture.camera.azimuth, picture.camera.elevation = -30, 20
    picture.reset_camera(bounds=picture.bounds)
    picture.camera.zoom(1.1)
    picture.screenshot(HERE / f"lammps-{name}.png")
    picture.close()


if __name__ == "__main__":
    open_library()  # names the plugin's folder to the lmp that is started below
    for name in sys.argv[1:] or PICTURES:
        draw(name, PICTURES[name])
