# SPDX-License-Identifier: GPL-2.0-only
"""Random trees of rigid bodies on random joints with random words, let fall: none flies apart, and the books close."""

import joint_lab as lab
import numpy as np
import pytest
import rigid_lab

FREQUENCY = 600.0


def words_of(random, kind):
    """Words of a joint but its place."""
    found = [f"frequency {FREQUENCY / 3 if kind == 'spring' else FREQUENCY}"]
    if kind in ("hinge", "slider"):
        scale = 1.0 if kind == "hinge" else 0.1
        most = 10.0 ** random.uniform(-2, 1) / scale
        found.append("axis " + numbers(random.normal(size=3)))
        some = [
            f"motor {3.0 * scale * random.normal()} {most}",
            f"friction {0.3 * most}",
            f"limits {-scale * random.uniform(0.1, 1)} {scale * random.uniform(0.1, 1)}",
        ]
        found += [one for one in some if random.random() < 0.5]
    if kind == "spring" and random.random() < 0.5:
        found.append("pulls-only")
    if random.random() < 0.5:
        found.append(f"damping-ratio {random.uniform(0, 0.3)}")
    if random.random() < 0.1:
        found.append(f"breaks {10.0 ** random.uniform(0, 3)}")
    return " ".join(found)


def numbers(values) -> str:
    """As words."""
    return " ".join(repr(float(value)) for value in values)


def tree(seed):
    """Bodies of 0.06 to 6 litres and joints: the first one to the world, each further one to one before it."""
    random = np.random.default_rng(seed)
    centres, bodies, joints = [], [], []
    for n in range(random.integers(1, 7)):
        way = random.normal(size=3)
        centres.append(centres[random.integers(n)] + 0.4 * way / np.linalg.norm(way) if n else np.zeros(3))
        size, q = 10.0 ** random.uniform(-1.2, -0.4, 3), rigid_lab.about(random.normal(size=3), random.uniform(0, 3))
        bodies.append(lab.box(size, 1000.0 * size.prod(), centres[n], q))
        other = random.integers(n) if n else None
        ends = (centres[n], centres[other] if n else 0.1 * random.normal(size=3))
        kind = random.choice(["ball", "hinge", "weld", "slider", "spring"])
        at = f"from {numbers(ends[0])} to {numbers(ends[1])}" if kind == "spring" else f"at {numbers(0.5 * (ends[0] + ends[1]))}"
        joints.append(f"{kind} {n + 1} {other + 1 if n else 'world'} {at} {words_of(random, kind)}")
    return bodies, joints


@pytest.mark.parametrize("first", [0, *(pytest.param(n, marks=pytest.mark.soak) for n in range(10, 200, 10))])
def test_random_joints_keep_their_books(tmp_path, first):
    """For a second at 0.35/frequency: kinetic energy, that of gravity and of joints, heat and work are in balance to 2e-3 of what
    falls by 0.3, which (0.35/3)^2/8 of the energy of slow springs and 0.35^2/8 of that of joints that swing are below."""
    for seed in range(first, first + 10):
        bodies, joints = tree(seed)
        with lab.World(tmp_path, bodies, joints, 0.35 / FREQUENCY) as world:
            start, scale = world.energy(), 0.3 * 9.81 * world.body.mass.sum()
            for _ in range(10):
                world.run(round(0.1 / world.dt))
                moved = max(scale, abs(world.number("work")), world.number("joint_heat"))
                assert world.energy() == pytest.approx(start, abs=2e-3 * moved), (seed, joints)
            assert world.number("joint_heat") > -1e-3 * scale
