# SPDX-License-Identifier: GPL-2.0-only
"""A scene by MuJoCo, for bench/published/mujoco_runs.py: ``mujoco_scene.py SCENE.json FOUND.npz``.

The found table has ``times`` (F,), ``motion`` (F, N, 3, 3) with centre, velocity and spin of each body [SI], and the processor
``seconds`` of the steps.
"""

import json
import sys
import time
from pathlib import Path

import mujoco
import numpy as np

asked = json.loads(Path(sys.argv[1]).read_text())
model = mujoco.MjModel.from_xml_string(asked["xml"])
data = mujoco.MjData(model)
moves = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) for name in asked["names"]]
told = {body: np.array(motion) for body, motion in zip(moves, asked["motion"], strict=True)}
free = [body for body in moves if model.body_dofnum[body] == 6]
mujoco.mj_kinematics(model, data)
# Places are those of centres of mass, which in a mesh are not its origin.
for body in free:
    start = model.jnt_qposadr[model.body_jntadr[body]]
    data.qpos[start : start + 3] -= data.xipos[body] - data.xpos[body]
mujoco.mj_kinematics(model, data)
mujoco.mj_comPos(model, data)
still = np.zeros(6)
for body, motion in told.items():
    if not model.body_dofnum[body]:
        continue
    joint = model.body_jntadr[body]
    start, turn = model.body_dofadr[body], data.xmat[body].reshape(3, 3)
    base = told.get(model.body_parentid[body], still)
    match model.jnt_type[joint]:
        case mujoco.mjtJoint.mjJNT_FREE:
            # A free joint has the velocity of the body's frame, not of its centre, and the spin in that frame.
            arm = data.xipos[body] - data.xpos[body]
            data.qvel[start : start + 3] = motion[:3] - np.cross(motion[3:], arm)
            data.qvel[start + 3 : start + 6] = turn.T @ motion[3:]
        case mujoco.mjtJoint.mjJNT_BALL:
            data.qvel[start : start + 3] = turn.T @ (motion[3:] - base[3:])
        case mujoco.mjtJoint.mjJNT_HINGE:
            data.qvel[start] = data.xaxis[joint] @ (motion[3:] - base[3:])
        case mujoco.mjtJoint.mjJNT_SLIDE:
            data.qvel[start] = data.xaxis[joint] @ (motion[:3] - base[:3])
gravity = np.array(asked["gravity"])
frames = round(asked["time"] * asked["frames"])
times, found, start = [], [], time.process_time()
for frame in range(frames + 1):
    now = frame / asked["frames"]
    while data.time < now - 0.5 * model.opt.timestep:
        model.opt.gravity[:] = [np.interp(data.time, gravity[:, 0], gravity[:, k]) for k in (1, 2, 3)]
        mujoco.mj_step(model, data)
    if times and data.time == times[-1]:
        continue  # a frame within a step
    mujoco.mj_forward(model, data)
    rows = []
    for body in moves:
        velocity = np.zeros(6)
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
        rows.append(
            [data.xipos[body].copy(), velocity[3:] + np.cross(velocity[:3], data.xipos[body] - data.xpos[body]), velocity[:3]]
        )
    times.append(data.time)
    found.append(rows)
np.savez(sys.argv[2], times=np.round(times, 9), motion=found, seconds=time.process_time() - start)
