# SPDX-License-Identifier: GPL-2.0-only
"""PyBullet, deformable world: neo-Hookean tetrahedra, five in each cell of the same grid of nodes, implicit."""

import tempfile
from importlib.metadata import version
from itertools import product
from pathlib import Path

import numpy as np
import pybullet
from clock import run, tell, words

_, case = words()
h = case["h"]
n = round(1.0 / h) + 1
DT = 2e-3
CORNERS = {
    0: [(0, 3, 5, 6), (0, 1, 3, 5), (0, 2, 3, 6), (0, 4, 5, 6), (3, 5, 6, 7)],
    1: [(1, 2, 4, 7), (0, 1, 2, 4), (1, 2, 3, 7), (1, 4, 5, 7), (2, 4, 6, 7)],
}
"""Tetrahedra of a cell by corners x + 2 y + 4 z; neighbours are mirrored, so that their faces fit."""
nodes = np.array(list(product(range(n), repeat=3)), float) * h
cells = []
for i, j, k in product(range(n - 1), repeat=3):
    corner = [((i + (c & 1)) * n + j + (c >> 1 & 1)) * n + k + (c >> 2) for c in range(8)]
    for t in CORNERS[(i + j + k) % 2]:
        a, b, c, d = (corner[m] for m in t)
        if np.linalg.det(nodes[[b, c, d]] - nodes[a]) < 0.0:
            c, d = d, c
        cells.append((a, b, c, d))
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "cube.vtk"
    with path.open("w") as out:
        out.write(f"# vtk DataFile Version 2.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(nodes)} double\n")
        out.writelines("{:.9g} {:.9g} {:.9g}\n".format(*p) for p in nodes)
        out.write(f"CELLS {len(cells)} {5 * len(cells)}\n")
        out.writelines("4 {} {} {} {}\n".format(*c) for c in cells)
        out.write(f"CELL_TYPES {len(cells)}\n" + "10\n" * len(cells))
    pybullet.connect(pybullet.DIRECT)
    pybullet.resetSimulation(pybullet.RESET_USE_DEFORMABLE_WORLD)
    pybullet.setGravity(0, 0, -9.81)
    pybullet.setTimeStep(DT)
    floor = pybullet.createCollisionShape(pybullet.GEOM_PLANE)
    pybullet.createMultiBody(0, floor)
    nu, young = 0.25, case["young"]
    body = pybullet.loadSoftBody(
        str(path),
        basePosition=[0, 0, case["z"] - 0.5],
        mass=case["density"],
        useNeoHookean=1,
        NeoHookeanMu=young / (2 * (1 + nu)),
        NeoHookeanLambda=young * nu / ((1 + nu) * (1 - 2 * nu)),
        NeoHookeanDamping=0.01,
        useFaceContact=1,
        collisionMargin=0.006,
    )
if body < 0:
    raise SystemExit("loadSoftBody did not take the mesh")
found = run(lambda count: [pybullet.stepSimulation() for _ in range(count)], DT, case["time"], case["limit"], 1)
place = np.array(pybullet.getMeshData(body, -1, flags=pybullet.MESH_DATA_SIMULATION_MESH)[1])
if not np.isfinite(place).all():
    raise SystemExit("the positions are not numbers")
tell(version=version("pybullet"), nodes=len(nodes), **found)
