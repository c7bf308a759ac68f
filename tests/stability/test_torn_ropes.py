# SPDX-License-Identifier: GPL-2.0-only
"""Random ropes and chains on which something falls, so that most of them tear: none diverges, and their energies add up."""

import random

import pytest
from changing_springs import RESIDUAL, changed
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

LOOKS, LONG = 12, 120_000


def scene(seed: int) -> str:
    """Up to three lines of all kinds, held at one end or both, and a rigid thing that falls onto them: a soft one, into which
    ropes cut, folds up, torn or not."""
    chance = random.Random(seed)
    kind, d = chance.choice(["rope", "chain"]), chance.uniform(0.5, 3.0)
    resolution, young, e = max(d, d * chance.uniform(1.0, 3.0)), 10 ** chance.uniform(-0.3, 1.5), 10 ** chance.uniform(-2.0, -0.2)
    hold, slack = chance.choice(["start", "ends", "ends"]), chance.choice(["", f"length {chance.uniform(1.05, 1.3):.3f} m"])
    damping = chance.choice([0, 0.05, 0.3])
    lines = ["gravity (0, 0, -9.81) m/s^2", "ground z 0 m"]
    for k in range(chance.randint(1, 3)):
        ends = f"from (0, {0.1 * k}, {0.8 + 0.05 * k}) m to (1, {0.1 * k}, {0.8 + chance.uniform(0.0, 0.2)}) m"
        lines.append(
            f"object line[{k}] {{ shape {kind} {ends} thickness {d:.3f} cm {slack} resolution {resolution:.3f} cm "
            f"elasticity {young:.3f} MPa density 1000 damping {damping} hold {hold} tear-strain {e:.4f} }}"
        )
    shape = chance.choice(["sphere 12 cm", "box (20, 40, 20) cm"])
    lines.append(
        f"object thing {{ shape {shape} position (0.5, 0.1, {1.3 + chance.uniform(0.0, 0.2)}) m "
        f"velocity (0, 0, {-chance.uniform(1.0, 5.0)}) m/s density {chance.uniform(500.0, 4000.0):.0f} elasticity rigid }}"
    )
    return "\n".join([*lines, f"control {{ time 0.3 s seed {seed} friction {chance.choice([0, 0.4])} }}\n"])


def torn(seeds) -> int:
    """Scenes in which something tore; each is checked."""
    count = 0
    for seed in seeds:
        ready = prepare(parse_scene(scene(seed)))
        if ready.certificate.steps > LONG:
            continue
        tore, off = changed(ready, "torn", LOOKS)
        assert off < RESIDUAL, seed
        count += tore > 0.0
    return count


def test_six_random_scenes_that_tear():
    """A few of them."""
    assert torn(range(6)) >= 4


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("part", range(4))
def test_two_hundred_random_scenes_that_tear(part):
    """Fifty in each part."""
    assert torn(range(50 * part, 50 * part + 50)) >= 25
