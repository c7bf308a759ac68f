# SPDX-License-Identifier: GPL-2.0-only
"""Taichi, one CPU thread, double precision: our particles and springs, both ends gathered, one pass for forces and one for motion."""

import numpy as np
import taichi as ti
from clock import run, tell, words

ti.init(arch=ti.cpu, cpu_max_num_threads=1, default_fp=ti.f64, log_level=ti.ERROR)
_, case = words()
lattice = np.load(case["lattice"])
n, dt = len(lattice["mass"]), float(lattice["dt"])
owner = np.concatenate([lattice["pair"][:, 0], lattice["pair"][:, 1]])
partner = np.concatenate([lattice["pair"][:, 1], lattice["pair"][:, 0]])
order = np.lexsort((partner, owner))
first = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=n))]).astype(np.int32)


def field(values: np.ndarray, kind):
    """A field that holds an array."""
    made = ti.Vector.field(3, kind, len(values)) if values.ndim == 2 else ti.field(kind, len(values))
    made.from_numpy(np.ascontiguousarray(values))
    return made


x, v = field(lattice["position"], ti.f64), field(np.zeros((n, 3)), ti.f64)
inverse, begin = field(1.0 / lattice["mass"], ti.f64), field(first, ti.i32)
other = field(partner[order].astype(np.int32), ti.i32)
stiff, rest = (field(np.tile(lattice[name], 2)[order], ti.f64) for name in ("stiffness", "length"))
floor = float(lattice["stiffness"].max())


@ti.kernel
def kick():
    for i in x:
        f = ti.Vector([0.0, 0.0, 0.0])
        for s in range(begin[i], begin[i + 1]):
            d = x[other[s]] - x[i]
            r = d.norm()
            f += stiff[s] * (1.0 - rest[s] / r) * d
        f[2] -= floor * ti.min(x[i][2], 0.0)
        v[i] += dt * (f * inverse[i] + ti.Vector([0.0, 0.0, -9.81]))


@ti.kernel
def drift():
    for i in x:
        x[i] += dt * v[i]


def steps(count: int) -> None:
    for _ in range(count):
        kick()
        drift()


found = run(steps, dt, case["time"], case["limit"], 20)
if not np.isfinite(x.to_numpy()).all():
    raise SystemExit("the positions are no numbers")
tell(version=ti.__version__ if isinstance(ti.__version__, str) else ".".join(map(str, ti.__version__)), nodes=n, **found)
