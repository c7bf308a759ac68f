# SPDX-License-Identifier: GPL-2.0-only
"""Random scenes of ropes, chains and other objects at the certified time step: none diverges, and the books close."""

import numpy as np
import pytest
from campaign import rounds
from random_objects import keeps_energy, others

FEW = (3, 4, 6, 8)
"""Seeds of scenes that are run every day."""


def scene(seed: int) -> str:
    """Up to four ropes among up to three other objects."""
    random = np.random.default_rng(seed)
    some = random.uniform
    parts = ["gravity (0, 0, -9.81)", "ground z 0 m"]
    for k in range(random.integers(1, 5)):
        kind, thickness = random.choice(["rope", "chain"]), some(0.004, 0.03)
        a = np.array([some(-0.5, 0.5), some(-0.4, 0.4), some(0.4, 0.9)])
        b = a + [some(0.3, 0.9) * random.choice([-1, 1]), some(-0.3, 0.3), some(-0.2, 0.2)]
        length = np.linalg.norm(b - a) * random.choice([1.0, some(1.02, 1.6), some(0.9, 1.0)])
        ends = " to ".join(f"({x}, {y}, {z})" for x, y, z in (a, b))
        more = [random.choice(["", "hold ends", "hold start"])]
        more.append("velocity ({}, {}, {})".format(*some(-2, 2, 3)) if random.random() < 0.5 else "")
        parts.append(
            f"object rope[{k}] {{ shape {kind} from {ends} thickness {thickness} length {length}  density {some(300, 3000)}"
            f"  elasticity {10 ** some(5.5, 8)}  damping {random.choice([0.0, 0.1, 0.5])}"
            f"  friction {random.choice([0.0, 0.3, 0.8])}  {'  '.join(more)} }}"
        )
    return "\n".join([*parts, *others(random), "control { time 0.4 s }\n"])


@pytest.mark.parametrize("seed", FEW)
def test_ropes_among_others_keep_their_energy(seed):
    """A few, every day."""
    assert keeps_energy(scene(seed))


@pytest.mark.soak
def test_many_scenes_of_ropes_keep_their_energy():
    """Two hundred of them; most can be run."""
    assert np.mean([keeps_energy(scene(seed)) for seed in range(rounds(200))]) > 0.6
