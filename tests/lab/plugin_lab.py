# SPDX-License-Identifier: GPL-2.0-only
"""Small elastic bodies as arrays, and LAMMPS instances filled with them, for the tests of the plugin.

Units: spacing h = density = Young's modulus = 1 (docs/physics-solids.md), so the wave speed is sqrt(1.2).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
import plugin_path

WAVE_SPEED = 1.2**0.5
BOUND = 2.0 / 8.0**0.5
"""Largest stable time step by w_b of a box, 2.83 sqrt(E/rho)/h."""


@dataclass(frozen=True)
class Body:
    """Particles and springs of one or more objects."""

    x: np.ndarray
    v: np.ndarray
    mass: np.ndarray
    molecule: np.ndarray
    boundary: np.ndarray
    """Whether a particle lies on the surface, bool, shape (N,)."""
    bond: np.ndarray
    """Pairs i < j, 0-based, sorted, shape (S, 2)."""
    k: np.ndarray
    r0: np.ndarray


def block(cells, corner=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0)) -> Body:
    """A box of cells; springs on edges and face diagonals, k = 0.4 n/4 and 0.4 n/2 if n cells share them."""
    nx, ny, nz = cells
    index = np.arange((nx + 1) * (ny + 1) * (nz + 1)).reshape(nz + 1, ny + 1, nx + 1)
    x = np.stack(np.meshgrid(np.arange(nz + 1), np.arange(ny + 1), np.arange(nx + 1), indexing="ij"), -1)[..., ::-1]
    places = np.array([*product((0, 1), repeat=3)])
    corners = index[:nz, :ny, :nx].reshape(-1, 1) + index[:2, :2, :2].reshape(-1)
    share = np.bincount(corners.reshape(-1), minlength=index.size) / 8.0
    apart = np.abs(places[:, None] - places).sum(-1)
    low, high = np.nonzero(np.triu((apart == 1) | (apart == 2)))  # a later corner has the higher number
    pairs = corners[:, low] * index.size + corners[:, high]
    part = np.broadcast_to(np.where(apart[low, high] == 1, 0.4 / 4.0, 0.4 / 2.0), pairs.shape)
    pair, which = np.unique(pairs, return_inverse=True)
    bond = np.stack(np.divmod(pair, index.size), 1)
    x = x.reshape(-1, 3).astype(float) + corner
    n = len(x)
    return Body(
        x,
        np.tile(np.asarray(velocity, float), (n, 1)),
        share,
        np.ones(n, int),
        share < 0.999,
        bond,
        np.bincount(which.reshape(-1), part.reshape(-1)),
        np.linalg.norm(x[bond[:, 0]] - x[bond[:, 1]], axis=1),
    )


def particles(x, molecule=None, boundary=None, v=None, mass=None) -> Body:
    """Loose particles."""
    x = np.asarray(x, float)
    n = len(x)
    return Body(
        x,
        np.zeros((n, 3)) if v is None else np.asarray(v, float),
        np.ones(n) if mass is None else np.asarray(mass, float),
        np.arange(1, n + 1) if molecule is None else np.asarray(molecule),
        np.ones(n, bool) if boundary is None else np.asarray(boundary),
        np.empty((0, 2), int),
        np.empty(0),
        np.empty(0),
    )


def join(*bodies: Body) -> Body:
    """Several bodies as one system; molecules are numbered on."""
    first = np.cumsum([0] + [len(b.x) for b in bodies])
    object_ = np.cumsum([0] + [b.molecule.max() for b in bodies])
    return Body(
        *(np.concatenate([getattr(b, name) for b in bodies]) for name in ("x", "v", "mass")),
        np.concatenate([b.molecule + o for b, o in zip(bodies, object_)]),
        np.concatenate([b.boundary for b in bodies]),
        np.concatenate([b.bond + f for b, f in zip(bodies, first)]),
        *(np.concatenate([getattr(b, name) for b in bodies]) for name in ("k", "r0")),
    )


def shaken(body: Body, amount: float, seed: int = 1) -> Body:
    """The same body with random displacements and velocities."""
    random = np.random.default_rng(seed)
    return replace(
        body, x=body.x + amount * random.standard_normal(body.x.shape), v=body.v + amount * random.standard_normal(body.v.shape)
    )


def bond_types(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Distinct (k, r0) and the type of each spring, from 1."""
    table, kind = np.unique(np.stack([body.k, body.r0], 1), axis=0, return_inverse=True)
    return table, kind.reshape(-1) + 1


def write_data(body: Body, path: Path, order=None, columns: dict | None = None) -> None:
    """A LAMMPS data file, its lines in this ``order``, tags as they are. Atom type 1 inner, 2 boundary."""
    columns = {"rmass": body.mass, **(columns or {})}
    order = np.arange(len(body.x)) if order is None else order
    table, kind = bond_types(body)
    low, high = body.x.min(0) - 1.0, body.x.max(0) + 1.0
    text = ["test", "", f"{len(body.x)} atoms", f"{len(body.bond)} bonds", "2 atom types", f"{max(1, len(table))} bond types", ""]
    text += [f"{a!r} {b!r} {n}lo {n}hi" for a, b, n in zip(low.tolist(), high.tolist(), "xyz")]
    text += ["", "Atoms # bond", ""]
    text += [f"{i + 1} {body.molecule[i]} {1 + body.boundary[i]} " + " ".join(map(repr, body.x[i].tolist())) for i in order]
    text += ["", "Velocities", ""] + [f"{i + 1} " + " ".join(map(repr, body.v[i].tolist())) for i in order]
    text += ["", "Model", ""] + [f"{i + 1} " + " ".join(repr(float(c[i])) for c in columns.values()) for i in order]
    if len(body.bond):
        text += ["", "Bonds", ""]
        text += [f"{n + 1} {t} {i + 1} {j + 1}" for n, (t, (i, j)) in enumerate(zip(kind, body.bond))]
    path.write_text("\n".join(text) + "\n")


def prelude(columns=(), newton="off", skin=0.4, cutoff=3.0, velocities=False, special="1 1 1") -> list[str]:
    """Commands before the particles are read."""
    return [
        "units lj",
        "atom_style bond",
        "atom_modify map array sort 0 0",
        f"newton {newton}",
        "boundary s s s",
        f"comm_modify cutoff {cutoff}" + (" vel yes" if velocities else ""),
        f"neighbor {skin} bin",
        "neigh_modify every 1 delay 0 check yes",
        "pair_style none",
        f"special_bonds lj/coul {special}",
        "fix model all property/atom rmass" + "".join(f" d_{c}" for c in columns) + " ghost yes",
    ]


def springs(body: Body, style="mdanim/harmonic", c=None) -> list[str]:
    """bond_style and its coefficients; LAMMPS's K is k/2."""
    if not len(body.bond):
        return ["bond_style zero", "bond_coeff * 1"]
    table, _ = bond_types(body)
    dashpot = "" if c is None else f" {c!r}"
    return [f"bond_style {style}"] + [
        f"bond_coeff {t} {0.5 * k!r} {r0!r}{dashpot}" for t, (k, r0) in enumerate(table.tolist(), 1)
    ]


def script(
    body: Body, folder: Path, commands=(), order=None, style="mdanim/harmonic", newton="off", c=None, columns=None, **options
):
    """Commands that make an instance with this body, which they read from a file in the folder; ``commands`` follow."""
    path = folder / "data.test"
    write_data(body, path, order, columns)
    return [
        *prelude(columns or (), newton, **options),
        f"read_data {path} fix model NULL Model",
        "mass * 1.0",
        *springs(body, style, c),
        "group inner type 1",
        "group boundary type 2",
        "thermo_modify norm no",
        *commands,
    ]


def load(body: Body, folder: Path, commands=(), **options):
    """A LAMMPS instance with this body in it; ``commands`` follow. Options are those of `script`."""
    lmp = plugin_path.lammps()
    try:
        for command in script(body, folder, commands, **options):
            lmp.command(command)
            if command.startswith("thermo_style"):  # which forgets thermo_modify
                lmp.command("thermo_modify norm no")
    except BaseException:
        lmp.close()
        raise
    return lmp


def restarted(file: Path, body: Body, commands=(), **options):
    """A LAMMPS instance that goes on from a restart file of one with this body; ``commands`` follow. Options are those of
    `prelude`."""
    lmp = plugin_path.lammps()
    kept = [c for c in prelude(**options) if not c.startswith(("fix", "atom_style", "units", "boundary", "newton"))]
    read = [f"read_restart {file}", "fix model all property/atom rmass ghost yes"]
    for command in [*kept, *read, *springs(body), *commands]:
        lmp.command(command)
    return lmp


class Running:
    """A LAMMPS instance that lives as long as a context."""

    fix = ""
    """The fix that is asked for its outputs."""
    outputs: tuple[str, ...] = ()
    """Names of the entries of its vector."""
    lmp = None

    def __exit__(self, *_) -> None:
        self.lmp.close()

    def run(self, steps: int) -> None:
        """Go on."""
        self.lmp.command(f"run {steps} pre no post no")

    def number(self, name: str) -> float:
        """An output of the fix by its name."""
        return self.lmp.extract_fix(self.fix, 0, 1, self.outputs.index(name))


def in_child(body: Body, folder: Path, commands=(), ranks=1, timeout=60.0, **options) -> str:
    """Run the same in processes of their own, which may hang or crash. Returns tags, positions, velocities and forces at the end
    as text to the last bit, a title and a line for each particle."""
    end = "write_dump all custom end.txt id x y z vx vy vz fx fy fz modify sort id format float %.17g"
    (folder / "in.test").write_text("\n".join([*script(body, folder, commands, **options), end, ""]))
    done = plugin_path.lmp(folder / "in.test", ranks, timeout=timeout)
    assert done.returncode == 0, done.stdout + done.stderr
    return (folder / "end.txt").read_text().partition("ITEM: ATOMS")[2]


def by_tag(lmp, name: str) -> np.ndarray:
    """Copy of a per-atom array of a one-rank instance, in tag order."""
    n = lmp.get_natoms()
    tag = lmp.numpy.extract_atom("id")[: int(n)]
    return lmp.numpy.extract_atom(name)[: int(n)][np.argsort(tag)].copy()


def kinetic(body: Body, v: np.ndarray) -> float:
    """Kinetic energy for velocities v."""
    return float(0.5 * (body.mass * (v**2).sum(1)).sum())


def conserved(lmp, body: Body, dt: float, steps: int) -> float:
    """Run and give the energy that leap-frog conserves to fourth order, T + U + dt^2 (v.U''.v/12 - F.F/24m).

    ``thermo_style`` must name ``pe``; fixes that hold an energy are asked by ``fix_modify energy``.
    """
    lmp.command(f"run {steps - 1}" if lmp.extract_global("ntimestep") == 0 else f"run {steps - 1} pre no")
    before = by_tag(lmp, "f")
    lmp.command("run 1 pre no")
    f, v = by_tag(lmp, "f"), by_tag(lmp, "v")
    half = v - 0.5 * dt * f / body.mass[:, None]
    corrected = -dt * np.sum(half * (f - before)) / 12.0 - dt**2 * np.sum(f**2 / body.mass[:, None]) / 24.0
    return kinetic(body, v) + corrected + lmp.get_thermo("pe")
