# SPDX-License-Identifier: GPL-2.0-only
"""MuJoCo flex: tetrahedra over the same grid of nodes; the cube with Euler at a fraction of its largest step, the bar implicit.

Euler is what is cheapest per simulated second for the cube; integrator ``discrete`` is what MuJoCo takes for stiff flexes.
"""

import mujoco
import numpy as np
from clock import run, tell, words

MODEL = """
<mujoco>
  <option timestep="{dt}" integrator="{integrator}" gravity="0 0 -{gravity}" solver="CG" tolerance="1e-6"/>
  <size memory="2G"/>
  <worldbody>
    {floor}
    <flexcomp name="body" type="grid" dim="3" dof="full" count="{nx} {ny} {nz}" spacing="{h} {h} {h}" pos="0 0 {z}" mass="{mass}"
              radius="{radius}">
      <contact selfcollide="none"/>
      <elasticity young="{young}" poisson="0.25" damping="{damping}"/>
      {pin}
    </flexcomp>
  </worldbody>
</mujoco>
"""
LARGEST = 0.0252
"""Largest step over the spacing that Euler bears for the cube [s/m]: 1.2 ms with 21 cells; at 1.3 ms it breaks down."""
IMPLICIT = 4.3e-3
"""Step for the bar [s], a hundredth of what is run: half of it takes 1 % of the sag off its error, at twice the cost; twice it
adds 0.3 to 8 %."""

scene, case = words()
h, young = case["h"], case["young"]
if scene == "cube":
    n = round(1.0 / h) + 1
    text = dict(
        dt=case["fraction"] * LARGEST * h,
        integrator="Euler",
        gravity=9.81,
        nx=n,
        ny=n,
        nz=n,
        z=case["z"],
        mass=case["density"],
        damping=0.0,
        pin="",
        floor='<geom type="plane" size="5 5 .1"/>',
    )
else:
    across = round(case["thickness"] / h) + 1
    along = round(case["length"] / h) + 1
    mass = case["density"] * case["length"] * case["thickness"] ** 2
    text = dict(
        dt=IMPLICIT,
        integrator="discrete",
        gravity=case["gravity"],
        nx=along,
        ny=across,
        nz=across,
        z=1.0,
        mass=mass,
        damping=0.0,
        pin=f'<pin gridrange="0 0 0 0 {across - 1} {across - 1}"/>',
        floor="",
    )
model = mujoco.MjModel.from_xml_string(MODEL.format(h=h, radius=0.1 * h, young=young, **text))
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
start = data.flexvert_xpos.copy()
found = run(lambda count: mujoco.mj_step(model, data, count), text["dt"], case["time"], case["limit"], 5)
if not np.isfinite(data.flexvert_xpos).all() or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
    raise SystemExit(f"unstable at a step of {text['dt']:g} s")
error = {}
if scene == "cantilever":
    ends = np.isclose(start, start.min(0)) | np.isclose(start, start.max(0))
    sag = np.average((start - data.flexvert_xpos)[:, 2], weights=np.where(ends, 0.5, 1.0).prod(axis=1))
    error["error"] = None if found["extrapolated"] else float(sag / case["exact"] - 1.0)
tell(version=mujoco.__version__, nodes=len(start), note=text["integrator"], **found, **error)
