# SPDX-License-Identifier: GPL-2.0-only
"""How whole objects move: kinetic energy from their particles, contact forces from their momenta, and the table of
all objects and frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .. import features
from ..effects import acting
from ..model.spin import spin
from ..reach import Acting
from ..scene.scene import Save

if TYPE_CHECKING:
    from .trajectory import Trajectory


def kinetic(mass: np.ndarray, first: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Kinetic energy of each object [J], shape (O,): of its flight, its spin and its vibrations."""
    return np.add.reduceat(0.5 * mass * np.einsum("nd,nd->n", velocity, velocity), first)


class ContactForces:
    """Mean force of contact with objects, ground and walls on each object since the frame before.

    No frame holds forces. But where only gravity and contact act on an object from outside, contact has made exactly that change
    of its momentum that gravity has not made, as the leap-frog adds up forces. So the numbers cost nothing in a run. A single
    object that is held, or has air drag, gets the opposite of the force of contact on all others, where there are no planes.

    Args:
        trajectory: of the run.

    ``why`` is the reason why there are none for any object, "" where there are.
    """

    def __init__(self, trajectory: Trajectory):
        m, self._trajectory, self.why = trajectory.metadata, trajectory, ""
        self._told = np.zeros(len(m.names), bool)
        if (scene := trajectory.scene) is None:
            self.why = "the scene of this run, or one of its meshes, cannot be read here"
            return
        effects = acting(features.effects(), scene)
        uniform = Acting(scene, effects)
        self._gravity = uniform.acceleration
        held = np.add.reduceat(m.held, m.first[:-1]) > 0
        self._told = ~held & ~m.still & ~uniform.slowed
        self._alone = np.flatnonzero(~self._told)
        if len(self._alone) != 1 or uniform.planes:
            self._alone = self._alone[:0]
        self.why = next((why for e in effects if (why := e.untold(scene))), "")
        if not self.why and not self._told.any():
            self.why = "every object is held or has air drag, whose forces frames do not tell apart"

    def since(self, frame: int) -> np.ndarray:
        """[N], shape (O, 3), mean from the frame before to this one; NaN in the first frame, and for objects that are held or
        have air drag, unless there is one of them alone and neither ground nor walls."""
        t = self._trajectory
        force = np.full((len(self._told), 3), np.nan)
        if frame and not self.why:
            change = (t.center_velocities[frame] - t.center_velocities[frame - 1]) / (t.times[frame] - t.times[frame - 1])
            force[self._told] = (t.metadata.object_mass[:, None] * (change - self._gravity))[self._told]
            force[self._alone] = -force[self._told].sum(0)
        return force


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
        self.forces = ContactForces(trajectory)
        if not self.forces.why:
            self.columns += ["contact_fx", "contact_fy", "contact_fz"]

    def numbers(self, frame: int) -> np.ndarray:
        """The columns after frame, time and object in the rows of a frame, shape (O, columns - 3). Raises OutputError."""
        t, m = self.trajectory, self.trajectory.metadata
        found = [t.centers[frame], t.center_velocities[frame]]
        if self.whole:
            x, v = t.position(frame), t.velocity(frame)
            found += [spin(m.mass, m.first[:-1], x, v), kinetic(m.mass, m.first[:-1], v)[:, None]]
        if not self.forces.why:
            found.append(self.forces.since(frame))
        return np.hstack(found)[self.objects]
