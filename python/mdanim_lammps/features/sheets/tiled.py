# SPDX-License-Identifier: GPL-2.0-only
"""Triangles of a curved sheet and their springs (docs/physics-sheets.md): edges, whose constants are those with which it is as
stiff as its material in every direction around each particle, and springs that resist bending.

A fan is a particle with the smooth part of the surface around it: its triangles, laid flat, up to borders and creases.
"""

from __future__ import annotations

import math
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from ...model import shapes
from ...model.bends import BendLine, BendRing, runs_around
from ...model.orientation import MeshError
from ...model.remesh import remeshed
from ...model.rods import SOFT
from ...model.triangles import areas, edges
from ...records import dataclass
from ...scene.formatting import say
from ...scene.scene import Shell

LEAST = 0.1
"""Least constant of an edge over that on a lattice without bending."""
ROUNDS = 300
"""Steps towards the constants of edges, at most."""
EXACT = 1e-5
"""Largest change of a constant over the usual one at which they end."""
STILL = 0.5
"""Weight of a pull at the middle of a fan where the strain is even, beside that of its tensor."""
PUSHED = 0.8
"""Part of its length without load by which a link may be shorter, because of what it holds."""
AT_SIDE = 0.25
"""Distance from the end of a sheet along an axis over the length of an edge, up to which particles are on that side."""
STRAIGHT = 1e-6
"""Part of an edge up to which a straight line across a fan ends in one of its ends."""
EVEN = 0.05
"""Weight of an uneven share of rigidity among lines through a particle, beside one of its tensor."""
FLAT, NEAR = 0.004, 0.02
"""Area of a triangle over h^2 and distance of particles over h below which the surface has been folded up, as edges are too long
for it: triangles of even edges have 0.43 and 1, the worst of those made from surfaces that bear their edges about a third."""
LAME = 0.375
"""Both constants of Lame of a layer over E t, with Poisson's ratio 1/3."""


Crossing = tuple[int, int, float, float, float]


@dataclass(frozen=True, eq=False)
class Fan:
    """A particle and those around it, laid flat."""

    middle: int
    spoke: np.ndarray
    """Particles around it, in turn, int64, shape (n,)."""
    angle: np.ndarray
    """Angle of each [rad]."""
    length: np.ndarray
    """Length of each [m]."""
    closed: bool
    """Whether the last one is beside the first one."""
    area: float
    """A third of its triangles [m^2]."""

    def opposite(self, n: int) -> Crossing | None:
        """The two spokes between which the line from the n-th one through the middle goes on, the parts of both ends in the place
        where it leaves the fan, and how far that is [m]; None where it leaves the surface."""
        x, y = self.length * np.cos(self.angle), self.length * np.sin(self.angle)
        dx, dy = -math.cos(self.angle[n]), -math.sin(self.angle[n])
        last = len(self.spoke)
        for k in range(last if self.closed else last - 1):
            m = (k + 1) % last
            if n in (k, m):
                continue
            across = dx * (y[m] - y[k]) - dy * (x[m] - x[k])
            if across <= 0.0:
                continue
            part = (dy * x[k] - dx * y[k]) / across
            far = (x[k] * (y[m] - y[k]) - y[k] * (x[m] - x[k])) / across
            if far > 0.0 and -STRAIGHT <= part <= 1.0 + STRAIGHT:
                part = 0.0 if part < STRAIGHT else 1.0 if part > 1.0 - STRAIGHT else part
                return k, m, 1.0 - part, part, far
        return None


@dataclass(frozen=True, eq=False)
class Tiled:
    """A curved sheet of particles at the corners of triangles."""

    place: np.ndarray
    """Particles about the middle of the area [m], shape (N, 3)."""
    triangle: np.ndarray
    """All turned one way, outward where it is closed, int32, shape (T, 3)."""
    creases: np.ndarray
    """Edges at borders and where it is creased, pairs of particles, shape (K, 2)."""
    h: float
    """About the length of an edge [m]."""
    closed: bool
    """Whether it has no border."""

    @property
    def apart(self) -> float:
        """Distance of rows of triangles of its area, on a lattice of links h [m]."""
        return float(areas(self.place, self.triangle).sum()) / (len(self.place) * self.h)

    @cached_property
    def share(self) -> np.ndarray:
        """Area nearest to each particle, over that of all by their number [-], shape (N,)."""
        area = areas(self.place, self.triangle)
        found = np.bincount(self.triangle.ravel(), np.repeat(area / 3.0, 3), len(self.place))
        return found * (len(found) / area.sum())

    @cached_property
    def edge(self) -> np.ndarray:
        """Pairs i < j of particles, sorted, int64, shape (E, 2)."""
        return np.unique(np.sort(edges(self.triangle), axis=1), axis=0).astype(np.int64)

    @cached_property
    def sides(self) -> dict[str, np.ndarray]:
        """Particles near each end along its axes, by its name."""
        out = {f"{sign}{axis}": way * self.place[:, n] for n, axis in enumerate("xyz") for sign, way in (("-", -1.0), ("+", 1.0))}
        return {name: np.flatnonzero(far > far.max() - AT_SIDE * self.h) for name, far in out.items()}

    @cached_property
    def fans(self) -> list[Fan]:
        """Fans of all particles: one of each on smooth ground, several at creases."""
        cut: list[set[int]] = [set() for _ in self.place]
        for a, b in self.creases.tolist():
            cut[a].add(b)
            cut[b].add(a)
        return [self._fan(*run) for run in runs_around(self.triangle, len(self.place), cut)]

    def _fan(self, v: int, run: list[int], closed: bool) -> Fan:
        arm = self.place[run] - self.place[v]
        length = np.linalg.norm(arm, axis=1)
        unit = arm / length[:, None]
        step = np.arccos(np.clip(np.einsum("ij,ij->i", unit[:-1], unit[1:]), -1.0, 1.0))
        area = float((0.5 * length[:-1] * length[1:] * np.sin(step)).sum()) / 3.0
        angle = np.concatenate([[0.0], np.cumsum(step)])
        if closed:
            angle, length, run = angle[:-1] * (2.0 * math.pi / angle[-1]), length[:-1], run[:-1]
        return Fan(v, np.array(run), angle, length, closed, area)

    # -- springs

    def springs(self, young: float, thickness: float, bending: float, held: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs i < j of particles, sorted, int32, shape (S, 2), and k [N/m], r0 [m] and length without load [m] of each, shape
        (S, 3), for Young's modulus [Pa] and the thickness [m]; ``bending`` scales the rigidity."""
        n = len(self.place)
        key, density = self._bends[:2] if bending > 0.0 else (np.zeros(0, np.int64), np.zeros(0))
        own = self.edge[:, 0] * n + self.edge[:, 1]
        further = ~np.isin(key, own)
        pull = np.zeros(len(own))
        pull[np.searchsorted(own, key[~further])] = density[~further]
        pair = np.concatenate([self.edge, np.stack(np.divmod(key[further], n), axis=1)])
        length = np.linalg.norm(self.place[pair[:, 1]] - self.place[pair[:, 0]], axis=1)
        force = bending * young * thickness**3 * length * np.concatenate([pull, density[further]])
        further_k = -self._softness * density[further]
        links, square = self._links(bending > 0.0), length**2
        # All of it as stiff as the material where it is stretched alike along all directions.
        links *= (8.0 * LAME * sum(fan.area for fan in self.fans) - further_k @ square[len(own) :]) / (links @ square[: len(own)])
        k = young * thickness * np.concatenate([links, further_k])
        k = np.maximum(k, force / (PUSHED * length))
        value = np.stack([k, length - force / k, length], axis=1)
        order = np.lexsort((pair[:, 1], pair[:, 0]))
        return pair[order].astype(np.int32), value[order]

    def rings_of(self, held: np.ndarray) -> list[BendRing]:
        """Fans with the lines from each spoke through the middle, along which springs resist bending."""
        found = [(fan, [line for line, _ in self._across(fan) if line.stiffness > 0.0]) for fan in self.fans]
        return [BendRing(fan.middle, fan.spoke, fan.closed, 3.0 * fan.area, lines) for fan, lines in found if lines]

    def _across(self, fan: Fan) -> list[tuple[BendLine, tuple[int, Crossing]]]:
        """Lines from the spokes of a fan through its middle, and where they leave it: the curvature along one is 2/(l1 + l2)
        times the sum of both slopes, a sum of heights."""
        crossing = [(k, line) for k in range(len(fan.spoke)) if (line := fan.opposite(k)) is not None]
        if not crossing:
            return []
        rigidity, found = _weights(fan.angle[[k for k, _ in crossing]], 3.0 * LAME / 12.0 * fan.area).tolist(), []
        for (k, (b, c, at_b, at_c, far)), stiff in zip(crossing, rigidity):
            near = float(fan.length[k])
            here, there = _slopes(near, far)
            ends = [(int(fan.spoke[k]), here), (fan.middle, -here - there)]
            ends += [(int(fan.spoke[m]), there * part) for m, part in ((b, at_b), (c, at_c)) if part > 0.0]
            particle, weight = zip(*ends)
            way = self.place[fan.spoke[k]] - self.place[fan.middle]
            line = BendLine(particle, weight, stiff, way, 4.0 / (near + far))
            found.append((line, (k, (b, c, at_b, at_c, far))))
        return found

    @property
    def _softness(self) -> float:
        """Constant of a spring over two links over E t, times what it pushes with per length over E t^3 [m^2]: that of a rod's,
        SOFT E A/h where the rod has the push 2 E I/h^2 over 2 h."""
        return 12.0 * SOFT * self.h**2

    @cached_property
    def _bends(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Pairs that resist bending, as i n + j, and the pull of each per length over E t^3 [1/m^3]; and of pairs over two links
        the fan and their tensor, five numbers as `_tensor` has them, times their push per length and the square of the length.

        The curvature along a line through the middle of a fan is a sum of heights, each with a weight; its energy is that of
        springs between all of them with pulls per length that are products of the weights, without which they would not be in
        balance.
        """
        n, number, value, loaded, load = len(self.place), [], [], [], []
        for which, fan in enumerate(self.fans):
            for line, (k, (b, c, at_b, at_c, far)) in self._across(fan):
                ends, stiff = list(zip(line.particle, line.weight)), line.stiffness
                for i, (p, u) in enumerate(ends):
                    for q, v in ends[:i]:
                        number.append(min(p, q) * n + max(p, q))
                        value.append(-stiff * u * v)
                here, there = _slopes(float(fan.length[k]), far)
                for m, part in ((b, at_b), (c, at_c)):
                    if part > 0.0:
                        angles, lengths = fan.angle[[k, m]], fan.length[[k, m]]
                        way = lengths[1] * np.exp(1j * angles[1]) - lengths[0] * np.exp(1j * angles[0])
                        loaded.append(which)
                        load.append((stiff * here * there * part * abs(way) ** 2, np.angle(way)))
        key, of = np.unique(np.array(number, np.int64), return_inverse=True)
        density = np.bincount(of.reshape(-1), np.array(value), len(key))
        kept = density != 0.0
        size, angle = np.array(load).reshape(-1, 2).T
        return key[kept], density[kept], np.array(loaded, np.int64), size[:, None] * _tensor(angle)

    def _links(self, bends: bool) -> np.ndarray:
        """Constants of edges over E t, shape (E,): those with which edges, and springs over two links, have the tensor of the
        material in all fans, and pull at no particle where the strain is even, as nearly as constants above LEAST can."""
        from scipy.sparse import csr_matrix

        n, number = len(self.place), np.sort(edges(self.triangle), axis=1).astype(np.int64)
        own = self.edge[:, 0] * n + self.edge[:, 1]
        uses = np.bincount(np.searchsorted(own, number[:, 0] * n + number[:, 1]))
        area = np.array([fan.area for fan in self.fans])
        row, column, value = [], [], []
        for which, fan in enumerate(self.fans):
            ends = np.sort(np.stack([np.full(len(fan.spoke), fan.middle), fan.spoke], axis=1), axis=1)
            number = np.searchsorted(own, ends[:, 0] * n + ends[:, 1])
            beside = np.full(len(number), 2.0)
            if not fan.closed:
                beside[[0, -1]] = 1.0
            part = 0.5 * beside / uses[number] * fan.length**2 / math.sqrt(fan.area)
            pulls = STILL * fan.length * self.h / math.sqrt(fan.area) * fan.closed
            row.append(9 * which + np.tile(np.arange(9), (len(number), 1)))
            column.append(np.repeat(number[:, None], 9, axis=1))
            value.append(np.concatenate([part[:, None] * _tensor(fan.angle), pulls[:, None] * _odd(fan.angle)], axis=1))
        flat = [np.concatenate([a.ravel() for a in parts]) for parts in (row, column, value)]
        matrix = csr_matrix((flat[2], (flat[0], flat[1])), shape=(9 * len(area), len(own)))
        wanted = np.zeros((len(area), 9))
        wanted[:, 0] = 3.0 * LAME * area / ROUND
        if bends:
            np.subtract.at(wanted[:, :5], self._bends[2], self._softness * self._bends[3])
        wanted /= np.sqrt(area)[:, None]
        return _least_squares(matrix, wanted.ravel(), math.sqrt(0.75), LEAST * math.sqrt(0.75))


def _slopes(near: float, far: float) -> tuple[float, float]:
    """Weights of the heights of both ends of a line in its curvature [1/m^2], from the lengths of its parts [m]."""
    return 2.0 / ((near + far) * near), 2.0 / ((near + far) * far)


def _least_squares(matrix: Any, goal: np.ndarray, start: float, least: float) -> np.ndarray:
    """The x >= least with the smallest |matrix x - goal|, from all at one start: downhill, with the steps of Barzilai and Borwein
    (1988). Sums are NumPy's own, so that they do not depend on threads."""
    x = np.full(matrix.shape[1], start)
    turned = matrix.T.tocsr()
    down = turned @ (matrix @ x - goal)
    step = 1.0 / float((abs(turned) @ (abs(matrix) @ np.ones_like(x))).max())
    for _ in range(ROUNDS):
        there = np.maximum(x - step * down, least)
        way = there - x
        if np.abs(way).max() < EXACT * start:
            break
        slope = turned @ (matrix @ there - goal)
        step = float((way * way).sum()) / float((way * (slope - down)).sum())
        x, down = there, slope
    return x


ROUND = math.sqrt(0.375)


def _tensor(angle: np.ndarray) -> np.ndarray:
    """The fourth power of a direction, as numbers whose sums of products are cos(a - b)^4 for two, shape (..., 5)."""
    a = np.asarray(angle)[..., None]
    parts = [np.full_like(a, ROUND), np.sqrt(0.5) * np.cos(2 * a), np.sqrt(0.5) * np.sin(2 * a)]
    return np.concatenate([*parts, np.sqrt(0.125) * np.cos(4 * a), np.sqrt(0.125) * np.sin(4 * a)], axis=-1)


def _odd(angle: np.ndarray) -> np.ndarray:
    """The third power of a direction, likewise, shape (..., 4)."""
    a = np.asarray(angle)[..., None]
    one = [math.sqrt(0.75) * np.cos(a), math.sqrt(0.75) * np.sin(a)]
    return np.concatenate([*one, 0.5 * np.cos(3 * a), 0.5 * np.sin(3 * a)], axis=-1)


def _weights(angle: np.ndarray, wanted: float) -> np.ndarray:
    """Weights of directions, none below 0, whose tensors sum to one that is the same in all directions, with this product with
    each; as even as they can be."""
    from scipy.optimize import nnls

    tensor, even = _tensor(angle).T, wanted * 8.0 / (3.0 * len(angle))
    target = np.array([wanted / ROUND, 0.0, 0.0, 0.0, 0.0])
    matrix = np.concatenate([tensor, EVEN * np.eye(len(angle))])
    return nnls(matrix, np.concatenate([target, np.full(len(angle), EVEN * even)]))[0]


@lru_cache(maxsize=64)
def tiled(shell: Shell, h: float) -> Tiled:
    """The triangles of a shell with edges of about h [m]. Raises mesh.MeshError, also where such edges are too long for it."""
    skin = shapes.shell_surface(shell)
    found = Tiled(*remeshed(skin.points, skin.triangles, h), h, skin.closed)
    if _is_folded(found):
        cause = f"the surface has no triangles with edges of about {say(h, 'm')}: they are too long for its turns and borders"
        raise MeshError(cause, f"write a finer resolution, such as {say(0.5 * h, 'm')}")
    return found


def _is_folded(layer: Tiled) -> bool:
    """Whether triangles have all but no area, or particles are in one place."""
    from scipy.spatial import cKDTree

    if not len(layer.triangle):
        return True
    nearest = cKDTree(layer.place).query(layer.place, k=2)[0][:, 1].min()
    return areas(layer.place, layer.triangle).min() < FLAT * layer.h**2 or nearest < NEAR * layer.h
