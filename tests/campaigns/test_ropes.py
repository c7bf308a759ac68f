# SPDX-License-Identifier: GPL-2.0-only
"""Random scenes of ropes, chains and other objects at the certified time step: none diverges, and the books close."""

import numpy as np
import pytest
from campaign import rounds
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

RESIDUAL = 1e-3
"""Error of energy that `accuracy balanced` stands for."""
MOST = 8e7
"""Steps times particles of a scene that is run."""
FEW = (3, 4, 6, 8)
"""Seeds of scenes that are run every day."""
SHAPES = (
    "box (0.2, 0.15, 0.1)",
    "sphere 0.08",
    "cylinder 0.07 0.2",
    "ellipsoid (0.1, 0.07, 0.06)",
    "torus 0.1 0.03",
    "cone 0.1 0.15",
)
MATTER = ("rigid", "rigid  hold all", "1 MPa", "500 kPa  hold all")
FIT = ("starts inside", "below the ground", "thick, more than")
"""Parts of messages on objects that do not fit into a random scene."""


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
    parts += [
        f"object other[{k}] {{ shape {random.choice(SHAPES)}  position ({0.4 * k - 0.4}, {some(-0.2, 0.2)}, {some(0.15, 0.35)})\n"
        f"  density {some(200, 1500)}  elasticity {random.choice(MATTER)}  friction {some(0, 0.8)} }}"
        for k in range(random.integers(1, 4))
    ]
    return "\n".join([*parts, "control { time 0.4 s }\n"])


def check(seed: int) -> bool:
    """Run a scene for 0.4 s; whether it could be run."""
    text = scene(seed)
    try:
        ready = prepare(parse_scene(text))
    except SceneError as error:
        assert any(part in error.problems[0].message for part in FIT), f"{error}\n{text}"
        return False
    if ready.certificate.steps * ready.system.particles > MOST:
        return False
    with Instance(ready.plan) as instance:
        instance.setup()
        told = [energies(instance, ready.system.center_of_mass(instance.array("x")))]
        for _ in range(8):
            instance.run(ready.certificate.steps // 8)
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
        assert np.isfinite(instance.array("x")).all(), text
    begin, sums = told[0], [sum(value for name, value in e.items() if name != "contact_bound") for e in told]
    scale = max(max(e["kinetic"], abs(e["gravity"] - begin["gravity"]), e.get("elastic", 0.0)) for e in told)
    assert max(abs(s - sums[0]) for s in sums) < RESIDUAL * scale, text
    return True


@pytest.mark.parametrize("seed", FEW)
def test_ropes_among_others_keep_their_energy(seed):
    """A few, every day."""
    assert check(seed)


@pytest.mark.soak
def test_many_scenes_of_ropes_keep_their_energy():
    """Two hundred of them; most can be run."""
    assert np.mean([check(seed) for seed in range(rounds(200))]) > 0.6
