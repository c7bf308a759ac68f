# SPDX-License-Identifier: GPL-2.0-only
"""Random objects beside ropes and sheets, and whether a scene keeps its energy at the certified time step."""

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

RESIDUAL = 1e-3
"""Error of energy that `accuracy balanced` stands for."""
MOST = 8e7
"""Steps times particles of a scene that is run."""
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


def others(random: np.random.Generator) -> list[str]:
    """Up to three objects that are neither ropes nor sheets."""
    some = random.uniform
    return [
        f"object other[{k}] {{ shape {random.choice(SHAPES)}  position ({0.4 * k - 0.4}, {some(-0.2, 0.2)}, {some(0.15, 0.35)})\n"
        f"  density {some(200, 1500)}  elasticity {random.choice(MATTER)}  friction {some(0, 0.8)} }}"
        for k in range(random.integers(1, 4))
    ]


def keeps_energy(text: str) -> bool:
    """Run a scene; whether it could be run. Raises AssertionError where its books do not close."""
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
