# SPDX-License-Identifier: GPL-2.0-only
"""OpenMM on the CPU platform, one thread: our particles as HarmonicBondForce, gravity and floor as CustomExternalForce, Verlet.

Units of OpenMM stand for ours: nm for m, dalton for kg, ps for s; then its energies are in J.
"""

import numpy as np
import openmm
from clock import run, tell, words

_, case = words()
lattice = np.load(case["lattice"])
dt = float(lattice["dt"])
system, bonds = openmm.System(), openmm.HarmonicBondForce()
outer = openmm.CustomExternalForce("m*9.81*z + 0.5*k*min(z, 0)^2")
outer.addPerParticleParameter("m")
outer.addGlobalParameter("k", float(lattice["stiffness"].max()))
for i, mass in enumerate(lattice["mass"].tolist()):
    system.addParticle(mass)
    outer.addParticle(i, [mass])
for (i, j), k, length in zip(lattice["pair"].tolist(), lattice["stiffness"].tolist(), lattice["length"].tolist()):
    bonds.addBond(i, j, length, k)
system.addForce(bonds)
system.addForce(outer)
integrator = openmm.VerletIntegrator(dt)
context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("CPU"), {"Threads": "1"})
context.setPositions(lattice["position"])
found = run(integrator.step, dt, case["time"], case["limit"], 20)
if not np.isfinite(context.getState(energy=True).getPotentialEnergy()._value):
    raise SystemExit("the energy is not a number")
tell(version=openmm.__version__, nodes=len(lattice["mass"]), **found)
