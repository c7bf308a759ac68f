# SPDX-License-Identifier: GPL-2.0-only
"""A scene in LAMMPS of which bench/contact.py and bench/contact_at_rest.py measure the last object."""

import math

import numpy as np

STUFF = "density 1000  elasticity 1 MPa"
YOUNG, DENSITY = 1e6, 1000.0
"""Stiffness [Pa] and density [kg/m^3] of STUFF."""
WAVE = math.sqrt(1.2 * YOUNG / DENSITY)
"""Wave speed of STUFF [m/s]."""
MODELS = ("surface", "paper")


class World:
    """A scene in LAMMPS, and what becomes of its last object."""

    def __init__(self, text: str, control: str):
        from mdanim_lammps.engine.instance import Instance
        from mdanim_lammps.run.prepare import prepare
        from mdanim_lammps.scene.parse import parse_scene

        self.ready = prepare(parse_scene(f"{text}\ncontrol {{ time 100 s  {control} }}\n"))
        self.instance = Instance(self.ready.plan)
        self.instance.setup()
        system = self.ready.system
        self.mine = slice(system.first[-2], system.first[-1])
        self.mass = system.mass[self.mine]
        self.effects = self.ready.plan.effects
        self.start = self.energy()

    def run(self, time: float) -> None:
        """Go on for so long [s]."""
        self.instance.run(max(1, round(time / self.ready.plan.certificate.timestep)))

    @property
    def place(self) -> np.ndarray:
        """Place of the centre of the last object [m], shape (3,)."""
        return self.mass @ self.instance.array("x")[self.mine] / self.mass.sum()

    @property
    def velocity(self) -> np.ndarray:
        """Velocity of the same [m/s], shape (3,)."""
        return self.mass @ self.instance.array("v")[self.mine] / self.mass.sum()

    def spin(self) -> np.ndarray:
        """Its angular velocity [1/s], shape (3,)."""
        arm = self.instance.array("x")[self.mine] - self.place
        turning = (self.mass[:, None] * np.cross(arm, self.instance.array("v")[self.mine])).sum(0)
        return np.linalg.solve(inertia(self.mass, arm), turning)

    def energy(self) -> float:
        """All that the ledger counts, without gravity [J]."""
        scene, mass = self.ready.scene, self.ready.system.mass
        v = self.instance.array("v")
        kinetic = 0.5 * float((mass * (v**2).sum(1)).sum())
        kept = sum(e.energy(self.instance) for e in self.effects if e.ledger and e.name != "gravity")
        return kinetic + kept + sum(sum(e.lost(self.instance).values()) for e in self.effects if e.losses(scene))

    def close(self) -> None:
        """End LAMMPS."""
        self.instance.close()


def inertia(mass: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Tensor of inertia [kg m^2], shape (3, 3)."""
    square = (arm**2).sum(1)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]
    return (mass[:, None, None] * square).sum(0)
