# SPDX-License-Identifier: GPL-2.0-only
"""Positions and costs of many objects for the plan of a frame."""

from __future__ import annotations

from functools import partial

import numpy as np
from mdanim_lammps.parallel.plan import frame_plan as planning

BUNDLE_PARTICLES = 4000


plan, bundles = (partial(make, room=BUNDLE_PARTICLES) for make in (planning.plan, planning.bundles))


def scene(count, seed=0, still=0.1, volume=20.0, heavy=0.02):
    """Objects to plan for: random boxes, a few of them heavy."""
    rng = np.random.default_rng(seed)
    low = rng.uniform(0.0, (volume * count) ** (1.0 / 3.0), (count, 3))
    edge = rng.uniform(0.5, 1.0, (count, 3))
    particles = (1000 * edge.prod(axis=1) * np.where(rng.random(count) < heavy, 20.0, 1.0)).astype(np.int64)
    return dict(
        low=low,
        high=low + edge,
        d=np.full(count, 0.05),
        cost=2 * particles,
        owner=np.full(count, -1),
        particles=particles,
        still=rng.random(count) < still,
        gap=0.1,
    )
