# SPDX-License-Identifier: GPL-2.0-only
"""Plans of some objects of a plan: they evolve bit for bit as in the whole, as long as they meet none of the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import accumulate, pairwise

import numpy as np

from ..effects import Context, Effect
from ..model.system import System
from ..records import dataclass
from .plan import DRIVEN, Ends, Plan, both_ends


@dataclass(frozen=True)
class SubPlan(Plan):
    """A plan of some objects of a whole; object ``k`` of it is object ``objects[k]`` of the whole."""

    objects: tuple[int, ...]
    """Ascending, from 0."""
    make_ends: Callable[[], Ends]

    def ends(self) -> Ends:
        return self.make_ends()


class SubPlans:
    """Cuts parts out of a plan; keeps what is dear and the same whenever an object is part of one."""

    def __init__(self, whole: Plan):
        self.whole = whole
        system = whole.system
        owner = system.object
        counted = np.arange(len(system.names) + 1)
        # First rows of each object; lists, for they are asked for one by one.
        self._particle: list[int] = system.first.tolist()
        self._spring, self._bond, self._cell = (
            np.searchsorted(owner[array[:, 0]], counted).tolist() for array in (system.spring, whole.bonds, system.hexahedron)
        )
        self._ends: dict[int, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}

    @cached_property
    def gap(self) -> np.ndarray:
        """Gap from which on two objects do not feel each other [m]: the larger of their entries; shape (M,),
        0 without contact."""
        whole = self.whole
        own = [np.broadcast_to(e.gap(whole.context), len(whole.system.names)) for e in whole.effects]
        return np.maximum.reduce(own, initial=0.0, axis=0) if own else np.zeros(len(whole.system.names))

    @cached_property
    def grid_top(self) -> float:
        """Height above which an object and the cells of the grid do not matter to each other [m]; minus infinity without one."""
        return max((e.matters_below(self.whole.context) for e in self.whole.effects), default=-np.inf)

    def part(self, objects: Sequence[int], grid: bool) -> Plan:
        """The plan of these objects, from 0 and ascending, and of the grid with what it does to them, or without.

        Tags, molecules and bond types are numbered anew, from 1 and in the same order. Contact is left out where no two objects
        could touch. Raises ValueError for objects that are not ascending or not there, for a grid that is not there, and for
        nothing at all.
        """
        objects = tuple(int(m) for m in objects)
        self._check(objects, grid)
        whole, runs = self.whole, _runs(objects)
        take = _Taker(runs, self._particle)
        system = self._system(objects, runs)
        context = replace(whole.context, system=system, grid=whole.grid if grid else None)
        effects = self._effects(context)
        wanted = {name for e in effects for name in whole.asked[e.name]} | ({DRIVEN} if system.driven.any() else set())
        takers = {"particle": take, "bond": _Taker(runs, self._bond), "object": _Taker(runs, range(len(self._particle)))}

        def part(name: str) -> np.ndarray:
            field, values = whole.fields[name], whole.columns[name]
            return take.tags(values, field.tags) if field.tags else takers[field.per](values)

        used = self._used(objects)
        number = np.zeros(len(whole.coefficients) + 1, whole.bond_kind.dtype)
        number[used] = np.arange(1, len(used) + 1)
        return SubPlan(
            context=context,
            certificate=whole.certificate,
            effects=effects,
            columns={name: part(name) for name in whole.columns if name in wanted},
            fields={name: field for name, field in whole.fields.items() if name in wanted},
            slots=whole.slots,
            bonds=system.spring if len(whole.bonds) else system.spring[:0],
            bond_kind=number[takers["bond"](whole.bond_kind)],
            coefficients=whole.coefficients[used - 1],
            asked={e.name: whole.asked[e.name] for e in effects},
            spacing=whole.spacing,
            exponential=whole.exponential,
            objects=objects,
            make_ends=lambda: self._join_ends(objects, system.first, number),
        )

    def _check(self, objects: tuple[int, ...], grid: bool) -> None:
        count = len(self.whole.system.names)
        if any(b <= a for a, b in pairwise(objects)):
            raise ValueError(f"objects of a part must ascend, so that sums keep their order; got {objects}")
        if objects and not 0 <= objects[0] <= objects[-1] < count:
            raise ValueError(f"objects of a part must be within 0 and {count - 1}, got {objects}")
        if grid and self.whole.grid is None:
            raise ValueError("the plan has no grid")
        if not objects and not grid:
            raise ValueError("a part needs an object, or the grid")

    def _effects(self, context: Context) -> tuple[Effect, ...]:
        """The effects of the whole without those that have nothing to act on."""
        missing, effects = set(), []
        for effect in self.whole.effects:
            if effect.acts_on(context) and not missing.intersection(effect.needs):
                effects.append(effect)
            else:
                missing.add(effect.name)
        return tuple(effects)

    def _system(self, objects: tuple[int, ...], runs: list[tuple[int, int]]) -> System:
        s = self.whole.system
        particle, spring, cell = (_Taker(runs, first) for first in (self._particle, self._spring, self._cell))
        index = np.array(objects, np.intp)
        return _Cut(
            names=lambda: tuple(s.names[m] for m in objects),
            first=lambda: np.concatenate([[0], np.cumsum(np.diff(s.first)[index])]).astype(np.int64),
            position=lambda: particle(s.position),
            velocity=lambda: particle(s.velocity),
            mass=lambda: particle(s.mass),
            share=lambda: particle(s.share),
            layer=lambda: particle(s.layer),
            held=lambda: particle(s.held),
            spring=lambda: particle.renumber(s.spring, spring),
            spring_type=lambda: spring(s.spring_type),
            constants=lambda: s.constants,
            young=lambda: s.young[index],
            spacing=lambda: s.spacing[index],
            cell_volume=lambda: s.cell_volume[index],
            per_share=lambda: s.per_share[index],
            inertia_error=lambda: s.inertia_error[index],
            hexahedron=lambda: particle.renumber(s.hexahedron, cell),
            contact_kind=lambda: s.contact_kind[index],
            frames=lambda: s.frames,
            driven=lambda: s.driven[index],
            pinned=lambda: particle(s.pinned),
            inertia=lambda: s.inertia[index],
            rigid=lambda: s.rigid[index],
        )

    # --- springs at both ends: kept by object, for it takes a sort to make them ---------------------------------------

    def _ends_of(self, m: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Springs at each particle of one object, partners (from 1) in it, types in the whole."""
        if m not in self._ends:
            mine = slice(self._bond[m], self._bond[m + 1])
            start = self._particle[m]
            ends = both_ends(self.whole.bonds[mine] - np.int32(start), self.whole.bond_kind[mine], self._particle[m + 1] - start)
            self._ends[m] = np.diff(ends.first), ends.partner, ends.kind
        return self._ends[m]

    def _used(self, objects: tuple[int, ...]) -> np.ndarray:
        """Bond types of the whole that these objects have, ascending."""
        present = np.zeros(len(self.whole.coefficients) + 1, bool)
        for m in objects:
            present[self._kinds[m]] = True
        return np.flatnonzero(present)

    @cached_property
    def _kinds(self) -> list[np.ndarray]:
        kinds = self.whole.bond_kind
        return [np.flatnonzero(np.bincount(kinds[a:b])) for a, b in zip(self._bond, self._bond[1:])]

    def _join_ends(self, objects: tuple[int, ...], first: np.ndarray, number: np.ndarray) -> Ends:
        pieces = [self._ends_of(m) for m in objects]
        count, partner, kind = (_join([p[k] for p in pieces], np.int32) for k in range(3))
        where = np.concatenate([[0], np.cumsum(count, dtype=np.int64)])
        shift = np.repeat(first[:-1].astype(np.int32), np.diff(where[first]))
        return Ends(where, partner + shift, number[kind].astype(np.int32))


class _Cut(System):
    """A system cut out of another: an instance asks for few of its arrays, so each is made when it is first asked for."""

    def __init__(self, **make: Callable[[], object]):
        self.__dict__["make"] = make

    def __getattr__(self, name: str):
        if name not in self.__dict__["make"]:
            raise AttributeError(name)
        self.__dict__[name] = self.__dict__["make"][name]()
        return self.__dict__[name]


class _Taker:
    """Takes what belongs to some objects out of arrays in which object m has the rows [first[m], first[m+1])."""

    def __init__(self, runs: list[tuple[int, int]], first: list[int]):
        self.slices = [slice(first[a], first[b]) for a, b in runs]

    @cached_property
    def shifts(self) -> list[int]:
        """By how much the rows of each run come earlier in the part than in the whole."""
        sizes = [s.stop - s.start for s in self.slices]
        return [s.start - before for s, before in zip(self.slices, accumulate(sizes, initial=0))]

    def __call__(self, array: np.ndarray) -> np.ndarray:
        """Rows of an array; a view where they lie side by side."""
        if len(self.slices) == 1:
            return array[self.slices[0]]
        return np.concatenate([array[:0], *(array[s] for s in self.slices)])

    def renumber(self, array: np.ndarray, rows: _Taker) -> np.ndarray:
        """Rows of an array whose entries are row numbers of this taker's, numbered anew."""
        pieces = [array[s] - array.dtype.type(shift) if shift else array[s] for s, shift in zip(rows.slices, self.shifts)]
        return pieces[0] if len(pieces) == 1 else np.concatenate([array[:0], *pieces])

    def tags(self, table: np.ndarray, columns: int) -> np.ndarray:
        """Rows of a table whose first columns are tags (from 1, 0 for none), these numbered anew."""
        rows = self(table)
        shift = np.repeat(self.shifts, [s.stop - s.start for s in self.slices]).astype(table.dtype)[:, None]
        tags = rows[:, :columns]
        return np.hstack([np.where(tags > 0, tags - shift, 0), rows[:, columns:]])


def _runs(objects: tuple[int, ...]) -> list[tuple[int, int]]:
    """First object, and that behind the last, of every stretch without a gap."""
    starts = [k for k in range(len(objects)) if k == 0 or objects[k] != objects[k - 1] + 1]
    return [(objects[a], objects[b - 1] + 1) for a, b in zip(starts, [*starts[1:], len(objects)])]


def _join(pieces: list[np.ndarray], dtype) -> np.ndarray:
    return pieces[0] if len(pieces) == 1 else np.concatenate([np.zeros(0, dtype), *pieces])
