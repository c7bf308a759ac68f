# SPDX-License-Identifier: GPL-2.0-only
"""Contact by features of fix mdanim/rigid: the same bits on ranks, in any order of particles, from restart files and states."""

import re

import numpy as np
import plugin_lab
import pytest
import rigid_lab as lab
import rigid_meshes
import state_lab

OPTIONS = {"cutoff": 0.2, "skin": 0.1}
WEDGE = "polyhedron 6 -0.05 -0.05 -0.05 0.05 -0.05 -0.05 0 0.05 -0.05 -0.05 -0.05 0.05 0.05 -0.05 0.05 0 0.05 0.05"
FACES = "5 3 0 2 1 3 3 4 5 4 0 1 4 3 4 1 2 5 4 4 2 0 3 5"


def round_heap(folder, commands=()) -> lab.World:
    """Shapes of all kinds that fall on each other, between a wall, held cylinders and the floor."""
    random = np.random.default_rng(6)
    makes = (
        lambda **more: lab.cylinder(0.05, 0.1, **more),
        lambda **more: lab.cone(0.06, 0.1, **more),
        lambda **more: lab.ellipsoid((0.04, 0.05, 0.07), **more),
        lambda **more: lab.torus(0.06, 0.02, **more),
        lambda **more: lab.box((0.1, 0.06, 0.08), **more),
        lambda **more: lab.ball(0.04, **more),
    )
    bodies = []
    for n in range(9):
        q = lab.about(random.uniform(-1, 1, 3), random.uniform(0, 3))
        bodies.append(makes[n % 6](at=(0.06 * (n % 3 - 1), 0.05 * (n % 2), 0.12 + 0.075 * n), q=q, v=(0, 0, -1), mu=0.3))
    lying = lab.about((0, 1, 0), np.pi / 2)
    bodies += [lab.cylinder(0.05, 0.5, at=(0, y, 0.05), q=lying, held=True) for y in (-0.12, 0.17)]
    planes = ("plane z lo 0.0", "plane x lo -0.25")
    return lab.World(folder, bodies, frequency=lab.frequency_of(2.0, 0.06), planes=planes, commands=commands)


def heap(folder, commands=()) -> lab.World:
    """Boxes, balls and a wedge that fall on each other, between a wall, a held box and the floor."""
    random = np.random.default_rng(2)

    def turned():
        return lab.about(random.uniform(-1, 1, 3), random.uniform(0, 3))

    bodies = [lab.box((0.1, 0.1, 0.1), at=(0.02 * n, 0.01 * n, 0.09 + 0.15 * n), q=turned(), v=(0, 0, -2)) for n in range(3)]
    bodies += [lab.ball(0.05, at=(0.1 * n - 0.05, 0.09, 0.07), v=(0.5, -0.5, -1), mu=0.3) for n in range(2)]
    bodies += [lab.box((0.06, 0.2, 0.4), at=(-0.12, 0, 0.22), q=lab.about((0, 1, 0), 0.2), mu=0.2)]
    wedge = lab.box((0.1, 0.1, 0.1), at=(0.02, 0.01, 0.5), v=(0, 0, -1))
    bodies += [wedge.put(shape=f"{WEDGE} {FACES}"), lab.box((0.5, 0.1, 0.1), at=(0, -0.15, 0.05), held=True)]
    planes = ("plane z lo 0.0", "plane x lo -0.25")
    return lab.World(
        folder,
        bodies,
        frequency=lab.frequency_of(2.0, 0.06),
        planes=planes,
        words="lambda 0.01 pair 1 plane1 0.1 0.2",
        commands=commands,
    )


def bowl_of_triangles(folder, commands=()) -> lab.World:
    """Shapes of all kinds, and a channel, that fall into a held bowl of triangles."""
    random = np.random.default_rng(8)
    channel = [
        (-0.05, -0.03),
        (0.05, -0.03),
        (0.05, 0.03),
        (0.03, 0.03),
        (0.03, -0.01),
        (-0.03, -0.01),
        (-0.03, 0.03),
        (-0.05, 0.03),
    ]
    shapes = [
        lab.box((0.1, 0.06, 0.08)),
        lab.ball(0.04),
        lab.cylinder(0.04, 0.09),
        lab.ellipsoid((0.04, 0.05, 0.07)),
        rigid_meshes.solid(*rigid_meshes.profile(channel, 0.08), 0.02),
        lab.cone(0.05, 0.1),
        lab.torus(0.05, 0.02),
    ]
    bodies = []
    for n, shape in enumerate(shapes):
        q = lab.about(random.uniform(-1, 1, 3), random.uniform(0, 3))
        at = (0.1 * np.cos(2.4 * n), 0.1 * np.sin(2.4 * n), 0.12 + 0.04 * n)
        bodies.append(shape.put(at=at, q=q, v=(0, 0, -1), mu=0.3))
    bodies.append(lab.mesh(*rigid_meshes.bowl(0.3, 0.03, 1.3, 24, 10), 0.03))
    return lab.World(folder, bodies, frequency=lab.frequency_of(2.0, 0.06), planes=("plane z lo -0.1",), commands=commands)


HEAPS = pytest.mark.parametrize("heap", [heap, round_heap, bowl_of_triangles])


@HEAPS
def test_bits_do_not_depend_on_ranks_or_order(tmp_path, heap):
    """All ranks compute all contacts."""
    world = heap(tmp_path, ["run 500"])
    mixed = np.random.default_rng(3).permutation(len(world.setup.x))
    forms = ({}, {"order": mixed, "ranks": 2}, {"ranks": 3})
    ends = [plugin_lab.in_child(world.setup, tmp_path, world.commands, **OPTIONS, **form) for form in forms]
    assert len(set(ends)) == 1


@HEAPS
def test_bits_do_not_depend_on_threads(tmp_path, monkeypatch, heap):
    """Bodies, contacts, the account and the bound on the step of three threads, which share all they can, are those of one."""
    monkeypatch.setenv("MDANIM_LEAST_TASK", "1")
    found = []
    for threads in (1, 3):
        with heap(tmp_path, [f"run_style verlet/mdanim threads {threads}"]) as world:
            world.run(500)
            books = [
                world.number(n) for n in ("friction_heat", "damping_loss", "let_go", "deepest", "worst_bound", "most_touching")
            ]
            found.append((ends(world), books))
    assert are_same(found[0][0], found[1][0]) and found[0][1] == found[1][1]
    assert found[0][1][0] > 0.0 and found[0][1][1] > 0.0


def ends(world):
    """Places, velocities and the state of all bodies and contacts."""
    return plugin_lab.by_tag(world.lmp, "x"), plugin_lab.by_tag(world.lmp, "v"), state_lab.pack(world.lmp, "r")


def are_same(one, other):
    """Whether both have the same bits."""
    return np.array_equal(one[0], other[0]) and np.array_equal(one[1], other[1]) and one[2].same(other[2])


@HEAPS
def test_what_is_remembered_changes_no_bit(tmp_path, heap):
    """A state that is put drops all that is known of features and bodies near each other: 300 steps with one each time, and 300
    steps on end."""
    with heap(tmp_path) as world:
        world.run(1700)
        before = state_lab.pack(world.lmp, "r")
        world.run(300)
        assert world.number("touching") > 5
        end = ends(world)
        state_lab.put(world.lmp, "r", before)
        for _ in range(300):
            world.lmp.command("run 1")
            state_lab.put(world.lmp, "r", state_lab.pack(world.lmp, "r"))
        assert are_same(ends(world), end)


@HEAPS
def test_runs_go_on_to_the_bit(tmp_path, heap):
    """Several runs with setups are one run: forces of contact are not found anew where nothing has changed."""
    with heap(tmp_path) as world:
        world.run(300)
        end = ends(world)
    with heap(tmp_path) as world:
        for _ in range(3):
            world.lmp.command("run 100")
        assert are_same(ends(world), end)
        kept = [world.number(name) for name in ("contact", "touching", "friction_heat")]
        world.lmp.command("run 0")
        assert [world.number(name) for name in ("contact", "touching", "friction_heat")] == kept


def test_a_state_goes_on_in_another_instance(tmp_path):
    """With records of bodies and of pairs; those that are broken are refused, and change nothing."""
    with heap(tmp_path) as world:
        world.run(1200)
        records = state_lab.pack(world.lmp, "r")
        keys = records.key.tolist()
        assert keys == sorted(keys) and any(b for _, b in keys) and [k for k in keys if not k[1]] == [[n, 0] for n in range(1, 8)]
        world.run(100)
        end = ends(world)
    with heap(tmp_path) as other:
        other.run(50)
        before = ends(other)
        data = records.data.copy()
        pair = next(k for k, (_, b) in enumerate(keys) if b)
        data[records.first[pair] + 16 : records.first[pair] + 32] = 77  # the kind of its first contact
        with pytest.raises(RuntimeError, match="of features that there are not"):
            state_lab.put(other.lmp, "r", state_lab.Records(records.key, records.first, data))
        assert are_same(ends(other), before)
        state_lab.put(other.lmp, "r", records)
        other.lmp.command("run 100")
        assert are_same(ends(other), end)


def test_a_body_that_is_laid_aside_touches_nothing(tmp_path):
    """Its particles leave the group without a setup: the others go on as without it, and it has no energy."""
    two = [lab.box((0.1, 0.1, 0.1), at=(0, 0, z), mu=0.0) for z in (0.05, 0.15)]
    with lab.World(tmp_path, two, frequency=lab.frequency_of(1.0, 0.1)) as world:
        world.run(200)
        height = world.rows()[1, 2]
        assert world.number("touching") == 12  # corners at the floor, of each box in the other
        tag, mask = (world.lmp.numpy.extract_atom(name)[:16] for name in ("id", "mask"))
        mask[tag <= 8] = 0  # in no group, not even in all
        world.lmp.numpy.extract_atom("x")[:16][tag <= 8] += (0, 2.0, 0)  # more than the skin: lists are made anew
        world.run(200)
        time = 200 * world.dt
        assert world.number("touching") == 0 and world.number("contact") == 0.0
        assert world.rows()[1, 2] == pytest.approx(height - 0.5 * 9.81 * time**2, abs=1e-3)
        fallen = 0.5 * two[1].mass * (world.rows()[1, 3:6] ** 2).sum()
        assert world.number("translation") + world.number("rotation") == pytest.approx(fallen, rel=1e-9)


def test_a_body_comes_back_and_is_met(tmp_path):
    """A box stands still. It leaves the group while another one comes near, through two setups, and is back before they meet: all
    has the same bits as if it had always been there."""
    two = [lab.box((0.1, 0.1, 0.1), at=(x, 0, 0), v=(v, 0, 0)) for x, v in ((-0.105, 0.5), (0.0, 0.0))]
    found = []
    for leaves in (False, True):
        with lab.World(tmp_path, two, frequency=lab.frequency_of(1.0, 0.1), planes=(), gravity=(0, 0, 0)) as world:
            tag, mask = (world.lmp.numpy.extract_atom(name)[:16] for name in ("id", "mask"))
            kept = mask.copy()
            if leaves:
                mask[tag > 8] = 0
            for _ in range(2):
                world.lmp.command(f"run {int(0.0024 / 0.5 / world.dt)}")
            assert world.number("touching") == 0
            mask = world.lmp.numpy.extract_atom("mask")[:16]
            mask[:] = kept
            world.lmp.command(f"run {int(0.01 / 0.5 / world.dt)}")
            assert world.rows()[1, 3] > 0.1
            found.append((world.rows().tobytes(), world.number("deepest")))
    assert found[0] == found[1]


def test_a_state_with_a_wrong_rotation_is_refused(tmp_path):
    """A quaternion whose length is not 1, of a body or of its shape."""
    one = [lab.box((0.1, 0.1, 0.1), at=(0, 0, 0.05))]
    with lab.World(tmp_path, one, frequency=lab.frequency_of(1.0, 0.1)) as world:
        records, before = state_lab.pack(world.lmp, "r"), ends(world)
        for at in (10, 26):  # among the numbers behind the version and the size of the head
            data = records.data.copy()
            data[16:][: 30 * 8].view(np.float64)[at] = 2.0
            with pytest.raises(RuntimeError, match="its motion or its mass"):
                state_lab.put(world.lmp, "r", state_lab.Records(records.key, records.first, data))
            assert are_same(ends(world), before)


@HEAPS
def test_a_restart_file_goes_on_to_the_bit(tmp_path, heap):
    """Contacts are in it."""
    with heap(tmp_path) as world:
        world.run(200)
        world.lmp.command(f"write_restart {tmp_path / 'half'}")
        world.run(100)
        end = ends(world)
    again = plugin_lab.restarted(tmp_path / "half", world.setup, [*world.commands, "run 100"], **OPTIONS)
    assert np.array_equal(plugin_lab.by_tag(again, "x"), end[0]) and np.array_equal(plugin_lab.by_tag(again, "v"), end[1])
    again.close()


def test_another_body_far_away_changes_no_bit(tmp_path):
    """A small cube slides over the corner of a large one. Its last contacts act on ramps beyond the edges of the large one, where
    the spheres about both no longer meet; lists of near bodies are made anew at other times with a thick body 3 m away."""
    large = lab.box((1, 1, 1), at=(0, 0, -0.5), held=True)
    small = lab.box((0.04, 0.04, 0.04), at=(0.48, 0.48, 0.0199), v=(0.5, 0.5, 0), beta=0.0, mu=0.0)
    paths = []
    for number, more in enumerate([[], [lab.box((0.04, 0.04, 0.04), at=(3, 3, 3))], [lab.box((0.5, 0.5, 0.5), at=(3, 3, 3))]]):
        folder = tmp_path / str(number)
        folder.mkdir()
        with lab.World(folder, [small, *more, large], frequency=1000.0, planes=()) as world:
            rows = []
            for _ in range(60):
                world.run(5)
                rows.append([*world.rows()[0], world.number("touching"), world.number("let_go")])
        paths.append(np.array(rows))
    touching = paths[0][:, 13]
    beyond = np.sqrt(((paths[0][:, :3] - large.at) ** 2).sum(1)) > np.sqrt(0.75) * 1.04
    assert (touching[beyond] > 0).any()  # the case of interest
    assert np.array_equal(paths[0], paths[1]) and np.array_equal(paths[0], paths[2])


@pytest.mark.parametrize("usual", [(), (0,), (1,), (0, 1)])
def test_whose_damping_counts(tmp_path, usual):
    """The larger one of two bodies with the word `usual`, and of two without it; else that of the body without it. The bits are
    those of a pair with this damping."""
    betas, found = (0.1, 0.4), []
    counts = max(betas) if len(usual) != 1 else betas[1 - usual[0]]
    two = [lab.ball(0.05, at=(x, 0.01, 0), v=(-9 * x, 0, 0), mu=0.3, beta=beta) for x, beta in zip((-0.053, 0.053), betas)]
    for words in (f"pair 1 2 0.3 {counts}", ""):
        world = lab.World(tmp_path, two, frequency=lab.frequency_of(1.0, 0.1), planes=(), gravity=(0, 0, 0), words=words)
        lines = (tmp_path / "shapes").read_text().splitlines()
        lines = [line.replace(" free ", " usual free ") if not words and n in usual else line for n, line in enumerate(lines)]
        (tmp_path / "shapes").write_text("\n".join(lines) + "\n")
        with world:
            world.run(60)
            found.append((world.rows().tobytes(), world.number("damping_loss")))
            assert found[-1][1] > 0.0
    assert found[0] == found[1]


def test_a_thick_body_far_away_makes_no_near_pairs(tmp_path):
    """Small balls with gaps of a third of a radius, of which one moves: each has its own skin, and no bit depends on it."""
    small = [lab.ball(0.03, at=(0.07 * (n % 5), 0.07 * (n // 5), 0.0), mu=0.0) for n in range(25)]
    small[0] = lab.ball(0.03, at=(0.0, 0.0, 0.0), v=(0.5, 0.1, 0), mu=0.0)
    found = []
    for more in ([], [lab.ball(2.0, at=(30, 30, 30))]):
        folder = tmp_path / str(len(more))
        folder.mkdir()
        with lab.World(folder, small + more, frequency=1000.0, planes=(), gravity=(0, 0, 0), thin=0.06) as world:
            near = [world.number("near")]
            for _ in range(6):
                world.run(30)
                near.append(world.number("near"))
            found.append((near, world.rows()[:25].tobytes()))
    assert found[0] == found[1]
    assert found[0][0][0] == 0.0 and max(found[0][0]) > 0.0


AT = "free 0 0 0.05 1 0 0 0"
BOX = f"{AT} box 0.1 0.1 0.1"
TOUCH = "shapes FILE contact 1 1 objects"
TWICE = "polyhedron 7 0 0 1 1 0 0 0 1 0 -1 0 0 0 -1 0 0 0 -1 0 0 1 8 3 0 1 2 4 0 2 3 6 3 6 3 4 4 6 4 1 0 " + " ".join(
    f"3 5 {b} {a}" for a, b in ((1, 2), (2, 3), (3, 4), (4, 1))
)
"""An octahedron whose upper corner is given twice."""


def two_cubes(shift):
    """Words of a polyhedron with the faces of two cubes of 0.1 m, the second one shifted by this along each axis."""
    corners = [(0.1 * (q & 1) + d, 0.1 * (q >> 1 & 1) + d, 0.1 * (q >> 2) + d) for d in (0.0, shift) for q in range(8)]
    loops = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
    faces = [(4, *(k + more for k in loop)) for more in (0, 8) for loop in loops]
    return (
        f"polyhedron 16 {' '.join(repr(c) for at in corners for c in at)} 12 {' '.join(str(k) for face in faces for k in face)}"
    )


@pytest.mark.parametrize(
    ("words", "text", "why"),
    [
        ("objects", f"1 0 0 {BOX}", "contact needs 'shapes"),
        ("shapes FILE", f"1 0 0 {BOX}", "nothing can touch; write objects, or plane"),
        ("shapes FILE contact 0 1 objects", f"1 0 0 {BOX}", "OMEGA must be above 0, got 0"),
        ("shapes FILE contact 1 1 plane w lo 0", f"1 0 0 {BOX}", "the axis of a plane is x, y or z, got w"),
        ("shapes FILE contact 1 1 plane z at 0", f"1 0 0 {BOX}", "the upper, hi; got at"),
        ("shapes FILE contact 1 1 objects pair 1 plane1 0 0", f"1 0 0 {BOX}", "a pair has plane1, and 0 planes are given before"),
        ("shapes FILE contact 1 1 objects pair 1 1 0 0", f"1 0 0 {BOX}", "a pair is two different molecule IDs"),
        ("shapes FILE contact 1 1 objects pair 1 5 0 0", f"1 0 0 {BOX}", "pair names molecule 5, which has no shape"),
        ("shapes FILE contact 1 1 objects", f"1 -1 0 {BOX}", "line 1 of FILE: friction must be at least 0"),
        ("shapes FILE contact 1 1 objects", "\n1 0 0 loose", "line 2 of FILE: a body is free, held or driven, got loose"),
        ("shapes FILE contact 1 1 objects", "1 0 0 free 0 0 0 1 1 0 0 box 1 1 1", "the rotation is not a unit quaternion"),
        ("shapes FILE contact 1 1 objects", "1 0 0 free 0 0 0 1 0 0 0 box 1 1", "line 1 of FILE: a side is missing"),
        (
            "shapes FILE contact 1 1 objects",
            "1 0 0 free 0 0 0 1 0 0 0 knot 1 1",
            "ellipsoid, torus, polyhedron or mesh, got knot",
        ),
        ("shapes FILE contact 1 1 objects", f"1 0 0 {BOX} 3", "there is more than belongs to it, from 3 on"),
        ("shapes FILE contact 1 1 objects", f"7 0 0 {BOX}", "has object 7 (molecule ID) as free, and it has no particle"),
        (
            "shapes FILE contact 1 1 objects",
            f"1 0 0 {BOX.replace('free', 'held')}",
            "object 1 (molecule ID) as held, and it has a",
        ),
        ("shapes FILE contact 1 1 objects", f"1 0 0 {BOX}\n1 0 0 {BOX}", "line 2 of FILE: object 1 has a line already"),
        (
            "shapes FILE contact 1 1 objects",
            f"1 0 0 {BOX[:-15].rstrip()} {WEDGE} 5 3 0 1 2 {FACES[10:]}",
            "has a corner of the body before it",
        ),
        ("shapes FILE contact 1 1 objects", f"1 0 0 {BOX[:-15].rstrip()} {WEDGE} 4 {FACES[2:-10]}", "has one face"),
        (
            "shapes FILE contact 1 1 objects",
            f"1 0 0 {BOX[:-15].rstrip()} {WEDGE} 5 3 0 9 1 {FACES[10:]}",
            "has a corner that there is not",
        ),
        (TOUCH, f"1 0 0 {AT} {TWICE}", "line 1 of FILE: corners 0 and 6 are at one place; make them one"),
        (TOUCH, f"1 0 0 {AT} {two_cubes(1e-9)}", "line 1 of FILE: corners 0 and 8 are at one place"),
        (TOUCH, f"1 0 0 {AT} {two_cubes(1.5e-7)}", "line 1 of FILE: the 12 faces are more than one closed surface"),
        (TOUCH, f"1 0 1.5 {BOX}", "line 1 of FILE: damping must be at most 1, got 1.5"),
        (f"{TOUCH} pair 1 2 0 1.5", f"1 0 0 {BOX}", "beta of a pair must be at most 1, got 1.5"),
        (TOUCH, f"1 0 0 {AT} box 1e200 1 1", "line 1 of FILE: a side must be from 1e-50 to 1e+50, got 1e+200"),
        (TOUCH, f"1 0 0 {AT} {two_cubes(1e308)}", "line 1 of FILE: a corner must be within 1e+50 of the origin"),
        (TOUCH, f"1 0 0 {AT} ball 1e-310", "line 1 of FILE: the radius must be from 1e-50 to 1e+50, got 1e-310"),
        (f"{TOUCH} drive none", f"1 0 0 {AT} ball 1", "drive none is not the ID of a fix mdanim/drive"),
        (TOUCH, f"1 0 0 {BOX} covered +x +w", "line 1 of FILE: a side is -x, +x, -y, +y, -z or +z, got +w"),
        (TOUCH, f"1 0 0 {BOX} covered", "line 1 of FILE: a side that is covered is missing"),
        (TOUCH, f"1 0 0 {AT} torus 1 2", "line 1 of FILE: the tube of a torus must be thinner than its ring"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, words, text, why):
    """With the line or the word, and what is wrong in it."""
    path = tmp_path / "forms"
    path.write_text(text)
    commands = [f"fix r all mdanim/rigid {words.replace('FILE', str(path))}", "run 0"]
    with pytest.raises(Exception, match=re.escape(why.replace("FILE", str(path)))):
        plugin_lab.load(plugin_lab.block((2, 2, 2)), tmp_path, commands).close()
