# SPDX-License-Identifier: GPL-2.0-only
"""How the force of the air is measured for ``expect``."""

from __future__ import annotations

import numpy as np

from ...effects.measured import Measured
from ...scene.scene import Expect
from .effect import FORCE


def force(m: Measured, e: Expect) -> float:
    """[N]"""
    n = list(m.trajectory.names).index(e.subject)
    of_frames = (m.trajectory.field(FORCE, frame)[n] for frame in range(len(m.times)))
    return m.at(np.array([float(np.linalg.norm(one)) for one in of_frames]), e.time)


MEASURES = {("NAME", "air.force"): force}
