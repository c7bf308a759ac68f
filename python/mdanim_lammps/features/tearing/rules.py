# SPDX-License-Identifier: GPL-2.0-only
"""Springs of an object that break, and when, as ``fix mdanim/tear`` reads it (docs/fix_mdanim_tear.md)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...model.model import Model
from ...model.system import System
from ...model.triangles import edges
from ...scene.shapes import Rope

MORE = 1.25
"""Strain that the links of a rope bear over that of the weakest one. Links that were all alike broke together: a cord of 100
links from which a ball fell came apart in 52 pieces."""
SAME = 1e-9
"""Difference of lengths that are alike, over one of them."""
TOUGH, OF_ROPE = 0.36, 2.0
"""e^2 E h/G of sheets and solids, 0.31 to 0.44 (bench/tearing.py), and of a link of a rope."""


def strain_of(system: System, m: int, solid: Any) -> float:
    """The strain that springs of an object bear [-]."""
    if solid.tear_strain is not None:
        return solid.tear_strain
    own, rope = system.springs_of(m), isinstance(solid.shape, Rope)
    h = float(system.unloaded[own][~over_two(system, own)].mean()) if rope else float(system.spacing[m])
    return math.sqrt((OF_ROPE if rope else TOUGH) * solid.toughness / (float(system.young[m]) * h))


def over_two(system: System, own: slice) -> np.ndarray:
    """Which of these springs push in the body without load: those over two links, which resist bending; bool, shape (S,)."""
    return system.rest[own] > system.unloaded[own] * (1.0 + SAME)


def over_two_of(system: System, m: int, model: Model) -> np.ndarray:
    """The same of an object: of a layer, springs that are not edges of its triangles."""
    own = system.springs_of(m)
    if model.frame.dimensions != 2:
        return over_two(system, own)
    n = int(system.first[m + 1] - system.first[m])
    (low, high), (i, j) = (
        np.sort(edges(model.frame.triangle), axis=1).astype(np.int64).T,
        (system.spring[own] - system.first[m]).T,
    )
    return ~np.isin(i * np.int64(n) + j, low * n + high)


def middles(pair: np.ndarray, length: np.ndarray, over: np.ndarray) -> np.ndarray:
    """The particle between the two links that each spring over two links lies over, int64, shape (K,): of curved sheets, where
    they are most nearly in a row.

    Args:
        pair: particles of springs, i < j, sorted, shape (S, 2).
        length: without load [m], shape (S,): that of a spring over two links is the sum of theirs, or less.
        over: which springs these are, bool, shape (S,).
    """
    link, count = pair[~over].astype(np.int64), int(pair.max(initial=-1)) + 1
    low, high = link.T
    ends, others = np.concatenate([low, high]), np.concatenate([high, low])
    of_link = np.tile(np.arange(len(link)), 2)
    order = np.lexsort((others, ends))
    ends, others, of_link = ends[order], others[order], of_link[order]
    first = np.searchsorted(ends, np.arange(count + 1))
    key, size = low * count + high, length[~over]
    a, b = pair[over].astype(np.int64).T
    found, best = np.full(len(a), -1, np.int64), np.full(len(a), np.inf)
    for k in range(int(np.diff(first).max(initial=0))):
        at = np.minimum(first[a] + k, len(others) - 1)
        middle = others[at]
        wanted = np.minimum(middle, b) * count + np.maximum(middle, b)
        place = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
        off = np.abs(size[of_link[at]] + size[place] - length[over])
        fits = (first[a] + k < first[a + 1]) & (key[place] == wanted) & (off < best)
        found[fits], best[fits] = middle[fits], off[fits]
    if np.isinf(best).any():
        raise ValueError("a spring pushes that does not lie over two links")
    return found


def lengths(pair: np.ndarray, length: np.ndarray, over: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Lengths without load of both links that springs lie over [m], shape (K, 2), from the same and ``middles``."""
    link, count = pair[~over].astype(np.int64), int(pair.max(initial=-1)) + 1
    ends = np.sort(np.stack([pair[over], np.stack([middle, middle], axis=1)], axis=2), axis=2).astype(np.int64)
    return length[~over][np.searchsorted(link[:, 0] * count + link[:, 1], ends[..., 0] * count + ends[..., 1])]


def beyond(system: System, m: int, over: np.ndarray) -> float:
    """The most that a remainder of springs over two links is stiffer than these, over their constant, at least 2 [-]."""
    own = system.springs_of(m)
    if not over.any():
        return 2.0
    pair, length = system.spring[own] - system.first[m], system.unloaded[own]
    both = lengths(pair, length, over, middles(pair, length, over))
    return max(2.0, float((both.sum(axis=1) / both.min(axis=1)).max()) - 1.0)


def limits(solid: Any, seed: int, strain: float, length: np.ndarray) -> np.ndarray:
    """Lengths at which links are gone [m], from those without load, shape (L,). All of them bear the ``strain``; but of a rope
    one link, which the seed and the name of the rope choose, and the others MORE: as no rope is alike everywhere, it tears in one
    place."""
    if not isinstance(solid.shape, Rope):
        return (1.0 + strain) * length
    import random  # loaded for ropes that tear alone

    each = np.full(len(length), MORE * strain)
    each[random.Random(f"{seed} {solid.name}").randrange(len(length))] = strain
    return (1.0 + each) * length


def rules_text(system: System, m: int, model: Model, solid: Any, seed: int, strain: float) -> str:
    """The lines of an object."""
    own = system.springs_of(m)
    lines = [f"object {m + 1} {strain!r}{' whole' if solid.yield_strain is not None else ''}\n"]
    over, length = over_two_of(system, m, model), system.unloaded[own]
    pair = system.spring[own] - system.first[m]
    if over.any() or isinstance(solid.shape, Rope):
        limit = limits(solid, seed, strain, length[~over])
        rows = zip((pair[~over] + 1).tolist(), length[~over].tolist(), limit.tolist())
        lines += [f"link {i} {j} {a!r} {b!r}\n" for (i, j), a, b in rows]
        lines += over_lines(pair, length, over, 0.5 * system.stiffness[own], system.rest[own])
    return "".join(lines)


def over_lines(pair: np.ndarray, length: np.ndarray, over: np.ndarray, half: np.ndarray, rest: np.ndarray) -> list[str]:
    """The lines of springs over two links; those whose links are not in a row end with their own length."""
    middle = middles(pair, length, over)
    both = lengths(pair, length, over, middle).sum(axis=1)
    bent = both > length[over] * (1.0 + SAME)
    rows = zip((pair[over] + 1).tolist(), (middle + 1).tolist(), half[over].tolist(), rest[over].tolist())
    ends = [f" {own!r}" if is_bent else "" for own, is_bent in zip(length[over].tolist(), bent.tolist())]
    return [f"over {i} {k} {j} {a!r} {b!r}{end}\n" for ((i, j), k, a, b), end in zip(rows, ends)]
