# SPDX-License-Identifier: GPL-2.0-only
"""Observations of particles part by part equal those of all at once, to the bit."""

from dataclasses import fields

import numpy as np
import pytest
from mdanim_lammps.features.liquid.kept import HEIGHT
from mdanim_lammps.run.observe import Observer, join, recorded_models
from scene_texts import SPLASH

TEXT = SPLASH + "expect raft.draft = 1 +- 1 m\nexpect stone.immersed = 1 +- 1\nexpect stone.strain.max = 1 +- 1\n"


@pytest.fixture(scope="module")
def splash(tmp_path_factory):
    """A scene, and a state of it in which numbers are of all sizes."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    path = tmp_path_factory.mktemp("observe") / "splash.txt"
    path.write_text(TEXT)
    ready, rng = prepare(load_scene(path)), np.random.default_rng(3)
    system = ready.system
    x = system.position + rng.normal(0.0, 1e-3, system.position.shape)
    return (
        ready,
        x,
        rng.normal(0.0, 10.0 ** rng.uniform(-9, 3, x.shape)),
        {HEIGHT.name: np.full(ready.plan.grid.shape[1::-1], 0.13)},
    )


def in_parts(splash, parts, x, v):
    """Observations of executors: each sees numbers of its own objects alone, the others are lost."""
    ready, height = splash[0], splash[3]
    observer = Observer(ready.plan, recorded_models(ready.models, ready.plan))
    found = []
    for objects in map(np.array, parts):
        mine = [np.full_like(a, np.nan) for a in (x, v)]
        for place in ready.system.stretches(objects):
            mine[0][place], mine[1][place] = x[place], v[place]
        found.append(observer.observe(objects.astype(np.int64), objects.astype(np.int64), *mine, height))
    return join(found)


def same(one, other) -> bool:
    return all(np.array_equal(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))


@pytest.mark.parametrize("parts", [[[0], [1], [2]], [[1], [0, 2]], [[], [2], [0, 1]]])
def test_parts_tell_what_the_whole_tells(splash, parts):
    """Means, reaches, speeds, cells inside out and recorded quantities."""
    ready, x, v, _ = splash
    x = x.copy()
    x[ready.system.hexahedron[[3, -5], 0]] += 0.06  # a corner through its cell
    whole = in_parts(splash, [[0, 1, 2]], x, v)
    assert len(whole.inverted) >= 2 and set(whole.recorded) == {"draft.raft", "immersed.stone", "strain.stone"}
    assert whole.objects.tolist() == [0, 1, 2] and whole.not_finite is None
    assert same(whole, in_parts(splash, parts, x, v))


def test_means_are_those_of_the_system(splash):
    """The centres of mass that files always had, and the fastest component of each object."""
    ready, x, v, _ = splash
    seen, first = in_parts(splash, [[2, 0], [1]], x, v), ready.system.first[:-1]
    weighted = np.add.reduceat(ready.system.mass[:, None] * x, first)
    assert np.array_equal(seen.center, weighted / np.add.reduceat(ready.system.mass[:, None], first))
    assert np.array_equal(seen.speed, np.maximum.reduceat(np.abs(v).max(1), first))


@pytest.mark.parametrize("value", [np.nan, -np.inf])
def test_the_first_number_that_is_not_finite(splash, value):
    """The first of all parts that have such numbers."""
    ready, x, v, _ = splash
    x, v, first = x.copy(), v.copy(), ready.system.first
    x[first[2] + 7, 1] = v[first[1] + 5, 2] = v[first[1] + 6, 0] = value
    assert in_parts(splash, [[1], [0, 2]], x, v).not_finite == first[1] + 5
    assert in_parts(splash, [[0, 2], [1]], x, v).not_finite == first[1] + 5


def test_what_is_inside_another_is_told_once(splash):
    """By the part that has both near; the guard is told of the first."""
    ready, x, v, height = splash
    x, system = x.copy(), ready.system
    raft, stone = (slice(*system.first[m : m + 2]) for m in (1, 2))
    x[stone] += x[raft].mean(0) - x[stone].mean(0)
    observer = Observer(ready.plan, ready.models)
    alone = observer.observe(np.array([0]), np.array([0]), x, v, height)
    both = observer.observe(np.array([1, 2]), np.array([1, 2]), x, v, height)
    assert alone.sunk is None and set(both.sunk) == {1, 2}
    assert join([alone, both]).sunk == join([both, alone]).sunk == both.sunk


def test_out_of_reach_of_the_liquid(splash):
    """An object above the liquid needs no heights of it, and nothing of it is in the liquid."""
    ready, x, v, height = splash
    x = x + [0.0, 0.0, 10.0]
    observer = Observer(ready.plan, ready.models)
    seen = [observer.observe(np.arange(3), np.arange(3), x, v, told).recorded for told in ({}, height)]
    assert seen[0] == seen[1] and seen[0]["draft.raft"] == seen[0]["immersed.stone"] == 0.0
