# SPDX-License-Identifier: GPL-2.0-only
"""Hands of a scene: a ball that hangs at one against the closed form, what a hand may cost, and what is refused."""

import numpy as np
import pytest
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.hands import strength
from mdanim_lammps.model.inertia import largest_mobility
from mdanim_lammps.picture.drawn import drawn
from mdanim_lammps.results.files import HANDS
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.view.feed import ADDED, Feed

R, G = 0.05, 9.81
BALL = "object ball { shape sphere 5 cm  position (0, 0, 1) m  density 1000  elasticity rigid }\n"
SCENE = f"gravity (0, 0, -9.81) m/s^2\n{BALL}control {{ time 1 s  frames 25 fps }}\n"
TOP = "at (0, 0, 1.05) m  key 0 s at (0, 0, 1.05) m  key 1 s at (0, 0, 1.05) m"


def test_a_ball_comes_to_rest_below_the_hand():
    """As a body on a critically damped spring, z = g/w^2 (1 - (1 + w t) exp(-w t)) with w^2 = 4 g/r: in the end a quarter of its
    radius below."""
    ready = prepare(parse_scene(f"{SCENE}hand ball {{ {TOP} }}\n"))
    per_frame, dt = ready.certificate.steps_per_frame, ready.certificate.timestep
    w = (4.0 * G / R) ** 0.5
    with Instance(ready.plan) as instance:
        instance.setup()
        mass = ready.system.mass
        for frame in range(1, 26):
            instance.run(per_frame)
            fallen = 1.0 - mass @ instance.array("x")[:, 2] / mass.sum()
            t = frame * per_frame * dt
            assert fallen == pytest.approx(G / w**2 * (1.0 - (1.0 + w * t) * np.exp(-w * t)), abs=0.04 * R / 4)
        assert fallen == pytest.approx(R / 4, rel=1e-6)
        assert instance.fix_value("hand", "work") == pytest.approx(-mass.sum() * G * R / 4, rel=1e-2)


def test_a_hand_lifts_all_that_is_welded():
    """A hammer that is taken at its handle hangs a quarter of the radius of all of it below the hand."""
    handle = "object handle { shape box (4, 4, 20) cm  position (0, 0, 1) m  density 500  elasticity rigid }\n"
    head = "object head { shape box (10, 10, 8) cm  position (0, 0, 0.88) m  density 500  elasticity rigid }\n"
    weld = "joint weld handle head { at (0, 0, 0.91) m }\n"
    pull = TOP.replace("1.05", "1.1")
    ready = prepare(parse_scene(SCENE.replace(BALL, handle + head + weld) + f"hand handle {{ {pull} }}\n"))
    middle = (0.16 * 1.0 + 0.4 * 0.88) / 0.56
    radius = max(1.0 - middle + np.hypot(0.1, 0.02 * 2**0.5), middle - 0.88 + np.hypot(0.04, 0.05 * 2**0.5))
    with Instance(ready.plan) as instance:
        instance.setup()
        before = instance.array("x")[0, 2]
        instance.run(ready.certificate.steps)
        assert before - instance.array("x")[0, 2] == pytest.approx(0.25 * radius, rel=1e-3)


def test_each_object_is_looked_at_once(monkeypatch):
    """Its mobility, for the strength of a hand, however many objects there are and however often it is asked for."""
    asked = []
    monkeypatch.setattr(strength, "largest_mobility", lambda *a: asked.append(a) or largest_mobility(*a))
    balls = "".join(BALL.replace("ball", f"b{n}").replace("(0, 0, 1)", f"({n}, 0, 1)") for n in range(5))
    prepare(parse_scene(f"hands on\n{balls}control {{ time 1 s  frames 25 fps }}\n"))
    assert len(asked) == 5


def test_a_hand_is_in_the_bound_and_costs_little():
    """A few per cent of what deforms; and a hand that comes later finds the certificate and the effects that it needs."""
    soft = SCENE.replace("elasticity rigid", "elasticity 300 kPa")
    alone, held, open_ = (prepare(parse_scene(soft + more)) for more in ("", f"hands on\nhand ball {{ {TOP} }}\n", "hands on\n"))
    assert 1.0 < alone.certificate.bound / held.certificate.bound < 1.12
    assert held.certificate == open_.certificate and held.plan.effects == open_.plan.effects


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SCENE.replace("rigid }", "rigid  hold all }") + f"hand ball {{ {TOP} }}", "ball is held as a whole"),
        (f"{SCENE}hand cube {{ {TOP} }}", "cube"),
        (f"{SCENE}hand ball {{ at (0, 0, 1) m  key 0 s at (0, 0, 1) m }}", "fewer than two keys"),
        (f"{SCENE}hand ball {{ at (0, 0, 1) m  key 1 s at (0, 0, 1) m  key 1 s at (0, 0, 1) m }}", "times of keys must rise"),
        (f"{SCENE}hand ball {{ {TOP.replace('1.05', '2', 1)} }}", "the hand would hold ball at .* which is 1 m from"),
        (f"{SCENE}hand ball {{ {TOP} }}\nrecord ball.contact", "a hand may pull at it"),
        (
            SCENE.replace(
                BALL, "repeat i in 1 .. 2 { " + BALL.replace("ball", "ball[i]").replace("(0, 0, 1)", "((i), 0, 1)") + "}\n"
            )
            + f"hand ball {{ {TOP} }}",
            r"ball are 2 objects, and a hand pulls at one",
        ),
    ],
    ids=["held", "unknown", "keys", "times", "beside", "contact", "several"],
)
def test_what_is_refused(text, message):
    with pytest.raises(SceneError, match=message):
        prepare(parse_scene(text))


@pytest.mark.parametrize(("elasticity", "near"), [("rigid", 1e-4), ("300 kPa  damping 0.3", 0.2 * R)], ids=["rigid", "soft"])
def test_pictures_show_the_hand_and_what_it_holds(tmp_path, elasticity, near):
    """A line from where the hand is to the top of the ball, a quarter of its radius long at rest; nothing before and after."""
    scene = SCENE.replace("elasticity rigid", f"elasticity {elasticity}  resolution 2.5 cm").replace("time 1 s", "time 0.6 s")
    hand = "hand ball { at (0, 0, 1.05) m  key 0.04 s at (0, 0, 1.05) m  key 0.44 s at (0, 0, 1.05) m }\n"
    with Scene.from_text(scene + hand, "hand").run(tmp_path / "r", movie=False).trajectory as t:
        (one,) = drawn(t)
        for frame, time in enumerate(t.times):
            a, p = one.points(frame)[one.line[0]]
            np.testing.assert_allclose(a, (0.0, 0.0, 1.05), atol=1e-12)
            if holds := 0.04 <= time <= 0.44:
                np.testing.assert_allclose(p, t.centers[frame, 0] + (0.0, 0.0, R), atol=near)
                rest = a[2] - p[2]
            assert holds or np.ptp(one.points(frame), axis=0).max() < 1e-12
        assert elasticity != "rigid" or rest == pytest.approx(R / 4, rel=0.03)


def test_pictures_show_the_hands_of_a_page(tmp_path):
    """Hands that the run has kept beside its trajectory are drawn; a file that cannot be read as a scene has none."""
    scene = SCENE.replace("time 1 s", "time 0.04 s")
    folder = Scene.from_text("hands on\n" + scene, "hand").run(tmp_path / "r", movie=False).folder
    hand = "hand ball { at (0, 0, 1.05) m  key 0 s at (0, 0, 1.05) m  key 0.04 s at (0, 0, 1.07) m }\n"
    for lines, count in (("", 0), (f"# page\nhands on\n{hand}", 1), ("object x {", 0), (f"repeat i in 1 .. 2 {{ {hand} }}", 0)):
        (folder / HANDS).write_text(lines)
        with Trajectory(folder) as t:
            found = drawn(t)
            assert len(found) == count
            if found:
                np.testing.assert_allclose(found[0].points(len(t) - 1)[-2], (0.0, 0.0, 1.07), atol=1e-12)
                feed = Feed(folder, finished=True)  # the page shows it, too
                points = np.frombuffer(feed.frame(len(t) - 1, ADDED)[-12 * feed.head()["added"] :], "<f4").reshape(-1, 3)
                np.testing.assert_array_equal(points, found[0].points(len(t) - 1).astype("f4"))
                feed.close()
