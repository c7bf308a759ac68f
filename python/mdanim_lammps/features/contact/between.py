# SPDX-License-Identifier: GPL-2.0-only
"""The force between two things that touch, from the forces of contact on all that hangs together on one side of them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from ...effects.balance import Balance
from ...effects.measured import Measured
from ...model.boxes import box_pairs

NEAR = 1e-3
"""Gap of two things that count as touching, over the size of the smaller one: rigid ones rest beside each other with less."""


class Touching:
    """Who may touch whom since the frame before, by boxes, and the force between two of them.

    Frames tell the force of all contact on an object (`Balance`). Where a cut between two things parts all that touches, the
    force in the cut is the sum over all objects on one side of it: forces among these cancel. So a stone bears the contact of
    all that lies on it. Where two ways round a ring lead from one to the other, or where both sides lean on something else that
    is held, frames do not tell it: NaN.

    Boxes of a time between two frames hold both, and are grown by half of the way that the fastest particle may go in that time:
    who goes from one place to another with that speed at most does not leave them.

    Args:
        m: data of the run.
        balance: forces of all contact.
    """

    def __init__(self, m: Measured, balance: Balance):
        self._m, self._balance = m, balance
        self._unknown = set(balance.untold)

    def force(self, subject: int, other: str) -> np.ndarray:
        """Force on an object by another one, ``ground`` or ``walls``, mean since the frame before [N], shape (F, 3)."""
        names = self._m.names
        found = np.full((len(self._m.times), 3), np.nan)
        to = names.index(other) if other in names else other
        for frame in range(1, len(found)):
            neighbours = self._neighbours[frame]
            if to not in neighbours[subject]:
                found[frame] = 0.0
                continue
            for sign, one, beyond in ((1.0, subject, to), (-1.0, to, subject)):
                side = self._side(neighbours, one, beyond)
                if side is not None:
                    found[frame] = sign * self._balance.contact[frame, side].sum(axis=0)
                    break
        return found

    def _side(self, neighbours: dict, one: int | str, beyond: int | str) -> list[int] | None:
        """All that hangs together with ``one`` without its contact with ``beyond``; None where that leads there another way, or
        to something of which the force is not known."""
        seen, rest = {one}, [one]
        while rest:
            at = rest.pop()
            if isinstance(at, str) or at in self._unknown:
                return None
            for to in neighbours[at]:
                if (at, to) == (one, beyond) or to in seen:
                    continue
                if to == beyond:
                    return None
                seen.add(to)
                rest.append(to)
        return [n for n in seen if isinstance(n, int)]

    @cached_property
    def _neighbours(self) -> list[dict[int, set]]:
        """Neighbours of each object in the time before each frame, which it may touch: numbers of objects, names of planes."""
        found: list[dict[int, set]] = [{}]
        for low, high in self._boxes():
            size = (high - low).min(axis=1)
            now: dict[int, set] = {n: set() for n in range(len(size))}
            skin = 0.5 * NEAR * size[:, None]
            for i, j in box_pairs(low - skin, high + skin):  # the skins of two are no less than twice the smaller one
                gap = np.maximum(low[i] - high[j], low[j] - high[i]).max(axis=1)
                near = gap <= NEAR * np.minimum(size[i], size[j])
                for a, b in zip(i[near].tolist(), j[near].tolist()):
                    now[a].add(b)
                    now[b].add(a)
            for plane, gaps in self._gaps(low, high):
                for n in np.flatnonzero(gaps <= NEAR * size).tolist():
                    now[n].add(plane)
            found.append(now)
        return found

    def _gaps(self, low: np.ndarray, high: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
        """Ways of boxes to ground and walls [m], shape (M,); walls that move are near everything."""
        scene = self._m.scene
        if scene.ground is not None:
            yield "ground", low[:, 2] - scene.ground
        if scene.walls is not None:
            moves = scene.walls_drive or scene.walls_keys
            bottom = np.array(scene.walls.low)
            if scene.ground is not None and scene.ground >= bottom[2]:
                bottom[2] = -np.inf  # the ground is what things stand on there
            gap = np.minimum(low - bottom, scene.walls.high - high).min(axis=1)
            yield "walls", np.full(len(low), -np.inf) if moves else gap

    def _boxes(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Boxes in which objects are from each frame to the next, lower and upper corners [m], each of shape (M, 3)."""
        t = self._m.trajectory
        skin, first = t.metadata.skin, t.metadata.first[:-1]
        before = None
        for frame, dt in enumerate(np.diff(self._m.times, prepend=self._m.times[0])):
            low, high = skin.boxes(skin.vertices(t.position(frame), t.gone(frame)))
            speed = np.maximum.reduceat(np.linalg.norm(t.velocity(frame), axis=1), first)
            if before is not None:
                way = 0.5 * dt * np.maximum(speed, before[2])[:, None]
                yield np.minimum(low, before[0]) - way, np.maximum(high, before[1]) + way
            before = low, high, speed
