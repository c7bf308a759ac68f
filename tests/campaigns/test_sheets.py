# SPDX-License-Identifier: GPL-2.0-only
"""Random scenes of sheets and other objects at the certified time step: none diverges, and the books close."""

import numpy as np
import pytest
from campaign import rounds
from random_objects import keeps_energy, others

FEW = (1, 6, 9)
"""Seeds of scenes that are run every day: of those with the least work."""
HOLDS = ("", "hold face -x", "hold faces y", "hold face +y")


def scene(seed: int) -> str:
    """Up to two sheets among up to three other objects."""
    random = np.random.default_rng(seed)
    some = random.uniform
    parts = ["gravity (0, 0, -9.81)", "ground z 0 m"]
    for k in range(random.integers(1, 3)):
        size, thickness = some(0.3, 1.0, 2), 10 ** some(-3, -2)
        tilt = "axis ({}, {}, 1) angle {} deg".format(*some(-1, 1, 2), some(-40, 40))
        spin = "velocity ({}, {}, {})".format(*some(-2, 2, 3)) if random.random() < 0.5 else ""
        bending = random.choice([0.0, 0.3, 1.0, 3.0])
        parts.append(
            f"object sheet[{k}] {{ shape sheet ({size[0]}, {size[1]}) thickness {thickness} bending {bending}"
            f"  position ({some(-0.2, 0.2)}, {some(-0.2, 0.2)}, {0.75 + 0.2 * k})  orientation {tilt}\n"
            f"  density {some(200, 2000)}  elasticity {10 ** some(5, 7)}  damping {random.choice([0.0, 0.1, 0.5])}"
            f"  friction {random.choice([0.0, 0.3, 0.8])}  {random.choice(HOLDS)}  {spin} }}"
        )
    return "\n".join([*parts, *others(random), "control { time 0.4 s }\n"])


@pytest.mark.parametrize("seed", FEW)
def test_sheets_among_others_keep_their_energy(seed):
    """A few, every day."""
    assert keeps_energy(scene(seed))


@pytest.mark.soak
def test_many_scenes_of_sheets_keep_their_energy():
    """Two hundred of them; most can be run."""
    assert np.mean([keeps_energy(scene(seed)) for seed in range(rounds(200))]) > 0.6
