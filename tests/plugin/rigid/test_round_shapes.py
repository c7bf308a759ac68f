# SPDX-License-Identifier: GPL-2.0-only
"""Cylinders, cones, ellipsoids and tori on boxes and on each other, by features, against what is known in closed form.

As in test_known_motions.py: a time step of 0.35/frequency, blows 2 % of the thinnest part deep.
"""

import numpy as np
import pytest
import rigid_lab as lab
from mdanim_lammps.features.contact.restitution import damping_for
from rigid_samples import BALL, CAN, CONE, CUBE, DOMINO, EGG, WEDGE, G, meeting, momenta, rolled, tilted

RING, DISC = lab.torus(0.06, 0.02), lab.cylinder(0.08, 0.03)
LYING, OVER = lab.about((1, 0, 0), np.pi / 2), lab.about((1, 0, 0), np.pi)
FLOOR = lab.box((4, 4, 1), at=(0, 0, -0.5), held=True, mu=3.0)
SLOPE = lab.box((40, 2, 1), at=(0, 0, -0.5), held=True)
LOG = lab.cylinder(0.1, 0.3, at=(0, 0, 0.1), q=LYING)
HOLLOW = LOG.put(moments=LOG.mass * np.array([0.1**2 / 2 + 0.3**2 / 12, 0.1**2 / 2 + 0.3**2 / 12, 0.1**2]))
RAILS = [lab.box((40, 0.02, 1), at=(0, y, -0.5), held=True) for y in (-0.1, 0.1)]
UPRIGHT = lab.torus(0.08, 0.02, at=(0, 0, 0.1), q=LYING)

ROLLS = {
    "full cylinder": (LOG, [SLOPE], 2 / 3),
    "hollow cylinder": (HOLLOW, [SLOPE], 1 / 2),
    "coin": (lab.cylinder(0.1, 0.02, at=(0, 0, 0.1), q=LYING), [SLOPE], 2 / 3),
    "on edges of two rails": (LOG, RAILS, 2 / 3),
    "ellipsoid": (lab.ellipsoid((0.1, 0.2, 0.1), at=(0, 0, 0.1)), [SLOPE], 5 / 7),
    "torus": (UPRIGHT, [SLOPE], 1 / (1 + (0.08**2 + 0.75 * 0.02**2) / 0.1**2)),
}


@pytest.mark.parametrize("case", ROLLS)
def test_it_rolls_down_a_held_box(tmp_path, case):
    """At g sin / (1 + I/m R^2), without a way aside, and turning as fast as it goes."""
    body, hosts, part = ROLLS[case]
    gravity, sine, _ = tilted(0.2)
    with lab.World(tmp_path, [body, *hosts], frequency=lab.frequency_of(4.0, 0.2), thin=0.2, planes=[], gravity=gravity) as world:
        acceleration, last = rolled(world)
    assert acceleration == pytest.approx(part * G * sine, rel=1e-5)
    assert abs(last[1]) < 1e-9 * last[0]
    assert np.linalg.norm(last[10:]) * 0.1 == pytest.approx(last[3], rel=1e-5)


BLOWS = [
    *((CAN, other) for other in (CUBE, DOMINO, WEDGE, CAN, CONE, EGG, DISC)),
    *((CONE, other) for other in (CUBE, CONE, EGG)),
    *((EGG, other) for other in (CUBE, EGG)),
    *((DISC, other) for other in (CUBE, DOMINO, DISC)),
    *((RING, other) for other in (CUBE, CAN, BALL, EGG, RING)),
]


@pytest.mark.parametrize("mu", [0.0, 0.5])
@pytest.mark.parametrize("two", BLOWS, ids=lambda two: "-".join(body.shape.split()[0] for body in two))
def test_random_blows(tmp_path, two, mu):
    """Momentum and angular momentum stay to rounding. Energy: 95 of 100 within 1e-2, and nearly all within 2e-2, here twelve; a
    rim that leaves the cone of normals of an edge is let go and booked."""
    random, off = np.random.default_rng(5), []
    thin = min(body.thin for body in two)
    for _ in range(12):
        bodies = [body.put(mu=mu) for body in meeting(random, two)]
        with lab.World(tmp_path, bodies, frequency=lab.frequency_of(2.0, thin), planes=[], gravity=(0, 0, 0)) as world:
            start = momenta(bodies, world.rows())
            world.run(round(0.6 / world.dt))
            end = momenta(bodies, world.rows())
            taken = sum(map(world.number, ("friction_heat", "contact", "let_go")))
            off.append(abs((end[2] + taken) / start[2] - 1.0))
        assert end[0] == pytest.approx(start[0], abs=1e-13 * np.abs(start[0]).max())
        assert end[1] == pytest.approx(start[1], abs=1e-10 * np.abs(start[1]).max())
    assert np.sort(off)[-2] < 1e-2 and max(off) < 2e-2


SLAB, LOG_BELOW = lab.box((0.8, 0.8, 0.1), at=(0, 0, -0.05)), lab.cylinder(0.05, 0.3, at=(0, 0, -0.05), q=LYING)
LANDS = {
    "cylinder, flat": (CAN, SLAB, 0.06),
    "cylinder, flat on a cylinder": (CAN, lab.cylinder(0.05, 0.1, at=(0, 0, -0.05)), 0.06),
    "cylinder, flat on one that lies": (CAN, LOG_BELOW, 0.06),
    "cylinders that cross": (CAN.put(q=lab.about((0, 1, 0), np.pi / 2)), LOG_BELOW, 0.05),
    "box on a cylinder that lies": (CUBE, LOG_BELOW, 0.05),
    "ellipsoid": (EGG, SLAB, 0.08),
    "ellipsoid on a cylinder": (EGG, LOG_BELOW, 0.08),
    "cone, flat": (CONE, SLAB, 0.15 / 4),
    "tip of a cone": (CONE.put(q=OVER), SLAB, 0.15 * 0.75),
    "torus, flat": (RING, SLAB, 0.02),
}


@pytest.mark.parametrize("case", LANDS)
@pytest.mark.parametrize("e", [1.0, 0.8, 0.5])
def test_restitution(tmp_path, case, e):
    """The mean of five bodies that land at other times within a step."""
    body, host, height = LANDS[case]
    frequency, beta = lab.frequency_of(1.0, min(body.thin, 0.1)), damping_for(e)
    start = [(n, 0, (10 + n / 5) * 0.35 / frequency + height) for n in range(5)]
    bodies = [body.put(at=at, v=(0, 0, -1), mu=0.0, beta=beta) for at in start]
    hosts = [host.put(at=(n, 0, -0.05), mu=0.0, beta=beta, held=True) for n in range(5)]
    with lab.World(tmp_path, [*bodies, *hosts], frequency=frequency, gravity=(0, 0, 0), planes=[]) as world:
        world.run(40)
        assert world.number("touching") == 0 and world.number("deepest") > 0.0
        assert world.rows()[:, 5].mean() == pytest.approx(e, abs=0.06)


@pytest.mark.parametrize(("part", "stands"), [(0.8, True), (1.05, False)])
def test_a_cylinder_on_a_slope_stands_or_topples(tmp_path, part, stands):
    """It topples from a tangent of 2 r/h on; as it is let go without a load, it sways, and topples a tenth before."""
    radius, height = 0.05, 0.2
    can = lab.cylinder(radius, height, at=(0, 0, height / 2), mu=3.0)
    gravity, *_ = tilted(part * 2 * radius / height)
    with lab.World(
        tmp_path, [can, FLOOR], frequency=lab.frequency_of(np.sqrt(G * height), 0.1), planes=[], gravity=gravity
    ) as world:
        world.run(round(1.5 / world.dt))
        row = world.rows()[0]
        assert (row[2] > 0.99 * height / 2) == stands and (world.number("translation") < 1e-7)


@pytest.mark.parametrize(("inside", "stands"), [(0.5, True), (0.05, True), (-0.05, False)])
def test_a_cylinder_stands_over_the_edge_of_a_box(tmp_path, inside, stands):
    """As long as its centre is above the box: the edge crosses its rim at two places, which bear it."""
    radius, height = 0.05, 0.1
    can = lab.cylinder(radius, height, at=(-inside * radius, 0, height / 2))
    box = lab.box((1, 1, 0.5), at=(-0.5, 0, -0.25), held=True)
    with lab.World(tmp_path, [can, box], frequency=lab.frequency_of(np.sqrt(G * height), 0.1), planes=[]) as world:
        world.run(round(1.5 / world.dt))
        assert (world.rows()[0, 2] > 0.49 * height) == stands
        if stands:
            assert world.number("translation") + world.number("rotation") < 1e-12


@pytest.mark.parametrize("along", [0.06, 0.08])
def test_an_ellipsoid_rocks_on_a_box(tmp_path, along):
    """By 0.05 rad about where it is lowest: m g (rho - c) over I + m c^2, rho = a^2/c being the radius of its curvature there."""
    half, lean = np.array([along, 0.05, 0.05]), 0.05
    q = lab.about((0, 1, 0), lean)
    down = lab.matrix(q).T @ (0, 0, -1)
    low = lab.matrix(q) @ (half**2 * down / np.linalg.norm(half * down))
    egg = lab.ellipsoid(half, at=(0, 0, -low[2]), q=q, mu=2.0, beta=0.0)
    way = []
    with lab.World(tmp_path, [egg, FLOOR], frequency=lab.frequency_of(1.0, 0.1), planes=[]) as world:
        for _ in range(round(1.8 / world.dt / 5)):
            world.run(5)
            way.append(world.rows()[0, 0])
        every = 5 * world.dt
    way = np.array(way) - 0.5 * (max(way) + min(way))
    turns = np.flatnonzero(np.sign(way[1:]) != np.sign(way[:-1]))
    times = turns + way[turns] / (way[turns] - way[turns + 1])
    inertia = egg.mass / 5 * (half[0] ** 2 + half[2] ** 2)
    rate = egg.mass * G * (half[0] ** 2 / half[2] - half[2]) / (inertia + egg.mass * half[2] ** 2)
    period = 2.0 * every * (times[-1] - times[0]) / (len(times) - 1)
    assert period == pytest.approx(2.0 * np.pi / np.sqrt(rate), rel=5e-3)


STACKS = {
    "ten cylinders": [lab.cylinder(0.05, 0.1, at=(0, 0, 0.05 + 0.1 * n), beta=0.2) for n in range(10)],
    "a log cabin": [
        lab.cylinder(
            0.05,
            0.4,
            at=np.roll((0, y, 0), -(n % 2)) + (0, 0, 0.05 + 0.1 * n),
            beta=0.2,
            q=LYING if n % 2 else lab.about((0, 1, 0), np.pi / 2),
        )
        for n in range(3)
        for y in (-0.1, 0.1)
    ],
    "boxes and cylinders": [
        (lab.cylinder(0.05, 0.1) if n % 2 else lab.box((0.1, 0.1, 0.1), q=lab.about((0, 0, 1), 0.3 * n))).put(
            at=(0, 0, 0.05 + 0.1 * n), beta=0.2
        )
        for n in range(4)
    ],
}


@pytest.mark.parametrize(("seconds", "most"), [(2.0, 1e-6), pytest.param(20.0, 1e-20, marks=pytest.mark.soak)])
@pytest.mark.parametrize("case", STACKS)
def test_stacks_come_to_rest(tmp_path, case, seconds, most):
    """On a held box: they move by less than 1e-3 of a side at the end, and their motion dies down [J]."""
    bodies = [FLOOR, *STACKS[case]]
    with lab.World(tmp_path, bodies, frequency=lab.frequency_of(np.sqrt(G * 0.1 * len(bodies)), 0.1), planes=[]) as world:
        world.run(round(0.9 * seconds / world.dt))
        first = world.rows()
        world.run(round(0.1 * seconds / world.dt))
        assert np.abs(world.rows()[:, :3] - first[:, :3]).max() < 1e-4
        assert world.number("translation") + world.number("rotation") < most and abs(world.number("let_go")) < 1e-20


def test_a_torus_lies_and_rolls_on_a_plane(tmp_path):
    """Its four lowest points bear it; upright it rolls at g sin / (1 + I/m R^2)."""
    flat = RING.put(at=(0, 0.5, 0.0201))
    gravity, sine, _ = tilted(0.2)
    with lab.World(tmp_path, [UPRIGHT, flat], frequency=lab.frequency_of(4.0, 0.2), thin=0.04, gravity=gravity) as world:
        acceleration, _ = rolled(world)
        assert world.number("touching") == 5
        assert np.abs(world.rows()[1, 3:6]).max() < 1e-6
    assert acceleration == pytest.approx(G * sine * ROLLS["torus"][2], rel=1e-5)


def test_a_cone_lies_on_its_side(tmp_path):
    """On the lowest point of its rim, whose normals reach to that of its side, and its tip: the centre of mass is as high as it
    is far from its side."""
    radius, height = 0.06, 0.1
    lean = np.arctan(radius / height)
    level = 0.75 * height * np.sin(lean)
    cone = lab.cone(radius, height, at=(0, 0, level + 1e-3), q=lab.about((0, 1, 0), np.pi / 2 + lean))
    with lab.World(tmp_path, [cone, FLOOR], frequency=lab.frequency_of(np.sqrt(G * radius), radius), planes=[]) as world:
        world.run(round(0.4 / world.dt))
        assert world.rows()[0, 2] == pytest.approx(level, abs=5e-3 * radius)
        assert np.abs(world.rows()[0, [3, 4, 5, 10, 11, 12]]).max() < 1e-3


MAKES = (
    lambda random: lab.cylinder(random.uniform(0.03, 0.06), random.uniform(0.04, 0.14)),
    lambda random: lab.cone(random.uniform(0.04, 0.06), random.uniform(0.06, 0.14)),
    lambda random: lab.ellipsoid(random.uniform(0.03, 0.07, 3)),
    lambda random: lab.torus(0.05, random.uniform(0.015, 0.025)),
    lambda random: lab.box(random.uniform(0.05, 0.12, 3)),
    lambda random: lab.ball(random.uniform(0.03, 0.06)),
)


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.soak) for seed in range(1, 9))])
def test_heaps_of_all_shapes_keep_their_energy_and_stay_above_the_floor(tmp_path, seed):
    """18 bodies of random sizes fall into a shaft of held boxes."""
    random, wide, bodies = np.random.default_rng(seed), 0.45, []
    for n in range(18):
        place = ((n % 3 - 1) * wide / 3, (n // 3 % 3 - 1) * wide / 3, 0.1 + 0.17 * (n // 9))
        q = lab.about(random.uniform(-1, 1, 3), random.uniform(0, 3))
        bodies.append(MAKES[(n + seed) % 6](random).put(at=place, q=q, mu=0.4, beta=0.2))
    walls = [lab.box((0.2, 1.2, 1.5), at=(s * (wide / 2 + 0.1), 0, 0.7), held=True) for s in (-1, 1)]
    walls += [lab.box((wide, 0.2, 1.5), at=(0, s * (wide / 2 + 0.1), 0.7), held=True) for s in (-1, 1)]
    thin = min(body.thin for body in bodies)
    with lab.World(tmp_path, [*bodies, *walls, FLOOR], frequency=lab.frequency_of(3.0, thin), thin=thin, planes=[]) as world:
        start = world.energy()
        world.run(round(0.7 / world.dt))
        assert world.energy() == pytest.approx(start, rel=1e-3)
        assert world.number("let_go") < 1e-3 * start and world.number("touching") > 18
        # The centre of mass of a cone of 4 x 6 cm is 1.5 cm above its base.
        assert world.rows()[:, 2].min() > 0.014 and np.abs(world.rows()[:, :2]).max() < wide / 2
