# SPDX-License-Identifier: GPL-2.0-only
"""A semicircular arch of wedges under its own weight: how thick, and how rough, it has to be to stand.

`statics` asks a linear program whether forces exist in all joints of the same finite wedges that hold each of them: two normal
forces at the edges of a joint, which push, and one along it, of at most mu times both (Livesley 1978). With 100 wedges it has the
published limits of thickness and of friction, 0.1074 and 0.3092.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from mdanim_lammps.scene.scene import SceneRecord
from mdanim_lammps.scene.shapes import Mesh
from scipy.optimize import linprog

from .case import SCENES, Case, Curve, Found, Row, Runs
from .standing import least

STONES = 20
MESHES = {thin: SCENES / "meshes" / f"voussoir_{round(100 * thin):02d}.stl" for thin in (0.09, 0.15, 0.25)}
"""Files of the scenes: a stone for a radius of 1 m, by t/R."""


def faces(thin: float, stones: int = STONES) -> tuple[float, float]:
    """Distances of the inner and the outer face from the middle of the arch, for R = 1."""
    leans = np.cos(0.5 * np.pi / stones)
    return (1.0 - 0.5 * thin) * leans, (1.0 + 0.5 * thin) * leans


def voussoir(path: Path, thin: float, wide: float = 0.3) -> None:
    """Write a stone as STL [m], whose sides point to the origin and whose middle is above it."""
    corners = [
        [(x * r * np.tan(0.5 * np.pi / STONES), y * wide / 2.0, r) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        for r in faces(thin)
    ]
    sides = [(3, 2, 1, 0), (4, 5, 6, 7), *((k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4) for k in range(4))]
    triangles = np.array([three for a, b, c, d in sides for three in ((a, b, c), (a, c, d))])
    rows = np.zeros(len(triangles), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]))
    rows["corners"] = np.concatenate(corners)[triangles]
    path.write_bytes(bytes(80) + np.uint32(len(rows)).tobytes() + rows.tobytes())


def statics(thin: float, mu: float, stones: int = STONES) -> tuple[float, float] | None:
    """Least and largest thrust at the crown over weight per volume, t R: forces that hold all stones; None where none do."""
    joints = np.pi * np.arange(stones + 1) / stones - 0.5 * np.pi
    lo, hi = faces(thin, stones)
    area, r = (hi**2 - lo**2) * np.tan(0.5 * np.pi / stones), 2.0 / 3.0 * (hi**3 - lo**3) / (hi**2 - lo**2)
    balance, weights = np.zeros((3 * stones, 3 * len(joints))), np.zeros(3 * stones)
    for k in range(stones):
        middle = 0.5 * (joints[k] + joints[k + 1])
        centre = r * np.array([np.sin(middle), np.cos(middle)])
        weights[3 * k + 1] = area
        for j, sign in ((k, 1.0), (k + 1, -1.0)):
            out, across = np.array([np.sin(joints[j]), np.cos(joints[j])]), np.array([np.cos(joints[j]), -np.sin(joints[j])])
            for part, (at, force) in enumerate(((1.0 - 0.5 * thin, across), (1.0 + 0.5 * thin, across), (1.0, out))):
                (x, z), (fx, fz) = at * out - centre, sign * force
                balance[3 * k : 3 * k + 3, 3 * j + part] = fx, fz, x * fz - z * fx
    slips = np.zeros((2 * len(joints), 3 * len(joints)))
    for j in range(len(joints)):
        slips[2 * j : 2 * j + 2, 3 * j : 3 * j + 3] = (-mu, -mu, 1.0), (-mu, -mu, -1.0)
    crown = np.zeros(3 * len(joints))
    crown[3 * (stones // 2) : 3 * (stones // 2) + 2] = 1.0 / thin
    ends = []
    for sign in (1.0, -1.0):
        bounds = [(0.0, None), (0.0, None), (None, None)] * len(joints)
        found = linprog(sign * crown, slips, np.zeros(len(slips)), balance, weights, bounds)
        if not found.success:
            return None
        ends.append(sign * found.fun)
    return ends[0], ends[1]


def of(path: Path, scene: SceneRecord) -> SceneRecord:
    """The scene with stones of this file."""
    stones = tuple(replace(one, shape=Mesh(path)) if isinstance(one.shape, Mesh) else one for one in scene.solids)
    return replace(scene, solids=stones)


def stands(runs: Runs, thin: float, mu: float) -> bool:
    """Whether the crown has sunk by less than half of the thickness in the end."""
    path = MESHES.get(thin)
    if path is None:
        path = runs.folder() / "stone.stl"
        voussoir(path, thin)
    z = runs.run("arch", partial(of, path), thin=thin, mu=mu).trajectory.objects[f"stone[{STONES // 2}]"].center_of_mass[:, 2]
    return bool(z[0] - z[-1] < 0.5 * thin)


def limit(held: Callable[[float], bool], low: float, high: float) -> float:
    """The same of statics, to four digits."""
    return least(held, low, high, 14)


def arch(runs: Runs) -> Found:
    """Limits of thickness and of friction, by halving."""
    rows, found = [], []
    thickness = least(lambda thin: stands(runs, thin, 0.6), 0.09, 0.13, 4)
    rows.append(Row("least t/R at friction 0.6", 0.107426, thickness, 0.04))
    found.append((thickness, 0.6))
    for thin, low, high, published in ((0.15, 0.30, 0.40, None), (0.25, 0.27, 0.35, 0.309215)):
        needed = published or limit(lambda mu, thin=thin: statics(thin, mu) is not None, low, high)
        friction = least(lambda mu, thin=thin: stands(runs, thin, mu), low, high, 3)
        rows.append(Row(f"least friction at t/R {thin:g}", needed, friction, 0.02))
        found.append((thin, friction))
    thick = np.array([0.11, 0.12, 0.13, 0.15, 0.17, 0.19, 0.21, 0.25])
    needs = [limit(lambda mu, thin=thin: statics(thin, mu) is not None, 0.25, 0.5) for thin in thick]
    line = {"statics of twenty stones": ((thick[0], *thick), (0.62, *needs))}
    points = {"Cocchetti and Rizzi": ((0.107426, 0.200637), (0.395832, 0.309215)), "here": tuple(zip(*found))}
    return Found(rows, Curve("t/R", "least friction", line, points))


CASES = [
    Case(
        "arch",
        "A masonry arch",
        "Cocchetti and Rizzi 2020",
        "Cocchetti and Rizzi, Frattura ed Integrità Strutturale 51 (2020) 356, Table 3: t/R = 0.107426 from μ = 0.3958 on; "
        "nothing stands below μ = 0.3092. Friction at t/R = 0.15 lies between both; its limit is that of statics of the same "
        "twenty stones by linear programming (bench/published/arches.py, which gives the published limits, too).",
        "2 % of friction, 4 % of thickness: found by halving intervals three or four times, to 2 % and 1 % of the figure. Joints "
        "give way a little, so that hinges are inside of their edges and a thin arch has to be thicker.",
        "Weight grows from nothing in a second, as when the centering is lowered, and `contact-stiffness` is 10. With the usual "
        "one joints give way more: the arch of t/R = 0.15 then stands with friction 0.40 and falls with 0.36, and where it has "
        "to bear its weight at once it falls with 0.40 and stands with 0.45.",
        arch,
        peers=True,
    )
]
