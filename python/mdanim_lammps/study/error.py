# SPDX-License-Identifier: GPL-2.0-only
"""The distance of two runs, the limit and the order of a ladder of runs, and whether the ladder converges.

A run is its track: centres of mass [m], shape (F, M, 3), of M objects in F frames at the same times. Everything here is a
pure function of tracks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..records import dataclass

REST = 1e-12
"""Motion that is nothing but rounding [m]."""
ROUND_OFF = 1e-9
"""Differences below this, relative to the extent of the motion, are not errors of a setting."""
CONVERGENT = 0.3
"""Differences above this share of the extent are too large to follow a power of the step."""
LOWEST, HIGHEST = 0.5, 3.5
"""Orders that are believed: laws have 1 (contact, surfaces of lattices) and 2 (springs, leap-frog). A slower fall has no limit
that three runs tell, a steeper one is chance."""
ONE_WAY = 0.5
"""Least cosine of the last two steps of a ladder that approaches a limit: errors C s^order have the direction of C whatever s is,
and where more than that is turned, what is seen is not their fall."""
PARTS = 60
"""Ends of a run that are tried to find out up to when it has an order."""
PART = 0.01
"""Two runs have diverged once they differ by this share of the extent."""
HALF_AS_FINE = 2.0
"""A finest run without a limit is compared with the runs at least half as fine: at order 1 it is as far from its limit."""
SAFETY, SHORT = 1.25, 3.0
"""Over an estimate of how far a limit is, the doubt: the factors of the grid convergence index for three runs and more, and for
fewer than were meant to be there, which may be near each other by chance (docs/decisions/accuracy.md)."""


def extent(track: np.ndarray) -> float:
    """Largest distance of any centre of mass from its start [m]; 0 where it is below REST."""
    far = float(np.linalg.norm(track - track[0], axis=-1).max())
    return far if far > REST else 0.0


def moving(track: np.ndarray) -> np.ndarray:
    """Objects that move at all, bool, shape (M,): those that never do would make every error look smaller."""
    return (track != track[0]).any(axis=(0, 2))


def distance(a: np.ndarray, b: np.ndarray) -> float:
    """Root mean square over frames and moving objects of the distance between two tracks [m]."""
    which = moving(b)
    return float(np.sqrt(((a - b)[:, which] ** 2).sum(-1).mean())) if which.any() else 0.0


def extrapolate(fine: np.ndarray, coarse: np.ndarray, ratio: float, order: float) -> np.ndarray:
    """Richardson's limit of x = x* + C s^order from two runs whose steps s are in the given ratio > 1."""
    return fine + (fine - coarse) / (ratio**order - 1.0)


@dataclass(frozen=True)
class Convergence:
    """The limit of a ladder of runs, its order and its errors."""

    limit: np.ndarray
    """Best estimate of the motion [m], shape (F, M, 3): Richardson's limit, by the order of the three finest runs if they have
    one; the finest run where there is no order."""
    errors: tuple[float, ...]
    """Error of each run against the limit, relative to the extent, coarsest first; nan for a finest run that is its own limit."""
    order: float | None
    """Observed order of all runs that converge, or of the three finest; None where errors follow no power of the step."""
    used: int = 0
    """Runs in the fit."""
    why: str = ""
    """Why there is no order."""
    doubt: float = 0.0
    """How far the limit itself may be off, relative to the extent: as far as it is from the finest run; with an order of three
    runs alone `SAFETY` times as far; without an order, `SAFETY` or `SHORT` times as far as the finest run is from any run at
    least half as fine."""


def converge(steps: Sequence[float], tracks: Sequence[np.ndarray], scale: float, *, short: bool = False) -> Convergence:
    """Find the limit of a ladder and the order in which it is approached.

    The order is that of all runs, or, where these have none, that of the three finest: coarse cells may differ from fine ones by
    more than any power of the spacing. In both cases the last two steps of the ladder must lead the same way.

    Args:
        steps: time step, spacing or the like of each run, falling.
        tracks: of each run [m], each of shape (F, M, 3); two at least.
        scale: extent of the motion [m].
        short: whether finer runs are missing that were meant to be there.
    """
    tracks = [np.asarray(t) for t in tracks]
    if scale == 0.0:
        return Convergence(tracks[-1], (0.0,) * len(tracks), None, why="nothing moves")
    plain = [distance(t, tracks[-1]) / scale for t in tracks[:-1]]
    if max(plain) < ROUND_OFF:
        return Convergence(tracks[-1], (*plain, 0.0), None, why="all runs agree to round-off")
    orders, used, why = (None, 0, "an order takes three runs") if len(tracks) < 3 else _orders(steps, tracks, scale)
    if orders is None:
        near = [off for off, step in zip(plain, steps) if step <= 1.001 * HALF_AS_FINE * steps[-1]] or plain[-1:]
        doubt = (SHORT if short else SAFETY) * max(near)
        return Convergence(tracks[-1], (*plain, math.nan), None, why=why, doubt=doubt)
    limit = extrapolate(tracks[-1], tracks[-2], steps[-2] / steps[-1], orders[-1])
    errors = tuple(distance(t, limit) / scale for t in tracks)
    # Three runs tell an order, and leave nothing to check it by.
    return Convergence(limit, errors, orders[0], used=used, doubt=errors[-1] * (SAFETY if why else 1.0))


def _orders(steps: Sequence[float], tracks: Sequence[np.ndarray], scale: float) -> tuple[list[float] | None, int, str]:
    """The order of all runs and that of the three finest, or the one of them that there is; how many runs the first is from; and
    why there is none, of all of them or at all.

    Orders of fine cells may be others than those of coarse ones: the limit is made with that of the finest.
    """
    every, used, why = _order_of_all(steps, tracks, scale)
    ratio = _ratio(*tracks[-3:])
    if ratio is None:
        return None, 0, why or "the last two steps of the ladder go in different directions"
    orders = [order for order in (every, _order_of_three(steps[-3:], ratio)) if order is not None]
    return orders or None, used or 3, why


def _ratio(coarse: np.ndarray, middle: np.ndarray, fine: np.ndarray) -> float | None:
    """The first of the two steps between three runs over the second, along the way from coarse to fine; None where these steps do
    not lead one way."""
    which = moving(fine)
    first, second = (middle - coarse)[:, which].ravel(), (fine - middle)[:, which].ravel()
    if first @ second <= ONE_WAY * np.linalg.norm(first) * np.linalg.norm(second):
        return None
    return float((first @ (first + second)) / (second @ (first + second)))


def _order_of_three(steps: Sequence[float], ratio: float) -> float | None:
    """The order p for which (s1^p - s2^p) / (s2^p - s3^p) is the ratio of the steps between three runs: Richardson's formula."""
    (a, b), c = (math.log(s / steps[-1]) for s in steps[:2]), ratio

    def off(p: float) -> float:
        return (math.exp(a * p) - math.exp(b * p)) / (math.exp(b * p) - 1.0) - c

    low, high = LOWEST, HIGHEST
    if not off(low) < 0.0 < off(high):  # the quotient grows with p
        return None
    while high - low > 1e-6:
        low, high = (middle, high) if off(middle := 0.5 * (low + high)) < 0.0 else (low, middle)
    return low


def _order_of_all(steps: Sequence[float], tracks: Sequence[np.ndarray], scale: float) -> tuple[float | None, int, str]:
    """The order of all runs that converge, how many these are, and why there is none.

    It is the slope of log error over log step, least squares over the convergent part, against Richardson's limit of the two
    finest runs for that same order: both are found together by iteration. A fit against the finest run would flatter the runs
    next to it. The finest run itself is left out of the fit; with three runs this is the usual formula for three grids; of more
    runs half must converge. The convergent part reaches from the finest run as far as errors grow with the step and stay below
    CONVERGENT.
    """
    size, order = np.log(np.asarray(steps, float)), 2.0
    for _ in range(50):
        limit = extrapolate(tracks[-1], tracks[-2], steps[-2] / steps[-1], order)
        errors = np.array([distance(t, limit) for t in tracks]) / scale
        first = _convergent(errors)
        inside = slice(first, len(tracks) - 1)
        if len(size[inside]) < max(2, len(tracks) // 2):
            return None, 0, "too few runs converge"
        found = float(np.polyfit(size[inside], np.log(errors[inside]), 1)[0])
        if not LOWEST < found < HIGHEST:
            return None, 0, "errors hardly fall from run to run"
        if abs(found - order) < 1e-4:
            return found, len(tracks) - 1 - first, ""
        order = 0.5 * (order + found)
    return None, 0, "errors follow no power of the step"


def order_until(
    times: np.ndarray, steps: Sequence[float], tracks: Sequence[np.ndarray], scale: float
) -> tuple[float, float] | None:
    """Up to when a ladder without an order has one [s], and that order; None where it has none from the start.

    What happens then depends on more than the step: which particles meet in a blow changes with every spacing. Times are tried
    from the beginning on, and the last one counts before the first without an order. Arguments as for `converge`.
    """
    seen = []
    for frames in np.unique(np.linspace(2, len(times) - 1, PARTS).astype(int)):
        part = converge(steps, [t[:frames] for t in tracks], scale)
        if part.order is not None:
            seen.append((float(times[frames - 1]), part.order))
        elif seen:
            break
    # The median, because the last of them may already include the beginning of the divergence.
    return (seen[-1][0], float(np.median([order for _, order in seen]))) if seen else None


def _convergent(errors: np.ndarray) -> int:
    """Index of the coarsest run of the convergent part."""
    first = len(errors) - 2
    while first > 0 and errors[first] < errors[first - 1] < CONVERGENT:
        first -= 1
    return first if ROUND_OFF < errors[first] < CONVERGENT else len(errors)


@dataclass(frozen=True, slots=True)
class Growth:
    """How the difference between two runs grows: in a chaotic scene no ladder has an order."""

    folding: float
    """Time in which the difference grows e-fold, mean over the run until the runs have diverged [s]; inf: no growth."""
    parted: float | None
    """Time from which the difference stays above PART of the extent [s]; None: it never does."""


def growth(times: np.ndarray, a: np.ndarray, b: np.ndarray, scale: float) -> Growth:
    """Divergence of two runs of neighbouring settings.

    Args:
        times: of the frames [s], shape (F,).
        a, b: tracks [m], shape (F, M, 3).
        scale: extent of the motion [m].
    """
    which = moving(b)
    apart = np.sqrt(((a - b)[:, which] ** 2).sum(-1).mean(-1)) / scale if which.any() else np.zeros(len(times))
    near = np.flatnonzero(apart <= PART)
    last = int(near[-1]) + 1
    parted = float(times[last]) if last < len(times) else None
    known = np.flatnonzero((apart > ROUND_OFF) & (np.arange(len(times)) <= last))
    if len(known) < 3:
        return Growth(math.inf, parted)
    slope = float(np.polyfit(times[known], np.log(apart[known]), 1)[0])
    return Growth(1.0 / slope if slope > 0.0 else math.inf, parted)


def difference(a: np.ndarray, b: np.ndarray, limit: np.ndarray, doubt: float) -> tuple[float, float]:
    """Least and most of the error of ``a`` less that of ``b`` [m], over all truths within ``doubt`` [m] of ``limit``.

    Both errors are distances from the same truth, so their difference is far better known than each. It depends on where the
    truth is along the line from a to b and how far from that line: a plane with a disk of truths.
    """
    apart, to_a, to_b = distance(a, b), distance(a, limit), distance(b, limit)
    if not math.isfinite(doubt) or apart == 0.0:
        return -apart, apart
    along = (apart**2 + to_a**2 - to_b**2) / (2.0 * apart)
    aside = math.sqrt(max(to_a**2 - along**2, 0.0))
    radius, angle = np.meshgrid(np.linspace(0.0, doubt, 17), np.linspace(0.0, 2.0 * np.pi, 96))
    x, y = along + radius * np.cos(angle), aside + radius * np.sin(angle)
    found = np.hypot(x, y) - np.hypot(x - apart, y)
    return float(found.min()), float(found.max())
