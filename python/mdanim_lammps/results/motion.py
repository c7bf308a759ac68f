# SPDX-License-Identifier: GPL-2.0-only
"""How whole objects move: kinetic energy from their particles, contact forces from their momenta, and the table of
all objects and frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .. import features
from ..bodies import all_held, kind_of
from ..effects import acting
from ..effects.balance import Balance, untold
from ..model.added import tensor_of
from ..model.spin import spin
from ..scene.scene import Save

if TYPE_CHECKING:
    from .trajectory import Trajectory


def kinetic(mass: np.ndarray, first: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Kinetic energy of each object [J], shape (O,): of its flight, its spin and its vibrations."""
    return np.add.reduceat(0.5 * mass * np.einsum("nd,nd->n", velocity, velocity), first)


class ContactForces:
    """Mean force of contact with objects, ground and walls on each object since the frame before, by effects/balance.py.

    Args:
        trajectory: of the run.

    ``why`` is the reason why there are none for any object, "" where there are.
    """

    def __init__(self, trajectory: Trajectory):
        self.why, self._force = "the scene of this run, or one of its meshes, cannot be read here", None
        if (scene := trajectory.scene) is None:
            return
        reasons = untold(scene, effects := acting(features.effects(), scene))
        self.why = next(iter(reasons.values()), "") if len(reasons) == len(scene.solids) else ""
        if not self.why:
            t, mass = trajectory, trajectory.metadata.object_mass
            self._force = Balance(scene, effects, mass, t.times, t.centers, t.center_velocities).contact

    def since(self, frame: int) -> np.ndarray:
        """[N], shape (O, 3), mean from the frame before to this one; NaN in the first frame, and for objects of which frames do
        not tell it: those that are held, unless there is one of them alone and neither ground nor walls, and those that joints,
        air or a liquid push."""
        return self._force[frame]


class _RigidOnes:
    """The rigid objects of a run that move: these have the moments of inertia of their shape, not those of their particles."""

    def __init__(self, trajectory: Trajectory):
        m, self._inertia, self._places = trajectory.metadata, {}, {}
        self._mass = m.mass
        solids = () if trajectory.scene is None else trajectory.scene.solids
        for n, solid in enumerate(solids):
            if not kind_of(solid).deforms and not all_held(solid):
                own = slice(m.first[n], m.first[n + 1])
                start = trajectory.position(0)[own]
                self._inertia[n] = tensor_of(solid, float(m.object_mass[n]))
                self._places[n] = own, start - np.average(start, axis=0, weights=m.mass[own])

    def kinetic(self, of_particles: np.ndarray, x: np.ndarray, velocity: np.ndarray, spins: np.ndarray) -> np.ndarray:
        """Kinetic energy of each object [J], shape (O,): that of its particles, of rigid ones m v^2/2 + w R I R' w/2 with the
        rotation R since the start."""
        found = np.array(of_particles)
        for n, inertia in self._inertia.items():
            own, start = self._places[n]
            now = x[own] - np.average(x[own], axis=0, weights=self._mass[own])
            turn = np.linalg.lstsq(start, now, rcond=None)[0].T
            along, mass = turn.T @ spins[n], self._mass[own].sum()
            found[n] = 0.5 * mass * velocity[n] @ velocity[n] + 0.5 * along @ inertia @ along
        return found


class MotionTable:
    """A table with a row for each object and frame: frame, time [s], object, centre of mass [m], its velocity [m/s]; where all
    particles are stored also spin [rad/s] and kinetic energy [J]; where `ContactForces` has them the force of contact [N].

    Args:
        trajectory: of the run.
        objects: indices into ``trajectory.names``, ascending, shape (O,).
    """

    def __init__(self, trajectory: Trajectory, objects: np.ndarray):
        self.trajectory, self.objects, m = trajectory, objects, trajectory.metadata
        self.columns = ["frame", "time", "object", "x", "y", "z", "vx", "vy", "vz"]
        self.whole = m.save is Save.ALL
        """Whether all particles are stored."""
        if self.whole:
            self.columns += ["wx", "wy", "wz", "kinetic"]
            self._rigid = _RigidOnes(trajectory)
        self.forces = ContactForces(trajectory)
        if not self.forces.why:
            self.columns += ["contact_fx", "contact_fy", "contact_fz"]

    def numbers(self, frame: int) -> np.ndarray:
        """The columns after frame, time and object in the rows of a frame, shape (O, columns - 3). Raises OutputError."""
        t, m = self.trajectory, self.trajectory.metadata
        found = [t.centers[frame], t.center_velocities[frame]]
        if self.whole:
            x, v = t.position(frame), t.velocity(frame)
            turning = spin(m.mass, m.first[:-1], x, v)
            energy = self._rigid.kinetic(kinetic(m.mass, m.first[:-1], v), x, t.center_velocities[frame], turning)
            found += [turning, energy[:, None]]
        if not self.forces.why:
            found.append(self.forces.since(frame))
        return np.hstack(found)[self.objects]
