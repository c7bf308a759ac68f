# SPDX-License-Identifier: GPL-2.0-only
"""Naive twin of plugin/liquid/waves/waves.h, written from the equations (W1) ... (W9) of docs/physics-liquid.md.

Spans and links are objects, each step is a loop over them, the linear system is a full matrix. Solid parts are
(nz, ny, nx), in 1/4096.
"""

import re
from dataclasses import dataclass, field

import numpy as np

UNIT, WHOLE, SHUT = 2**20, 4096, 3968
FILM = 2**-10
VISCOSITY, INERTIA, QUICK, BREAKING, OVERFULL, MEAN_OVER, SLAM = 0.02, 8 / 21, 1 / 8, 0.3, 0.15, 16, 100
OPPOSITE = {"west": "east", "east": "west", "south": "north", "north": "south"}


@dataclass(eq=False)
class Span:
    """Cells low ... high - 1 of a column; `slices` are (from, to, open volume) in height."""

    x: int
    y: int
    low: int
    high: int
    slices: list
    at_ends_only: bool
    content: int = 0
    full: bool = False
    rest: float = 0.0
    phi: float = 0.0
    coming: float = 0.0
    sides: dict = field(default_factory=lambda: {side: [] for side in OPPOSITE})

    floor = property(lambda self: self.slices[0][0])
    roof = property(lambda self: self.slices[-1][1])
    capacity = property(lambda self: sum(open for _, _, open in self.slices))
    volume = property(lambda self: self.content / UNIT)

    def surface(self):
        """Height at which the content stands, and how much a bit of height holds there."""
        left = self.volume
        if left < self.capacity:
            for start, end, open in self.slices:
                if open > 0 and left < open:
                    return start + left / (open / (end - start)), open / (end - start)
                left -= open
        return self.roof, 1.0

    def below(self, height):
        """Volume up to a height."""
        return sum(open * min(1.0, max(0.0, (height - start) / (end - start))) for start, end, open in self.slices)


@dataclass(eq=False)
class Link:
    """From span a to span b, which lies to the east or north of it."""

    a: Span
    b: Span
    edge: float
    top: float
    layers: list | None
    u: float = 0.0
    q: float = 0.0

    def levels(self):
        """How high it is filled from either side; heads of spans that have let go of their roofs are new."""
        return [s.head if s.volume > FILM and s.head > self.edge else self.edge for s in (self.a, self.b)]

    def opening(self, level):
        """How much of it is open below a level."""
        if self.layers is None:
            return min(level, self.top) - self.edge
        return sum(open * min(1.0, max(0.0, (level - low) / (high - low))) for low, high, open in self.layers)


def is_plate(part, x, y, low, high):
    """Whether partly solid cells between open ones are a plate: 7/8 of a cell thick, and as much in all columns beside it."""
    _, ny, nx = part.shape
    beside = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)]
    sums = [part[max(0, low - 2) : high + 2, j, i].sum() for i, j in beside if 0 <= i < nx and 0 <= j < ny]
    return high - low <= 5 and 8 * min(part[low - 1 : high + 1, y, x].sum(), *sums) >= 7 * WHOLE


def stretches(part, x, y):
    """Cells between shut ones, cut at plates."""
    column, nz = part[:, y, x], part.shape[0]
    low = None
    for z in range(nz + 1):
        if z < nz and column[z] < SHUT:
            low = z if low is None else low
            continue
        if low is None:
            continue
        runs = "".join("#" if p >= WHOLE - SHUT else "." for p in column[low:z])
        for run in re.finditer(r"(?<=\.)#+(?=\.)", runs):
            first, end = low + run.start(), low + run.end()
            if is_plate(part, x, y, first, end):
                whole = int(column[first:end].sum())
                face = min(range(first + 1, max(first + 2, end)), key=lambda f: abs(whole - 2 * int(column[first:f].sum())))
                yield low, face
                low = face
        yield low, z
        low = None


def cut(part, x, y):
    """The open spans of a column, from below."""
    column = [int(p) for p in part[:, y, x]]
    nz = len(column)
    spans = []
    for low, z in stretches(part, x, y):
        slices = [[float(k), k + 1.0, (WHOLE - column[k]) / WHOLE] for k in range(low, z)]
        slices[0][0] += column[low] / WHOLE
        if z - 1 > low:
            slices[-1][1] -= column[z - 1] / WHOLE
        if low > 0 and column[low - 1] >= SHUT:  # what is open of the shut cells at its ends belongs to it
            rest = (WHOLE - column[low - 1]) / WHOLE
            slices[0][0] -= rest
            slices[0][2] += rest
        if z < nz and column[z] >= SHUT and (z + 1 == nz or column[z + 1] >= SHUT):
            rest = (WHOLE - column[z]) / WHOLE
            slices[-1][1] += rest
            slices[-1][2] += rest
        spans.append(Span(x, y, low, z, slices, not any(column[low + 1 : z - 1])))
    return spans


def parts(part, lower, upper):
    """Whether a plate above one span goes on as what is below another one, of a neighbouring column, or the other way round."""
    if lower.high == part.shape[0] or upper.low == 0:
        return False
    ends = part[lower.high, lower.y, lower.x], part[upper.low - 1, upper.y, upper.x]
    both = slice(upper.low, lower.high)
    solid = part[both, lower.y, lower.x].astype(int) + part[both, upper.y, upper.x]
    return min(ends) < SHUT and (2 * solid >= WHOLE).all()


def join(part, a, b):
    """The link between two spans of neighbouring columns, or None."""
    layers = range(max(a.low, b.low), min(a.high, b.high))
    if not layers or parts(part, a, b) or parts(part, b, a):
        return None
    top = min(a.roof, b.roof)
    if a.at_ends_only and b.at_ends_only:
        edge = max(a.floor, b.floor)
        return Link(a, b, edge, top, None) if top - edge >= 1e-3 else None
    open = [(z, WHOLE - int(part[z, a.y, a.x]) - int(part[z, b.y, b.x])) for z in layers]
    open = [(max(z, a.floor, b.floor), z + 1, share / WHOLE) for z, share in open if share >= WHOLE - SHUT]
    return Link(a, b, float(open[0][0]), top, open) if open else None


class Twin:
    """A basin that is poured once; `bed` is n^2 g cell^(-1/3) with Manning's n."""

    def __init__(self, part, height, bed=0.0):
        nz, ny, nx = part.shape
        self.bed = bed
        self.height, self.fastest = nz, 4 * nz**0.5
        self.spans = [span for y in range(ny) for x in range(nx) for span in cut(part, x, y)]
        self._join(part)
        self.before = self.before_that = np.zeros(len(self.spans))
        for span in self.spans:
            level = height[span.y, span.x]
            span.content = int(span.below(level) * UNIT)
            span.full = span.content >= span.capacity * UNIT
            span.phi = span.rest = max(span.roof, level) if span.full else span.surface()[0]

    def _join(self, part):
        self.links = []
        for side, dx, dy in (("east", 1, 0), ("north", 0, 1)):
            for a in self.spans:
                for b in self.spans:
                    if (b.x - a.x, b.y - a.y) == (dx, dy) and (link := join(part, a, b)):
                        self.links.append(link)
                        a.sides[side].append(link)
                        b.sides[OPPOSITE[side]].append(link)

    def move_roofs(self, part):
        """New solids that leave each span where it is, but for its ends."""
        old, links = self.spans, {(id(link.a), id(link.b)): link for link in self.links}
        self.spans = [span for y in range(part.shape[1]) for x in range(part.shape[2]) for span in cut(part, x, y)]
        assert [(s.x, s.y) for s in old] == [(s.x, s.y) for s in self.spans]
        was = {}
        for now, span in zip(self.spans, old):
            now.content, now.full, now.rest, now.phi = span.content, span.full, span.rest, span.phi
            now.coming = now.capacity - span.capacity
            was[id(now)] = id(span)
        self._join(part)
        for link in self.links:
            if span := links.get((was[id(link.a)], was[id(link.b)])):
                link.u = span.u
                link.q = span.q * min(1.0, (min(link.top, span.top) - max(link.edge, span.edge)) / (span.top - span.edge))

    def update(self, dt=0.1):
        """One update."""
        parts = max(1, int(np.ceil(max((abs(link.u) for link in self.links), default=0.0) * dt / 0.5)))
        for _ in range(parts):
            self._sub_update(dt / parts, 1 / parts)
        for span in self.spans:
            span.coming = 0.0

    def _sub_update(self, dt, share):
        self._look()
        faster = [self._advected(link, dt) if link.wet else 0.0 for link in self.links]
        for link, u in zip(self.links, faster):
            link.star = u
        delta = 2 * self.before - self.before_that
        for _ in range(4):
            delta = self._solve(dt, share)
            pulling = [n for n, s in enumerate(self.spans) if s.full and s.head + delta[n] < s.roof - 1e-6]
            for n in pulling:
                span = self.spans[n]
                span.full = False
                free, span.slope = span.surface()
                delta[n] += span.head - free
                span.head = free
            if not pulling:
                break
        self.before_that, self.before = self.before, delta
        self._push(delta, dt)
        self._limit()
        for link in self.links:
            link.a.content -= link.units
            link.b.content += link.units
            link.q = link.units / UNIT / dt

    def _look(self):
        for span in self.spans:  # (W1)
            free, span.slope = span.surface()
            if span.full and span.volume < span.capacity - 1:
                span.full = False
            if not span.full and span.volume >= span.capacity:
                span.full = True
                span.phi = span.rest = max(span.phi, span.roof)
            span.head = span.rest if span.full else free
        for link in self.links:  # (W2)
            levels = link.levels()
            link.wet = max(levels) > link.edge
            if not link.wet:
                link.u = link.q = 0.0
            upwind = levels[0] if link.u > 0 else levels[1] if link.u < 0 else max(levels)
            link.height = link.opening(upwind) if link.wet else 0.0

    def _advected(self, link, dt):
        """(W3), (W4)."""
        ahead = "east" if link.b.x > link.a.x else "north"
        back = OPPOSITE[ahead]
        across = ("south", "north") if ahead == "east" else ("west", "east")

        def flux(span, side):
            return sum(other.q for other in span.sides[side] if other.wet)

        def neighbour(span, side):
            wet = [other for other in span.sides[side] if other.wet] if span else []
            height = sum(other.height for other in wet)
            return (max(wet, key=lambda other: abs(other.q)).u, height) if height > 0 else None

        def beyond(span, side):
            found = span.sides[side]
            if not found:
                return None
            widest = max(found, key=lambda other: other.top - other.edge)
            return widest.b if widest.a is span else widest.a

        a, b = link.a, link.b
        incoming = [(neighbour(a, back), (flux(a, back) + link.q) / 2), (neighbour(b, ahead), -(link.q + flux(b, ahead)) / 2)]
        for side, sign in zip(across, (1, -1)):
            beside = neighbour(beyond(a, side), ahead) or neighbour(beyond(b, side), back)
            incoming.append((beside, sign * (flux(a, side) + flux(b, side)) / 2))
        depth = max((a.volume + b.volume) / 2, 1e-6)
        weights = []
        for (u, height), q in ((found, q) for found, q in incoming if found):
            shared = min(height, link.height) / max(link.height, 1e-6)
            weights.append((u, max(q, 0.0) * dt / depth + VISCOSITY * dt * shared))
        total = max(1.0, sum(weight for _, weight in weights))
        mean = link.u + sum(weight * (u - link.u) for u, weight in weights) / total
        if not self.bed:
            return mean
        height = max(link.height, FILM)
        speed = np.hypot(mean, (incoming[2][1] - incoming[3][1]) / 2 / height)
        return mean / (1 + dt * self.bed * speed / height ** (4 / 3))

    def _solve(self, dt, share):
        """(W5), (W6)."""
        number = {id(span): n for n, span in enumerate(self.spans)}
        matrix, rhs = np.zeros((len(self.spans),) * 2), np.zeros(len(self.spans))
        wet = [link for link in self.links if link.wet]
        for n, span in enumerate(self.spans):
            mine = [link for link in wet if span in (link.a, link.b)]
            span.beside_full = any(link.a.full or link.b.full for link in mine)
            if span.full:
                matrix[n, n] = 0.0
                inflow = sum(link.height * link.star * (1 if link.b is span else -1) for link in mine) * dt
                rhs[n] = (OVERFULL * (span.volume - span.capacity) - span.coming * share + inflow) / dt**2
                continue
            if span.slope < 0.999:
                rhs[n] = sum(link.height * link.star * (1 if link.b is span else -1) for link in mine) / dt
            slopes = [abs(link.a.head - link.b.head) for link in mine if not (link.a.full or link.b.full)]
            part = min(1.0, max(0.0, 2 - max(slopes, default=0.0) / BREAKING)) if span.slope >= 0.999 else 0.0
            matrix[n, n] = span.slope / max(dt**2, part * INERTIA * span.volume)
        for link in wet:
            a, b = number[id(link.a)], number[id(link.b)]
            if min(link.a.head, link.b.head) < link.edge:  # liquid falls from the upper side
                upper, head = (b, link.b.head) if link.a.head < link.edge else (a, link.a.head)
                matrix[upper, upper] += link.height
                rhs[upper] -= link.height * (head - link.edge)
                continue
            matrix[a, a] += link.height
            matrix[b, b] += link.height
            matrix[a, b] -= link.height
            matrix[b, a] -= link.height
            pull = link.height * (link.a.head - link.b.head)
            rhs[a] -= pull
            rhs[b] += pull
        delta = np.zeros(len(self.spans))
        used = np.flatnonzero(np.diag(matrix) > 0)
        delta[used] = np.linalg.solve(matrix[np.ix_(used, used)], rhs[used])
        return delta

    def _push(self, delta, dt):
        for span, change in zip(self.spans, delta):  # (W7)
            part = 0.0 if span.full or span.beside_full else min(QUICK, 0.5 / (dt**2 * max(1.0, span.volume)))
            span.phi = min(max(span.head + (1 - part) * change, span.head - SLAM), self.height + SLAM)
            if span.full:
                span.rest += (max(span.phi, span.roof) - span.rest) / MEAN_OVER
        for link in self.links:  # (W8)
            link.units = 0
            u = link.star - dt * (max(link.b.phi, link.edge) - max(link.a.phi, link.edge))
            u = min(max(u, -self.fastest), self.fastest)
            height = link.opening(link.levels()[0 if u > 0 else 1]) if link.wet else 0.0
            link.u = u if height > 0 else 0.0
            if height > 0:
                link.units = round(height * u * dt * UNIT)

    def _limit(self):
        """(W9)."""

        def passing(span):
            signed = [link.units if link.b is span else -link.units for link in self.links if span in (link.a, link.b)]
            return sum(u for u in signed if u > 0), -sum(u for u in signed if u < 0)

        def scale(shares, of_giver):
            for link in self.links:
                giver, taker = (link.a, link.b) if link.units > 0 else (link.b, link.a)
                share = shares[id(giver if of_giver else taker)]
                if link.units and share < 1:
                    link.units = int(link.units * (share * (1 - 1e-12)))
                    link.u *= 1.0 if of_giver else share

        gone = {id(span): passing(span)[1] for span in self.spans}
        scale({id(s): s.content / gone[id(s)] if gone[id(s)] > s.content else 1.0 for s in self.spans}, True)
        for _ in range(2):
            shares = {}
            for span in self.spans:
                came, went = passing(span)
                room = max(0.0, (span.capacity + 0.25) * UNIT - span.content + went)
                shares[id(span)] = room / came if came > room else 1.0
            scale(shares, False)
