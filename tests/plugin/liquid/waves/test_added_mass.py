# SPDX-License-Identifier: GPL-2.0-only
"""The liquid that moves up and down with bodies, (W14) to (W16): a naive twin, rigid bodies, impacts; cell, g, density are 1."""

import numpy as np
import pytest
from plugin_library import library
from waves_lab import DOUBLE, DOUBLES, INT

DT = 0.1


def follow(depths, mass, velocity, since, state, bottom=0.0):
    """The state of all columns, (ny, nx, 3): mass, force and velocity; since 0 begins. `bottom`: heights of the lower faces."""
    function = library().mdanim_added_mass
    function.restype, function.argtypes = None, [INT, INT, DOUBLES, DOUBLES, DOUBLES, DOUBLE, DOUBLES]
    state = np.ascontiguousarray(state, float).copy()
    ny, nx = state.shape[:2]
    solids = np.ascontiguousarray(np.stack(np.broadcast_arrays(mass, velocity), axis=-1), float)
    bottoms = np.ascontiguousarray(np.broadcast_to(bottom, (ny, nx)), float)
    function(nx, ny, np.ascontiguousarray(depths, float), bottoms, solids, since, state)
    return state


def most(depths, flat=1.0):
    """(W14), with the distance to all columns that are not wet from below tried out; a way along the bottom counts `flat`."""
    found = np.zeros(depths.shape[:2])
    wet = depths[..., 0] > 0
    others = np.argwhere(~wet)
    for place in np.argwhere(wet):
        way = np.sort(np.abs(others - place), axis=1)
        reach = 2.0 * flat * ((way[:, 1] + (2**0.5 - 1) * way[:, 0]).min() - 0.25)
        found[tuple(place)] = sum((9 / d**2 + 1 / reach**2) ** -0.5 for d in depths[tuple(place)] if d > 0)
    return found


def bodies(seed=0):
    """Depths and masses of two bodies, one with a corner cut off."""
    rng = np.random.default_rng(seed)
    there = np.zeros((20, 26), bool)
    there[3:11, 2:13] = there[8:17, 16:24] = True
    there[3:6, 2:5] = False
    depths = np.where(there[..., None], rng.uniform((1, 0), (9, 4), (*there.shape, 2)), 0.0)
    depths[12, 18:20, 1] = 0.0
    return depths, np.where(there, rng.uniform(1, 5, there.shape), 0.0)


def test_the_mass_is_that_of_the_twin():
    """Where something begins to move all of it is there, and nothing pushes."""
    depths, mass = bodies()
    state = follow(depths, mass, np.where(mass > 0, 0.3, 0.0), 0.0, np.zeros((*mass.shape, 3)))
    np.testing.assert_allclose(state[..., 0], most(depths), rtol=1e-12)
    assert not state[..., 1].any() and (state[mass > 0, 2] == 0.3).all()


@pytest.mark.parametrize("slope", [0.5, 2.0])
def test_below_a_wedge_less_moves_along(slope):
    """In potential flow a bottom at 45 degrees takes half of what a flat one takes: 0.76 of 1.51 pi rho a^2 of a square that
    moves along its diagonal, or across a side."""
    depths, mass, _ = plate()
    bottom = np.broadcast_to(slope * np.abs(np.arange(11) - 5.0), mass.shape)
    state = follow(depths, mass, 0.0, 0.0, np.zeros((9, 11, 3)), bottom)
    np.testing.assert_allclose(state[..., 0], most(depths, 1.0 / (1.0 + slope**2)), rtol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_forces_are_those_of_the_twin(seed):
    """From any state and velocities, where the bodies were elsewhere before."""
    rng = np.random.default_rng(seed)
    depths, mass = bodies(seed)
    before = rng.normal(0, 1, (*mass.shape, 3)) * (rng.random(mass.shape) < 0.8)[..., None]
    before[..., 0] = np.abs(before[..., 0])
    velocity = rng.normal(0, 1, mass.shape)
    state = follow(depths, mass, velocity, DT, before)
    twin = np.zeros_like(state)
    for body in (np.s_[2:12, 1:14], np.s_[7:18, 15:25]):
        at = np.zeros(mass.shape, bool)
        at[body] = depths[body][..., 0] > 0
        known = at & (before[..., 0] > 0)
        weight = np.sqrt(mass[known])
        plane = np.stack([np.ones(mass.shape), *np.indices(mass.shape)], axis=-1)
        changed = (velocity - before[..., 2]) / DT
        fit = np.linalg.lstsq(plane[known] * weight[:, None], changed[known] * weight, rcond=None)[0]
        own, full, was = mass[at], most(depths)[at], before[at]
        now = np.minimum(full, was[:, 0] + np.minimum(full, 3 * (own + was[:, 0])) * DT)
        taken = np.maximum(0, now - was[:, 0]) * np.maximum(0, -velocity[at]) / DT
        a = (own * (plane @ fit)[at] - was[:, 1] + taken) / (own + now)
        twin[at] = np.stack([now, np.clip(taken - now * a, -8, 8), velocity[at]], axis=1)
    np.testing.assert_allclose(state, twin, atol=1e-10)


def plate(mass=0.5):
    """A plate of 7 x 5 columns over 10 cells of liquid, at rest."""
    depths, masses = np.zeros((9, 11, 2)), np.zeros((9, 11))
    depths[2:7, 2:9, 0], masses[2:7, 2:9] = 10.0, mass
    return depths, masses, follow(depths, masses, 0.0, 0.0, np.zeros((9, 11, 3)))


@pytest.mark.parametrize("mass", [0.05, 0.5, 5.0])
def test_a_rigid_body_accelerates_as_with_its_added_mass(mass):
    """Force over both masses, however light the body is against the liquid."""
    depths, masses, state = plate(mass)
    own, moved, v, force = masses.sum(), state[..., 0].sum(), 0.0, 0.2
    assert moved > 0.5 * masses[masses > 0].size
    for step in range(60):
        a = (force + state[..., 1].sum()) / own
        v += DT * a
        state = follow(depths, masses, np.where(masses > 0, v, 0.0), DT, state)
        # Columns at the edge take less liquid along than those in the middle: the lighter the body, the later they agree.
        assert step < 30 or a == pytest.approx(force / (own + moved), rel=0.05)


def test_what_vibrates_moves_no_liquid():
    """The force follows the motion of the body as a whole: waves along it do not come back an update late."""
    depths, masses, state = plate()
    bending = np.where(masses > 0, np.cos(2 * np.pi * np.arange(11) / 3.5), 0.0)
    bending -= bending.sum() / (masses > 0).sum() * (masses > 0)
    state = follow(depths, masses, bending, DT, state)
    assert np.abs(state[..., 1]).max() < 0.15 * np.abs(state[..., 0] * bending / DT).max()


def test_a_body_that_hits_pays_for_what_it_takes_along():
    """It loses the momentum that the liquid gains, and never jumps back."""
    depths, masses, _ = plate(3.0)
    v, state = -2.0, np.zeros((9, 11, 3))
    for _ in range(60):
        state = follow(depths, masses, np.where(masses > 0, v, 0.0), DT, state)
        v += DT * state[..., 1].sum() / masses.sum()
        assert v < 0
    moved = most(depths).sum()
    assert state[..., 0].sum() == pytest.approx(moved)
    assert (masses.sum() + moved) * v == pytest.approx(-2.0 * masses.sum(), rel=0.15)  # it brakes while the mass grows
