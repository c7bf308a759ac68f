# SPDX-License-Identifier: GPL-2.0-only
"""Forces, releases and drives against their closed forms: ``python bench/forces.py`` prints the table of
docs/physics-drives.md."""

from __future__ import annotations

import math

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.model.inertia import tensor
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

G = 9.81
CUBE = "object cube { shape box (10, 10, 10) cm position (0, 0, 1) m density 700 elasticity "
WHEEL = "object wheel { shape cylinder 10 cm 4 cm position (0, 0, 0) m mass 1 kg elasticity "
BELT = """gravity (0, 0, -9.81) m/s^2
object belt { shape box (300, 40, 4) cm position (0, 0, -2) cm density 1000 elasticity rigid
  hold all drive velocity (0.5, 0, 0) m/s }
object block { shape box (10, 10, 10) cm position (0, 0, 5) cm density 700 elasticity rigid }
"""


def run(text: str, pieces: int = 1):
    """The prepared scene; and places and velocities of all particles at the ends of so many parts of the run."""
    ready = prepare(parse_scene(text, "scene.txt"))
    found = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(pieces):
            instance.run(ready.certificate.steps // pieces)
            found.append((instance.array("x").copy(), instance.array("v").copy()))
    return ready, found


def mean(ready, values: np.ndarray, m: int = 0) -> np.ndarray:
    """Mean of an object, by mass."""
    return ready.system.center_of_mass(values)[m]


def push(elasticity: str) -> tuple[float, float]:
    """Speed of a cube that 2 N have pushed for 0.25 s, F T/M."""
    ready, ((_, v),) = run(f"{CUBE}{elasticity} force (2, 0, 0) N from 0.0501 s to 0.3001 s }}\ncontrol {{ time 0.4 s }}\n")
    return 2.0 * 0.25 / 0.7, float(mean(ready, v)[0])


def flywheel(elasticity: str) -> tuple[float, float]:
    """Angular velocity of a disc that 0.02 N m have turned for 0.3 s, T t/I."""
    ready, ((x, v),) = run(f"{WHEEL}{elasticity} torque (0, 0, 0.02) N*m to 0.3 s }}\ncontrol {{ time 0.4 s }}\n")
    solid, arm = ready.scene.solids[0], x - mean(ready, x)
    mass = ready.system.mass
    spin = (mass * np.cross(arm, v)[:, 2]).sum() / (mass * (arm[:, :2] ** 2).sum(1)).sum()
    return 0.02 * 0.3 / tensor(solid.shape, 1.0, solid.rotation)[2, 2], float(spin)


def fall(elasticity: str) -> tuple[float, float]:
    """Height that a cube has fallen 0.3 s after its release, g t^2/2."""
    text = (
        f"gravity (0, 0, -9.81) m/s^2\n{CUBE}{elasticity} hold all release 0.1 s }}\ncontrol {{ time 0.4 s timestep 0.05 ms }}\n"
    )
    ready, ((x, _),) = run(text)
    return 0.5 * G * 0.3**2, float(1.0 - mean(ready, x)[2])


def throw(elasticity: str) -> tuple[float, float]:
    """Way of a cube that is driven with 2 m/s for 0.1 s, then let go for 0.3 s."""
    text = (
        f"{CUBE}{elasticity} hold all drive velocity (2, 0, 0) m/s release 0.1 s }}\ncontrol {{ time 0.4 s timestep 0.05 ms }}\n"
    )
    ready, ((x, _),) = run(text)
    return 0.8, float(mean(ready, x)[0])


def slip() -> tuple[float, float]:
    """Time for which a block slips on a belt of 0.5 m/s with friction 0.3, v/(mu g), by its speed half way."""
    slips = 0.5 / (0.3 * G)
    ready, ((_, v),) = run(f"{BELT}control {{ time {0.5 * slips!r} s friction 0.3 }}\n")
    passed = ready.certificate.steps * ready.certificate.timestep
    return slips, 0.5 * passed / float(mean(ready, v, 1)[0])


def main() -> None:
    """Print the table."""
    rows = [("a block slips on a belt for v/(μ g)", "s", slip())]
    for elasticity in ("1 MPa", "rigid"):
        rows += [
            (f"speed after a push, F T/M, {elasticity}", "m/s", push(elasticity)),
            (f"spin after a torque, T t/I, {elasticity}", "rad/s", flywheel(elasticity)),
            (f"fall after a release, g t²/2, {elasticity}", "m", fall(elasticity)),
            (f"way of what is thrown, {elasticity}", "m", throw(elasticity)),
        ]
    print("| case | closed form | found | off |\n|---|---|---|---|")
    for name, unit, (exact, found) in rows:
        off = found / exact - 1.0
        print(f"| {name} | {exact:.5g} {unit} | {found:.5g} {unit} | {off if math.isfinite(off) else 0.0:+.1e} |")


if __name__ == "__main__":
    main()
