# SPDX-License-Identifier: GPL-2.0-only
"""A scene drawn before it is run: its start, a moment of a preview run, and what is shown beside the surfaces."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from mdanim_lammps.api.scene import Scene, draw_picture
from mdanim_lammps.cli import main
from mdanim_lammps.errors import UsageError
from mdanim_lammps.picture.marks import MOST_NAMES, Marks
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.loop import write_start
from picture_samples import read_png

SIZE = (320, 180)
TWO = """gravity (0, 0, -9.81) m/s^2
ground z 0
object low { shape box (20, 20, 20) cm  position (0, 0, 0.1) m  density 1000  elasticity 1 MPa  color "#ff0000" }
object high { shape box (20, 20, 20) cm  position (0, 0, 0.6) m  density 1000  elasticity 1 MPa  color "#0000ff" }
control { time 3 s  resolution 5 cm }
render { background white  camera from (0, -2, 0.4) m look (0, 0, 0.4) m }
"""


@pytest.fixture
def two(tmp_path):
    path = tmp_path / "two.txt"
    path.write_text(TWO)
    return path


def draw(path, **options) -> np.ndarray:
    """The picture of a scene, int, shape (height, width, 3)."""
    picture = draw_picture(Scene.load(path).record, path.with_suffix(".png"), size=SIZE, **options)
    return read_png(picture).astype(int)


def rows_of(picture: np.ndarray, channel: int) -> np.ndarray:
    """Rows of the pixels in which one of red, green and blue is far above the others."""
    rest = np.delete(picture, channel, axis=2).max(axis=2)
    return np.nonzero(picture[:, :, channel] > rest + 60)[0]


def test_start_and_a_later_moment(two):
    """At 0 s the upper cube hangs where the scene puts it; at 0.25 s it has fallen by 31 cm. Nothing but the picture is left."""
    start, later = draw(two), draw(two, at=0.25)
    assert start.shape == (180, 320, 3)
    red, blue, fallen = rows_of(start, 0), rows_of(start, 2), rows_of(later, 2)
    side = blue.max() - blue.min()
    assert len(red) > 300 and blue.max() < red.min()
    assert 1.2 * side < fallen.max() - blue.max() < 1.9 * side
    assert {p.name for p in two.parent.iterdir()} == {"two.txt", "two.png"}


LOADED = """
import sys
from mdanim_lammps.cli import main
try:
    main(["picture", sys.argv[1], "-q"])
finally:
    print("loaded", *sorted({"scipy", "lammps", "mpi4py", "rich"} & set(sys.modules)))
"""


def test_a_picture_of_boxes_loads_nothing_that_it_does_not_need(two):
    """Each of these takes 0.1 to 0.3 s to import; a picture is to take a second or two."""
    ran = subprocess.run([sys.executable, "-c", LOADED, str(two)], stdout=subprocess.PIPE, text=True, check=True)
    assert ran.stdout.split() == ["loaded"]
    assert two.with_suffix(".png").exists()


MOVING = """object stone { shape sphere 10 cm  position (0, 0, 1) m  density 1000  elasticity 1 MPa
  velocity (1, 2, 3) m/s  spin (0, 0, 3) rad/s }
object wall { shape box (10, 60, 60) cm  position (1, 0, 1) m  density 1000  elasticity 1 MPa  hold faces y }
control { time 0.02 s  frames 100 fps  save all }
"""


def test_the_start_that_is_drawn_is_the_run_s(tmp_path):
    """Without a liquid it is written without LAMMPS: the same bits as frame 0 of a run."""
    path = tmp_path / "moving.txt"
    path.write_text(MOVING)
    scene = Scene.load(path)
    scene.run(tmp_path / "ran")
    (tmp_path / "start").mkdir()
    write_start(scene.prepared, tmp_path / "start")
    with Trajectory(tmp_path / "ran") as ran, Trajectory(tmp_path / "start") as start:
        assert len(start) == 1
        assert start.times[0] == ran.times[0] == 0.0
        np.testing.assert_array_equal(start.position(0), ran.position(0))
        np.testing.assert_array_equal(start.velocity(0), ran.velocity(0))


def test_marks_are_drawn(two):
    """Names stand above their objects, boxes around them; springs take the place of surfaces."""
    plain, names, boxes, springs = (
        draw(two, marks=marks) for marks in (Marks(), Marks(names=True), Marks(boxes=True), Marks(springs=True))
    )
    named = np.nonzero((names != plain).any(axis=2))
    assert 20 < len(named[0]) < 600 and abs(np.mean(named[1]) - 160) < 5
    assert named[0].min() < rows_of(plain, 2).min()
    boxed = (boxes != plain).any(axis=2)
    assert 200 < boxed.sum() < 4000
    assert len(rows_of(springs, 0)) == len(rows_of(springs, 2)) == 0
    assert (springs < 100).all(axis=2).sum() > 500


def test_many_springs_leave_a_lattice(two):
    """A fine model is not one black patch: most of it is grey."""
    two.write_text(TWO.replace("resolution 5 cm", "resolution 2.5 cm"))
    path = draw_picture(Scene.load(two).record, two.with_suffix(".png"), size=(640, 360), marks=Marks(springs=True))
    seen = read_png(path)[:300].mean(axis=2)
    assert (seen < 200).sum() > 5000 and (seen < 60).sum() < 0.4 * (seen < 200).sum()


def test_too_many_names_are_refused(tmp_path):
    """Before a window is opened, with the number that is possible."""
    path = tmp_path / "many.txt"
    path.write_text(
        f"repeat i in 0 .. {MOST_NAMES} {{ object b[i] {{ shape box (1, 1, 1) cm  position (2*i, 0, 0) cm  density 1000\n"
        "  elasticity 1 MPa } }\ncontrol { time 1 s }\n"
    )
    with pytest.raises(UsageError, match=f"names of {MOST_NAMES + 1} objects"):
        draw(path, marks=Marks(names=True))


def test_command(two, capsys):
    """The picture lies beside the scene, or where -o says."""
    other = two.parent / "other.png"
    for options, file in (([], two.with_suffix(".png")), (["-o", str(other), "--boxes"], other)):
        with pytest.raises(SystemExit) as ended:
            main(["picture", str(two), "--size", "160", "90", *options])
        assert not ended.value.code
        assert f"picture  {file}" in capsys.readouterr().out
        assert read_png(file).shape == (90, 160, 3)


@pytest.mark.parametrize(
    ("options", "words"),
    [(["--at", "soon"], "--at soon: expected a time"), (["-o", "a.jpg"], "a.png"), (["--size", "1", "9"], "--size 1 9")],
)
def test_command_refuses(two, capsys, options, words):
    with pytest.raises(SystemExit) as ended:
        main(["picture", str(two), *options])
    assert ended.value.code == 2
    assert words in capsys.readouterr().err
