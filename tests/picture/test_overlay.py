# SPDX-License-Identifier: GPL-2.0-only
"""Arrows, trails, labels, captions, curves, copies and colours in pictures of a run, against places known otherwise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.offsetbox import TextArea
from mdanim_lammps import Scene, Trajectory, UsageError
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.pieces.names import piece_name
from mdanim_lammps.picture.curves import COVERED, Curves, covered
from mdanim_lammps.picture.drawn import drawn
from mdanim_lammps.picture.framing import pixels_per_metre, seen_at
from mdanim_lammps.picture.layer import InkLayer
from mdanim_lammps.picture.overlay import _near, _reach, _round_value, free_height, letters_of, room_for
from mdanim_lammps.picture.plot import span_of
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.picture.run_values import RunValues
from mdanim_lammps.picture.tones import Tones
from mdanim_lammps.run.loop import write_start
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.naming import labelled, objects_by_name
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.quantities import Asked
from mdanim_lammps.scene.render import Render, Standpoint
from mdanim_lammps.scene.shown import Arrows, Caption, ColorBy, NameTag, Trail

SIZE = (320, 180)
TEXT = """
gravity (0, 0, -9.81) m/s^2
object ball { shape sphere 10 cm  position (0, 0, 1.5) m  mass 1 kg  elasticity rigid  velocity (2, 0, 0) m/s  color red }
object cube { shape box (20, 20, 20) cm  position (1, 0, 1.5) m  mass 2 kg  elasticity 1 MPa  spin (0, 6, 0) rad/s }
object post { shape box (10, 10, 100) cm  position (-1, 0, 0.5) m  mass 9 kg  elasticity 1 MPa  hold all }
control { time 0.5 s  frames 20 fps  resolution 10 cm }
"""
CAMERA = "camera from (0.5, -6, 1) m look (0.5, 0, 1) m"
ALL = """
render {
  arrows velocity of ball
  arrows weight
  arrows spin of cube scale 0.02
  trail ball 0.2 s
  label ball "falls"
  plot ball.speed
  plot cube.kinetic
  plot cube.force.z
  caption "now" from 0.1 s to 0.3 s
  freeze 0.1 s
  color-by speed
}
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A flight beside a held post, with nothing laid over its pictures."""
    return Scene.from_text(TEXT + f"render {{ {CAMERA} }}\n", "flight").run(tmp_path_factory.mktemp("flight") / "r")


def pictures(run, frames=(6,), size=SIZE, **words):
    """Frames of the run with these settings of ``render``, int, shape (height, width, 3), first row on top."""
    render = replace(run.scene.record.render, **words)
    with Painter(run.trajectory, render, size=size) as painter:
        return [painter.frame(n).astype(int) for n in frames], painter.view(0.0)


def changed(run, frame=6, size=SIZE, **words):
    """Pixels that settings change, bool, first row below."""
    ((plain,), view), ((other,), _) = pictures(run, (frame,), size), pictures(run, (frame,), size, **words)
    return (np.abs(plain - other).max(axis=2) > 12)[::-1], view


def test_an_arrow_goes_from_the_centre_along_the_velocity(run):
    """From where the centre is seen to where centre + scale times velocity is seen, to three pixels."""
    found, view = changed(run, arrows=(Arrows("velocity", "ball", 0.2),))
    found[-30:] = False  # the legend
    t, m = run.trajectory, 0
    ends = np.array([t.centers[6, m], t.centers[6, m] + 0.2 * t.center_velocities[6, m]])
    pixels, ahead = seen_at(view, SIZE, ends)
    y, x = np.nonzero(found)
    along = (pixels[1] - pixels[0]) / np.hypot(*(pixels[1] - pixels[0]))
    way = (np.column_stack([x + 0.5, y + 0.5]) - pixels[0]) @ along
    off = (np.column_stack([x + 0.5, y + 0.5]) - pixels[0]) @ [-along[1], along[0]]
    assert ahead.all() and abs(way.min()) < 3 and abs(way.max() - np.hypot(*(pixels[1] - pixels[0]))) < 3
    assert np.abs(off).max() < 8 and np.abs(off.mean()) < 0.5


def test_places_are_seen_where_the_window_draws_them(run):
    """The red ball's pixels have their middle where its centre is projected to."""
    (picture,), view = pictures(run, (3,), (640, 360))
    red = ((picture[..., 0] > 90) & (picture[..., 1] < 60) & (picture[..., 2] < 60))[::-1]
    y, x = np.nonzero(red)
    pixel, _ = seen_at(view, (640, 360), run.trajectory.centers[3, :1])
    middle = np.array([x.min() + x.max() + 1, y.min() + y.max() + 1]) / 2
    assert np.abs(middle - pixel[0]).max() < 1.5
    metre = pixels_per_metre(view, (640, 360), run.trajectory.centers[3, 0])
    assert x.max() + 1 - x.min() == pytest.approx(0.2 * metre, rel=0.08)


def test_all_arrows_of_a_unit_have_one_length(run):
    """Without a scale of their own; the longest is a seventh of the scene, and what is held has none."""
    lines = (Arrows("weight"), Arrows("force", "cube"))
    with Painter(run.trajectory, Render(arrows=lines), size=SIZE) as painter:
        weight, force = painter._overlay._vectors
        assert weight.scale == force.scale and weight.objects == (0, 1) and force.objects == (1,)
        assert 2.0 * 9.81 * weight.scale == pytest.approx(0.14 * painter.action.size, rel=1e-3)
        np.testing.assert_allclose(weight.values[:, 1], np.tile([0.0, 0.0, -2.0 * 9.81], (11, 1)))


@pytest.mark.parametrize(("value", "shown"), [(0.0, 1.0), (1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (49.0, 20.0), (0.0501, 0.05)])
def test_values_of_the_legend_are_round(value, shown):
    """1, 2 or 5 times a power of ten, not above the value."""
    assert _round_value(value) == pytest.approx(shown)


def test_curves_grow_with_the_film(run):
    """A curve reaches as far into its panel as the frame into the run, at the height of its value."""
    reach = []
    for frame in (0, 5, 10):
        plain = pictures(run, (frame,), (640, 360), plot=(Asked("ball", "position.z"),))[0][0]
        panel = plain[:140, int(640 * (1 - COVERED)) + 50 :]
        red = (panel[..., 0] > 150) & (panel[..., 1] < 60) & (panel[..., 2] < 60)
        red[:25] = False  # its name
        reach.append(np.flatnonzero(red.any(axis=0)).max())
        last = np.flatnonzero(red[:, reach[-1] - 2])
        low, high = span_of([RunValues(run.trajectory).series(Asked("ball", "position.z"))], "m")
    assert reach[1] - reach[0] == pytest.approx(reach[2] - reach[1], abs=2) and reach[1] - reach[0] > 70
    assert low < 1.5 - 9.81 * 0.125 and high > 1.5 and last.mean() > 80  # it has fallen to the lower edge


def test_the_automatic_camera_leaves_room_for_panels(run):
    """Everything that moves is seen left of them or below, in every frame."""
    t = run.trajectory
    render = Render(plot=(Asked("ball", "speed"),))
    with Painter(t, render, size=(640, 360)) as painter:
        view = painter.view(0.0)
    for frame in range(len(t)):
        pixels, ahead = seen_at(view, (640, 360), t.metadata.skin.vertices(t.position(frame)))
        assert ahead.all() and pixels.min() > 0 and (pixels < (640, 360)).all() and free_of(pixels / (640, 360), render).all()


def free_of(share, render):
    """Which places, in parts of a picture of 16 by 9, are not behind panels, bool, shape (P,)."""
    wide, high = covered(render.plot, 16 / 9)
    return (share < (1.0 - wide, 1.0 - high)).any(axis=1)


@pytest.mark.parametrize("place", ["side", "front"])
def test_a_view_in_a_direction_shows_the_whole_run_beside_what_is_laid_over_it(run, place):
    """In every frame: right of the scale of colours, below the legend, left of the curves or below, however near to the eye."""
    t, size = run.trajectory, np.array([640, 360])
    tells = {"plot": (Asked("ball", "speed"),), "color_by": ColorBy("speed"), "arrows": (Arrows("velocity"),) * 2}
    render = Render(camera=(Standpoint(place),), **tells)
    with Painter(t, render, size=tuple(size)) as painter:
        view, room = painter.view(0.0), room_for(render, tuple(size))
    assert room.left > 0.1 and room.above > 0.08
    points = np.concatenate([t.metadata.skin.vertices(t.position(frame)) for frame in range(len(t))])
    share = seen_at(view, size, points)[0] / size
    assert (share > (room.left, room.below)).all() and (share < (1.0, 1.0 - room.above)).all()
    assert free_of(share, render).all()


def test_a_start_has_its_meshes_beside_it(tmp_path):
    """Curves and arrows of a picture are found from its scene, which is read with its meshes."""
    (tmp_path / "start").mkdir()
    (tmp_path / "nut.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    text = """object nut { shape mesh "nut.obj" scale 0.1 position (0, 0, 1) m density 700 elasticity rigid }
render { plot nut.speed arrows velocity of nut } control { time 0.1 s }
"""
    scene = Scene.from_text(text, "nut", folder=tmp_path)
    with Trajectory(write_start(scene.prepared, tmp_path / "start")) as start:
        assert RunValues(start).series(Asked("nut", "speed")).tolist() == [0.0]


def test_strings_are_in_the_picture(tmp_path):
    """A pendulum is seen from its bob to the point of the world that it hangs at; before its run, too."""
    text = "gravity (0, 0, -9.81) m/s^2\nobject bob { shape sphere 3 cm  position (5, 0, 0) cm  mass 1 kg  elasticity rigid }\n"
    text += "joint spring bob world { to (0, 0, 1) m }\ncontrol { time 0.05 s }\n"
    scene = Scene.from_text(text, "pendulum")
    with scene.run(tmp_path / "r", movie=False).trajectory as t, Painter(t) as painter:
        at, _ = seen_at(painter.view(0.0), painter.size, np.array([(0.0, 0.0, 1.0), (0.05, 0.0, 0.0)]))
        (string,) = drawn(t)
        with Trajectory(write_start(prepare(scene.record), tmp_path)) as start:
            np.testing.assert_allclose(drawn(start)[0].points(0), string.points(0), atol=1e-9)
            assert RunValues(start).end == RunValues(t).end == pytest.approx(0.05)
    assert (at > 0.0).all() and (at < painter.size).all() and at[0, 1] - at[1, 1] > 0.5 * painter.size[1]


def test_words_stand_where_and_when_they_should(run):
    """A label beside its object, on the left where it would cover another one on the right, a caption in its time alone, a trail
    where the object was."""
    for m, name, side in ((0, "ball", -1), (1, "cube", 1)):  # the ball flies to the cube
        label, view = changed(run, label=(NameTag(name, "falls"),))
        pixel, _ = seen_at(view, SIZE, run.trajectory.centers[6, [m]])
        y, x = np.nonzero(label)
        assert 0 < (side * (x - pixel[0, 0])).min() < 25 and abs((y.min() + y.max()) / 2 - pixel[0, 1]) < 6
    caption = (Caption("now", 0.1, 0.3),)
    frames = (0, 1, 2, 6, 7)
    both = zip(pictures(run, frames)[0], pictures(run, frames, caption=caption)[0])
    assert [bool((a != b).any()) for a, b in both] == [False, False, True, True, False]
    trail, _ = changed(run, trail=(Trail("ball", 0.2),))
    pixels, _ = seen_at(view, SIZE, run.trajectory.centers[2:7, 0])
    y, x = np.nonzero(trail)
    assert abs(x.min() - pixels[0, 0]) < 4 and abs(x.max() - pixels[-1, 0]) < 12 and abs(y.max() - pixels[0, 1]) < 4


def test_an_object_in_pieces_has_its_words_once():
    """Beside all of them while they hang together, however they have turned; then beside those that stay near their middle."""
    names = [*(piece_name("vase", n) for n in range(6)), "b[1]", "b[2]"]
    assert labelled(objects_by_name(names)["vase"], names) == [[0, 1, 2, 3, 4, 5]]
    assert labelled(objects_by_name(names)["b"], names) == [[6], [7]]
    places = np.array([(x, 0.0, z) for x in (0.0, 1.0) for z in (0.0, 1.5, 3.0)])
    reach, turned = _reach(places), places[:, [2, 0, 1]] + (3.0, 0.0, 1.0)
    assert _near(turned, reach).all() and _near(places[:1], 0.0).all()
    away = np.where(np.arange(6)[:, None] == 2, turned + 9.0, turned)
    assert _near(away, reach).tolist() == [n != 2 for n in range(6)]
    assert _near(9.0 * turned, reach).any()


def test_copies_stay_where_things_were(run):
    """A pale ball at each time before, none ahead and none of what is held; they cast no shadows."""
    seen, lamp = [], []
    for freeze in (None, 0.1):
        with Painter(run.trajectory, replace(run.scene.record.render, freeze=freeze), size=SIZE) as painter:
            seen.append(painter.frame(6).astype(int))
            lamp.append(painter._light._lamp.depth.numbers.copy())
            view = painter.view(0.0)
    np.testing.assert_array_equal(*lamp)
    found = (np.abs(seen[0] - seen[1]).max(axis=2) > 12)[::-1]
    pixels, _ = seen_at(view, SIZE, run.trajectory.centers[:, 0])
    seen = [bool(found[int(y), int(x)]) for x, y in pixels[:8]]
    assert seen[0] and seen[2] and seen[4] and not seen[7]
    post, _ = seen_at(view, SIZE, run.trajectory.centers[:1, 2])
    assert not found[int(post[0, 1]), int(post[0, 0])]
    with pytest.raises(UsageError, match="501 copies of everything would cover the picture; 200 are the most"):
        Painter(run.trajectory, Render(freeze=0.001), size=SIZE)


def test_colours_tell_speed_and_strain(run):
    """From 0 to a value that few exceed; the ball's colour goes with its speed; what is held keeps its own."""
    tones = Tones((run.trajectory, None), ColorBy.SPEED)
    fastest = np.linalg.norm(run.trajectory.velocity(10), axis=1).max()
    assert tones.most == pytest.approx(fastest, rel=0.05) and tones.unit == "m/s"
    assert len({tuple(tones.colors(np.array([x * fastest]))[0]) for x in (0.0, 0.25, 0.5, 0.75, 1.1, 2.0)}) == 5
    (first, last), view = pictures(run, (1, 9), color_by=ColorBy.SPEED)
    post, _ = seen_at(view, SIZE, run.trajectory.centers[:1, 2])
    at = SIZE[1] - 1 - int(post[0, 1]), int(post[0, 0])
    assert np.array_equal(first[at], last[at]) and np.array_equal(first[at], pictures(run, (1,))[0][0][at])
    strain = Tones((run.trajectory, None), ColorBy.STRAIN)
    assert strain.of_particles(0).max() == 0.0 and 0.0 < strain.most < 0.1


@pytest.mark.parametrize("height", [360, 720])
def test_letters_are_large_enough_to_read(run, height):
    """Eleven pixels at least."""
    with Painter(run.trajectory, Render(caption=(Caption("x"),)), size=(height * 16 // 9, height)) as painter:
        assert painter._overlay._layer.letters >= 11.0


def test_words_may_have_signs_of_mathematics():
    """A dollar sign starts no formula, and characters of other scripts are drawn."""
    layer, picture = InkLayer((200, 40), 11.0, dark=False), np.full((40, 200, 4), 255, np.uint8)
    layer.words((5, 20), "5 $ and $x^2$ µ²°")
    layer.lay_on(picture)
    assert (picture[..., :3] < 100).any() and (picture[..., 3] == 255).all()


def test_nothing_of_it_changes_a_run(run, tmp_path):
    """The same frames to the bit with all of it; its movie and its stored scene can be made again."""
    other = Scene.from_text(TEXT + ALL, "flight").run(tmp_path / "flight.out")
    for frame in range(len(run.trajectory)):
        np.testing.assert_array_equal(run.trajectory.position(frame), other.trajectory.position(frame))
        np.testing.assert_array_equal(run.trajectory.velocity(frame), other.trajectory.velocity(frame))
    assert {"kinetic.cube", "spin.x.cube"} <= set(other.ledger.columns) and not (other.folder / "records.csv").exists()
    assert other.render(tmp_path / "m.mp4", size=(128, 72)).stat().st_size > 1000
    text = lock_text(other.scene.record)
    assert lock_text(parse_scene(text, "flight")) == text


def test_a_run_of_before_shows_all_that_its_frames_tell(run):
    """A quantity that needed every frame while it ran is refused, with the line that would have recorded it."""
    pictures(run, arrows=(Arrows("contact"), Arrows("force"), Arrows("weight")), plot=(Asked("ball", "distance", "cube"),))
    with pytest.raises(UsageError, match=r"the run has not recorded kinetic of cube; write it in the scene, record cube.kinetic"):
        pictures(run, plot=(Asked("cube", "kinetic"),))
    with pytest.raises(
        UsageError, match=r"the run has not recorded strain.max of cube; .* record cube.strain.max, and run it again"
    ):
        pictures(run, plot=(Asked("cube", "strain.max"),))
    with pytest.raises(UsageError, match=r"the ledger of the run has no column liquid_cells"):
        pictures(run, plot=(Asked("liquid", "volume"),))


def test_a_scene_is_drawn_before_its_run(tmp_path):
    """Curves are empty, arrows that need a frame before are missing."""
    Scene.from_text(TEXT + ALL, "flight").picture(tmp_path / "p.png", size=SIZE)
    assert (tmp_path / "p.png").stat().st_size > 1000


def test_on_a_dark_background_in_final_quality(run):
    """Letters are light, and everything is drawn twice as large and then made smaller."""
    render = dict(background="#000000", caption=(Caption("light"),))
    (picture,), _ = pictures(run, **render)
    words = picture[int(0.86 * SIZE[1]) : int(0.94 * SIZE[1]), 100:220]
    assert words.max() > 220
    with Trajectory(run.folder) as t:
        from mdanim_lammps.scene.render import Quality

        with Painter(t, Render(quality=Quality.FINAL, **render), size=SIZE) as painter:
            assert painter.frame(3)[int(0.86 * SIZE[1]) : int(0.94 * SIZE[1]), 100:220].max() > 220


@pytest.mark.parametrize(
    ("line", "message", "hint"),
    [
        ("arrows speed", "'speed' is not one of the choices of arrows", "did you mean 'velocity'?"),
        ("arrows velocity of bal", "no object is called bal", "did you mean 'ball'?"),
        ("arrows velocity scale 0", "s of arrows must be > 0, found 0", ""),
        ("trail", "nothing follows trail", ""),
        ("trail bal", "no object is called bal", "did you mean 'ball'?"),
        ("trail ball 2 m", "T of trail must be a time, found 2 m, a length", ""),
        ('label "x"', "label needs the name of an object", 'label ball "falls freely"'),
        ("label ball", "nothing follows ball", ""),
        ("plot ball.sped", "sped is not a quantity of ball", "did you mean 'speed'?"),
        ("plot post.draft", "post.draft needs a liquid block", ""),
        ('caption "x" from 0.2 s to 0.1 s', "the caption ends at 0.1 s and begins at 0.2 s", "earlier time first"),
        ("freeze 0 s", "freeze must be > 0, found 0", ""),
        ("freeze 1 ms", "501 copies would cover the picture; 200 are the most", "freeze 0.05 s"),
        ("color-by heat", "'heat' is not one of the choices of color-by", ""),
        ("freeze 2.505 ms plot ball.speed plot ball.position.z", "", ""),  # 200 copies
    ],
)
def test_what_cannot_be_shown_is_refused(line, message, hint):
    """With its place, and a way out."""
    text = TEXT + f"render {{ {line} }}\n"
    if not message:
        assert len(parse_scene(text).render.plot) == 2
        return
    with pytest.raises(SceneError) as error:
        parse_scene(text)
    (problem,) = error.value.problems
    assert message in problem.message and hint in problem.hint and problem.span.line == 7


@pytest.mark.parametrize(
    ("line", "cause"),
    [
        ('caption "x" from 3 s to 4 s', "the caption begins at 3 s, and the run ends at 0.5 s"),
        ("freeze 2 s", "the first copy would be left at 2 s, and the run ends at 0.5 s"),
        ("color-by strain", "color-by strain shows nothing: no object deforms"),
        ("color-by stress", "color-by stress shows nothing: no object deforms"),
    ],
)
def test_what_would_not_be_seen_is_told(line, cause):
    """A warning at its place; none where something can be seen."""
    (warning,) = parse_scene(TEXT.replace("elasticity 1 MPa", "elasticity rigid") + f"render {{ {line} }}\n").warnings
    assert warning.severity == "warning" and cause in warning.message and warning.span.line == 7 and warning.hint
    assert not parse_scene(TEXT + f"render {{ {line.replace('3 s', '0.3 s').replace('freeze 2', 'freeze 0.2')} }}\n").warnings


IN_A_LAKE = """
gravity (0, 0, -9.81) m/s^2
liquid lake { basin from (-0.2, -0.2, 0) m to (0.2, 0.2, 0.4) m  density 1000 kg/m^3  level 0.2 m }
object cork { shape box (16, 16, 16) cm  position (0, 0, 0.3) m  density 500 kg/m^3  elasticity rigid }
control { time 0.1 s }
"""


def test_arrows_that_no_object_would_have_are_refused(prepared):
    """Contact beside a liquid; what is told of an object at least has arrows."""
    with pytest.raises(SceneError, match="the force of contact on cork is not known: lift and drag"):
        prepared(IN_A_LAKE + "render { arrows contact }\n")
    prepared(IN_A_LAKE + "render { arrows force }\n", "force")


def test_the_legend_says_that_arrows_are_too_small(run, monkeypatch):
    """In place of a scale by which none is seen."""
    from mdanim_lammps.picture.layer import InkLayer

    words = []
    monkeypatch.setattr(InkLayer, "words", lambda self, at, text, **looks: words.append(text))
    pictures(run, arrows=(Arrows("velocity"), Arrows("weight", scale=1e-6)))
    assert "weight: too small to be seen" in words and any(w.startswith("velocity  ") for w in words)


def test_four_units_have_no_room():
    """Three panels are the most."""
    lines = "\n".join(f"plot ball.{word}" for word in ("speed", "position.z", "kinetic", "force"))
    with pytest.raises(SceneError, match="curves of 4 units are asked for, and a picture has room for 3 panels"):
        parse_scene(TEXT + f"render {{\n{lines}\n}}\n")


def test_curves_of_what_several_objects_have(tmp_path):
    """The number of parts of an object with pieces, which no single object of the run has the name of."""
    text = """
    object v { shape box (10, 10, 10) cm  density 300  elasticity rigid  position (0, 0, 0.2) m  pieces 6  strength 1 kPa }
    control { time 0.1 s }
    render { plot v.pieces }
    """
    found = Scene.from_text(text, "v").run(tmp_path / "v.out")
    values = RunValues(found.trajectory)
    (of,) = found.trajectory.scene.render.plot
    assert values.series(of).tolist() == [1.0] * len(found.trajectory)
    with pytest.raises(UsageError, match="has no object w"):
        values.series(replace(of, subject="w"))


def test_names_of_curves_are_readable(run):
    """In a small picture: ten pixels high at least, in lines of the panel, above the curves."""
    size, letters = (640, 360), letters_of((640, 360))
    layer, asked = InkLayer(size, letters, False), [Asked(name, f"position.{axis}") for name in ("ball", "cube") for axis in "xz"]
    curves = Curves(layer, asked, [RunValues(run.trajectory)], {})
    picture = np.full((size[1], size[0], 4), 255, np.uint8)
    layer.lay_on(picture)
    ground = layer.figure.axes[0]
    names = [text for area in ground.findobj(TextArea) for text in area.get_children()]
    assert [name.get_text() for name in names] == [
        "ball.position.x",
        "ball.position.z",
        "cube.position.x",
        "cube.position.z",
        "[m]",
    ]
    boxes = [name.get_window_extent() for name in names]
    panel, plot = ground.get_window_extent(), curves._curves[0][0].get_window_extent()
    assert all(name.get_fontsize() >= 10.0 for name in names)
    assert all(panel.x0 <= box.x0 and box.x1 <= panel.x1 and plot.y1 <= box.y0 and box.y1 <= panel.y1 + 1.0 for box in boxes)
    assert plot.height > 0.4 * panel.height


@pytest.mark.parametrize(
    ("placed", "height"),
    [
        ([(11, 20, 5)], 5),
        ([(4, 20, 6)], 4),
        ([(4, 20, 4.5)], 6.5),
        ([(4, 20, 6), (0, 3, 4.5)], 2.5),
        ([], 5),
        ([(0, 9, 2 * k) for k in range(9)], 5),
    ],
)
def test_words_that_would_cover_others_stand_above_or_below_them(placed, height):
    assert free_height(5.0, 0.0, 10.0, placed, 2.0) == height


def test_labels_of_objects_side_by_side_are_apart(tmp_path):
    """Three boxes behind each other, as the camera sees them."""
    boxes = "".join(
        f"object b{k} {{ shape box (10, 10, 10) cm  position (0, {0.3 * k}, 0.05) m  density 300  elasticity rigid }}\n"
        for k in range(3)
    )
    labels = "".join(f'label b{k} "a long name of box number {k}"\n' for k in range(3))
    scene = Scene.from_text(f"{boxes} control {{ time 0.1 s  frames 10 fps }}\nrender {{ camera front\n{labels} }}", "boxes")
    found = scene.run(tmp_path / "b.out").trajectory
    with Painter(found, found.scene.render, size=(640, 360)) as painter:
        written = []
        painter._overlay._layer.words = lambda at, text, ha, **_: written.append((ha, float(at[1])))
        painter.pixels(1)
    heights = [[y for side, y in written if side == ha] for ha in ("left", "right")]
    assert max(map(len, heights)) > 1
    assert all(np.diff(sorted(of_side)).min(initial=np.inf) >= 1.19 * letters_of((640, 360)) for of_side in heights)


def test_names_of_curves_leave_room_in_the_smallest_picture(run):
    """Names are smaller where a panel has no room for their lines."""
    asked = [Asked(name, f"position.{axis}") for name in ("ball", "cube") for axis in "xyz"] + [Asked("cube", "speed")]
    layer = InkLayer((320, 180), letters_of((320, 180)), False)
    curves = Curves(layer, asked, [RunValues(run.trajectory)], {})
    assert all(axes.get_window_extent().height > 8.0 for axes, *_ in curves._curves)


def test_words_are_as_they_are_written():
    layer, drawn = InkLayer((200, 100), 11.0, False), []
    layer.add = drawn.append
    layer.words((0.0, 0.0), "$x$ 5 \\% of $")
    assert [text._preprocess_math(text.get_text()) for text in drawn] == [("$x$ 5 \\% of $", False)]
