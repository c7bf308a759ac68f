# SPDX-License-Identifier: GPL-2.0-only
"""A row of dominoes, and a twin of it: stones that turn about their front edges and strike each other inelastically.

A stone of height h and thickness d leans by the angle q, its foot is p in front of that of the stone behind. The upper edge of
stone i lies on the back of stone j = i + 1 where

    h sin(q_i - q_j) = p cos q_j - d.

It presses with a force F across that back and slides down on it, so that friction mu F pulls stone j down and holds stone i
up. About their feet, with the moment of inertia J,

    J q_i'' = m g (h sin q_i - d cos q_i)/2 - F h (cos(q_i - q_j) + mu sin(q_i - q_j))
    J q_j'' = m g (h sin q_j - d cos q_j)/2 + F (h cos(q_i - q_j) - p sin q_j - mu d).

With the second derivative of the condition of each touching pair these are linear in all q'' and F. Where the foremost stone has
come to the next one, impulses with the same levers make all speeds fit the conditions again: nothing springs back, and nothing is
left to choose.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .case import Case, Curve, Found, Row, Runs


@dataclass(frozen=True)
class Twin:
    """Stones of 1 kg/m in a row; lengths [m], g [m/s^2]."""

    h: float
    d: float
    p: float
    mu: float
    g: float

    def falls(self, number: int, push: float, step: float = 1e-3) -> np.ndarray:
        """Times at which the stones begin to move [s], shape (number,), the first one with the speed `push` [rad/s].

        `step` is in units of sqrt(h/g).
        """
        q, w, times, now = np.zeros(1), np.array([push]), [0.0], 0.0
        dt, strikes = step * math.sqrt(self.h / self.g), math.asin((self.p - self.d) / self.h)
        while len(times) < number:
            before = q, w
            q, w = self._stepped(q, w, dt)
            now += dt
            if q[-1] >= strikes:
                part = (strikes - before[0][-1]) / (q[-1] - before[0][-1])
                now -= (1.0 - part) * dt
                q, w = self._stepped(*before, part * dt)
                times.append(now)
                q, w = np.append(q, 0.0), np.append(w, 0.0)
                matrix, _ = self._matrix(q, w)
                w = np.linalg.solve(matrix, np.concatenate([w * self._inertia(), np.zeros(len(q) - 1)]))[: len(q)]
        return np.array(times)

    def _inertia(self) -> float:
        return (self.h**2 + self.d**2) / 3.0

    def _matrix(self, q: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The matrix of all q'' and forces, and what the conditions leave on the right, shape (2 n - 1, 2 n - 1) and (n - 1,)."""
        n, matrix, right = len(q), np.zeros((2 * len(q) - 1,) * 2), np.zeros(len(q) - 1)
        matrix[range(n), range(n)] = self._inertia()
        for i in range(n - 1):
            j, lean = i + 1, q[i] - q[i + 1]
            s, c = self.h * math.sin(lean), self.h * math.cos(lean)
            matrix[i, n + i] = c + self.mu * s
            matrix[j, n + i] = -(c - self.p * math.sin(q[j]) - self.mu * self.d)
            matrix[n + i, [i, j]] = c, self.p * math.sin(q[j]) - c
            right[i] = s * (w[i] - w[j]) ** 2 - self.p * math.cos(q[j]) * w[j] ** 2
        return matrix, right

    def _turns(self, q: np.ndarray, w: np.ndarray) -> np.ndarray:
        matrix, right = self._matrix(q, w)
        weight = 0.5 * self.g * (self.h * np.sin(q) - self.d * np.cos(q))
        return np.linalg.solve(matrix, np.concatenate([weight, right]))[: len(q)]

    def _stepped(self, q: np.ndarray, w: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """After a step of the rule of the middle."""
        half = 0.5 * dt
        middle = q + half * w, w + half * self._turns(q, w)
        return q + dt * middle[1], w + dt * self._turns(*middle)


def _begins(times: np.ndarray, spin: np.ndarray, least: float) -> float:
    """When a stone turns with this speed [1/s], between frames on a straight line [s]: a blow falls between two of them."""
    n = int((spin > least).argmax())
    return float(np.interp(least, spin[n - 1 : n + 1], times[n - 1 : n + 1])) if n else 0.0


def row(runs: Runs) -> Found:
    """Speed of the wave where it has settled, on earth and with a quarter of the weight, and how the row begins."""
    h, d, pitch, number = 0.048, 0.008, 0.024, 30
    speeds, rows = {}, []
    for g in (9.81, 9.81 / 4.0):
        twin = Twin(h, d, pitch, 0.2, g).falls(number, 1.2 * math.sqrt(g / h), 5e-3)
        run = runs.run("row", g=f"{g} m/s^2").trajectory
        spins = np.array([run.objects[f"stone[{k}]"].spin[:, 1] for k in range(1, number + 1)])
        began = np.array([_begins(run.times, spin, 0.1 * math.sqrt(g / h)) for spin in spins])
        speeds[g] = 15.0 * pitch / float(began[-1] - began[-16])
        if g == 9.81:
            rows = [
                Row("time until the tenth stone", float(twin[9]), float(began[9]), 0.01, "s"),
                Row("speed of the wave", 15.0 * pitch / float(twin[-1] - twin[-16]), speeds[g], 0.01, "m/s"),
            ]
            stones = np.arange(1, number + 1)
            curve = Curve("time [s]", "stone that begins to fall", {"here": (began, stones)}, {"twin": (twin, stones)})
    rows.append(Row("speed over that with a quarter of g", 2.0, speeds[9.81] / speeds[9.81 / 4.0], 0.005))
    return Found(rows, curve)


CASES = [
    Case(
        "row",
        "A row of dominoes",
        "twin after van Leeuwen 2010",
        "Stones that turn about their feet and strike each other inelastically, as those of van Leeuwen, Am. J. Phys. 78 (2010) "
        "721; equations and solution are in bench/published/dominoes.py. That speed grows as √g is exact.",
        "1 %: the twin's feet never slip or lift, and its blows take no time. 0.5 % of √g: a frame in the time of fifteen "
        "stones.",
        "Thirty stones of 48 × 24 × 8 mm, 24 mm apart, with friction 0.2, with 1 on the ground. The smaller the steps, the "
        "later stones begin, up to 1 % at `reference`, as friction between stones takes more in blows than the twin's, as much "
        "as 0.215 would: without it (`friction 0.001`) the tenth stone is 0.2 % early. It is as late with `friction 4` on the "
        "ground, and the twin's steps do not matter.",
        row,
        peers=True,
    )
]
