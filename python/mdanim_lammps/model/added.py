# SPDX-License-Identifier: GPL-2.0-only
"""Mass that features add to solids of an even density, by their modules ``masses``: a function ``added(solid)``, which gives an
`Added` or None.

Masses of particles follow by factors that are near those of the densities around them, and with which mass, centre and second
moments are those of the whole.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from ..bodies import lets_go
from ..features import facets
from ..records import dataclass
from . import shapes
from .inertia import tensor
from .masses import inertia
from .model import Model

SAMPLES = np.array(list(product((-0.375, -0.125, 0.125, 0.375), repeat=3)))
"""Places around a particle at which densities are asked for, over the edges of a cell, shape (64, 3)."""
ITERATIONS, HALVINGS, ENOUGH = 60, 40, 1e-13
"""Most steps of Newton's method, most halvings of one, and the error of moments at which it ends."""


@dataclass(frozen=True, slots=True, eq=False)
class Added:
    """Mass besides that of an even density; about the place of the solid, axes of the world."""

    mass: float
    """[kg]"""
    first: np.ndarray
    """Integral of x dm [kg m], shape (3,)."""
    second: np.ndarray
    """Integral of x x' dm [kg m^2], shape (3, 3)."""
    ratio: Callable[[np.ndarray], np.ndarray]
    """Density at places of the world [m], shape (n, 3), over the even one, shape (n,)."""


@lru_cache(maxsize=1)
def _givers() -> tuple[Callable[[Any], Added | None], ...]:
    return tuple(facet.added for facet in facets("masses"))


def added(solid: Any) -> Added | None:
    """The sum of all that features add to a solid; None for nothing. Raises mesh.MeshError."""
    found = [one for give in _givers() if (one := give(solid)) is not None]
    if len(found) < 2:
        return found[0] if found else None

    def ratio(x: np.ndarray) -> np.ndarray:
        return 1.0 + sum(one.ratio(x) - 1.0 for one in found)

    return Added(sum(o.mass for o in found), sum(o.first for o in found), sum(o.second for o in found), ratio)


def centre_of(solid: Any) -> np.ndarray:
    """Centre of mass from the place of a solid, axes of the world [m], shape (3,)."""
    more = added(solid)
    return np.zeros(3) if more is None else more.first / shapes.mass(solid)


def tensor_of(solid: Any, mass: float | None = None) -> np.ndarray:
    """Tensor of inertia about the centre of mass, world frame [kg m^2], shape (3, 3), of a body that does not deform, with its
    own mass or another one [kg].

    Raises mesh.MeshError for a mesh that encloses no volume.
    """
    more = added(solid)
    if more is None:
        return tensor(solid.shape, shapes.mass(solid) if mass is None else mass, solid.rotation)
    own, second = _moments(solid, more)
    found = inertia(second - np.outer(more.first, more.first) / own) * (1.0 if mass is None else mass / own)
    return 0.5 * (found + found.T)


def _moments(solid: Any, more: Added) -> tuple[float, np.ndarray]:
    """Mass [kg] and second moments about the place of a solid, axes of the world [kg m^2], shape (3, 3)."""
    turned = np.array(solid.rotation, float)
    even = turned @ shapes.second_moments(solid.shape) @ turned.T
    return shapes.mass(solid), shapes.even_mass(solid) * even + more.second


def weighed(model: Model, solid: Any) -> Model:
    """The model of a solid with what features add to its mass. It turns about its centre of mass at first."""
    more = added(solid)
    if more is None or (model.held.all() and not lets_go(solid)):
        return model
    mass, second = _moments(solid, more)
    arm = model.position - solid.position
    around = np.asarray(model.cell) * SAMPLES @ np.array(solid.rotation, float).T
    near = sum(more.ratio(model.position + off) for off in around) / len(around)
    masses = model.mass * near
    target = np.concatenate([[1.0], more.first / mass, second[np.triu_indices(3)] / mass])
    fitted = _fitted(masses, arm, target, 10) if model.inertia is None else None
    if fitted is None:
        fitted = _fitted(masses, arm, target, 4)
    assert fitted is not None
    velocity = np.where(model.held[:, None], 0.0, model.velocity - np.cross(solid.spin, more.first / mass))
    return replace(model, mass=mass * fitted, velocity=velocity)


def _fitted(masses: np.ndarray, arm: np.ndarray, target: np.ndarray, rows: int) -> np.ndarray | None:
    """Masses m_i (t + sqrt(1 + t^2)), t = sum lambda_k f_k, with these moments over the mass, shape (N,): f are 1, x, y, z and
    six products of two of them. None where the first ``rows`` of them cannot be reached."""
    scale = np.sqrt(np.maximum((arm**2).mean(axis=0), 1e-300))
    x = arm / scale
    a, b = np.triu_indices(3)
    basis = np.concatenate([np.ones((1, len(x))), x.T, (x[:, a] * x[:, b]).T])[:rows]
    asked = np.concatenate([target[:1], target[1:4] / scale, target[4:] / (scale[a] * scale[b])])[:rows]
    share, factor = masses / masses.sum(), np.zeros(rows)

    def left(of: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        t = of @ basis
        weight = share * (t + np.sqrt(1.0 + t * t))
        return weight, asked - (weight * basis).sum(axis=1)

    weight, off = left(factor)
    for _ in range(ITERATIONS):
        if np.abs(off).max() < ENOUGH:
            return weight
        t = factor @ basis
        slope = (share * (1.0 + t / np.sqrt(1.0 + t * t)) * basis) @ basis.T
        step = np.linalg.lstsq(slope, off, rcond=1e-12)[0]
        for shorter in 0.5 ** np.arange(HALVINGS):
            tried = left(factor + shorter * step)
            if np.abs(tried[1]).max() < np.abs(off).max():
                factor = factor + shorter * step
                weight, off = tried
                break
        else:
            break
    return weight if np.abs(off).max() < 1e-9 else None
