# SPDX-License-Identifier: GPL-2.0-only
"""MuJoCo, rigid bodies at its default step and solver; ``mujoco_rigid, CG`` with its other solver."""

import mujoco
from clock import run, tell, words
from rigid_bodies import FRICTION, SCENES, deepest

STEP = 2e-3

scene, case = words()
bodies, wall = SCENES[scene](case)
text = f'<geom type="plane" size="20 20 1" friction="{FRICTION}"/>'
if wall is not None:
    for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        text += f'<geom type="plane" size="20 20 1" friction="{FRICTION}" pos="{-wall * x} {-wall * y} 0" zaxis="{x} {y} 0"/>'
for b in bodies:
    form = "box" if len(b.size) == 3 else "sphere"
    size = " ".join(str(s / 2 if form == "box" else s) for s in b.size)
    turn = " ".join(map(str, (*b.axis, b.angle)))
    text += (
        f'<body pos="{" ".join(map(str, b.position))}" axisangle="{turn}"><freejoint/>'
        f'<geom type="{form}" size="{size}" density="{b.density}" friction="{FRICTION}"/></body>'
    )
solver = f' solver="{case["way"]}"' if case.get("way") else ""
options = f'<compiler angle="radian"/><size memory="2G"/><option timestep="{STEP}"{solver}/>'
model = mujoco.MjModel.from_xml_string(f"<mujoco>{options}<worldbody>{text}</worldbody></mujoco>")
data = mujoco.MjData(model)
for n, b in enumerate(bodies):
    data.qvel[6 * n] = b.speed
worst = 0.0


def step(count: int) -> None:
    mujoco.mj_step(model, data, count)


found = run(step, STEP, case["time"], case["limit"], 10)
mujoco.mj_kinematics(model, data)
overlap = deepest(bodies, wall, data.xpos[1:], data.xmat[1:].reshape(-1, 3, 3))
note = f"{case.get('way') or 'Newton'}, overlap at the end {overlap:.2g}"
tell(version=mujoco.__version__, nodes=len(bodies), note=note, **found)
