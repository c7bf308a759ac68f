# SPDX-License-Identifier: GPL-2.0-only
"""Welds between rigid objects: these move as one body of ``fix mdanim/rigid`` (docs/physics-joints.md, "Welds of rigid
objects")."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ...effects.context import Context
from ...effects.readings import Readings
from ...model.shapes import thickness
from ...model.spin import rotation
from ...model.system import System
from ...scene.once import once_for
from ...scene.scene import Solid
from ..rigid.touching import AT, BEARS_FORCE, BEARS_TORQUE, told_of_bodies
from .ends import lever
from .links import Link, Links, links_of
from .rows import TOLD


def welds_here(context: Context) -> list[Link]:
    """The welds of a context that make one body of two objects."""
    names = set(context.system.names)
    solids = context.scene.solids
    return [link for link in links_of(context.scene).welds if solids[link.first].name in names] if context.scene.joints else []


def thin_of(solids: Sequence[Solid], link: Link) -> float:
    """Thinnest part of what a weld joins [m]."""
    return min(thickness(solids[m].shape) for m in link.ends)


def arm_of(solids: Sequence[Solid], link: Link) -> float:
    """Distance of a weld from the farther one of the centres of what it joins [m]."""
    return max(math.dist(solids[m].position, link.begin) for m in link.ends)


def told_of_welds(readings: Readings) -> np.ndarray:
    """Columns that rows of joints tell of the welds of a context, shape (J, TOLD)."""
    context = readings.context
    here = welds_here(context)
    told = np.zeros((len(here), TOLD))
    if not here:
        return told
    links = links_of(context.scene)
    number = {name: m for m, name in enumerate(context.system.names)}
    number_of = {k: number[solid.name] for k, solid in enumerate(context.scene.solids) if solid.name in number}
    told_of = told_of_bodies(readings)
    rows = {k: told_of[m] for k, m in number_of.items() if m in told_of}
    hangs = hung_by(links)
    x = readings.array("x")
    whole = (ring for ring in rings(links) if ring.parts[0] in rows)
    shared = dict(found for ring in whole for found in _shared(context.system, x, ring, number_of, rows))
    for n, link in enumerate(here):
        if link.number in shared:
            force, torque, place = shared[link.number]
        else:
            row = rows[hangs[link.number]]
            force, torque, place = row[BEARS_FORCE], row[BEARS_TORQUE], row[AT]
        told[n, 0] = np.linalg.norm(force)
        told[n, 1] = np.linalg.norm(torque)
        told[n, 7:] = np.tile(place, 2)
    return told


def _shared(
    system: System, x: np.ndarray, ring: Ring, number_of: dict[int, int], rows: dict[int, np.ndarray]
) -> Iterator[tuple[int, np.ndarray]]:
    """Numbers of the welds of a body with a ring, each with what it bears: force, torque and place, shape (3, 3), with
    particles at x [m], shape (N, 3); ``number_of`` has the numbers in the system of solids of the scene."""
    mine = np.concatenate([np.arange(*system.first[m : m + 2]) for m in (number_of[k] for k in ring.parts)])
    turned = rotation(system.mass[mine], system.position[mine], x[mine])
    borne = np.zeros((len(ring.parts), 6))
    for k, _, weld in ring.hangs:
        row = rows[ring.parts[k]]
        borne[k] = np.concatenate([row[BEARS_FORCE] @ turned, row[BEARS_TORQUE] @ turned])
        moved = row[AT] - turned @ weld.begin
    for weld, load in zip(ring.welds, ring.shares(borne)):
        yield weld.number, np.array([load[:3], load[3:], turned @ weld.begin + moved])


class Ring:
    """A body whose welds close rings. Balance does not tell what each of them bears: they share it as springs would that are all
    alike, k u^2/2 + k L^2 w^2/2 with the way u and the turn w by which a weld gives way, and its arm L."""

    def __init__(self, links: Links, parts: list[int], welds: list[Link]):
        self.solids, self.parts, self.welds = links.solids, parts, welds
        number = {m: k for k, m in enumerate(parts)}
        self.ends = [[number[m] for m in weld.ends] for weld in self.welds]
        hung = hung_by(links)
        self.hangs = [
            (number[hung[weld.number]], sum(ends) - number[hung[weld.number]], weld)
            for weld, ends in zip(self.welds, self.ends)
            if weld.number in hung
        ]
        """Each part but the first, by its place among them, the part that it hangs on, and the weld between."""
        self.arms = np.array([max(arm_of(self.solids, weld), thin_of(self.solids, weld)) for weld in self.welds])

    def shares(self, borne: np.ndarray) -> np.ndarray:
        """Loads of welds, force and torque about the place of each, shape (W, 6), in the frame of the start, from what the welds
        by which parts hang would bear alone, shape (P, 6)."""
        loads = np.zeros((len(self.parts), 6))
        for k, other, weld in self.hangs:
            for sign, m in ((1.0, k), (-1.0, other)):
                turning = borne[k, 3:] + np.cross(weld.begin - self._place(m), borne[k, :3])
                loads[m] += sign * np.concatenate([borne[k, :3], turning])
        rows, solver = self._springs
        found = (rows @ solver.solve(loads[1:].ravel())).reshape(-1, 6)
        found[:, 3:] *= self.arms[:, None]
        return found

    @cached_property
    def _springs(self) -> tuple[Any, Any]:
        """Rows of what welds hold in the motions of all parts but the first, which stands, a turn times its arm, sparse, shape
        (6 W, 6 (P - 1)), and the solver of these springs."""
        from scipy.sparse import coo_array  # both take 0.2 s
        from scipy.sparse.linalg import splu

        turns, six = np.hstack([np.zeros((3, 3)), np.eye(3)]), np.arange(6)
        blocks, rows, columns = [], [], []
        for n, (weld, ends, arm) in enumerate(zip(self.welds, self.ends, self.arms)):
            for sign, k in zip((1.0, -1.0), ends):
                if k > 0:
                    blocks.append(sign * np.vstack([lever(weld.begin - self._place(k)), arm * turns]))
                    rows.append(np.repeat(6 * n + six, 6))
                    columns.append(np.tile(6 * (k - 1) + six, 6))
        shape = 6 * len(self.welds), 6 * (len(self.parts) - 1)
        held = coo_array((np.ravel(blocks), (np.concatenate(rows), np.concatenate(columns))), shape=shape).tocsc()
        return held, splu((held.T @ held).tocsc())

    def _place(self, k: int) -> np.ndarray:
        return np.array(self.solids[self.parts[k]].position, float)


@once_for(lambda links: links)
def rings(links: Links) -> list[Ring]:
    """Bodies whose welds close rings."""
    hangs = hung_by(links)
    welds: dict[int, list[Link]] = {}
    for weld in links.welds:
        welds.setdefault(links.whole_of[weld.first][0], []).append(weld)
    return [Ring(links, links.whole_of[m], of) for m, of in sorted(welds.items()) if any(w.number not in hangs for w in of)]


@once_for(lambda links: links)
def hung_by(links: Links) -> dict[int, int]:
    """The object that hangs on the first one of its body by a weld, by the number of the weld. Welds that close rings are not
    among them."""
    at: dict[int, list[Link]] = {}
    for link in links.welds:
        for m in link.ends:
            at.setdefault(m, []).append(link)
    found: dict[int, int] = {}
    for first in sorted({part[0] for part in links.whole_of.values()}):
        reached, todo = {first}, [first]
        for m in todo:
            for link in at[m]:
                other = link.first if link.second == m else link.second
                if other not in reached:
                    reached.add(other)
                    todo.append(other)
                    found[link.number] = other
    return found
