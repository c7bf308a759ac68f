# SPDX-License-Identifier: GPL-2.0-only
"""Patterns of objects and floors, and cameras in a given direction."""

from __future__ import annotations

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.errors import SceneError
from mdanim_lammps.picture.framing import seen_at
from mdanim_lammps.picture.render import Painter
from mdanim_lammps.picture.textures import material_places
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.render import Floor, Render, Standpoint

SIZE = (320, 180)
TEXT = """
object ball { shape sphere 10 cm  position (0, 0, 0.1) m  mass 1 kg  elasticity rigid  spin (0, 0, 5) rad/s
  velocity (1, 0, 0) m/s  color red  TEXTURE }
object box { shape box (20, 10, 10) cm  position (0, 0.5, 0.05) m  orientation axis (0, 0, 1) angle 90 deg  mass 1 kg
  elasticity rigid  hold all  texture wood }
control { time 0.3 s  frames 10 fps }
"""


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Trajectories of a ball that turns, with squares and without."""
    place = tmp_path_factory.mktemp("textures")
    texts = {"checker": TEXT.replace("TEXTURE", "texture checker size 4 cm"), "": TEXT.replace("TEXTURE", "")}
    return {word: Scene.from_text(text, "ball").run(place / f"r{word}").trajectory for word, text in texts.items()}


def pictures(trajectory, render, *frames):
    """Frames as float arrays."""
    with Painter(trajectory, render, size=SIZE) as painter:
        return [painter.frame(n).astype(float) for n in frames], painter.view(0.0)


def test_pattern_turns_with_the_material(runs):
    """A ball that turns without moving in the picture changes where it has squares, and nowhere where it has none."""
    follow = Render(camera=(Standpoint("follow", "ball"),), floor=Floor.NONE, shadows=0.0)
    around = slice(60, 120), slice(130, 190)
    change = {}
    for word, trajectory in runs.items():
        (first, last), _ = pictures(trajectory, follow, 0, 3)
        change[word] = np.abs(first[around] - last[around]).mean()
    assert change["checker"] > 20.0 and change[""] < 4.0


def test_places_lie_along_the_axes_of_the_object(runs):
    """From the middle, over the size; the longest axis of wood stands first."""
    t = runs["checker"]
    skin = t.metadata.skin
    found = material_places(t, skin.vertices(t.position(0)), skin.object_of_vertex)
    ball, box = (found[skin.object_of_vertex == m] for m in (0, 1))
    np.testing.assert_allclose(np.ptp(ball[:, :3], axis=0), 0.2 / 0.04, rtol=0.02)
    assert set(ball[:, 3]) == {4.0} and set(box[:, 3]) == {1.0}
    spans = np.ptp(box[:, :3], axis=0)
    np.testing.assert_allclose(spans / spans[1], [2.0, 1.0, 1.0], rtol=1e-5)
    np.testing.assert_allclose(box[:, :3].min(axis=0), -box[:, :3].max(axis=0), rtol=1e-5)
    plain = runs[""].metadata.skin
    assert (material_places(runs[""], plain.vertices(t.position(0)), plain.object_of_vertex)[:, 3] <= 1.0).all()


@pytest.mark.parametrize("floor", ["wood", "tiles", "grass", "studio"])
def test_floors_have_a_pattern_of_their_own(runs, floor):
    """Each differs from the plain one, and is drawn below what stands on it."""
    (plain,), view = pictures(runs[""], Render(floor=Floor.PLAIN), 0)
    (found,), _ = pictures(runs[""], Render(floor=floor), 0)
    assert np.abs(found - plain)[:150].mean() > (2.0 if floor == "studio" else 8.0)
    pixel, _ = seen_at(view, SIZE, runs[""].centers[0, :1])
    at = SIZE[1] - 1 - int(pixel[0, 1]), int(pixel[0, 0])
    np.testing.assert_array_equal(found[at], plain[at])


@pytest.mark.parametrize(("word", "forward"), [("top", (0, 0, -1)), ("side", (-1, 0, 0)), ("front", (0, 1, 0))])
def test_view_in_a_direction_holds_everything(runs, word, forward):
    """All centres are in the picture at all times, whatever is written for its size."""
    with Painter(runs[""], Render(camera=(Standpoint(word),)), size=SIZE) as painter:
        view = painter.view(0.0)
    way = (view.look - view.eye) / np.linalg.norm(view.look - view.eye)
    np.testing.assert_allclose(way, forward, atol=1e-9)
    pixel, before = seen_at(view, SIZE, runs[""].centers.reshape(-1, 3))
    assert before.all() and (pixel > 0).all() and (pixel < SIZE).all()


def test_camera_follows(runs):
    """The ball, which goes straight on, stays in the middle."""
    t = runs[""]
    with Painter(t, Render(camera=(Standpoint("follow", "ball"),)), size=SIZE) as painter:
        views = [painter.view(float(time)) for time in t.times]
    for frame in (1, 2):
        pixel, _ = seen_at(views[frame], SIZE, t.centers[frame, :1])
        assert np.linalg.norm(pixel[0] - np.array(SIZE) / 2) < 1.0
    assert views[3].eye[0] - views[0].eye[0] == pytest.approx(0.3, rel=1e-3)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("camera follow cube", "no object is called cube"),
        ("camera top\n  camera side", "camera top is a view for the whole movie"),
    ],
)
def test_standpoints_that_cannot_be(line, message):
    """Are refused."""
    with pytest.raises(SceneError, match=message):
        parse_scene(TEXT.replace("TEXTURE", "") + f"render {{\n  {line}\n}}\n", "x")


def test_lock_holds_them():
    """As they were written."""
    text = lock_text(parse_scene(TEXT.replace("TEXTURE", "texture brick") + "render { camera follow ball  floor grass }\n", "x"))
    words = " ".join(text.split())
    assert "camera follow ball" in words and "texture brick" in words and lock_text(parse_scene(text, "x")) == text
