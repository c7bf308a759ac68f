# SPDX-License-Identifier: GPL-2.0-only
"""A plan as a LAMMPS data file, and its contact bodies as text. The only place where ids become 1-based in text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from ..model.contact_body import ContactBody
from .columns import spread, wide_columns
from .commands import bond_coeffs, box
from .plan import Plan

CHUNK = 1 << 16


def rows(pattern: str, *columns: np.ndarray) -> Iterator[str]:
    """Lines of text from equally long columns; ``pattern`` formats one row, floats by ``%r`` so that no bit is lost."""
    for start in range(0, len(columns[0]), CHUNK):
        block = [c[start : start + CHUNK].tolist() for c in columns]
        yield "".join(pattern % row for row in zip(*block))


def data_text(plan: Plan) -> Iterator[str]:
    """The text of ``data.NAME``, in pieces."""
    system = plan.system
    n, s = system.particles, len(plan.bonds)
    tag = np.arange(1, n + 1)
    low, high = box(plan).tolist()
    yield f"{plan.scene.title or plan.name}: {len(system.names)} objects, written by mdanim-lammps\n\n"
    yield f"{n} atoms\n{s} bonds\n8 atom types\n{len(plan.coefficients)} bond types\n\n"
    for axis, a, b in zip("xyz", low, high):
        yield f"{a!r} {b!r} {axis}lo {axis}hi\n"
    if not n:  # liquid alone
        return
    # Remarks to LAMMPS, which knows molecules by number.
    yield "".join(f"# molecule {number} {name}\n" for number, name in enumerate(system.names, 1))
    yield "\nAtoms # bond\n\n"
    yield from rows("%d %d %d %r %r %r\n", tag, system.object + 1, plan.kind, *system.position.T)
    yield "\nVelocities\n\n"
    yield from rows("%d %r %r %r\n", tag, *system.velocity.T)
    narrow = [name for name in plan.columns if name not in wide_columns(plan)]
    numbers = [one for name in narrow for one in spread(plan, name).reshape(n, -1).T]
    yield "\nModel # mass" + "".join(f" {name}" for name in narrow) + "\n\n"
    yield from rows(f"%d{' %r' * (1 + len(numbers))}\n", tag, system.mass, *numbers)
    if s:
        yield "\nBond Coeffs # mdanim/harmonic\n\n" + "\n".join(bond_coeffs(plan)) + "\n"
        yield "\nBonds\n\n"
        yield from rows("%d %d %d %d\n", np.arange(1, s + 1), plan.bond_kind, plan.bonds[:, 0] + 1, plan.bonds[:, 1] + 1)


def write_wide_columns(plan: Plan, path: Path) -> None:
    """Write ``columns.NAME``, for a variable `atomfile`: for each number of each table a line per particle. Raises OSError."""
    n = plan.system.particles
    with open(path, "w", encoding="ascii") as file:
        for name in wide_columns(plan):
            for numbers in spread(plan, name).T:
                file.write(f"# {name}\n{n}\n")
                file.writelines(rows("%d %r\n", np.arange(1, n + 1), numbers))


def write_data(plan: Plan, path: Path) -> None:
    """Write ``data.NAME``. Raises OSError."""
    with open(path, "w", encoding="ascii", errors="replace") as file:  # a title may hold any letter
        file.writelines(data_text(plan))


def bodies_text(bodies: Mapping[int, ContactBody]) -> Iterator[str]:
    """The text of ``contact.NAME``, in pieces: bodies by their numbers (docs/fix_mdanim_contact.md)."""
    yield "# Contact bodies, written by mdanim-lammps\n"
    for kind, body in bodies.items():
        yield f"\nbody {kind}\n"
        yield from rows("cells %d %d %d\n", *body.count[:, None])
        yield from rows("edge %r %r %r\n", *body.edge[:, None])
        if body.radius:
            shared = len(body.sharer)
            yield f"line {len(body.node)} {body.radius!r} {body.hardness!r} {body.spread!r} {shared}\n"
            yield from rows("%d %d %d %r %r %r\n", *body.sharer.T, *body.share.T)
        elif body.frame is None or body.frame_at is None:
            yield f"{'tears' if body.tears else 'particles'} {len(body.node)}\n"
            yield from rows("%d\n", body.node)
        else:
            yield f"rigid {len(body.node)}  # four particles, at\n"
            yield from rows("%d %r %r %r\n", body.frame, *body.frame_at.T)
        yield f"filled {len(body.filled)}\n"
        yield from rows("%d\n", body.filled)
        yield f"points {len(body.cell)}  # cell, kind, area, at, centre, normal\n"
        yield from rows("%d %d" + " %r" * 10 + "\n", body.cell, body.kind, body.area, *body.at.T, *body.centre.T, *body.normal.T)
        depth = np.zeros(0) if body.depth is None else body.depth
        yield f"depth {len(depth)}\n"
        yield from rows("%r\n", depth)
        yield f"open {len(body.open)}  # side, low and high along the first and the second axis across\n"
        yield from rows("%d" + " %r" * 4 + "\n", *body.open.T)


def write_bodies(plan: Plan, path: Path) -> None:
    """Write ``contact.NAME``. Raises OSError."""
    with open(path, "w", encoding="ascii") as file:
        file.writelines(bodies_text(plan.contact_bodies))
