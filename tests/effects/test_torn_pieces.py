# SPDX-License-Identifier: GPL-2.0-only
"""Pieces of solids and sheets that are torn touch each other, and all else, with what a tear laid bare."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.folds.layers import layers, pairs
from mdanim_lammps.run.energy import energies
from twin.folds import Layer, Pair

BLOCK = """{gravity}
object block {{
  shape {shape}  position (0, 0, {z}) m  resolution 5 cm  density 1000  elasticity 100 kPa
  damping 0.2  friction 0.3  tear-strain 0.2
}}
{more}
control {{ time 1 s }}
"""
FALLS = "gravity (0, 0, -9.81) m/s^2\nground z 0 m"


def torn(prepared, shape: str, gravity: str = FALLS, z: float = 0.16, more: str = ""):
    """A block without the springs across its middle, and which of its particles are below; none of other objects."""
    ready = prepared(BLOCK.format(shape=shape, gravity=gravity, z=z, more=more))
    system, (i, j) = ready.system, ready.system.spring.T
    z = system.position[:, 2]
    own = np.arange(len(z)) < system.first[1]
    rows = np.unique(z[own].round(9))
    low = z < rows[len(rows) // 2 - 1 :][:2].mean()
    ready.plan.columns["torn"][(low[i] != low[j]) & own[i]] = 1
    return ready, own & low, own & ~low


def faces(corner: np.ndarray) -> np.ndarray:
    """Triangles of the outer faces of a lattice of particles in rows, x fastest; shape (E, 3)."""
    number = np.arange(corner.size).reshape(corner.shape)
    found = []
    for axis in range(3):
        for end in (0, -1):
            side = number.take(end, axis=axis)
            a, b, c, d = (part.ravel() for part in (side[:-1, :-1], side[:-1, 1:], side[1:, 1:], side[1:, :-1]))
            found += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    return np.concatenate(found)


def test_the_faces_of_pieces_push_each_other(prepared):
    """As a twin has it that is told of two bodies; momentum and angular momentum are kept."""
    ready, low, high = torn(prepared, "box (5, 5, 25) cm", gravity="")
    system, context = ready.system, ready.context
    (pair,), layer = pairs(context), layers(context)[0]
    weight = np.zeros(system.particles)
    weight[layer.particle] = layer.weight
    bodies = [np.flatnonzero(part) for part in (low, high)]
    found = []
    for moved in (0.0, 0.045):  # of a gap of 5 cm
        with Instance(ready.plan) as instance:
            x = instance.array("x")
            x[high] += [0.013, 0.021, -moved]
            x[:] += np.random.default_rng(1).uniform(-1e-4, 1e-4, x.shape)
            instance.setup()
            found.append(instance.array("f").copy())
            place, stored = instance.array("x").copy(), energies(instance, system.center_of_mass(x))["contact"]
        assert (stored > 0.0) == (moved > 0.0)
    sides = [Layer(rows, system.position[rows], faces(np.zeros((len(rows) // 4, 2, 2))), weight[rows]) for rows in bodies]
    twin = Pair(*sides, pair.reach, pair.stiffness)
    still = np.zeros_like(place)
    push, _, _, energy = twin.forces(place, still, system.mass, 1e-3)
    pushed = found[1] - found[0]
    springs = np.abs(found[0]).max()
    assert np.abs(push).max() > 10.0 * springs  # which both have, nearly the same
    np.testing.assert_allclose(pushed, push, rtol=0.0, atol=0.02 * np.abs(push).max() + springs)
    assert stored == pytest.approx(energy, rel=1e-2)
    np.testing.assert_allclose(found[1].sum(axis=0), 0.0, atol=1e-12 * np.abs(push).max())
    np.testing.assert_allclose(np.cross(place, found[1]).sum(axis=0), 0.0, atol=1e-12 * np.abs(push).max())


def fallen(ready, seconds: float) -> tuple[np.ndarray, float]:
    """Places at the end [m], and what the energies have changed by together, over the largest change of any."""
    told = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(9):
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
            instance.run(max(1, round(seconds / 8.0 / ready.certificate.timestep)))
        x = instance.array("x").copy()
    total = [sum(one.values()) for one in told]
    return x, float(abs(total[-1] - total[0]) / max(np.ptp([one[name] for one in told]) for name in told[0]))


@pytest.mark.parametrize("shape", ["box (10, 10, 30) cm", "sphere 15 cm"])
def test_a_piece_lies_on_the_other_one(prepared, shape):
    """On what the tear laid bare: it falls by the cell that is gone, 5 cm, and no further. Both fell through each other."""
    ready, low, high = torn(prepared, shape)
    before = ready.system.position
    x, off = fallen(ready, 0.4)
    assert x[high, 2].min() > x[low, 2].max() - 0.02
    assert before[high, 2].mean() - x[high, 2].mean() > 0.03 and off < 1e-3


def test_a_piece_lies_on_the_ground_and_bears_a_ball(prepared):
    """With particles that were inside: the lower piece flies away, the upper one falls on its new face; a ball falls on that of
    the lower one. Both sank in."""
    ready, low, high = torn(prepared, "box (20, 20, 20) cm", z=0.11)
    ready.system.velocity[low] = [6.0, 0.0, 0.0]
    inside = high & (np.abs(ready.system.position[:, :2]) < 0.09).all(axis=1)
    x, off = fallen(ready, 0.3)
    assert inside.any() and x[inside, 2].min() > -0.01 and off < 1e-3
    ball = "object ball { shape sphere 6 cm  position (0, 0, 0.35) m  density 1500  elasticity rigid }"
    ready, low, high = torn(prepared, "box (20, 20, 20) cm", z=0.11, more=ball)
    ready.system.velocity[high] = [0.0, 9.0, 5.0]
    x, off = fallen(ready, 0.35)
    assert x[-8:, 2].min() > x[low, 2].mean() and off < 1e-3


@pytest.mark.parametrize("thing", ["sheet (0.1, 0.1) m thickness 4 mm", "box (10, 10, 10) cm"])
def test_what_is_laid_bare_bears_layers(prepared, thing):
    """Sheets touch it as they touch each other, and so does what may tear itself."""
    more = f"object thing {{ shape {thing}  resolution 5 cm  position (0, 0, 0.36) m  density 500\n"
    more += "  elasticity 100 kPa  tear-strain 1 }"
    ready, low, high = torn(prepared, "box (20, 20, 20) cm", z=0.11, more=more)
    ready.system.velocity[high] = [0.0, 20.0, 0.0]
    thing = np.arange(ready.system.particles) >= ready.system.first[1]
    assert {(pair.first, pair.second) for pair in pairs(ready.context)} == {(0, 0), (0, 1), (1, 1)}
    x, off = fallen(ready, 0.3)
    assert x[thing, 2].min() > x[low, 2].max() - 0.02 and off < 1e-3


def test_halves_of_a_sheet_touch(prepared):
    """A torn sheet whose parts fall on each other needs no `touches-itself`."""
    ready = prepared(
        "object paper { shape sheet (0.4, 0.2) m thickness 4 mm  position (0, 0, 1) m  resolution 4 cm  density 500\n"
        "  elasticity 500 kPa  friction 0.2  tear-strain 0.2 }\ncontrol { time 1 s }\n"
    )
    system, (i, j) = ready.system, ready.system.spring.T
    left = system.position[:, 0] < -0.01
    ready.plan.columns["torn"][left[i] != left[j]] = 1
    with Instance(ready.plan) as instance:
        x, v = instance.array("x"), instance.array("v")
        x[left] += [0.25, 0.03, 0.02]
        v[left] = [0.0, 0.0, -0.3]
        instance.setup()
        before = (system.mass[:, None] * v).sum(axis=0)
        instance.run(round(0.2 / ready.certificate.timestep))
        x, v = instance.array("x"), instance.array("v")
        assert x[left, 2].mean() > x[~left, 2].mean()
        np.testing.assert_allclose((system.mass[:, None] * v).sum(axis=0), before, atol=1e-9 * np.abs(before).max())


@pytest.mark.parametrize("shape", ["sheet (0.4, 0.2) m thickness 4 mm", "box (0.4, 0.2, 0.08) m"])
def test_sides_of_a_crack_touch(prepared, shape):
    """One side falls on the other and stays above it, where both hang together at the end of the crack. It fell through."""
    ready = prepared(
        f"object paper {{ shape {shape}  position (0, 0, 1) m  resolution 4 cm  density 500\n"
        "  elasticity 500 kPa  damping 0.3  tear-strain 1 }\ncontrol { time 1 s }\n"
    )
    system, (i, j) = ready.system, ready.system.spring.T
    place = system.position
    left, joined = place[:, 0] < -0.01, place[:, 1] > 0.05
    ready.plan.columns["torn"][(left[i] != left[j]) & ~(joined[i] & joined[j])] = 1
    thick = np.ptp(place[:, 2])
    with Instance(ready.plan) as instance:
        x, v = instance.array("x"), instance.array("v")
        far = np.clip((0.02 - place[:, 1]) / 0.06, 0.0, 1.0)[left, None]  # from the joint
        x[left] += far * [0.07, 0.0, thick + 0.02]
        v[left] = far * [0.0, 0.0, -0.5]
        instance.setup()
        instance.run(round(0.04 / ready.certificate.timestep))
        x = instance.array("x").copy()
    near = (place[:, 1] < -0.03) & (np.abs(place[:, 0]) < 0.05)
    assert x[left & near, 2].mean() - x[~left & near, 2].mean() > 0.9 * thick + 0.01


def test_all_of_a_torn_bag_touches_itself_at_once(prepared):
    """Its two sides, which are nearer to each other without load than what touches itself before, far from the only link that is
    gone. They did so from the next list on, which depends on executors and on where a run was taken up."""
    ready = prepared(
        "object bag { shape box (10, 10, 2.4) cm sheet thickness 2 mm  position (0, 0, 1) m  resolution 1.2 cm  density 300\n"
        "  elasticity 1 MPa  tear-strain 2  touches-itself yes }\ncontrol { time 1 s }\n"
    )
    place, (i, j) = ready.system.position, ready.system.spring.T
    ready.plan.columns["torn"][np.linalg.norm(place[i] + place[j], axis=1).argmax()] = 1
    top, near = place[:, 2] > 1.005, np.hypot(*(place[:, :2] + 0.01).T) < 0.02
    with Instance(ready.plan) as instance:
        instance.array("x")[near, 2] += np.where(top, -0.0105, 0.0105)[near]
        instance.setup()
        instance.run(1)
        assert instance.fix_value("folds", "lists") == 1.0 and instance.fix_scalar("folds") > 1e-4
