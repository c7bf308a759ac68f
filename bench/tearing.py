# SPDX-License-Identifier: GPL-2.0-only
"""Toughness of sheets and solids: the constant c of e^2 = c G/(E h), from the matrix of springs of a strip with a slit.

A strip of the height H between two sides that are held apart by u, with a slit from its end to the middle, tears on where the
spring at the end of the slit is strained by e. It then releases G = E (u/H)^2 H/2 (1 - nu^2) for each area, which is far ahead of
the slit stored above and below it (Rivlin and Thomas 1953). nu is that of the body, 1/3 of a sheet, 1/4 of a solid.
"""

import numpy as np
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

BODIES = {
    "sheet, slit along rows": ("sheet (0.6, 0.3) m thickness 1 mm bending 0", 0, 1, 1 / 3),
    "sheet, slit across rows": ("sheet (0.3, 0.6) m thickness 1 mm bending 0", 1, 0, 1 / 3),
    "solid": ("box (0.6, 0.3, {depth}) m", 0, 1, 1 / 4),
}
SCENE = """
object a {{ shape {shape} position (0, 0, 1) m density 1000 elasticity 1 MPa resolution {h} m {hold} }}
control {{ time 1 s }}
"""


def constant(shape: str, along: int, across: int, nu: float, h: float) -> tuple[float, float]:
    """c, and the spacing that is reached [m]; the strip is pulled along the axis ``across``."""
    hold = "hold faces " + "xyz"[across]
    system = prepare(parse_scene(SCENE.format(shape=shape.format(depth=4 * h), h=h, hold=hold))).system
    x = system.position - system.position.mean(axis=0)
    size = np.ptp(x, axis=0)
    k, pair = system.stiffness, system.spring
    i, j = pair.T
    planes = np.unique(x[:, across].round(9))
    upper = int(np.searchsorted(planes, 1e-9))
    level = 0.5 * (planes[upper - 1] + planes[upper])  # a slit near the middle, between particles
    cut = ((x[i, across] - level) * (x[j, across] - level) < 0) & (0.5 * (x[i, along] + x[j, along]) < 0.0)
    n = (x[i] - x[j]) / np.linalg.norm(x[i] - x[j], axis=1)[:, None]
    block = np.where(cut, 0.0, k)[:, None, None] * n[:, :, None] * n[:, None, :]
    rows, columns, values = [], [], []
    for a in range(3):
        for b in range(3):
            w = block[:, a, b]
            for p, q, sign in ((i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)):
                rows.append(3 * p + a)
                columns.append(3 * q + b)
                values.append(sign * w)
    many = 3 * len(x)
    matrix = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(many, many)).tocsr()
    moved = np.zeros((len(x), 3))
    moved[system.held, across] = 0.5 * np.sign(x[system.held, across])
    fixed = np.repeat(system.held, 3).reshape(-1, 3)
    if "sheet" in shape:
        fixed[:, 2] = True
    free = np.flatnonzero(~fixed.ravel())
    u = moved.ravel()
    u[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix @ u)[free])
    u = u.reshape(-1, 3)
    strain = np.einsum("sd,sd->s", u[i] - u[j], n) / np.linalg.norm(x[i] - x[j], axis=1)
    inside = np.abs(0.5 * (x[i, along] + x[j, along])) < 0.3 * size[along]
    largest = strain[~cut & inside].max()  # of u = 1
    spacing = float(system.spacing[0])
    return 2.0 * (1.0 - nu**2) * (largest * size[across]) ** 2 * spacing / size[across], spacing


if __name__ == "__main__":
    print("| body | h [m] | c |\n| --- | --- | --- |")
    for name, (shape, along, across, nu) in BODIES.items():
        for h in (0.03, 0.02, 0.01) if name == "solid" else (0.02, 0.01, 0.005):
            c, reached = constant(shape, along, across, nu, h)
            print(f"| {name} | {reached:.4g} | {c:.3f} |")
