# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/wall: shapes against the naive twin, fast impacts, moving regions, what it refuses."""

import re

import numpy as np
import plugin_lab as lab
import pytest
from twin import wall

RANDOM = np.random.default_rng(9)
SCATTERED = lab.particles(RANDOM.uniform(-9.0, 9.0, (200, 3)), mass=np.ones(200))
STIFFNESS = RANDOM.uniform(0.5, 2.0, 200)
LOW, HIGH = np.array([-3.0, -4.0, -5.0]), np.array([6.0, 5.0, 4.0])
DEPTH_INSIDE = lambda x: np.minimum(x - LOW, HIGH - x)


def inside_box(x):
    """Vectors from the nearest face of the box to particles inside it."""
    d = np.zeros_like(x)
    for n in np.flatnonzero((DEPTH_INSIDE(x) > 0.0).all(1)):
        axis = DEPTH_INSIDE(x[n]).argmin()
        d[n, axis] = x[n, axis] - (LOW if x[n, axis] - LOW[axis] < HIGH[axis] - x[n, axis] else HIGH)[axis]
    return d


SHAPES = {
    "plane 1 2 -1 0.5 -1 2": lambda x: wall.below_plane(x, [1.0, 2.0, -1.0], [0.5, -1.0, 2.0]),
    "block -3 6 -4 5 -5 4": lambda x: wall.outside_box(x, LOW, HIGH),
    "block -3 6 -4 5 -5 4 side out": inside_box,
    "block INF INF INF INF -2 INF": lambda x: wall.below_plane(x, [0.0, 0.0, -2.0], [0.0, 0.0, 1.0]),
    "sphere 1 0 -1 4": lambda x: wall.outside_sphere(x, np.array([1.0, 0.0, -1.0]), 4.0),
    "sphere 1 0 -1 4 side out": lambda x: wall.inside_sphere(x, np.array([1.0, 0.0, -1.0]), 4.0),
    "cylinder z 1 0.5 3 -4 5": lambda x: wall.outside_tube(x, np.array([1.0, 0.5]), 3.0, -4.0, 5.0),
}


@pytest.mark.parametrize("region", SHAPES)
def test_every_shape_equals_the_naive_twin(tmp_path, region):
    """Force, energy and vector for 200 particles at any depth."""
    d = SHAPES[region](SCATTERED.x)
    lmp = lab.load(
        SCATTERED,
        tmp_path,
        [f"region r {region}", "fix w all mdanim/wall r d_k", "fix run all mdanim/leapfrog", "run 0"],
        columns={"k": STIFFNESS},
    )
    force = -STIFFNESS[:, None] * d
    assert (d != 0.0).any(1).sum() > 10
    # One product of numbers up to 20.
    assert np.abs(lab.by_tag(lmp, "f") - force).max() < 1e-13
    assert lmp.extract_fix("w", 0, 0) == pytest.approx(0.5 * (STIFFNESS * (d**2).sum(1)).sum(), rel=1e-13)
    expected = [*-force.sum(0), (d != 0.0).any(1).sum(), np.linalg.norm(d, axis=1).max()]
    assert [lmp.extract_fix("w", 0, 1, n) for n in range(5)] == pytest.approx(expected, rel=1e-12)
    lmp.close()


@pytest.mark.parametrize(
    "region",
    [
        "plane 0 0 0 0 0 1",
        "block -50 50 -50 50 0 300",
        "sphere 1.5 1.5 60 60",
        "cone z 1.5 1.5 40 60 0 300",
        "ellipsoid 1.5 1.5 80 60 60 80",
        "prism -40 40 -40 40 0 300 10 0 0",
    ],
)
def test_a_fast_block_comes_back(tmp_path, region):
    """Five wave speeds into a wall as stiff as the block: no abort, it leaves again."""
    body = lab.block((3, 3, 3), (0.0, 0.0, 0.5), (0.0, 0.0, -5.0 * lab.WAVE_SPEED))
    lmp = lab.load(
        body,
        tmp_path,
        [
            f"region r {region}",
            "fix w all mdanim/wall r 1.0",
            "fix run all mdanim/leapfrog",
            f"timestep {0.1 * lab.BOUND}",
            "run 300",
        ],
    )
    v = body.mass @ lab.by_tag(lmp, "v") / body.mass.sum()
    assert v[2] > 2.0
    assert lmp.extract_fix("w", 0, 1, 3) == 0.0
    assert lmp.extract_fix("w", 0, 1, 4) > 3.0
    lmp.close()


def test_energy_of_a_bounce(tmp_path):
    """One particle on a floor under gravity: kinetic, potential and wall energy add up over many bounces."""
    lmp = lab.load(
        lab.particles([[0.0, 0, 2.0]]),
        tmp_path,
        [
            "region r plane 0 0 0 0 0 1",
            "fix w all mdanim/wall r 50.0",
            "fix_modify w energy yes",
            "fix g all gravity 1.0 vector 0 0 -1",
            "fix_modify g energy yes",
            "fix run all mdanim/leapfrog",
            "timestep 0.005",
            "thermo_style custom step etotal",
            "compute_modify thermo_temp extra/dof 0",
            "run 0",
        ],
    )
    start, off = lmp.get_thermo("etotal"), []
    for _ in range(50):
        lmp.command("run 97 pre no post no")
        off.append(lmp.get_thermo("etotal"))
    # Where the force has its kink a step may start or end anywhere: w dt = 0.035 squared, summed over five
    # bounces.
    assert np.abs(np.array(off) / start - 1.0).max() < 2e-3
    assert lmp.extract_fix("w", 0, 1, 4) > 0.2
    lmp.close()


@pytest.mark.parametrize(
    "region",
    [
        "plane 0 0 0 0 0 1",
        "block -50 50 -50 50 0 INF",
        "sphere 1.5 1.5 60 60",
        "sphere 1.5 1.5 -1 1 side out",  # narrower than the body: the corners of its box pass beside it
    ],
)
def test_only_watched_particles_cost_but_none_is_missed(tmp_path, region):
    """Looking at the watch list only, and at the box around all before,
    gives the bits of looking at all particles in every step."""
    body = lab.block((3, 3, 3), (0.0, 0.0, 3.0), (0.1, 0.0, -0.8))
    found = []
    # With delay 1 lists may be late, so the wall does not rely on them.
    for neigh in ("neigh_modify every 1 delay 0 check yes", "neigh_modify every 1 delay 1 check yes"):
        lmp = lab.load(
            body,
            tmp_path,
            [neigh, f"region r {region}", "fix w all mdanim/wall r 1.0", "fix run all mdanim/leapfrog", "timestep 0.2", "run 80"],
        )
        assert lmp.extract_fix("w", 0, 1, 4) > 0.1
        found.append(np.concatenate([lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v")]))
        lmp.close()
    assert np.array_equal(*found)


def test_a_moving_floor_lifts_a_particle(tmp_path):
    """A region that moves is asked where it is now."""
    lmp = lab.load(
        lab.particles([[0.0, 0, 0.5]]),
        tmp_path,
        [
            "timestep 0.01",
            "variable up equal step*dt*0.5",
            "region r plane 0 0 0 0 0 1 move NULL NULL v_up",
            "fix w all mdanim/wall r 100.0",
            "fix run all mdanim/leapfrog",
            "run 300",
        ],
    )
    # Hit by a floor at 0.5 it leaves at twice that.
    assert lab.by_tag(lmp, "v")[0, 2] == pytest.approx(1.0, rel=1e-3)
    lmp.close()


def test_only_the_group_is_held(tmp_path):
    """Particles outside the group pass."""
    lmp = lab.load(
        SCATTERED,
        tmp_path,
        [
            "group some id 1:100",
            "region r plane 0 0 0 0 0 1",
            "fix w some mdanim/wall r 1.0",
            "fix run all mdanim/leapfrog",
            "run 0",
        ],
    )
    f = lab.by_tag(lmp, "f")
    assert np.array_equal(f[:, 2] != 0.0, (SCATTERED.x[:, 2] < 0.0) & (np.arange(200) < 100))
    lmp.close()


@pytest.mark.parametrize(
    ("region", "words", "message"),
    [
        ("plane 0 0 0 0 0 1", "nowhere 1.0", "no region nowhere"),
        ("plane 0 0 0 0 0 1", "r -1.0", "k must be >= 0, got -1.0"),
        ("plane 0 0 0 0 0 1", "r", "missing argument"),
        ("plane 0 0 0 0 0 1", "r 1.0 2.0", "got also 2.0"),
        ("plane 0 0 0 0 0 1", "r d_none", "no per-particle property d_none"),
        ("block -1 1 -1 1 -1 1 open 6", "r 1.0", "has open faces"),
        ("union 2 a b", "r 1.0", "style union cannot tell its nearest surface"),
        ("intersect 2 a b", "r 1.0", "style intersect cannot tell its nearest surface"),
    ],
)
def test_mistakes_are_refused_with_the_word(tmp_path, region, words, message):
    """Give one wrong word or a region without a nearest surface."""
    with pytest.raises(Exception, match=re.escape(message)):
        lab.load(
            SCATTERED,
            tmp_path,
            ["region a sphere 0 0 0 2", "region b sphere 1 0 0 2", f"region r {region}", f"fix w all mdanim/wall {words}"],
        ).close()


def test_a_deleted_region_is_noticed(tmp_path):
    """Delete the region between fix and run."""
    with pytest.raises(Exception, match="region r has been deleted"):
        lab.load(
            SCATTERED,
            tmp_path,
            [
                "region r plane 0 0 0 0 0 1",
                "fix w all mdanim/wall r 1.0",
                "fix run all mdanim/leapfrog",
                "region r delete",
                "run 0",
            ],
        )


def test_without_a_skin_a_block_bounces_as_with_one(tmp_path):
    """Give the bits of a run with a skin: nothing is looked ahead, and no loop waits for it."""
    body = lab.block((2, 2, 2), (0.0, 0.0, 0.5), (0.1, 0.0, -0.5))
    commands = [
        "region r plane 0 0 0 0 0 1",
        "fix w all mdanim/wall r 1.0",
        "fix run all mdanim/leapfrog",
        "timestep 0.1",
        "run 60",
    ]
    found = [lab.in_child(body, tmp_path, commands, skin=skin) for skin in (0.4, 0.0)]
    assert found[0] == found[1]
    lmp = lab.load(body, tmp_path, commands)
    assert lmp.extract_fix("w", 0, 1, 4) > 0.1, "it must touch"
    lmp.close()
