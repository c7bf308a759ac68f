# SPDX-License-Identifier: GPL-2.0-only
"""Pieces that are glued together in fix mdanim/rigid: they move as one body, and break where a closed form says so."""

import numpy as np
import pytest
import rigid_lab as lab
import state_lab
from glue_lab import DENSITY, EDGE, bar, glue_file, world


def motion(rows, bodies):
    """Centre of mass, its velocity, and angular momentum about it."""
    mass = np.array([b.mass for b in bodies])
    centre, velocity = (mass @ rows[:, k : k + 3] / mass.sum() for k in (0, 3))
    arm = rows[:, :3] - centre
    own = np.array([b.moments[0] for b in bodies])  # of cubes
    return centre, velocity, (mass[:, None] * np.cross(arm, rows[:, 3:6]) + own[:, None] * rows[:, 10:13]).sum(axis=0)


@pytest.mark.parametrize("pieces", [2, 5])
def test_it_tumbles_and_bounces_as_one_body(tmp_path, pieces):
    """As a box of this size: in flight, at corners and edges on the ground, and at rest."""
    start = {"at": (0, 0, 0.5), "q": lab.about((1, 2, 0.5), 0.4), "v": (0.5, 0, -1), "spin": (1, 4, 3)}
    whole = lab.box((pieces * EDGE, EDGE, EDGE), DENSITY, **start)
    found = []
    for name, bodies in (("one", [whole]), ("many", bar(pieces, **start))):
        (folder := tmp_path / name).mkdir()
        options = {"planes": ["plane z lo 0.0"], "gravity": (0, 0, -9.81), "frequency": lab.frequency_of(4.0, EDGE), "thin": EDGE}
        make = lab.World(folder, bodies, **options) if name == "one" else world(folder, bodies, 1e12, **options)
        with make as one:
            for time in (0.2, 0.2, 0.6):
                one.run(round(time / one.dt))
                rows = one.rows()
                centre, velocity = (rows[0, :3], rows[0, 3:6]) if name == "one" else motion(rows, bodies)[:2]
                found.append((centre, velocity, one.number("contact")))
            assert one.number("deepest") > 0.0
            if name == "many":
                assert one.number("broken_faces") == 0.0
    for single, glued in zip(found[:3], found[3:]):
        for a, b in zip(single, glued):
            assert b == pytest.approx(a, abs=1e-7)


@pytest.mark.parametrize(("over", "breaks"), [(0.99, False), (1.01, True)])
def test_a_bar_that_spins_breaks_in_its_middle(tmp_path, over, breaks):
    """Where the tension rho w^2 L^2/8 is above the strength."""
    pieces, spin = 6, 40.0
    tension = DENSITY * spin**2 * (pieces * EDGE) ** 2 / 8
    bodies = bar(pieces, spin=(0, 0, spin))
    with world(tmp_path, bodies, tension / over) as one:
        before = motion(one.rows(), bodies)
        energy = one.number("translation") + one.number("rotation")
        one.run(200)
        rows = one.rows()
        assert one.number("broken_faces") == breaks
        whole = [one.lmp.extract_fix("r", 0, 2, n, 13) for n in range(pieces)]
        assert whole == ([1, 1, 1, 4, 4, 4] if breaks else [1] * 6)
        for a, b in zip(before, motion(rows, bodies)):
            assert b == pytest.approx(a, abs=1e-11)
        assert one.number("translation") + one.number("rotation") == pytest.approx(energy, rel=1e-12)
        assert abs(one.number("torn")) < 1e-12 * energy


@pytest.mark.parametrize(("over", "breaks"), [(0.99, False), (1.01, True)])
def test_a_bar_that_is_pushed_at_its_end_breaks_by_bending(tmp_path, over, breaks):
    """By F, and what accelerates the last cube: F d - m a d/2 - I alpha about its inner side."""
    pieces, force, bodies = 3, 100.0, bar(3)
    mass, own, length = bodies[0].mass, bodies[0].moments[0], pieces * EDGE
    turning = force * length / 2 / (pieces * mass * (length**2 + EDGE**2) / 12)
    across = force / (pieces * mass) + turning * EDGE
    moment = force * EDGE - mass * across * EDGE / 2 - own * turning
    push = ["group end id 18 20 22 24", f"fix push end addforce 0.0 0.0 {force / 4!r}"]  # particles in the last side
    with world(tmp_path, bodies, moment / (EDGE**3 / 6) / over, commands=push) as one:
        one.run(2)
        assert one.number("broken_faces") == breaks


@pytest.mark.parametrize("friction", [0.0, 0.6])
@pytest.mark.parametrize("strength", [2e4, 5e5])
def test_energies_add_up_where_a_ball_breaks_a_bar(tmp_path, strength, friction):
    """The force on the ball changes too where the bar breaks, and with it the energy of its motion by half of a kick."""
    bodies = [b.put(mu=friction, beta=0.8) for b in bar(4)]
    ball = lab.ball(0.1, 4e3, at=(0.01, 0.02, 0.1501), v=(0.5, 0, -5), mu=friction, beta=0.8)
    with world(tmp_path, bodies, strength, beside=[ball], frequency=lab.frequency_of(5.0, EDGE), thin=EDGE) as one:
        columns = ("kinetic", "contact", "friction_heat", "damping_loss", "let_go", "torn")
        before = sum(map(one.number, columns))
        one.run(60)
        assert one.number("broken_faces") > 0.0
        assert abs(one.number("torn")) > 1e-3 * before
        assert sum(map(one.number, columns)) == pytest.approx(before, rel=5e-5)  # of contacts at this step: 2e-5


def test_edges_across_a_brick_do_not_touch_where_glue_breaks(tmp_path):
    """Two bricks, one aside and 1 nm in the other: two corners of each touch, and edges where the sides end."""
    low, high = (
        lab.box((0.2, 0.12, 0.1), DENSITY, at=(0.1 * k, 0.0, k * (0.1 - 1e-9)), v=(0, 0, 0), spin=(0, 0, 0.1)) for k in (0, 1)
    )
    second, section = (0.1 * 0.12**3 / 12, 0.12 * 0.1**3 / 12), (0.1 * 0.12**2 / 6, 0.12 * 0.1**2 / 6)
    numbers = [1e-6, 0.012, *second, *section, sum(section), 0.05, 0, 0.05, 0, 0, 1, 1, 0, 0]
    (tmp_path / "glue").write_text("1 2 5 4 " + " ".join(map(repr, numbers)) + "\n")
    words, none = f"glue {tmp_path}/glue", {"planes": [], "gravity": (0, 0, 0)}
    with lab.World(tmp_path, [low, high], words=words, frequency=2e3, thin=EDGE, **none) as one:
        one.run(1)
        assert one.number("broken_faces") == 1.0
        one.run(1)
        assert one.number("touching") == 6.0  # and two edges across each other where the faces end


def test_files_with_mistakes_are_refused(tmp_path):
    """With the line."""
    bodies = bar(2)
    (tmp_path / "glue").write_text("2 1 1 0 1.0\n")
    make = lab.World(tmp_path, bodies, words=f"glue {tmp_path}/glue", planes=[], gravity=(0, 0, 0), frequency=1e3)
    with pytest.raises(Exception, match=r"line 1 of .*the molecule ID with the lower number stands first"), make:
        pass


def test_what_is_glued_sleeps_and_wakes_as_one(tmp_path):
    """Three cubes in a row on the ground, with one on the last of them. A ball strikes the first one after they fell asleep: it
    moves as where nothing sleeps. A state that is put back after each step gives the same bits."""
    bodies = bar(3, at=(0, 0, EDGE / 2))
    flies = 0.5
    ball = lab.ball(0.04, 12000.0, at=(-0.19 - 2 * flies, 0, 0.05), v=(2, 0, 0.5 * 9.81 * flies))
    beside = [lab.box((EDGE,) * 3, DENSITY, at=(EDGE, 0, 1.5 * EDGE)), ball]
    options = {"planes": ["plane z lo 0.0"], "gravity": (0, 0, -9.81), "frequency": lab.frequency_of(2.0, EDGE), "thin": EDGE}
    ends = []
    for rule in ("", " sleep 1e-4 1e-2 0.1"):
        with lab.World(tmp_path, [*bodies, *beside], words=glue_file(tmp_path, bodies, 1e12) + rule, **options) as one:
            one.run(round(0.45 / one.dt))
            if rule:
                assert one.number("asleep") == 4 and not one.rows()[:3, 3:6].any()
                kept = state_lab.pack(one.lmp, "r")
            one.run(round(0.1 / one.dt))
            if rule:
                assert one.number("asleep") == 0
            ends.append(one.rows()[:, :3])
            if rule:
                state_lab.put(one.lmp, "r", kept)
                for _ in range(round(0.1 / one.dt)):
                    one.lmp.command("run 1")
                    state_lab.put(one.lmp, "r", state_lab.pack(one.lmp, "r"))
                assert (one.rows()[:, :3] == ends[-1]).all()
    assert ends[0] == pytest.approx(ends[1], abs=1e-4 * EDGE) and ends[0][0, 0] > -EDGE + 1e-3
