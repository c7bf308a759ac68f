# SPDX-License-Identifier: GPL-2.0-only
"""Naive twin of fix mdanim/contact for cuboids, from the page of its law (docs/physics-contact.md): all points of every object
against every other object and plane, each looked at in every step, places in the host by Newton's method to the end.

It has no boxes, no lists and no look ahead. A cell in contact that is turned inside out is an error here: nothing is let go.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .maps import inverse, trilinear_spot

FACING = 0.45
"""Least cosine between a point's outward normal and that of a side that faces it, negated."""
DEEPEST = 0.5
"""Cells up to which a contact begins."""
ONSET = 0.05
"""eps over the spacing."""
STICK = 0.8
"""kappa_t over kappa."""
STEEP, MORE = 1.1, 1.0
"""Gradient of the depth beyond which less than all of the depth counts, and how much it grows at most from there on."""
CRUSHED = 0.25
"""Volume over that of an undeformed cell below which points on edges are let go."""
FAR = 2.2
"""Spacings from the middle of the nearest cell beyond which nothing is known of a point."""


# --- the undeformed cuboid ---


def depths(count, edge, X):
    """Depth (P, 6) below the sides -x, +x, -y, +y, -z, +z, and its gradient by X (6, 3)."""
    both = np.stack([X * edge, (np.array(count) - X) * edge], -1)
    slopes = np.zeros((6, 3))
    slopes[[0, 2, 4], [0, 1, 2]], slopes[[1, 3, 5], [0, 1, 2]] = edge, -np.array(edge)
    return both.reshape(len(X), 6), slopes


def ramps(count, is_flat, X):
    """Weight of a point across each axis (P, 3), its slope, and the cells that it lacks to the first of it."""
    rise = np.where(is_flat[:, None], np.minimum(1.0, 0.25 * np.array(count)), 0.5)
    middle = np.where(is_flat[:, None], 1.5 * rise, 0.0)
    rounded = 0.05  # of the width at either end, where the slope rises and falls evenly
    width = rise / (1.0 - rounded)
    start = middle - 0.5 * width

    def ramp(inside):
        r = (inside - start) / width
        slope = np.interp(r, [0.0, rounded, 1.0 - rounded, 1.0], [0.0, 1.0, 1.0, 0.0])
        value = np.select(
            [r <= 0.0, r < rounded, r < 1.0 - rounded, r < 1.0],
            [0.0, r**2 / (2 * rounded), r - rounded / 2, 1.0 - rounded - (1.0 - r) ** 2 / (2 * rounded)],
            1.0 - rounded,
        )
        return value / (1.0 - rounded), slope / (1.0 - rounded) / width

    (low, low_slope), (high, high_slope) = ramp(X), ramp(count - X)
    return low * high, low_slope * high - high_slope * low, start - np.minimum(X, count - X)


def flattened(n):
    """Factor of a depth whose gradient has the length n, and -d(log of the factor)/dn over n."""
    over = np.maximum(n - STEEP, 0.0)
    y = STEEP + MORE * over / (over + MORE)
    flat = n > STEEP
    return np.where(flat, y / n, 1.0), np.where(flat, (1.0 / n - (MORE / (over + MORE)) ** 2 / y) / n, 0.0)


def onset(d, eps):
    """g(d) and its derivative."""
    d = np.maximum(d, 0.0)
    early = d < eps
    return np.where(early, d**3 / (6 * eps), (d - eps / 2) ** 2 / 2 + eps**2 / 24), np.where(early, d**2 / (2 * eps), d - eps / 2)


# --- contacts ---


@dataclass
class Law:
    """Law for the points of one object in another, or against a plane."""

    kappa: float
    onset: float
    friction: float
    eta: float
    """Dashpot by area [N s/m^3]."""


@dataclass
class Account:
    energy: float = 0.0
    stick: float = 0.0
    heat: float = 0.0
    damped: float = 0.0
    touching: int = 0
    deepest: float = 0.0
    let_go: float = 0.0


@dataclass
class Memory:
    """Memory of all points of an object in one host: side -1 for no contact."""

    side: np.ndarray
    open: np.ndarray
    X: np.ndarray
    anchor: np.ndarray
    offset: np.ndarray
    depth: np.ndarray
    pull: np.ndarray
    stick: np.ndarray
    stick_energy: np.ndarray
    damping: np.ndarray
    drag: np.ndarray
    cell: np.ndarray
    energy: np.ndarray

    @classmethod
    def new(cls, points: int, sides: int = 6) -> Memory:
        zeros = np.zeros
        return cls(
            np.full(points, -1), zeros((points, sides), bool), np.full((points, 3), np.nan), zeros((points, 3)), zeros(points),
            zeros(points), zeros((points, 3)), zeros(points), zeros(points), zeros(points), zeros((points, 3)),
            zeros((points, 3), int), zeros(points),
        )  # fmt: skip


def pressure(law, area, t, c, memory, depth, dt, account):
    """Force over the gradient of the depth, and kappa w g, of the contacts c."""
    memory.offset[c] = np.minimum(memory.offset[c], depth)
    value, slope = onset(depth - memory.offset[c], law.onset)
    press = law.kappa * area * t * slope
    if dt > 0.0 and law.eta > 0.0:
        deeper = depth - memory.depth[c]
        more = np.where(depth > memory.offset[c], np.maximum(law.eta * area * t * deeper / dt, -press), 0.0)
        account.damped += float((0.5 * (memory.damping[c] + more) * deeper).sum())
        press = press + more
        memory.damping[c] = more
    memory.depth[c] = depth
    return press, law.kappa * area * value


def friction(law, area, t, c, memory, away, normal, press, dt, account):
    """Force of the stick spring, of its dashpot, and what is left of the way to the anchor."""
    k = STICK * law.kappa * area * t
    length, steep = np.linalg.norm(away, axis=1), np.linalg.norm(normal, axis=1)
    most = law.friction * press * steep
    slips = k * length > most
    kept = np.where(slips, most / np.maximum(k * length, 1e-300), 1.0)
    drag = np.zeros_like(away)
    before = np.where(memory.stick[c, None] > 0, -memory.pull[c] / np.maximum(memory.stick[c, None], 1e-300), 0.0)
    if dt > 0.0 and law.eta > 0.0:
        rate = (away - before) / dt
        unit = normal / steep[:, None]
        rate -= (rate * unit).sum(1)[:, None] * unit
        eta = law.eta * np.sqrt(STICK) * area * t  # 2 beta sqrt(kappa_t rho h/2) w t
        drag = np.where(slips[:, None], 0.0, -eta[:, None] * rate)
        account.damped -= float((0.5 * (memory.drag[c] + drag) * rate * dt).sum())
        memory.drag[c] = drag
    left = kept[:, None] * away
    pull = -k[:, None] * left
    if dt > 0.0:
        account.heat += float((np.where(slips, -0.5, 0.0) * ((pull + memory.pull[c]) * (away - left)).sum(1)).sum())
        # A spring that gets softer does no work.
        account.heat += float((0.5 * (memory.stick[c] - k) * (left * before).sum(1)).sum())
    memory.pull[c], memory.stick[c] = pull, k
    memory.stick_energy[c] = 0.5 * k * (left**2).sum(1)
    return pull, drag, kept


@dataclass
class Solid:
    """A cuboid: the arrays of its contact body, its particles' rows, and material."""

    body: dict
    rows: slice
    young: float
    friction: float
    density: float
    held: bool = False
    carriers: tuple = field(init=False)

    def __post_init__(self):
        cell = np.stack(np.unravel_index(self.body["cell"], self.count[::-1])[::-1], -1)
        still = np.zeros(((self.count + 1).prod(), 3))
        self.carriers = tuple(trilinear_spot(still, self.count, self.body[name], cell) for name in ("at", "centre"))
        self.middles = trilinear_spot(still, self.count, cell + 0.5, cell)

    @property
    def count(self):
        return self.body["count"].astype(int)

    @property
    def spacing(self) -> float:
        return float(np.cbrt(self.body["edge"].prod()))

    def points(self, x):
        """Places of the points and of the centres of their areas."""
        return (np.einsum("pn,pnc->pc", s.N, x[self.rows][s.nodes]) for s in self.carriers)

    def normals(self, x):
        """Outward unit normals of the points in space: by the middle of the cell that carries each."""
        m = self.middles
        J = np.einsum("pnc,pna->pca", x[self.rows][m.nodes], m.dN)
        n = np.einsum("pac,pa->pc", np.linalg.inv(J), self.body["normal"] * self.body["edge"])
        return n / np.linalg.norm(n, axis=1, keepdims=True)

    def push(self, which, points, forces, onto):
        """Add forces at points (0: themselves, 1: centres of their areas)."""
        s = self.carriers[which]
        np.add.at(onto[self.rows], s.nodes[points], s.N[points][..., None] * forces[:, None, :])


class Twin:
    """The law over all objects. `forces` is asked once for every step, in order."""

    def __init__(self, solids, planes=(), objects=True, stiffness=1.0, damping=0.3, pairs=None):
        """``planes``: (axis, sign, place) each, sign 1 where objects belong above. ``pairs``: (mu, beta) by objects (a, b)."""
        self.solids, self.planes = solids, planes
        self.account = Account()
        self.memory, self.laws = {}, {}

        def law(a, density, kappa, mu, beta):
            h = self.solids[a].spacing
            return Law(kappa, ONSET * h, mu, 2.0 * beta * np.sqrt(kappa * density * h / 2.0))

        for a, first in enumerate(solids):
            for b, second in enumerate(solids):
                if a == b or not objects or (first.held and second.held):
                    continue
                mu = np.sqrt(first.friction * second.friction)
                mu, beta = (pairs or {}).get((min(a, b), max(a, b)), (mu, damping if mu > 0.0 else 0.0))
                kappa = stiffness * 2.0 * first.young * second.young / (first.young + second.young)
                lighter = min(one.density for one in (first, second) if not one.held)
                self.laws[a, b] = law(a, lighter, kappa / max(first.spacing, second.spacing), mu, beta)
                self.memory[a, b] = Memory.new(len(first.body["cell"]))
            for p in range(len(planes)):
                beta = damping if first.friction > 0.0 else 0.0
                if not first.held:
                    self.laws[a, -1 - p] = law(a, first.density, stiffness * first.young / first.spacing, first.friction, beta)
                    self.memory[a, -1 - p] = Memory.new(len(first.body["cell"]), 1)

    def forces(self, x, dt: float):
        """Forces (N, 3) on all particles at ``x``. dt = 0 is the setup of a run: points are looked at, and no contact begins."""
        total = np.zeros_like(x)
        self.account.energy = self.account.stick = 0.0
        self.account.touching = 0
        for (a, b), law in self.laws.items():
            (self._in_object if b >= 0 else self._in_plane)(a, b, law, x, dt, total)
        return total

    def _in_object(self, a, b, law, x, dt, total):
        owner, host, memory, account = self.solids[a], self.solids[b], self.memory[a, b], self.account
        count, edge, h = host.count, host.body["edge"], host.spacing
        place, centre = owner.points(x)
        shift, normal = centre - place, owner.normals(x)
        there = x[host.rows]
        is_sharp, is_flat = owner.body["kind"] == 1, owner.body["kind"] == 0
        area = owner.body["area"]

        # Where every point is in the host; nothing is known of those far away.
        grid = there.reshape(*(count[::-1] + 1), 3)
        middles = 0.5 * (grid[:-1, :-1, :-1] + grid[1:, 1:, 1:]).reshape(-1, 3)
        away = np.linalg.norm(place[:, None] - middles, axis=2)
        cell = np.stack(np.unravel_index(away.argmin(1), count[::-1])[::-1], -1)
        touches = memory.side >= 0
        near = np.flatnonzero((away.min(1) <= FAR * h) | touches)
        memory.X[~np.isfinite(memory.X)] = (cell + 0.5)[~np.isfinite(memory.X)]
        X, cell, spot = inverse(there, count, place[near], memory.X[near], is_sharp[near])
        is_found = np.isfinite(X).all(1)
        assert is_found[touches[near]].all(), "a cell in contact is turned inside out"
        known, X, cell, spot = near[is_found], X[is_found], cell[is_found], spot.take(is_found)
        memory.X[:] = np.nan
        memory.X[known], memory.cell[known] = X, cell
        X_centre = X + spot.to_material(shift[known])
        depth, slopes = depths(count, edge, X)

        # Which sides a point might be in, and which could not hold energy.
        facing = np.empty((len(known), 6))
        counted = depth.copy()
        is_crushed = np.linalg.det(spot.J) < CRUSHED * h**3
        sees_smooth = is_sharp[known]
        apart = np.empty((len(known), 6))
        _, _, missing = ramps(count, is_flat[known], X_centre)
        for s in range(6):
            inward = spot.gradient(np.tile(slopes[s], (len(known), 1)))
            steep = np.linalg.norm(inward, axis=1)
            facing[:, s] = (normal[known] * inward).sum(1) / steep
            counted[sees_smooth, s] *= flattened(steep)[0][sees_smooth]
            others = [d for d in range(3) if d != s // 2]
            apart[:, s] = np.maximum(-depth[:, s] / h, missing[:, others].max(1))
        is_open = (apart <= 0.0) | (0.5 * (FACING - facing) > apart) | is_crushed[:, None]
        t, slope_t, _ = ramps(count, is_flat[known], X_centre)
        product = lambda values, side: np.where(np.arange(3) == side[:, None] // 2, 1.0, values).prod(1)

        if dt > 0.0:
            faces = facing >= FACING
            is_shut = (faces & (depth <= 0.0)).any(1)
            rank = np.where(faces & (depth > 0.0), depth / np.maximum(facing, FACING), np.inf)
            side = rank.argmin(1)
            row = np.arange(len(known))
            born = ~touches[known] & ~is_shut & np.isfinite(rank.min(1))
            born &= (depth[row, side] <= DEEPEST * h) & (product(t, side) > 0.0) & ~(is_crushed & sees_smooth)
            n = known[born]
            memory.side[n] = side[born]
            memory.anchor[n] = X[born]
            memory.depth[n] = counted[born, side[born]]
            was_open = memory.open[n, side[born]] | is_crushed[born]
            memory.offset[n] = np.where(was_open, memory.depth[n], 0.0)
            memory.pull[n] = memory.stick[n] = memory.stick_energy[n] = memory.energy[n] = 0.0
            memory.damping[n] = memory.drag[n] = 0.0
        free = memory.side[known] < 0
        memory.open[:] = False
        memory.open[near[~is_found]] = True
        memory.open[known[free]] = is_open[free]
        if dt == 0.0:
            assert free.all(), "a setup with contacts is not in the twin"
            return

        c = np.flatnonzero(~free)  # rows of `known`
        if not len(c):
            return
        side = memory.side[known[c]]
        d, t_c = counted[c, side], product(t[c], side)
        crushed = is_crushed[c] & sees_smooth[c]
        over = (d <= 0.0) | (t_c <= 0.0) | crushed
        self._let_go(law, area, memory, known[c[crushed]], d[crushed], t_c[crushed])
        ended = known[c[over]]
        account.damped += float((0.5 * memory.damping[ended] * (d[over] - memory.depth[ended])).sum())
        account.heat += float(memory.stick_energy[ended].sum())
        memory.side[ended] = -1
        memory.open[ended] = is_open[c[over]]
        c = c[~over]
        side, d, t_c, n = side[~over], d[~over], t_c[~over], known[c]
        spot = spot.take(c)

        grad_t = np.zeros((len(c), 3))
        for axis in range(3):
            rest = np.where(np.arange(3) == axis, slope_t[c], np.where(np.arange(3) == side[:, None] // 2, 1.0, t[c]))
            grad_t[:, axis] = np.where(side // 2 == axis, 0.0, rest[:, axis] * np.delete(rest, axis, 1).prod(1))
        grad = spot.gradient(slopes[side])
        steep, along = np.linalg.norm(grad, axis=1), spot.to_material(grad)
        part, more = flattened(steep)
        part, more = np.where(is_sharp[n], part, 1.0), np.where(is_sharp[n], more, 0.0) * d
        along_f, surface = pressure(law, area[n], t_c, n, memory, d, dt, account)
        press = part * along_f
        memory.energy[n] = t_c * surface
        pull = drag = lean = np.zeros((len(c), 3))
        if law.friction > 0.0:
            lean = memory.anchor[n] - X[c]  # to the anchor, at the depth of the point
            lean = lean - ((lean * slopes[side]).sum(1) / (grad**2).sum(1))[:, None] * spot.to_material(grad)
            way = -np.einsum("pca,pa->pc", spot.J, lean)
            pull, drag, kept = friction(law, area[n], t_c, n, memory, way, grad, press, dt, account)
            lean = kept[:, None] * lean
            memory.anchor[n] = X[c] + lean
        at_centre = -surface[:, None] * spot.gradient(grad_t)
        to_centre = spot.to_material(shift[n])
        turned = np.einsum("pcab,pb->pca", spot.dJ, to_centre)  # how J changes on the way to the centre
        at_point = -press[:, None] * grad + pull + drag - spot.gradient(np.einsum("pca,pc->pa", turned, at_centre))
        bend = np.einsum("pcab,pb,pc->pa", spot.dJ, along, grad)  # how n.J v changes with X
        at_point = at_point - (along_f * more)[:, None] * spot.gradient(bend)
        owner.push(0, n, at_point, total)
        owner.push(1, n, at_centre, total)
        moment = to_centre[:, :, None] * at_centre[:, None, :] + lean[:, :, None] * pull[:, None, :]  # (P, a, c)
        moment = moment + (along_f * more)[:, None, None] * along[:, :, None] * grad[:, None, :]
        back = spot.N[:, :, None] * (at_point + at_centre)[:, None, :] + np.einsum("pna,pac->pnc", spot.dN, moment)
        np.add.at(total[host.rows], spot.nodes, -back)

        account.energy += float((t_c * surface).sum())
        account.stick += float(memory.stick_energy[n].sum())
        account.touching += len(c)
        account.deepest = max(account.deepest, float(d.max(initial=0.0)))

    def _let_go(self, law, area, memory, points, depth, t):
        """Energy of contacts in crushed cells is released, less the work of their forces in half of the step."""
        value, slope = onset(memory.depth[points] - memory.offset[points], law.onset)
        k, energy = law.kappa * area[points], memory.energy[points]
        was = energy / np.maximum(k * value, 1e-300)
        half = 0.5 * k * (was * slope * (depth - memory.depth[points]) + (t - was) * value)
        self.account.let_go += float((energy + np.where(value > 0.0, half, 0.0)).sum())

    def _in_plane(self, a, b, law, x, dt, total):
        axis, sign, at = self.planes[-1 - b]
        owner, memory, account = self.solids[a], self.memory[a, b], self.account
        place, _ = owner.points(x)
        depth = sign * (at - place[:, axis])
        inside, touches = depth > 0.0, memory.side >= 0
        if dt > 0.0:
            n = np.flatnonzero(inside & ~touches)
            memory.side[n], memory.anchor[n], memory.depth[n] = 0, place[n], depth[n]
            memory.offset[n] = np.where(memory.open[n, 0], depth[n], 0.0)
            memory.pull[n] = memory.stick[n] = memory.stick_energy[n] = 0.0
            memory.damping[n] = memory.drag[n] = 0.0
            ended = np.flatnonzero(~inside & touches)
            account.damped += float((0.5 * memory.damping[ended] * (depth[ended] - memory.depth[ended])).sum())
            account.heat += float(memory.stick_energy[ended].sum())
            memory.side[ended] = -1
        memory.open[:, 0] = inside
        n = np.flatnonzero(memory.side >= 0)
        if not len(n):
            return
        downward = np.zeros((len(n), 3))
        downward[:, axis] = -sign
        area, one = owner.body["area"][n], np.ones(len(n))
        press, surface = pressure(law, area, one, n, memory, depth[n], dt, account)
        force = -press[:, None] * downward
        if law.friction > 0.0:
            away = place[n] - memory.anchor[n]
            away[:, axis] = 0.0
            pull, drag, kept = friction(law, area, one, n, memory, away, downward, press, dt, account)
            memory.anchor[n] = place[n] - kept[:, None] * away
            force = force + pull + drag
        owner.push(0, n, force, total)
        account.energy += float(surface.sum())
        account.stick += float(memory.stick_energy[n].sum())
        account.touching += len(n)
        account.deepest = max(account.deepest, float(depth[n].max()))
