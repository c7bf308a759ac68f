# SPDX-License-Identifier: GPL-2.0-only
"""Quantities of the motion of objects."""

from __future__ import annotations

from collections.abc import Callable
from operator import itemgetter

import numpy as np

from ... import features
from ...effects import acting
from ...effects.balance import Balance
from ...effects.measured import Glance, Mean, Measurable, Measure, Measured, Of, Recorded, of_vector
from ...model.spin import rotation, spin
from ...scene.once import once_for


def _place(m: Measured, of: Of) -> np.ndarray:
    return m.center[:, m.solid(of.subject)]


def _velocity(m: Measured, of: Of) -> np.ndarray:
    return m.velocity[:, m.solid(of.subject)]


def _between(part: int, number: Callable[[np.ndarray], float]) -> Callable[[Measured, Of, float], float]:
    return lambda m, of, time: float(number(motion(m, m.solid(of.subject), time)[part]))


def _distance(m: Measured, of: Of) -> np.ndarray:
    return np.linalg.norm(_place(m, of) - m.center[:, m.solid(of.argument)], axis=1)


def _distance_between(m: Measured, of: Of, time: float) -> float:
    return float(np.linalg.norm(motion(m, m.solid(of.subject), time)[0] - motion(m, m.solid(of.argument), time)[0]))


def _speed(m: Measured, of: Of) -> np.ndarray:
    return np.linalg.norm(_velocity(m, of), axis=1)


def _component(vector: Measure, axis: int) -> Measure:
    return lambda m, of: vector(m, of)[:, axis]


def _norm(vector: np.ndarray) -> float:
    return float(np.linalg.norm(vector))


@once_for(lambda m: m)
def balance(m: Measured) -> Balance:
    """The momenta of all objects."""
    effects = acting(features.effects(), m.scene)
    return Balance(m.scene, effects, np.asarray(m.trajectory.metadata.object_mass), m.times, m.center, m.velocity)


def _resultant(m: Measured, of: Of) -> np.ndarray:
    return balance(m).resultant[:, m.solid(of.subject)]


@once_for(lambda g: g)
def _spin(g: Glance) -> np.ndarray:
    return spin(g.context.system.mass[g.mine], np.zeros(1, int), g.position[g.mine], g.velocity[g.mine])[0]


@once_for(lambda g: g)
def turn(g: Glance) -> np.ndarray:
    """Rotation of an object since the start, of least squares over its particles: a matrix, shape (3, 3)."""
    system = g.context.system
    return rotation(system.mass[g.mine], system.position[g.mine], g.position[g.mine])


def _angle(g: Glance, axis: int) -> float:
    """Part of a rotation about an axis [rad], from -pi to pi: the twist of its quaternion."""
    r = turn(g)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    return float(np.arctan2(r[j, i] - r[i, j], 1.0 + np.trace(r))) * 2.0


def _follow(angles: np.ndarray) -> np.ndarray:
    """Angles without jumps by whole turns from frame to frame."""
    return np.unwrap(angles)


def _kinetic(g: Glance) -> float:
    """Kinetic energy of flight, spin and vibrations [J]. A rigid object has the inertia of its shape, no other."""
    system, v = g.context.system, g.velocity[g.mine]
    mass = system.mass[g.mine]
    if not system.rigid[g.solid]:
        return float(0.5 * mass @ np.einsum("nd,nd->n", v, v))
    mean = np.average(v, axis=0, weights=mass)
    along = turn(g).T @ _spin(g)
    return float(0.5 * mass.sum() * mean @ mean + 0.5 * along @ system.inertia[g.solid] @ along)


def _work(m: Measured, of: Of) -> np.ndarray:
    """Energy that has come from outside [J], shape (F,): columns of the ledger."""
    terms = dict.fromkeys(term for effect in acting(features.effects(), m.scene) for term in effect.sources(m.scene))
    return np.sum([m.ledger(term) for term in terms if m.has(term)] or [np.zeros(len(m.times))], axis=0)


def _power(m: Measured, of: Of) -> np.ndarray:
    return np.append(np.nan, np.diff(_work(m, of)) / np.diff(m.times))


MEASURES = {
    ("energy", "work"): Measurable(_work),
    ("energy", "power"): Mean(_power),
    **{
        ("NAME", f"{word}.{letter}"): Measurable(_component(vector, axis), between=_between(part, itemgetter(axis)))
        for part, (word, vector) in enumerate((("position", _place), ("velocity", _velocity)))
        for axis, letter in enumerate("xyz")
    },
    ("NAME", "speed"): Measurable(_speed, between=_between(1, _norm)),
    ("NAME", "distance"): Measurable(_distance, between=_distance_between),
    **of_vector("NAME", "force", _resultant, Mean),
    ("NAME", "spin"): Recorded("spin", lambda g: _norm(_spin(g))),
    ("NAME", "kinetic"): Recorded("kinetic", _kinetic),
    **{
        ("NAME", f"{word}.{letter}"): of
        for axis, letter in enumerate("xyz")
        for word, of in (
            ("spin", Recorded(f"spin.{letter}", lambda g, axis=axis: float(_spin(g)[axis]))),
            ("angle", Recorded(f"angle.{letter}", lambda g, axis=axis: _angle(g, axis), follow=_follow)),
        )
    },
}


def motion(m: Measured, solid: int, time: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Centre of mass and its velocity; between two frames by the cubic that meets both positions and velocities."""
    x, v = m.center[:, solid], m.velocity[:, solid]
    if time is None:
        return x[-1], v[-1]
    after = min(int(np.searchsorted(m.times, time * (1 - 1e-9))), len(m.times) - 1)
    if after == 0 or abs(m.times[after] - time) <= 1e-9 * time:
        return x[after], v[after]
    before = after - 1
    dt = m.times[after] - m.times[before]
    s = (time - m.times[before]) / dt
    position = (
        (1 + 2 * s) * (1 - s) ** 2 * x[before]
        + s * (1 - s) ** 2 * dt * v[before]
        + s * s * (3 - 2 * s) * x[after]
        + s * s * (s - 1) * dt * v[after]
    )
    velocity = (
        6 * s * (1 - s) * (x[after] - x[before]) / dt + (1 - 4 * s + 3 * s * s) * v[before] + (3 * s * s - 2 * s) * v[after]
    )
    return position, velocity
