# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces made anew with triangles of about one size (Botsch and Kobbelt 2004): long edges are cut, short ones collapse, others
flip towards six at each corner, and corners move within the surface. Borders and creases stay where they are.
"""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np

from .triangles import areas, edges, normals, surface_of, unit_normals

LONG, SHORT = 4.0 / 3.0, 4.0 / 5.0
"""Lengths over the one that is asked for, above which an edge is cut and below which it collapses."""
ROUNDS = 8
CREASE = math.cos(math.radians(40.0))
"""Cosine of the angle between neighbours' normals below which their edge is a crease, and of the bend in a crease or border below
which it has a corner."""
TURNED = 0.5
"""Cosine of the angle by which a triangle may turn where an edge collapses or flips."""
EVEN = 0.55, 1.7
"""Edges of a surface over the length that is asked for, with which it stays as it is."""
MEAN = 0.85, 1.2
"""The same of their mean."""
FINEST = 4
"""Triangles of a surface over those that are asked for, above which it is first made coarser."""


def remeshed(points: np.ndarray, triangles: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points [m], shape (V, 3), triangles, int32, shape (T, 3), and borders and creases, pairs of points, shape (K, 2), of the
    same surface with edges of about this length [m]; as it is where they are so already. No edge has more than two triangles,
    which are all turned one way."""
    edge = edges(triangles)
    length = np.linalg.norm(points[edge[:, 0]] - points[edge[:, 1]], axis=1)
    even = length.min() >= EVEN[0] * size and length.max() <= EVEN[1] * size
    if even and MEAN[0] * size <= length.mean() <= MEAN[1] * size:
        return points, triangles, creases(points, triangles)
    target = _Target(points, triangles)
    net = _Net(*_coarser(points, triangles, size), smooth=target.is_smooth)
    for _ in range(ROUNDS):
        net.cut(LONG * size)
        net.collapse(SHORT * size, LONG * size)
        net.flip()
        net.even_out(target)
    net.flip(final=True)
    return *net.arrays(), net.lines()


def creases(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Edges i < j of one triangle, or of two that meet at an angle, shape (K, 2)."""
    edge = np.sort(edges(triangles), axis=1)
    pair, number, uses = np.unique(edge, axis=0, return_inverse=True, return_counts=True)
    normal = unit_normals(points, triangles)
    of = np.argsort(number.reshape(-1), kind="stable") // 3
    first = np.cumsum(uses) - uses
    sharp = uses == 1
    two = np.flatnonzero(uses == 2)
    sharp[two] = np.einsum("ij,ij->i", normal[of[first[two]]], normal[of[first[two] + 1]]) < CREASE
    return pair[sharp]


def _coarser(points: np.ndarray, triangles: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """A surface of far too many triangles with fewer, of the same connection."""
    wanted = FINEST * areas(points, triangles).sum() / (math.sqrt(3.0) / 4.0 * size**2)
    if len(triangles) <= wanted:
        return points, triangles
    import pyvista

    fine = pyvista.PolyData.from_regular_faces(points, triangles)
    return surface_of(
        fine.decimate_pro(1.0 - wanted / len(triangles), preserve_topology=True, splitting=False, boundary_vertex_deletion=False)
    )


class _Target:
    """A surface, its borders and creases, to which points are moved back."""

    def __init__(self, points: np.ndarray, triangles: np.ndarray):
        import pyvista

        self._surface = pyvista.PolyData.from_regular_faces(points, triangles)
        line = creases(points, triangles)
        self._a, self._b = points[line[:, 0]], points[line[:, 1]]
        self.is_smooth = not len(line)
        """Whether it has neither: what is bent sharply in a coarser one is not a crease of it."""

    def on_surface(self, x: np.ndarray) -> np.ndarray:
        """The nearest points of the surface, shape (N, 3)."""
        return np.asarray(self._surface.find_closest_cell(x, return_closest_point=True)[1]).reshape(-1, 3)

    def on_lines(self, x: np.ndarray) -> np.ndarray:
        """The nearest points of borders and creases, shape (N, 3)."""
        way = self._b - self._a
        square = np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)
        found = np.empty_like(x)
        for n, point in enumerate(x):
            part = np.clip(((point - self._a) * way).sum(axis=1) / square, 0.0, 1.0)
            near = self._a + part[:, None] * way
            found[n] = near[((near - point) ** 2).sum(axis=1).argmin()]
        return found


class _Net:
    """Triangles that change."""

    def __init__(self, points: np.ndarray, triangles: np.ndarray, smooth: bool = False):
        self.x = list(map(tuple, points.tolist()))
        self.triangle: dict[int, tuple[int, int, int]] = dict(enumerate(map(tuple, triangles.tolist())))
        self.of: defaultdict[int, set[int]] = defaultdict(set)
        """Triangles of each corner."""
        for t, corners in self.triangle.items():
            for c in corners:
                self.of[c].add(t)
        self.next = len(self.triangle)
        self.line: defaultdict[int, set[int]] = defaultdict(set)
        """The other ends of the borders and creases at each corner."""
        for a, b in [] if smooth else creases(points, triangles).tolist():
            self.line[a].add(b)
            self.line[b].add(a)
        self.fixed = {c for c, ends in self.line.items() if self._is_corner(c, ends)}

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Points and triangles, without what is gone."""
        kept = np.array([self.triangle[t] for t in sorted(self.triangle)], np.int64)
        used, number = np.unique(kept, return_inverse=True)
        return np.array(self.x)[used], number.reshape(-1, 3).astype(np.int32)

    def lines(self) -> np.ndarray:
        """Borders and creases, pairs of points of `arrays`, shape (K, 2)."""
        number = {v: n for n, v in enumerate(sorted(v for v, ts in self.of.items() if ts))}
        found = sorted((number[a], number[b]) for a, ends in self.line.items() for b in ends if a < b)
        return np.array(found, np.int64).reshape(-1, 2)

    def _is_corner(self, c: int, ends: set[int]) -> bool:
        if len(ends) != 2:
            return len(ends) > 0
        a, b = ends
        return _cosine(_less(self.x[c], self.x[a]), _less(self.x[b], self.x[c])) < CREASE

    def edges(self) -> list[tuple[int, int]]:
        """Pairs i < j, sorted."""
        return sorted(
            {(min(a, b), max(a, b)) for t in self.triangle.values() for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
        )

    def _beside(self, a: int, b: int) -> list[int]:
        """Triangles of an edge."""
        return sorted(self.of[a] & self.of[b])

    def _around(self, c: int) -> set[int]:
        """Corners beside a corner."""
        found = {d for t in self.of[c] for d in self.triangle[t]}
        found.discard(c)
        return found

    def _remove(self, t: int) -> None:
        for c in self.triangle.pop(t):
            self.of[c].discard(t)

    def _add(self, corners: tuple[int, int, int]) -> None:
        self.triangle[self.next] = corners
        for c in corners:
            self.of[c].add(self.next)
        self.next += 1

    def cut(self, long: float) -> None:
        """Halve edges that are longer [m], the longest first, until none is."""
        while True:
            far = [(-d, e) for e in self.edges() if (d := math.dist(self.x[e[0]], self.x[e[1]])) > long]
            if not far:
                return
            for _, (a, b) in sorted(far):
                beside = self._beside(a, b)
                if not beside:
                    continue
                middle = len(self.x)
                self.x.append(tuple(0.5 * (p + q) for p, q in zip(self.x[a], self.x[b])))
                for t in beside:
                    corners = self.triangle[t]
                    self._remove(t)
                    for gone in (a, b):
                        self._add(tuple(middle if c == gone else c for c in corners))
                if b in self.line[a]:
                    self.line[a].discard(b)
                    self.line[b].discard(a)
                    for end in (a, b):
                        self.line[end].add(middle)
                        self.line[middle].add(end)

    def collapse(self, short: float, long: float) -> None:
        """Merge the ends of edges that are shorter [m], where no other becomes longer than ``long`` [m]."""
        near = sorted((d, e) for e in self.edges() if (d := math.dist(self.x[e[0]], self.x[e[1]])) < short)
        for _, (a, b) in near:
            if self.of[a] & self.of[b] and math.dist(self.x[a], self.x[b]) < short:
                self._collapsed(a, b, long)

    def _collapsed(self, a: int, b: int, long: float) -> None:
        """Merge b into a, or a into b, where that may be."""
        on_line = b in self.line[a]
        choices = []
        for keep, gone in ((a, b), (b, a)):
            if gone in self.fixed or (self.line[gone] and not on_line):
                continue
            free = not (self.line[keep] or self.line[gone]) or (on_line and keep not in self.fixed and gone not in self.fixed)
            place = tuple(0.5 * (p + q) for p, q in zip(self.x[a], self.x[b])) if free else self.x[keep]
            choices.append((keep, gone, place))
        for keep, gone, place in choices[:1] if choices else ():
            shared = self.of[keep] & self.of[gone]
            opposite = {c for t in shared for c in self.triangle[t]} - {keep, gone}
            if self._around(keep) & self._around(gone) != opposite or len(self._around(gone) | self._around(keep)) < 5:
                continue
            if on_line and len(self.line[keep] & self.line[gone]):
                continue
            if any(math.dist(place, self.x[c]) > long for c in self._around(gone) | self._around(keep) if c not in (keep, gone)):
                continue
            moved = {keep: place, gone: place}
            changed = (self.of[gone] | self.of[keep]) - shared
            if not all(self._stays(t, moved) for t in changed):
                continue
            for t in sorted(shared):
                self._remove(t)
            for t in sorted(self.of[gone]):
                corners = self.triangle[t]
                self._remove(t)
                self._add(tuple(keep if c == gone else c for c in corners))
            for end in sorted(self.line.pop(gone, ())):
                self.line[end].discard(gone)
                if end != keep:
                    self.line[end].add(keep)
                    self.line[keep].add(end)
            self.x[keep] = place
            return

    def _stays(self, t: int, moved: dict[int, tuple]) -> bool:
        """Whether a triangle keeps its side when some corners move."""
        corners = self.triangle[t]
        before, after = (_normal(*(where.get(c, self.x[c]) for c in corners)) for where in ({}, moved))
        return _cosine(before, after) > TURNED

    def flip(self, final: bool = False) -> None:
        """Flip edges where corners then have more nearly six neighbours, four on a border; at the end where the angles opposite
        of an edge sum to more than half a turn."""
        for a, b in self.edges():
            beside = self._beside(a, b)
            if len(beside) != 2 or b in self.line[a]:
                continue
            (c,), (d,) = (set(self.triangle[t]) - {a, b} for t in beside)
            if c == d or d in self._around(c):
                continue
            if final:
                better = self._opposite(a, b, c) + self._opposite(a, b, d) > math.pi + 1e-9
            else:
                now = sum(self._off(v, 0) for v in (a, b, c, d))
                better = self._off(a, -1) + self._off(b, -1) + self._off(c, 1) + self._off(d, 1) < now
            if better:
                self._flipped(a, b, c, d, beside)

    def _off(self, v: int, more: int) -> int:
        """Square of the number of neighbours of a corner beyond the best one."""
        border = any(len(self.of[v] & self.of[e]) == 1 for e in self.line[v])
        return (len(self._around(v)) + more - (4 if border else 6)) ** 2

    def _opposite(self, a: int, b: int, c: int) -> float:
        return math.acos(max(-1.0, min(1.0, _cosine(_less(self.x[a], self.x[c]), _less(self.x[b], self.x[c])))))

    def _flipped(self, a: int, b: int, c: int, d: int, beside: list[int]) -> None:
        old = [_normal(*(self.x[v] for v in self.triangle[t])) for t in beside]
        first = self.triangle[beside[0]]
        # a, b, c or b, a, c around the first triangle, whichever way it is turned.
        forward = (first.index(b) - first.index(a)) % 3 == 1
        new = ((a, d, c), (d, b, c)) if forward else ((a, c, d), (d, c, b))
        turned = [_normal(*(self.x[v] for v in corners)) for corners in new]
        if min(_cosine(one, other) for one in old for other in turned) < CREASE:
            return
        for t in beside:
            self._remove(t)
        for corners in new:
            self._add(corners)

    def even_out(self, target: _Target) -> None:
        """Move each corner to the middle of those around it, within the surface, along its border or crease."""
        points, triangles = self.arrays()
        kept = sorted(v for v, ts in self.of.items() if ts)
        number = {v: n for n, v in enumerate(kept)}
        area = np.zeros(len(points))
        np.add.at(area, triangles, areas(points, triangles)[:, None] / 3.0)
        directed = edges(triangles)
        both = np.unique(np.concatenate([directed, directed[:, ::-1]]), axis=0)
        sums, weight = np.zeros_like(points), np.zeros(len(points))
        np.add.at(sums, both[:, 0], area[both[:, 1], None] * points[both[:, 1]])
        np.add.at(weight, both[:, 0], area[both[:, 1]])
        way = sums / weight[:, None] - points
        normal = np.zeros_like(points)
        np.add.at(normal, triangles, normals(points, triangles)[:, None])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
        way -= np.einsum("ij,ij->i", way, normal)[:, None] * normal
        on_line = np.array([n for n, v in enumerate(kept) if self.line.get(v) and v not in self.fixed], np.int64)
        inner = np.array([n for n, v in enumerate(kept) if not self.line.get(v)], np.int64)
        if len(on_line):
            ends = [[number[e] for e in sorted(self.line[kept[n]])] for n in on_line.tolist()]
            middle = np.array([points[end].mean(axis=0) for end in ends])
            points[on_line] = target.on_lines(middle)
        if len(inner):
            points[inner] = target.on_surface(points[inner] + way[inner])
        for v, place in zip(kept, map(tuple, points.tolist())):
            self.x[v] = place


def _less(p: tuple, q: tuple) -> tuple:
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def _normal(a: tuple, b: tuple, c: tuple) -> tuple:
    (ux, uy, uz), (vx, vy, vz) = _less(b, a), _less(c, a)
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


def _cosine(u: tuple, v: tuple) -> float:
    size = math.sqrt((u[0] ** 2 + u[1] ** 2 + u[2] ** 2) * (v[0] ** 2 + v[1] ** 2 + v[2] ** 2))
    return (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / size if size > 0.0 else -1.0
