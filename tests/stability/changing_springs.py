# SPDX-License-Identifier: GPL-2.0-only
"""Runs of random scenes whose springs break or yield: how much has changed, and whether energies add up."""

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import Prepared, prepare
from mdanim_lammps.scene.parse import parse_scene

RESIDUAL = 2e-3
"""Change of all energies over the largest change of any."""


def changed(ready: Prepared, column: str, looks: int) -> tuple[float, float]:
    """The largest size of a value of a column of springs at the end, and the residual of energy by so many looks."""
    told = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(looks + 1):
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
            instance.run(max(1, ready.certificate.steps // looks))
        assert np.isfinite(instance.array("x")).all(), ready.scene.control.seed
        most = float(np.abs(instance.column(column).astype(float)).max())
    swing = max(np.ptp([one[name] for one in told]) for name in told[0])
    return most, float(np.ptp([sum(one.values()) for one in told]) / swing)


def all_changed(texts, column: str, *, looks: int, longest: int) -> tuple[int, list[float]]:
    """Scenes in which a spring has changed, and residuals; without those that are refused or take more steps than ``longest``."""
    told = []
    for text in texts:
        try:
            ready = prepare(parse_scene(text))
        except SceneError:
            continue
        if ready.certificate.steps <= longest:
            told.append(changed(ready, column, looks))
    return sum(most > 0.0 for most, _ in told), [off for _, off in told]
