# SPDX-License-Identifier: GPL-2.0-only
"""The depth below surfaces on which lines and sheets of particles lie is true to a thousandth of their thickness, and is a
distance as far around them as points of these are thick."""

from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps.bodies import kind_of
from mdanim_lammps.model import shapes
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.spread import spread
from mdanim_lammps.scene.scene import Cylinder, Ellipsoid, HoldAll, Sphere, Torus
from model_samples import ROPE, SHEET, scene, solid

ROUND = [Sphere(0.2), Torus(0.2, 0.05), Ellipsoid((0.2, 0.15, 0.1))]


def depth_at(body, place: np.ndarray) -> np.ndarray:
    """Value of the depth [m] at places X [-], shape (P, 3), from its B-splines."""
    count = body.count
    margin = next(m for m in range(2, 40) if (count + 1 + 2 * m).prod() == len(body.depth))
    coefficient = body.depth.reshape(tuple((count + 1 + 2 * margin)[::-1]))
    at = place + margin
    middle = np.floor(at + 0.5).astype(int)
    u = at - middle
    weight = [0.5 * (0.5 - u) ** 2, 0.75 - u**2, 0.5 * (0.5 + u) ** 2]
    found = np.zeros(len(place))
    for c in range(3):
        for b in range(3):
            for a in range(3):
                node = middle + np.array([a, b, c]) - 1
                found += weight[a][:, 0] * weight[b][:, 1] * weight[c][:, 2] * coefficient[tuple(node.T[::-1])]
    return found


@pytest.mark.parametrize("shape", ROUND, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("beside", [ROPE, SHEET], ids=["rope", "sheet"])
def test_a_held_object_beneath_is_fine_enough(shape, beside):
    """Without a rope or a sheet it has two cells across, and is off by hundredths."""
    made = scene(solid(shape, hold=(HoldAll(),)), solid(beside, "cloth", position=(2.0, 0.0, 0.0)))
    spacing = kind_of(made.solids[0]).spacing(made, shapes.thickness(shape) / 2)(made.solids[0])
    body = build_models(made, [spacing, 0.1])[0].frame.contact
    points, _, _ = spread(shape, shapes.thickness(shape) / 20)
    low = build_models(made, [spacing, 0.1])[0].frame.cells.low
    off = np.abs(depth_at(body, (points - low) / body.edge)) / shapes.thickness(shape)
    assert off.max() < 1e-3


@pytest.mark.parametrize(("radius", "known"), [(0.002, 2), (0.05, 22), (0.5, 32)])
def test_the_depth_around_a_thin_rod_is_a_distance_as_far_as_ropes_are_thick(radius, known):
    """A rod of 2 cm in cells of 2.5 mm. It was kept on two nodes around the cells, and one depth was read everywhere beyond."""
    rod, rope = (
        solid(Cylinder(0.01, 0.1), hold=(HoldAll(),)),
        solid(replace(ROPE, thickness=2.0 * radius), position=(2.0, 0.0, 0.0)),
    )
    frame = build_models(scene(rod, rope), [0.0025, 0.1])[0].frame
    assert frame.margin == known
    assert (frame.known_for >= radius) == (known < 32)
    angle = np.linspace(0.0, 2.0 * np.pi, 40)
    away = 0.01 + min(radius, frame.known_for)
    place = np.stack([away * np.cos(angle), away * np.sin(angle), 0.0 * angle], axis=1)
    found = depth_at(frame.contact, (place - frame.cells.low) / frame.contact.edge)
    assert np.abs(found - 0.01 + away).max() < 2e-5
