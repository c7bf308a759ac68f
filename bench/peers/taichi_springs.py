# SPDX-License-Identifier: GPL-2.0-only
"""Taichi, one CPU thread, double precision: our particles and springs, written in two ways.

The usual way: each particle gathers its springs, one kernel for forces and one for motion, which any number of
threads could share. Told ``serial``: each spring once, its particle moves at once, many steps in one kernel; this is faster, and
for one thread only, as two particles at a time would add to the same third.
"""

import numpy as np
import taichi as ti
from clock import run, tell, words

ti.init(arch=ti.cpu, cpu_max_num_threads=1, default_fp=ti.f64, log_level=ti.ERROR)
_, case = words()
lattice = np.load(case["lattice"])
n, dt = len(lattice["mass"]), float(lattice["dt"])
serial = case["way"] == "serial"
pair, copies = lattice["pair"], 1 if serial else 2
owner, partner = pair.T if serial else np.concatenate([pair, pair[:, ::-1]]).T
order = np.lexsort((partner, owner))
first = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=n))]).astype(np.int32)


def field(values: np.ndarray, kind):
    """A field that holds an array."""
    made = ti.Vector.field(3, kind, len(values)) if values.ndim == 2 else ti.field(kind, len(values))
    made.from_numpy(np.ascontiguousarray(values))
    return made


x, v, f = (field(values, ti.f64) for values in (lattice["position"], np.zeros((n, 3)), np.zeros((n, 3))))
inverse, begin = field(1.0 / lattice["mass"], ti.f64), field(first, ti.i32)
other = field(partner[order].astype(np.int32), ti.i32)
stiff, rest = (field(np.tile(lattice[name], copies)[order], ti.f64) for name in ("stiffness", "length"))
floor = float(lattice["stiffness"].max())


@ti.kernel
def kick():
    for i in x:
        force = ti.Vector([0.0, 0.0, 0.0])
        for s in range(begin[i], begin[i + 1]):
            d = x[other[s]] - x[i]
            r = d.norm()
            force += stiff[s] * (1.0 - rest[s] / r) * d
        force[2] -= floor * ti.min(x[i][2], 0.0)
        v[i] += dt * (force * inverse[i] + ti.Vector([0.0, 0.0, -9.81]))


@ti.kernel
def drift():
    for i in x:
        x[i] += dt * v[i]


@ti.kernel
def steps_at_once(count: ti.i32):
    ti.loop_config(serialize=True)
    for _ in range(count):
        for i in range(n):
            here, force = x[i], f[i]  # of lower partners, which have moved already
            for s in range(begin[i], begin[i + 1]):
                j = other[s]
                d = x[j] - here
                r = d.norm()
                pull = stiff[s] * (1.0 - rest[s] / r) * d
                force += pull
                for c in ti.static(range(3)):
                    f[j][c] = f[j][c] - pull[c]  # += would be atomic
            force[2] -= floor * ti.min(here[2], 0.0)
            f[i] = ti.Vector([0.0, 0.0, 0.0])
            v[i] += dt * (force * inverse[i] + ti.Vector([0.0, 0.0, -9.81]))
            x[i] = here + dt * v[i]


def steps(count: int) -> None:
    if serial:
        steps_at_once(count)
        return
    for _ in range(count):
        kick()
        drift()


found = run(steps, dt, case["time"], case["limit"], 20)
place = x.to_numpy()
if not np.isfinite(place).all():
    raise SystemExit("the positions are not numbers")
note = {"note": "each spring once, one thread only"} if serial else {}
tell(**note, version=ti.__version__ if isinstance(ti.__version__, str) else ".".join(map(str, ti.__version__)), nodes=n, **found)
