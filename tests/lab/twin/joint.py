# SPDX-License-Identifier: GPL-2.0-only
"""Forces of fix mdanim/joint as docs/fix_mdanim_joint.md has them, by least squares and derivatives that numpy finds."""

from __future__ import annotations

import re

import numpy as np


class Patch:
    """Particles as an affine body."""

    def __init__(self, mass: np.ndarray, at_start: np.ndarray):
        self.mass, self.start = mass, at_start
        ones = np.c_[np.ones(len(mass)), at_start]
        root = np.sqrt(mass)[:, None]
        self.map = np.linalg.pinv(ones * root) * root.T
        """From values of particles to the affine map of a place, shape (4, N)."""
        self.centre = mass @ at_start / mass.sum()
        r = at_start - self.centre
        self.inverse_S = np.linalg.inv(np.einsum("n,ni,nj->ij", mass, r, r))

    def weights(self, place) -> np.ndarray:
        """Weights of a material point."""
        return np.r_[1.0, place] @ self.map

    def direction(self, e) -> np.ndarray:
        """Weights of a direction."""
        return np.r_[0.0, e] @ self.map

    def mobility(self, place) -> float:
        """Velocity of a material point for an impulse of 1."""
        return (self.weights(place) ** 2 / self.mass).sum()

    def inertia(self, x: np.ndarray):
        """Moments of inertia and places from the centre of the affine map of x."""
        gradient = np.linalg.pinv(np.c_[np.ones(len(x)), self.start] * np.sqrt(self.mass)[:, None]) @ (
            x * np.sqrt(self.mass)[:, None]
        )
        r = (self.start - self.centre) @ gradient[1:]
        return (self.mass[:, None, None] * ((r**2).sum(1)[:, None, None] * np.eye(3) - r[:, :, None] * r[:, None])).sum(0), r

    def spin(self, x, v) -> np.ndarray:
        """Angular velocity."""
        moments, r = self.inertia(x)
        return np.linalg.solve(moments, (self.mass[:, None] * np.cross(r, v)).sum(0))

    def couple(self, torque, x) -> np.ndarray:
        """Forces that give it an angular acceleration alone."""
        moments, r = self.inertia(x)
        return self.mass[:, None] * np.cross(np.linalg.solve(moments, torque), r)


def energy(kind, words, patches, x, k, k_turning, directions, length):
    """Energy of the springs of a joint between particles at x, a pair of arrays."""
    (place_a, place_b), axis = places(words)
    gap = patches[0].weights(place_a) @ x[0] - patches[1].weights(place_b) @ x[1]
    if kind == "spring":
        return 0.5 * k * (np.linalg.norm(gap) - length) ** 2
    if kind == "slider":
        along = patches[1].direction(axis) @ x[1]
        way = gap @ along / np.linalg.norm(along)
        k = k * sum(p.mobility(at) for p, at in zip(patches, (place_a, place_b)))
        k = k / (patches[0].mobility(place_a) + patches[1].mobility(place_b + way * axis))
        gap = gap - (gap @ along) / (along @ along) * along
    apart = [patches[0].direction(e) @ x[0] - patches[1].direction(e) @ x[1] for e in directions]
    return 0.5 * k * gap @ gap + 0.5 * k_turning * sum(a @ a for a in apart)


def places(words):
    """Places in A and in B, and the axis of length 1."""
    numbers = np.array(re.findall(r"-?[\d.]+", words), float)
    if "from" in words:
        return (numbers[:3], numbers[3:6]), None
    axis = numbers[3:6] / np.linalg.norm(numbers[3:6]) if "axis" in words else None
    return (numbers[:3], numbers[:3]), axis


def springs(kind, words, patches, frequency):
    """Stiffness across the gap and of directions, and these."""
    (place_a, place_b), axis = places(words)
    mobility = sum(patch.mobility(place) for patch, place in zip(patches, (place_a, place_b)))
    directions = {"hinge": [axis], "weld": np.eye(3), "slider": np.eye(3)}.get(kind, [])
    of_directions = max((sum(e @ p.inverse_S @ e for p in patches) for e in directions), default=1.0)
    return frequency**2 / mobility, frequency**2 / of_directions, directions


def rates(kind, words, patches, frequency):
    """Rates that a joint adds to the particles of both patches by the sums of docs/fix_mdanim_joint.md, and its largest rate: the
    largest eigenvalue of J M^-1 J^T, of the rows J of weights times the root of their stiffness."""
    k, k_turning, directions = springs(kind, words, patches, frequency)
    ends, _ = places(words)
    rows = [(k, [patch.weights(place) for patch, place in zip(patches, ends)])]
    rows += [(k_turning, [patch.direction(e) for patch in patches]) for e in directions]
    added = [np.zeros(len(patch.mass)) for patch in patches]
    for stiffness, weights in rows:
        for rate, weight, patch in zip(added, weights, patches):
            rate += stiffness * np.abs(weight) * sum(np.abs(w).sum() for w in weights) / patch.mass
    joined = np.array([np.sqrt(stiffness) * np.r_[weights[0], -weights[1]] for stiffness, weights in rows])
    mass = np.concatenate([patch.mass for patch in patches])
    return added, np.linalg.eigvalsh(joined / mass @ joined.T).max()


def forces(kind, words, patches, x, v, frequency, spring, damping):
    """Forces on the particles of both patches, and some of what the fix tells."""
    (place_a, place_b), axis = places(words)
    k, k_turning, directions = spring, 0.0, []
    if kind != "spring":
        k, k_turning, directions = springs(kind, words, patches, frequency)
    arguments = (kind, words, patches, x, k, k_turning, directions, 0.3)
    found = [-slope(lambda: energy(*arguments), one) for one in x]
    told = {}
    at = [patch.weights(place) @ one for patch, place, one in zip(patches, (place_a, place_b), x)]
    if kind == "spring":
        way = at[1] - at[0]
        far, along = np.linalg.norm(way), way / np.linalg.norm(way)
        rate = along @ (patches[1].weights(place_b) @ v[1] - patches[0].weights(place_a) @ v[0])
        pull = damping * rate * along
        found[0] += np.outer(patches[0].weights(place_a), pull)
        found[1] -= np.outer(patches[1].weights(place_b), pull)
        return found, {"way": far, "rate": rate, "force": k * (far - 0.3) + damping * rate, "gap": far - 0.3}
    gap = at[0] - at[1]
    if kind == "slider":
        along = patches[1].direction(axis) @ x[1]
        along /= np.linalg.norm(along)
        told["way"] = gap @ along
        at_way = patches[0].mobility(place_a) + patches[1].mobility(place_b + told["way"] * axis)
        softer = sum(p.mobility(place) for p, place in zip(patches, (place_a, place_b))) / at_way
    # The material point of B that is where the joint's place in A is.
    ones = np.c_[np.ones(len(x[1])), patches[1].start]
    root = np.sqrt(patches[1].mass)[:, None]
    affine = np.linalg.pinv(ones * root) @ (x[1] * root)
    in_b = np.linalg.solve(affine[1:].T, at[0] - affine[0])
    weights = patches[0].weights(place_a), patches[1].weights(in_b)
    velocity = weights[0] @ v[0] - weights[1] @ v[1]
    if kind == "slider":
        velocity = softer * (velocity - along * (velocity @ along))
    found[0] -= damping * np.outer(weights[0], velocity)
    found[1] += damping * np.outer(weights[1], velocity)
    if len(directions):
        spin = patches[0].spin(x[0], v[0]) - patches[1].spin(x[1], v[1])
        if kind == "hinge":
            free = sum(p.direction(axis) @ one for p, one in zip(patches, x))
            free /= np.linalg.norm(free)
            spin = spin - free * (spin @ free)
            # A direction across the axis in both bodies: the one that is hardest to turn.
            across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
            across = np.array([across / np.linalg.norm(across), np.cross(axis, across / np.linalg.norm(across))])
            mobility, directions = np.linalg.eigh(across @ sum(p.inverse_S for p in patches) @ across.T)
            chosen = directions[:, 0] @ across if mobility[1] - mobility[0] > 1e-9 * mobility[1] else across[0]
            turned = [angle(patches, axis, chosen, [y + shift * u for y, u in zip(x, v)]) for shift in (1e-6, -1e-6)]
            told["rate"] = (turned[0] - turned[1]) / 2e-6
        torque = -damping * k_turning / k * spin
        found[0] += patches[0].couple(torque, x[0])
        found[1] += patches[1].couple(-torque, x[1])
    return found, told


def angle(patches, axis, across, x) -> float:
    """The angle of A seen from B about the mean axis of a hinge."""
    n = sum(p.direction(axis) @ one for p, one in zip(patches, x))
    n /= np.linalg.norm(n)
    to, start = (p.direction(across) @ one for p, one in zip(patches, x))
    to, start = to - n * (n @ to), start - n * (n @ start)
    return np.arctan2(n @ np.cross(start, to), start @ to)


def slope(value, x) -> np.ndarray:
    """Derivative by x, in place, of a function that is smooth over 1e-4: by four points each, to about 1e-11 of its size."""
    found, step = np.empty_like(x), 1e-4
    for n in np.ndindex(x.shape):
        before, values = x[n], []
        for shift in (1.0, -1.0, 2.0, -2.0):
            x[n] = before + shift * step
            values.append(value())
        x[n] = before
        found[n] = (8.0 * (values[0] - values[1]) - (values[2] - values[3])) / (12.0 * step)
    return found
