# SPDX-License-Identifier: GPL-2.0-only
"""Reports of executors for a planner."""

from __future__ import annotations

import numpy as np
from mdanim_lammps.parallel.plan.orders import Report

ROW = """
repeat i in 1 .. 8 {
  object cube[i] {
    shape box (10, 10, 10) cm  position (i*0.5, 0, 0) m  density 500  elasticity 100 kPa  velocity (20 - 4*i, 0, 0) m/s
  }
}
control { time 0.1 s  frames 50 fps  resolution 5 cm }
"""


def report(parts, owner, cost=1000, shift=0.0, speed=1.0, fingerprint="", **more):
    """Reports of two executors on the cubes that they have; cost [us] and speed of all, or of each."""
    system = parts.whole.system
    low, high = (f.reduceat(system.position, system.first[:-1]) + shift for f in (np.minimum, np.maximum))
    cost, speed = (np.broadcast_to(value, len(low)) for value in (cost, speed))
    mine = [np.flatnonzero(np.asarray(owner) == e) for e in (0, 1)]
    return [
        Report(m, low[m], high[m], speed[m].astype(float), cost[m].astype(np.int64), fingerprint=fingerprint, **more)
        for m in mine
    ]
