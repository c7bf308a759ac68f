# SPDX-License-Identifier: GPL-2.0-only
"""Commands for LAMMPS that stand in a scene (scene/lammps_lines.py)."""

from __future__ import annotations

from ..errors import Problem, SceneError
from ..scene.lammps_lines import check_trust
from .opened_lammps import OpenedLammps
from .plan import Plan


def run_lines_of_scene(lammps: OpenedLammps, plan: Plan) -> None:
    """Run the commands that the scene has as they stand. Raises SceneError at the line that LAMMPS does not take, and for
    lines behind which the particles or the steps are other ones."""
    check_trust(plan.scene)
    dt = lammps.lmp.extract_global("dt")
    for command in plan.scene.lammps:
        try:
            lammps.lmp.commands_string(command.text)
        except Exception as error:
            words = " ".join(str(error).split()).removeprefix("ERROR: ")
            raise SceneError([Problem(command.span, f"LAMMPS does not take this line: {words}")]) from error
        here = lammps.lmp.get_natoms(), lammps.step, lammps.lmp.extract_global("dt")
        if here != (plan.system.particles, 0, dt):
            cause = f"behind this line there are {here[0]:.0f} particles at step {here[1]} with a time step of {here[2]!r} s"
            way_out = "particles and steps are those of the scene: take out what makes or deletes particles, or runs"
            raise SceneError([Problem(command.span, cause, way_out)])
