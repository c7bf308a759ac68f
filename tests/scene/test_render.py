# SPDX-License-Identifier: GPL-2.0-only
"""The render block: slow motion, and a file that has nothing else."""

from dataclasses import replace

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import load_render, parse_scene
from mdanim_lammps.scene.render import Floor, Quality
from scene_parts import text


def film(speed: str, control: str = ""):
    """A scene of 3 s with a speed."""
    return parse_scene(text().replace("time 3 s", f"time 3 s {control}") + f"render {{ speed {speed} }}\n")


def test_slow_motion_has_frames_for_a_smooth_movie():
    """30 for each second of the movie, unless the scene says how many; a time lapse has those of any scene."""
    assert film("0.25").control.frames == 120.0
    assert film("0.25", "frames 60 fps").control.frames == 60.0
    assert film("4").control.frames == film("1").control.frames == 30.0
    slow = film("0.25")
    assert replace(parse_scene(lock_text(slow), slow.name), warnings=()) == slow


def test_a_moment_in_slow_motion_has_frames():
    """A stretch shorter than a frame of a movie at its own speed is long enough for one in slow motion."""
    moment = text().replace("time 3 s", "time 0.02 s")
    assert parse_scene(moment + "render { speed 0.1 }\n").control.frames == 300.0
    with pytest.raises(SceneError, match="not one frame of 1/30 s"):
        parse_scene(moment)


def test_slow_motion_that_jerks_is_told_of():
    """Below 15 pictures a second, at the frames of the scene, with the number that is smooth."""
    assert not film("0.25", "frames 60 fps").warnings and not film("0.25").warnings
    (warning,) = film("0.25", "frames 50 fps").warnings
    assert "12.5 pictures a second" in warning.message and "frames 120 fps" in warning.hint


def test_slow_motion_counts_as_frames():
    """The limit on frames holds for those that a speed calls for."""
    with pytest.raises(SceneError, match="the most is 10 000 000"):
        parse_scene(text().replace("3 s", "100 s") + "render { speed 1e-4 }\n")


@pytest.fixture
def file(tmp_path):
    def make(content: str):
        path = tmp_path / "look.txt"
        path.write_text(content)
        return path

    return make


def test_a_file_with_a_render_block_alone(file):
    """Names of objects are those of the run; what stands around the block is read as in a scene."""
    found = load_render(
        file('let d = 2\nrender { background "#000000"  speed 0.5  camera from (d, 0, 1) m look b[2] }\n'), ["b[1]", "b[2]"]
    )
    assert (found.background, found.speed, found.camera[0].look, found.camera[0].eye) == ("#000000", 0.5, "b[2]", (2.0, 0.0, 1.0))
    assert load_render(file(text() + "render { speed 2 }\n"), []).speed == 2.0


def test_words_of_a_film(file):
    """Light, shadows, floor and quality are read, written into a lock, and read again."""
    scene = parse_scene(text() + "render { light from (1, -1, 2)  shadows 0.5  floor checker  quality final }\n")
    render = scene.render
    assert (render.light, render.shadows, render.floor, render.quality) == ((1.0, -1.0, 2.0), 0.5, Floor.CHECKER, Quality.FINAL)
    assert replace(parse_scene(lock_text(scene), scene.name), warnings=()) == scene
    plain = parse_scene(text()).render
    assert (plain.shadows, plain.floor, plain.quality) == (1.0, Floor.GRID, Quality.DRAFT)


@pytest.mark.parametrize(
    ("line", "column", "cause", "hint"),
    [
        ("render { light from (1, 0, -1) }", 21, "at least 5 degrees above the floor, found (1, 0, -1)", "from (-1, -1, 2)"),
        ("render { light from (0, 0, 0) }", 21, "at least 5 degrees", "z is up"),
        ("render { light from (1, 0, 0.08) }", 21, "at least 5 degrees", "z is up"),
        ("render { light (1, 0, 1) }", 16, "cannot be followed by '('", "light from (1, -1, 2)"),
        ("render { shadows 1.5 }", 18, "shadows is too large", "1 is the darkest"),
        ("render { shadows -1 }", 18, "must be >= 0", ""),
        ("render { floor rug }", 16, "'rug' is not one of the choices of floor", "grid, plain, checker, wood"),
        ("render { quality fine }", 18, "'fine' is not one of the choices of quality", "final"),
    ],
)
def test_words_of_a_film_that_cannot_be(line, column, cause, hint):
    """Each at its value, with a way out."""
    with pytest.raises(SceneError) as error:
        parse_scene(text() + line + "\n")
    (problem,) = error.value.problems
    assert (problem.span.line, problem.span.column) == (8, column)
    assert cause in problem.message and hint in problem.hint


@pytest.mark.parametrize(
    ("content", "places"),
    [
        ("render { background blck\n camera from (1, 0, 0) look b }\n", [(1, 21), (2, 29)]),
        ("render { speed 1 }\nrender { speed 2 }\n", [(2, 1)]),
        ('title "no picture"\n', [(1, 1)]),
    ],
    ids=["values", "twice", "none"],
)
def test_problems_of_a_render_file(file, content, places):
    """All in one pass, each at its place."""
    with pytest.raises(SceneError) as error:
        load_render(file(content), ["a"])
    assert [(p.span.line, p.span.column) for p in error.value.problems] == places
