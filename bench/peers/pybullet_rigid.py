# SPDX-License-Identifier: GPL-2.0-only
"""PyBullet, rigid bodies at its default step and number of iterations."""

from importlib.metadata import version

import numpy as np
import pybullet
from clock import run, tell, words
from rigid_bodies import FRICTION, SCENES, deepest

STEP = 1.0 / 240.0

scene, case = words()
bodies, wall = SCENES[scene](case)
pybullet.connect(pybullet.DIRECT)
pybullet.setGravity(0.0, 0.0, -9.81)
pybullet.setTimeStep(STEP)
planes = [((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))]
if wall is not None:
    planes += [((x, y, 0.0), (-wall * x, -wall * y, 0.0)) for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))]
for normal, place in planes:
    plane = pybullet.createMultiBody(
        0.0, pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=normal), basePosition=place
    )
    pybullet.changeDynamics(plane, -1, lateralFriction=FRICTION**0.5)  # of a pair it takes the product
ids = []
for b in bodies:
    if len(b.size) == 3:
        form = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.5 * s for s in b.size])
    else:
        form = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=b.size[0])
    turn = pybullet.getQuaternionFromAxisAngle(b.axis, b.angle)
    one = pybullet.createMultiBody(b.density * b.volume, form, basePosition=b.position.tolist(), baseOrientation=turn)
    pybullet.changeDynamics(one, -1, lateralFriction=FRICTION**0.5, linearDamping=0.0, angularDamping=0.0)
    pybullet.resetBaseVelocity(one, (b.speed, 0.0, 0.0))
    ids.append(one)


def step(count: int) -> None:
    for _ in range(count):
        pybullet.stepSimulation()


found = run(step, STEP, case["time"], case["limit"], 10)
at = [pybullet.getBasePositionAndOrientation(one) for one in ids]
rotation = np.array([pybullet.getMatrixFromQuaternion(q) for _, q in at]).reshape(-1, 3, 3)
overlap = deepest(bodies, wall, np.array([p for p, _ in at]), rotation)
tell(version=version("pybullet"), nodes=len(bodies), note=f"overlap at the end {overlap:.2g}", **found)
