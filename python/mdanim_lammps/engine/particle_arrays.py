# SPDX-License-Identifier: GPL-2.0-only
"""The particles of a plan in LAMMPS: put in, and their values as arrays in tag order."""

from __future__ import annotations

import ctypes

import numpy as np

from .c_arrays import pointer
from .columns import gathered, property_of, spread
from .commands import BALANCE
from .opened_lammps import OpenedLammps
from .plan import Ends, Plan


class ParticleArrays:
    """Values of particles by name, ``x``, ``v``, ``f`` or a property. On several ranks each has those in its part of space, and
    all call the methods together."""

    def __init__(self, lammps: OpenedLammps, plan: Plan):
        self._lammps, self._plan = lammps, plan
        self._views: dict[str, tuple[int | None, np.ndarray]] = {}
        """Arrays of LAMMPS, and where they were."""
        self._gathered: dict[str, np.ndarray] = {}
        """Arrays of all ranks in tag order, and ``where`` each tag comes, rank by rank, until something changes them."""
        self._tags = self._ascending = self._rows = np.zeros(0, np.int32)
        """Tags of this rank's particles, as they were at the last look; their places by ascending tags; and `rows`."""

    def forget(self) -> None:
        """To be called before anything changes values behind the back of this object."""
        self._gathered.clear()

    # --- into LAMMPS ----------------------------------------------------------------------------------------------

    def insert(self, ends: Ends | None, position: np.ndarray) -> None:
        """Hand all particles, and springs if they are to have them, to the plugin; each rank takes those in its part of space."""
        plan, system = self._plan, self._plan.system
        n = system.particles
        names = [name for name, field in plan.fields.items() if field.per == "particle" and property_of(field, 0).is_number]
        properties = np.array([plan.columns[c] for c in names], dtype=np.float64).reshape(len(names), n)
        tag = np.arange(1, n + 1, dtype=np.int32)
        molecule = (system.object + 1).astype(np.int32)
        reals = [np.ascontiguousarray(a, np.float64) for a in (position, system.velocity, system.mass)]
        self._lammps.call(
            f"insert {n} particles",
            "mdanim_insert",
            ctypes.c_int(n),
            *(tag, plan.kind, molecule, *reals),
            ctypes.c_int(len(names)),
            (ctypes.c_char_p * max(1, len(names)))(*(c.encode() for c in names)),
            properties,
            *(map(pointer, ends) if ends else [None] * 3),
        )
        for name in plan.fields:
            if name not in names:
                self.put_column(name, spread(plan, name))

    def cut_space(self, position: np.ndarray) -> None:
        """Give every rank its share of the particles, and all of them their places."""
        self.forget()
        self._lammps.command(BALANCE[0])
        self.write("x", position)

    def write(self, name: str, values: np.ndarray) -> None:
        """Set ``x``, ``v`` or ``f`` from an array in tag order."""
        self.forget()
        if self._lammps.comm:
            self.local(name)[:] = values[self.local("id", 1) - 1]
        else:
            self.array(name)[:] = values

    def put_column(self, name: str, rows: np.ndarray) -> None:
        """Set the property of a column, in tag order."""
        self.forget()
        here = self.local(self._property(name).name, rows.shape[1] if rows.ndim > 1 else 1)
        if len(here):
            here[...] = rows[self.local("id", 1) - 1].reshape(here.shape)

    # --- out of LAMMPS --------------------------------------------------------------------------------------------

    def array(self, name: str) -> np.ndarray:
        """``x``, ``v`` or ``f`` in tag order, shape (N, 3), or a property ``d_NAME``, shape (N,), ``d2_NAME``, shape (N, K).

        On one process a view, valid until the next command; on several ranks a copy of the values of all ranks, the same until
        then.
        """
        width = 3
        if "_" in name:
            width = self._property(name.split("_", 1)[1]).width or 1
        return self._gather(name, width) if self._lammps.comm else self._view(name, width)

    def column(self, name: str) -> np.ndarray:
        """Values of a column of the plan now, of particles, springs or objects in the order of the plan, shape (N, ...), (S, ...)
        or (M, ...); a copy."""
        return gathered(self._plan, name, self.array(self._property(name).name))

    def _property(self, name: str):
        return property_of(self._plan.fields[name], self._plan.slots)

    def rows(self) -> np.ndarray | slice:
        """Which rows of `array` are those of the particles that this rank has, ascending: the same object until that changes; all
        of them on one process."""
        if not self._lammps.comm:
            return slice(None)
        tags = self.local("id", 1)
        if not np.array_equal(tags, self._tags):
            self._tags, self._ascending = tags.copy(), np.argsort(tags)
            self._rows = self._tags[self._ascending] - 1
        return self._rows

    def here(self, name: str) -> np.ndarray:
        """The `rows` of ``x``, ``v`` or ``f``, shape (n, 3), without asking other ranks; valid until the next command."""
        if not self._lammps.comm:
            return self.array(name)
        self.rows()
        return self.local(name).take(self._ascending, axis=0)

    def local(self, name: str, width: int = 3) -> np.ndarray:
        """View of a per-particle array of this rank in LAMMPS's own order, shape (n, 3), or (n,) for a width of 1."""
        n = self._lammps.lmp.extract_setting("nlocal")
        if n == 0:
            return np.zeros((0, width) if width > 1 else 0, np.int32 if name.startswith("i") else np.float64)
        return self._lammps.lmp.numpy.extract_atom(name)[:n]

    def _view(self, name: str, width: int) -> np.ndarray:
        where = self._lammps.place(name)
        if where and width > 1:  # rows, of which the first tells where all are
            where = ctypes.c_void_p.from_address(where).value
        if self._views.get(name, (None,))[0] != where or not where:  # making a view takes longer than a small scene's step
            self._views[name] = where, self.local(name, width)
        return self._views[name][1]

    def _gather(self, name: str, width: int) -> np.ndarray:
        """A per-particle array of all ranks, in tag order."""
        if name not in self._gathered:
            mixed = self._gather_as_it_is(name, width)
            if "where" not in self._gathered:  # each tag comes
                tags = self._gather_as_it_is("id", 1)
                self._gathered["where"] = np.empty(len(tags), np.intp)
                self._gathered["where"][tags - 1] = np.arange(len(tags))
            self._gathered[name] = mixed.take(self._gathered["where"], axis=0)  # faster than to put rows where they belong
            self._gathered[name].flags.writeable = False  # all callers get this one
        return self._gathered[name]

    def _gather_as_it_is(self, name: str, width: int) -> np.ndarray:
        """The same, rank by rank."""
        comm, own = self._lammps.comm, np.ascontiguousarray(self.local(name, width))
        counts = np.array(comm.allgather(len(own)))
        mixed = np.empty((counts.sum(), *own.shape[1:]), own.dtype)
        comm.Allgatherv(own, (mixed, counts * width))
        return mixed
