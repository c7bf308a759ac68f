# SPDX-License-Identifier: GPL-2.0-only
"""Whether objects are inside of those that have no cells: what is held, and rigid objects that are not convex."""

from __future__ import annotations

from collections.abc import Container
from functools import cached_property

import numpy as np

from ..model import mesh, shapes
from ..model.system import System
from ..scene.scene import Mesh

DEEP = 0.4
"""Depth of the centre of a guest below its own surface, over its thickness, from which on it says that all of it is in another
object: no blow goes as deep."""
BOX = [0, 1, 2, 4]
"""The lower corner of a box, and the ends of its edges there."""


class Hosts:
    """The objects of a system without cells, by their shapes."""

    def __init__(self, system: System, passing: Container[tuple[int, int]]):
        self.system, self.passing = system, passing
        self.whole = system.rigid | system.held_whole
        cells = np.bincount(system.object[system.hexahedron[:, 0]], minlength=len(system.names))
        boxed = np.array([frame.corners is not None for frame in system.frames])[system.contact_kind]
        self.numbers = np.flatnonzero(self.whole & boxed & (cells == 0))
        """Which they are, ascending."""
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
        """A guest in a host, and the host, the first one of all hosts; x and ``solids`` as in `Geometry`. Of a guest that deforms
        a point of its surface is deeper than a cell, of others the centre is below the surface."""
        hosts, guests = self.numbers, self.guests if len(self.numbers) else self.numbers
        if solids is not None:
            hosts, guests = np.intersect1d(hosts, solids), np.intersect1d(guests, solids)
        if not len(hosts) or not len(guests):
            return None
        low, high = self.system.bounds(x)
        for m in hosts.tolist():
            near = guests[((low[guests] < high[m]) & (high[guests] > low[m])).all(axis=1)]
            for n in near.tolist():
                both_still = self.system.still[m] and self.system.still[n]
                if n != m and not both_still and (min(m, n), max(m, n)) not in self.passing and self._is_in(x, n, m):
                    return n, m
        return None

    def _is_in(self, x: np.ndarray, guest: int, host: int) -> bool:
        system = self.system
        of_guest, of_host = (slice(system.first[m], system.first[m + 1]) for m in (guest, host))
        if self.whole[guest]:
            mass, depth = system.mass[of_guest], 0.0
            points = (mass @ x[of_guest] / mass.sum())[None]
        else:
            points, depth = x[of_guest][self.surface[of_guest]], float(np.cbrt(system.cell_volume[guest]))
        corner, frame = x[of_host], system.frames[system.contact_kind[host]]
        points = points[((points > corner.min(axis=0)) & (points < corner.max(axis=0))).all(axis=1)]
        if not len(points):
            return False
        own = frame.cells.low + frame.corners[BOX] * frame.cells.edge
        edges = corner[BOX[1:]] - corner[0]
        points = own[0] + (points - corner[0]) @ np.linalg.solve(edges, own[1:] - own[0])
        if isinstance(frame.shape, Mesh):  # few are in it, and only these are asked for exactly
            surface = self._surface(frame.shape)
            points = points[mesh.quick_depth(surface)(points) > depth]
            return bool(len(points)) and bool((mesh.depth(surface, points) > depth).any())
        return bool((shapes.depth(frame.shape, points) > depth).any())

    def _surface(self, shape: Mesh) -> mesh.Triangles:
        """The surface of a mesh, whose file may be gone since the start."""
        if shape not in self._surfaces:
            self._surfaces[shape] = mesh.load(shape)
        return self._surfaces[shape]
