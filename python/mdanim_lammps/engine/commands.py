# SPDX-License-Identifier: GPL-2.0-only
"""A plan as LAMMPS commands: the one source for ``in.*`` files and for live instances."""

from __future__ import annotations

import re

import numpy as np

from ..effects.leapfrog import LAMBDA
from ..scene.lammps_lines import check_trust
from .columns import property_of, wide_columns
from .plan import DRIVEN, HELD, Plan

SKIN = 1.5
"""Neighbour skin over the spacing: lists are rebuilt when a particle has moved half of it (bench/skin.py)."""
BALANCE = ("balance 1.0 rcb", "fix balance all balance 1000 1.1 rcb")
"""Cut space so that every rank has the same share of particles, now and in the course of a run; changes no bit of the result."""
MOVING = (f"variable {DRIVEN} atom d_{DRIVEN}", f"group {DRIVEN} variable {DRIVEN}", f"group moving union mobile {DRIVEN}")
"""Make the groups of what is driven, and of all that moves (effects.Context.pushed)."""
TABLE = "table:"
"""Begins the word of a command of an effect that stands for the path of one of its tables."""
GHOST = 3.0
"""Least communication cutoff over the spacing; where there are springs it is longer, see `prelude`."""


def harmonic_coeff(k: float) -> float:
    """LAMMPS's K for a spring constant k: bond_style harmonic is K (r - r0)^2, eq. (3.6) is k/2 (r - r0)^2."""
    return 0.5 * k


def bond_coeffs(plan: Plan) -> list[str]:
    """``TYPE K r0 [c]`` for every bond type, in digits that keep every bit."""
    rows, damped = [], plan.damped
    for kind, (k, r0, c) in enumerate(plan.coefficients.tolist(), start=1):
        rows.append(f"{kind} {harmonic_coeff(k)!r} {r0!r}" + (f" {c!r}" if damped else ""))
    return rows


def box(plan: Plan) -> np.ndarray:
    """Bounds of the simulation box at the start [m], shape (2, 3); LAMMPS shrinks and grows it with the particles."""
    # A part of a plan may be its liquid alone.
    places = plan.system.position if plan.system.particles else np.array([plan.grid.low, plan.grid.high])
    return np.array([places.min(0) - plan.spacing, places.max(0) + plan.spacing])


def prelude(plan: Plan) -> list[str]:
    """Commands before the particles exist."""
    skin = SKIN * plan.spacing
    reach = float(plan.columns["reach"].max()) if "reach" in plan.columns else 0.0
    longest = float(plan.coefficients[:, 1].max()) if len(plan.bonds) else 0.0
    # The last is LAMMPS's own estimate for bonds: below it, it warns at every rebuild.
    cutoff = max(GHOST * plan.spacing, 1.001 * (reach + skin), 1.5 * longest + 1.001 * skin)
    velocities = " vel yes" if plan.damped else ""
    wide = wide_columns(plan)
    words = {name: f" {property_of(field, plan.slots).word}" for name, field in plan.fields.items()}
    columns, tables = ("".join(word for name, word in words.items() if (name in wide) == of_wide) for of_wide in (False, True))
    return [
        "units si",
        "atom_style bond",
        "atom_modify map array sort 0 0",
        "newton off",
        "boundary s s s",
        "comm_style tiled",
        f"comm_modify cutoff {cutoff!r}{velocities}",
        f"neighbor {skin!r} bin",
        "neigh_modify every 1 delay 0 check yes",
        "pair_style none",
        "special_bonds lj/coul 1 1 1",
        *(["bond_style mdanim/harmonic"] if len(plan.bonds) else []),
        *([f"fix tables all property/atom{tables} ghost yes"] if wide else []),
        f"fix model all property/atom rmass{columns} ghost yes",
    ]


def table_file(plan: Plan, name: str) -> str:
    """Name of the file of a table."""
    return f"table.{name}.{plan.name}"


def physics(plan: Plan, threads: int = 1, folder: str = "") -> list[str]:
    """Commands after the particles exist: groups, effects, integrator, time step. Tables are in this folder, whose name ends with
    a slash."""
    effects = [c for e in plan.effects for c in e.commands(plan.context)]
    effects = [re.sub(rf"{TABLE}([\w-]+)", lambda table: folder + table_file(plan, table[1]), c) for c in effects]
    drag = f" lambda d_{LAMBDA.name}" if LAMBDA.name in plan.columns else ""
    movers = {e: found[1] for e in plan.effects if (found := e.integrates(plan.context)) is not None}
    own = tuple(f"fix {fix} " for e in movers for fix in e.fixes)
    effects = [c + drag if own and c.startswith(own) else c for c in effects]
    if drag and plan.exponential:
        drag += " drag exp"
    groups = movers.values()
    others = [f"group others subtract mobile {' '.join(groups)}"] if groups else []
    return [
        "mass * 1.0",  # wanted by atom_style bond; the particles' own masses (rmass) are what counts
        f"group mobile type 1:{HELD}",
        *(MOVING if DRIVEN in plan.columns else ()),
        *effects,
        *others,
        f"fix leapfrog {'others' if others else 'mobile'} mdanim/leapfrog{drag}",
        f"timestep {plan.certificate.timestep!r}",
        "run_style verlet/mdanim" + (f" threads {threads}" if threads > 1 else ""),
    ]


def lines_of_scene(plan: Plan) -> list[str]:
    """Commands that the scene has as they stand, behind all others; none that nobody has trusted."""
    check_trust(plan.scene)
    return [command.text for command in plan.scene.lammps]


def _with_bodies(plan: Plan, commands: list[str]) -> list[str]:
    """The same with the file of contact bodies named to fixes that look them up."""
    fixes = tuple(f"fix {fix} " for fix in plan.body_fixes)
    return [f"{c} bodies contact.{plan.name}" if fixes and c.startswith(fixes) else c for c in commands]


def _wide_columns(plan: Plan) -> list[str]:
    """Commands that set them from their file, number by number in its order."""
    if not (wide := wide_columns(plan)):
        return []
    tables = [property_of(plan.fields[name], plan.slots) for name in wide]
    numbers = [f"{table.name}[{n}]" for table in tables for n in range(1, table.width + 1)]
    lines = [f"variable columns atomfile columns.{plan.name}"]
    for number in numbers:
        lines += [f"set group all {number} v_columns", "next columns"]
    return lines[:-1]


def input_script(plan: Plan) -> str:
    """The text of ``in.NAME``: runs alone with ``lmp -in in.NAME``, on any number of ranks, to the same bits."""
    c = plan.certificate
    commands = physics(plan)
    ids = {c.split()[1] for c in commands if c.startswith("fix ")}
    energy = "".join(f" f_{fix}" for e in plan.effects for fix in e.fixes if fix in ids)
    when = f"{c.steps_per_frame}"
    variable, modify = [], []
    if c.last_steps:
        # Frames are every n steps, and the last one at the end of the run.
        n, end = c.steps_per_frame, c.steps
        variable = [f"variable frame equal (step+{n})*(step+{n}<={end})+{end}*(step+{n}>{end}&&step<{end})+1e15*(step>={end})"]
        modify = ["dump_modify trajectory every v_frame first yes"]
    title = (plan.scene.title or plan.name).encode("ascii", "replace").decode()  # LAMMPS reads ASCII
    return "\n".join(
        [
            f"# {title}",
            f"# Written by mdanim-lammps; run it here with 'lmp -in in.{plan.name}' or 'mpiexec -n 4 lmp -in in.{plan.name}',",
            "# with the lmp and the mpiexec of the environment that mdanim-lammps is installed in (.venv/bin): "
            "they know its styles.",
            f"# Effects: {', '.join(e.name for e in plan.effects) or 'none'}.",
            "",
            *prelude(plan),
            f"read_data data.{plan.name} fix model NULL Model",
            *_wide_columns(plan),
            "",
            *_with_bodies(plan, commands),
            "",
            *(["# Commands of the scene, as they stand.", *lines, ""] if (lines := lines_of_scene(plan)) else []),
            "# Several ranks: cut space so that every rank has the same share; changes no bit of the result.",
            *BALANCE,
            "",
            f"thermo {c.steps_per_frame}",
            f"thermo_style custom step time ke pe{' ebond' if len(plan.bonds) else ''}{energy}",
            "thermo_modify norm no flush yes",
            *variable,
            f"dump trajectory all custom {when} {plan.name}.lammpstrj id mol type x y z vx vy vz",
            "dump_modify trajectory sort id format float %.17g",
            *modify,
            f"run {c.steps}",
            "",
        ]
    )
