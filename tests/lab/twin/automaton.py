# SPDX-License-Identifier: GPL-2.0-only
"""Naive twin of plugin/liquid/automaton/automaton.cpp: every rule cell by cell, as it reads. Arrays are (nz, ny, nx)."""

from itertools import product

FULLEST = 250
EVEN_BLOCKS, ODD_BLOCKS, DISPLACEMENT, FILL = 0, 1, 2, 4
RING = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Corners (x, y) of a 2x2 block, in the order of the ring."""


def mix64(x):
    """Finaliser of splitmix64."""
    x = (x + 0x9E3779B97F4A7C15) % 2**64
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9 % 2**64
    x = (x ^ x >> 27) * 0x94D049BB133111EB % 2**64
    return x ^ x >> 31


def mix32(x):
    """The 32-bit mixer called lowbias32."""
    x = (x ^ x >> 16) * 0x7FEB352D % 2**32
    x = (x ^ x >> 15) * 0x846CA68B % 2**32
    return x ^ x >> 16


def key(seed, when, phase):
    """Key of all draws of one kind at one time."""
    return mix64((mix64((mix64(seed) + when) % 2**64) + phase) % 2**64)


def draw(key, cell):
    """64 bits for a cell."""
    return mix64(key ^ mix64(cell))


def block_draw(key, block, blocks, z):
    """0 ... 3 for a block of layer z: two bits of a word that 16 layers share."""
    word = mix32(mix32(z // 16 * blocks + block ^ key % 2**32) ^ key >> 32)
    return word >> 2 * (z % 16) & 3


def permuted(values, is_open, r):
    """The horizontal rule on the four cells of a block in ring order."""
    ring = [i for i in range(4) if is_open[i]]
    out = list(values)
    if len(ring) == 4:
        out = [values, values[2:] + values[:2], values[3:] + values[:3], values[1:] + values[:1]][r]
    elif len(ring) == 3:
        solid = ({0, 1, 2, 3} - set(ring)).pop()
        beside = [i for i in ring if abs(i - solid) in (1, 3)]
        sources = {0: ring, 1: ring, 2: ring[-1:] + ring[:-1], 3: ring[1:] + ring[:1]}[r]
        for target, source in zip(ring, sources):
            out[target] = values[source]
        if r == 1:
            out[beside[0]], out[beside[1]] = values[beside[1]], values[beside[0]]
    elif len(ring) == 2 and r >= 2:
        (xa, ya), (xb, yb) = RING[ring[0]], RING[ring[1]]
        if abs(xa - xb) + abs(ya - yb) == 1:
            out[ring[0]], out[ring[1]] = values[ring[1]], values[ring[0]]
    return out


def horizontal(q, solid, key, start):
    """One horizontal step, blocks starting at 0 (even) or -1 (odd); what lies outside is solid."""
    nz, ny, nx = q.shape
    xs, ys = range(start, nx, 2), range(start, ny, 2)
    for z, (by, y0), (bx, x0) in product(range(nz), enumerate(ys), enumerate(xs)):
        corners = [(x0 + dx, y0 + dy) for dx, dy in RING]
        is_open = [0 <= x < nx and 0 <= y < ny and not solid[z, y, x] for x, y in corners]
        values = [int(q[z, y, x]) if o else 0 for (x, y), o in zip(corners, is_open)]
        r = block_draw(key, by * len(xs) + bx, len(xs) * len(ys), z)
        for (x, y), o, value in zip(corners, is_open, permuted(values, is_open, r)):
            if o:
                q[z, y, x] = value


def vertical(q, solid, start, reading):
    """One vertical step of eq. (4.16) over pairs (start, start + 1), ..."""
    nz, ny, nx = q.shape
    for z, y, x in product(range(start, nz - 1, 2), range(ny), range(nx)):
        if solid[z, y, x] or solid[z + 1, y, x]:
            continue
        low, up = int(q[z, y, x]), int(q[z + 1, y, x])
        if up > 0 and low == 0:
            q[z, y, x], q[z + 1, y, x] = 1, up - 1
        elif low > 1 and (up < low if reading == "lower" else up < FULLEST):
            q[z, y, x], q[z + 1, y, x] = low - 1, up + 1


def sweep(q, solid, seed, when, reading="lower"):
    """Horizontal (even), vertical (a), horizontal (odd), vertical (b), in place."""
    horizontal(q, solid, key(seed, when, EVEN_BLOCKS), 0)
    vertical(q, solid, 0, reading)
    horizontal(q, solid, key(seed, when, ODD_BLOCKS), -1)
    vertical(q, solid, 1, reading)


def displace(q, new, seed, when):
    """Make the new cells solid, in place; in cell order liquid goes to a face neighbour or the nearest shell.

    Returns False where a cell's liquid finds no room; q is then of no use.
    """
    nz, ny, nx = q.shape
    spilled = [(c, int(q[c])) for c in product(range(nz), range(ny), range(nx)) if new[c] and q[c]]
    q[new != 0] = 0
    k = key(seed, when, DISPLACEMENT)
    for (z, y, x), units in spilled:

        def room(cell):
            inside = all(0 <= c < n for c, n in zip(cell, q.shape))
            return inside and not new[cell] and q[cell] + units <= FULLEST

        sides = [(0, 0, -1), (0, 0, 1), (0, -1, 0), (0, 1, 0), (-1, 0, 0), (1, 0, 0)]
        places = [c for c in ((z + dz, y + dy, x + dx) for dz, dy, dx in sides) if room(c)]
        for d in range(1, max(q.shape)):
            if places:
                break
            cube = product(*(range(c - d, c + d + 1) for c in (z, y, x)))
            places = [c for c in cube if max(abs(c[0] - z), abs(c[1] - y), abs(c[2] - x)) == d and room(c)]
        if not places:
            return False
        q[places[draw(k, (z * ny + y) * nx + x) % len(places)]] += units
    return True


def fill(q, solid, units, within, seed, when):
    """One unit into each empty open cell within, layer by layer, by lot in the last, in place; units left."""
    nz, ny, nx = q.shape
    k = key(seed, when, FILL)
    for z in range(nz):
        free = (within[z] != 0) & (solid[z] == 0) & (q[z] == 0)
        cells = [(y, x) for y, x in product(range(ny), range(nx)) if free[y, x]]
        cells.sort(key=lambda c: draw(k, (z * ny + c[0]) * nx + c[1]))
        for y, x in cells[:units]:
            q[z, y, x] = 1
        units -= len(cells[:units])
    return units
