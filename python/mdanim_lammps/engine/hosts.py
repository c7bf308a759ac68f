# SPDX-License-Identifier: GPL-2.0-only
"""Whether objects are inside of those that have no cells: what is held, and rigid objects that are not convex; and whether
what does not deform has gone through the surface of what does."""

from __future__ import annotations

from collections.abc import Container, Iterator
from functools import cached_property

import numpy as np

from ..model import mesh, shapes
from ..model.contact_body import BodyFrame
from ..model.nearest import Nearest
from ..model.system import System
from ..scene.scene import Mesh, PieceShape

DEEP = 0.4
"""Depth of the centre of a guest below its own surface, over its thickness, from which on it says that all of it is in another
object: no blow goes as deep."""
IN_CELL, AT_SURFACE = 0.75, 0.5
"""Cells from the middle of the nearest cell within which a place is in a body that deforms; and from its box, within which no
place is looked at."""
YIELDS = 0.25
"""Depth of a centre in a body that deforms, in cells of that, to which contact may let it: as far as the surface yields to a
stress that folds cells (docs/physics-contact.md)."""
BOX = [0, 1, 2, 4]
"""The lower corner of a box, and the ends of its edges there."""

UPPER = [[1, 2, 5, 6], [2, 3, 6, 7], [4, 5, 6, 7]]
"""Corners of the upper sides of a hexahedron of VTK across x, y and z."""


class Hosts:
    """The objects of a system without cells, by their shapes."""

    def __init__(self, system: System, passing: Container[tuple[int, int]], first_cell: np.ndarray):
        self.system, self.passing, self.first_cell = system, passing, first_cell
        self.whole = system.rigid | system.held_whole
        boxed = np.array([frame.corners is not None for frame in system.frames])[system.contact_kind]
        self.numbers = np.flatnonzero(self.whole & boxed & (np.diff(first_cell) == 0))
        """Which they are, ascending."""
        self.firm, self.soft = np.flatnonzero(self.whole & boxed), np.flatnonzero(~self.whole & ~system.bare)
        """Solids that are corners of a box, and those that deform and fill a volume, ascending."""
        self._surfaces: dict[Mesh, mesh.Triangles] = {}

    @cached_property
    def guests(self) -> np.ndarray:
        """Solids that are looked for in them, ascending: those that deform, and of others those whose centre of mass is deep in
        them."""
        system, deep = self.system, {}
        for m in np.flatnonzero(self.whole).tolist():
            kind = int(system.contact_kind[m])
            if kind not in deep:
                shape = system.frames[kind].shape
                deep[kind] = float(shapes.depth(shape, np.zeros((1, 3)))[0]) >= DEEP * shapes.thickness(shape)
        solid = np.array([deep.get(kind, True) for kind in system.contact_kind.tolist()])
        return np.flatnonzero(~system.bare & solid)

    @cached_property
    def surface(self) -> np.ndarray:
        """Particles on the surface of what deforms, bool, shape (N,)."""
        system = self.system
        drawn = np.concatenate([system.frames[kind].drawn for kind in system.contact_kind.tolist()])
        return system.boundary & drawn & ~self.whole[system.object]

    def sunk(self, x: np.ndarray, solids: np.ndarray | None = None) -> tuple[int, int] | None:
        """Two solids of which the first is in the second, as `Geometry.sunk`: a guest in a host, or what does not deform in what
        does. Of a guest that deforms a point of its surface is deeper than a cell, of others the centre is below the surface; of
        what does not deform a point of its surface is deeper than a cell in the other body as that was at the start."""
        if not len(self.numbers) and not (len(self.firm) and len(self.soft)):
            return None
        boxes, all_guests = self.system.bounds(x), self.guests if len(self.numbers) else self.numbers
        for host, guests in self._meeting(boxes, self.numbers, all_guests, solids):
            for guest in guests:
                if self._is_in(x, guest, host):
                    return guest, host
        for firm, soft in self._meeting(boxes, self.firm, self.soft, solids, AT_SURFACE * np.cbrt(self.system.cell_volume)):
            points = self._points_of(x, firm)
            for m in soft:
                if self._is_pierced(x, points, m):
                    return firm, m
        return None

    def holds_centre(self, x: np.ndarray, guest: int, host: int) -> bool:
        """Whether the centre of mass of one solid is in another one that has cells, deeper than contact lets it: the cells of a
        round body reach beyond its surface, by more than the thickness of a board."""
        centre = self._centre(x, guest)
        if self.system.frames[self.system.contact_kind[host]].corners is None:
            return self._below(x, host, centre, 0.0 if self.whole[host] else YIELDS)
        return bool(self._depth(host, self._through_box(x, host, centre))[0] > 0.0)

    def _centre(self, x: np.ndarray, m: int) -> np.ndarray:
        """Centre of mass of a solid [m], shape (1, 3)."""
        own = slice(self.system.first[m], self.system.first[m + 1])
        mass = self.system.mass[own]
        return (mass @ x[own] / mass.sum())[None]

    def _meeting(
        self,
        boxes: tuple[np.ndarray, np.ndarray],
        hosts: np.ndarray,
        guests: np.ndarray,
        solids: np.ndarray | None,
        inset: np.ndarray | float = 0.0,
    ) -> Iterator[tuple[int, list[int]]]:
        """Each host, and the guests that must not be in it whose boxes, smaller by their ``inset`` [m] at each side, overlap with
        its own; some at least."""
        if solids is not None:
            hosts, guests = np.intersect1d(hosts, solids), np.intersect1d(guests, solids)
        if not len(hosts) or not len(guests):
            return
        low, high = boxes
        inset = np.broadcast_to(inset, len(low))[guests, None]
        lower, upper = low[guests] + inset, high[guests] - inset
        still = self.system.still
        for m in hosts.tolist():
            near = guests[((lower < high[m]) & (upper > low[m])).all(axis=1)].tolist()
            met = [n for n in near if n != m and not (still[m] and still[n]) and (min(m, n), max(m, n)) not in self.passing]
            if met:
                yield m, met

    def _is_in(self, x: np.ndarray, guest: int, host: int) -> bool:
        system = self.system
        of_guest, of_host = (slice(system.first[m], system.first[m + 1]) for m in (guest, host))
        if self.whole[guest]:
            points, depth = self._centre(x, guest), 0.0
        else:
            points, depth = x[of_guest][self.surface[of_guest]], float(np.cbrt(system.cell_volume[guest]))
        corner, frame = x[of_host], system.frames[system.contact_kind[host]]
        points = points[((points > corner.min(axis=0)) & (points < corner.max(axis=0))).all(axis=1)]
        if not len(points):
            return False
        points = self._through_box(x, host, points)
        if isinstance(frame.shape, Mesh):  # few are in it, and only these are asked for exactly
            points = points[mesh.quick_depth(self._surface(frame.shape))(points) > depth]
        return bool(len(points)) and bool((self._depth(host, points) > depth).any())

    def _points_of(self, x: np.ndarray, firm: int) -> np.ndarray:
        """Points of the surface of a solid that is corners of a box [m], shape (K, 3), ascending along x; none of one that only
        its features touch."""
        corner, frame = x[self.system.first[firm] :][BOX], self.system.frames[self.system.contact_kind[firm]]
        if isinstance(frame.shape, Mesh | PieceShape) and frame.cells.filled.size == 1:
            return np.zeros((0, 3))
        own, at = _own_box(frame), frame.cells.low + frame.contact.at * frame.cells.edge
        points = corner[0] + (at - own[0]) @ np.linalg.solve(own[1:] - own[0], corner[1:] - corner[0])
        return points[np.argsort(points[:, 0])]

    def _is_pierced(self, x: np.ndarray, points: np.ndarray, soft: int) -> bool:
        """Whether one of some points [m], shape (K, 3), ascending along x, is deeper than a cell in a solid that deforms."""
        system = self.system
        around, margin = x[system.first[soft] : system.first[soft + 1]], AT_SURFACE * float(np.cbrt(system.cell_volume[soft]))
        low, high = around.min(axis=0) + margin, around.max(axis=0) - margin
        points = points[slice(*np.searchsorted(points[:, 0], (low[0], high[0])))]
        points = points[((points > low) & (points < high)).all(axis=1)]
        return bool(len(points)) and self._below(x, soft, points, 1.0)

    def _below(self, x: np.ndarray, m: int, points: np.ndarray, deep: float) -> bool:
        """Whether one of some points [m], shape (K, 3), is deeper in a solid, as that was at the start, than so many cells."""
        system, body = self.system, self.system.frames[self.system.contact_kind[m]]
        place = x[system.hexahedron[slice(*self.first_cell[m : m + 2])]]
        middle = place.mean(axis=1)
        near = Nearest(middle)(points)[1]
        of = np.stack([place[near][:, ends].mean(axis=1) for ends in UPPER], axis=1) - middle[near][:, None]
        solid = np.linalg.det(of) != 0.0  # a flat cell has no inside
        near, of, points = near[solid], of[solid], points[solid]
        within = np.linalg.solve(np.swapaxes(of, 1, 2), (points - middle[near])[..., None])[..., 0] / 2.0
        inside = (np.abs(within) <= IN_CELL).all(axis=1)
        number = np.argwhere(body.cells.filled)[near[inside], ::-1]
        rest = body.cells.low + (number + 0.5 + within[inside]) * body.cells.edge
        return bool((self._depth(m, rest) > deep * np.cbrt(system.cell_volume[m])).any())

    def _through_box(self, x: np.ndarray, m: int, points: np.ndarray) -> np.ndarray:
        """Places of points [m], shape (K, 3), in the own frame of a solid that is corners of a box."""
        corner, own = x[self.system.first[m] :][BOX], _own_box(self.system.frames[self.system.contact_kind[m]])
        return own[0] + (points - corner[0]) @ np.linalg.solve(corner[1:] - corner[0], own[1:] - own[0])

    def _depth(self, m: int, places: np.ndarray) -> np.ndarray:
        """Depths of places in the own frame of a solid below its surface [m], shape (K,)."""
        shape = self.system.frames[self.system.contact_kind[m]].shape
        return mesh.depth(self._surface(shape), places) if isinstance(shape, Mesh) else shapes.depth(shape, places)

    def _surface(self, shape: Mesh) -> mesh.Triangles:
        """The surface of a mesh, whose file may be gone since the start."""
        if shape not in self._surfaces:
            self._surfaces[shape] = mesh.load(shape)
        return self._surfaces[shape]


def _own_box(frame: BodyFrame) -> np.ndarray:
    """BOX of a body in its own frame [m], shape (4, 3)."""
    return frame.cells.low + frame.corners[BOX] * frame.cells.edge
