# SPDX-License-Identifier: GPL-2.0-only
"""Random scenes of joints, ropes and drives at the certified time step: none diverges, and the books close."""

import joint_scenes
import numpy as np
import pytest
from campaign import rounds
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import RefusedError, SceneError
from mdanim_lammps.run.energy import energies, source_terms
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

RESIDUAL = 1e-3
"""Error of energy that `accuracy balanced` stands for."""
WORST, RARE = 5e-3, 0.03
"""The largest one, and the part of scenes that may be off by more than RESIDUAL: a rope that holds what is thrown against its
joints."""
ROUNDING = 1e-9
"""Part of the largest energy of a scene that counts as moved at least: what hangs at rest moves by rounding alone."""
STEPS, LOOKS = 60_000, 20
"""Most steps of a scene, and how often it is looked at."""
FEW = (2, 6, 9, 12, 17)
"""Seeds of scenes that are run every day. In 12 a joint that is torn breaks, and something is seen late inside another thing."""
FIT = ("outside of", "starts inside", "opens by")
"""Parts of messages on objects that do not fit into a random scene."""


def residual(seed: int) -> float | None:
    """Largest change of all energies less the work, over the largest energy that moved; None of a scene that is refused."""
    text = joint_scenes.scene(seed)
    try:
        ready = prepare(parse_scene(text))
    except (SceneError, RefusedError) as error:
        assert any(part in str(error) for part in FIT), f"{error}\n{text}"
        return None
    sources, told = source_terms(ready.plan), []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(LOOKS + 1):
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
            instance.run(min(STEPS, ready.certificate.steps) // LOOKS)
        assert np.isfinite(instance.array("x")).all(), text
    terms = [name for name in told[0] if name != "contact_bound"]
    most = max(abs(value) for e in told for value in e.values())
    total = np.array([sum(e[name] * (-1.0 if name in sources else 1.0) for name in terms) for e in told])
    return float(np.abs(total - total[0]).max() / max(ROUNDING * most, *(np.ptp([e[name] for e in told]) for name in terms)))


@pytest.mark.parametrize("seed", FEW)
def test_a_few_scenes_of_joints_keep_their_energy(seed):
    """The short form of the next one."""
    found = residual(seed)
    assert found is not None and found < RESIDUAL


@pytest.mark.soak
@pytest.mark.parametrize("part", range(10))
def test_two_hundred_scenes_of_joints_keep_their_energy(part):
    """Most of them can be run."""
    count = rounds(24)
    found = {seed: residual(seed) for seed in range(part * count, (part + 1) * count)}
    run = {seed: off for seed, off in found.items() if off is not None}
    assert len(run) > 0.7 * count and max(run.values()) < WORST, run
    assert sum(off > RESIDUAL for off in run.values()) <= max(1.0, RARE * len(run)), run
