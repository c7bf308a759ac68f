# SPDX-License-Identifier: GPL-2.0-only
"""A feature is one folder, tests/lab/features/windy/wind: a word, a switch, a quantity of expect, a column, a field of frames."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.results.compare import compare
from mdanim_lammps.scene.parse import parse_scene
from paths import LAB
from picture_samples import read_png

WIND, TAU, TIME = 3.0, 1.0, 0.2
"""[m/s], [s], [s]: as in tests/lab/windy.py and tests/lab/features/windy/wind/effect.py."""


@pytest.fixture(scope="module")
def windy(tmp_path_factory):
    """All that is said and done about the wind."""
    done = subprocess.run(
        [sys.executable, LAB / "windy.py", tmp_path_factory.mktemp("windy")], capture_output=True, text=True, timeout=200
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_the_language_has_its_words(windy):
    """On the page of the language, explained, and read back from a lock."""
    words = windy["words"]
    assert "| **wind** `(wx, wy, wz)` | m/s | - | `(0, 0, 0) m/s` | Velocity of the air." in words["page"]
    assert "Called for by `wind`." in words["page"] and "| `wind.work` | J | work of the wind since the start |" in words["page"]
    assert [text.splitlines()[0] for text in words["explained"]] == [
        "wind (wx, wy, wz)   a setting outside of all blocks",
        "expect wind.work = ...   a quantity, in J",
        "gust   a limit that check prints with its margin",
    ]
    assert words["read back"] == [WIND, 0.0, 0.0]
    assert words["of objects"][words["of objects"].index("density") + 1] == "sail"


def test_check_tells_of_it(windy):
    """Cause, bound, margin and warning; switched off by its name."""
    told = windy["told"]
    assert told["check"]["on"] and told["check"]["reason"] == "the wind is (3.0, 0.0, 0.0) m/s" and told["check"]["place"]
    assert any("wind" in line for line in told["lines"])
    c = told["certificate"]
    assert (c["cause"], c["share"] > 0.9) == ("wind", True)
    assert c["bound"] == pytest.approx(2.0 / np.sqrt(1e8), rel=0.1) and c["timestep"] <= 1e-4
    assert "gust" in told["margins"] and {"a gust", "sails are up"} <= set(told["warnings"])
    on, reason, warnings = told["off"]
    assert not on and reason == "switched off; sails hang down" and any("wind is switched off" in w for w in warnings)


def test_lammps_is_told_of_it(windy):
    """Column with its unit, and commands, in the files as in a live instance."""
    told = windy["told"]
    assert "fix wind mobile mdanim/gravity 3.0 0.0 0.0" in told["script"] and "d_sail" in told["script"]
    assert "Model # mass sail" in told["data"] and told["unit"] == "m^2"


def test_a_run_keeps_its_account(windy):
    """Objects are accelerated, the ledger has its column and adds up, summary and cost name it, expect finds its work."""
    run, way = windy["run"], 0.5 * WIND / TAU * TIME**2
    assert "wind" in run["terms"] and run["residual"] < 1e-3
    work = run["mass"] * WIND / TAU * way
    assert run["potential"] == pytest.approx(work, rel=1e-3)
    # The zero of its potential is as arbitrary as that of gravity: a joule too much is held against the 5 J that move.
    assert run["joule"] == pytest.approx(1.0 / (run["kinetic"] + 1.0 + work), rel=0.2)
    assert "wind" in run["summary"] and "wind" in run["cost"]
    assert run["expect"] == [[pytest.approx(work, rel=1e-3), True]]


def test_pictures_have_what_it_draws(windy):
    """An arrow as it is lit, and a line, where they are in the first and the last frame; exports have the arrow as a body."""
    drawn = windy["drawn"]
    for path, *places in drawn["seen"]:
        image = read_png(path) / 255.0
        arrow, pole = ((1 + np.array(place) * (1, -1)) / 2 * drawn["size"] for place in places)
        red = (image[:, :, 0] > 0.3) & (image[:, :, 1:].max(axis=2) < 0.4 * image[:, :, 0])
        rows, columns = np.nonzero(red)
        for found, place in ((columns, arrow[:, 0]), (rows, arrow[:, 1])):
            # The last pixels of its tip are covered in part.
            assert (found.min(), found.max()) == (pytest.approx(place.min(), abs=4), pytest.approx(place.max(), abs=4))
        blue = (image[:, :, 2] > 0.4) & (image[:, :, :2].max(axis=2) < 0.5 * image[:, :, 2])
        # The arrow hides the upper half of its pole.
        assert np.ptp(np.nonzero(blue)[0]) > 0.35 * np.ptp(pole[:, 1])
    assert drawn["bodies"] == ["a", "b", "arrow"] and drawn["some"] == ["b"]
    np.testing.assert_allclose(drawn["arrow"], [[0.5, 0.15, 0.65]] * 2, atol=1e-12)


def test_frames_have_its_field(windy):
    """The force on each object, with its unit; nothing of what never moves."""
    run = windy["run"]
    for force in run["force"]:
        np.testing.assert_allclose(force, [[run["mass"] * WIND / TAU, 0, 0], [0, 0, 0]], rtol=1e-12)
    assert run["unit"] == "N"


def test_a_trajectory_keeps_it(windy):
    """Its record is read back, by a property that it adds."""
    assert windy["run"]["kept"] == [WIND, 0.0, 0.0]


def test_a_study_varies_it(windy):
    """A ladder, a field of the setting, its name in files; left out with a reason where there is no wind."""
    found = windy["varied"]
    assert found["ladders"]["lulls"][2].endswith(", lulls 4") and found["sizes"] == [1.0, 0.5, 0.25]
    assert found["key"].endswith("-w2") and found["put"] == [1, 2, 4] and found["same"]
    assert found["calm"] == "no wind"


def test_its_plane_is_one_of_the_scene(windy):
    """An object thrown away from the other may come back from the fence, and the guard stops what has passed it."""
    assert windy["told"]["may come back"] and "it has left the fence" in windy["left"]


def test_executors_know_it(windy, tmp_path):
    """Two of them give the same bits, those of its field too."""
    text = (LAB / "windy.txt").read_text()
    (tmp_path / "windy.txt").write_text(text)
    env = os.environ | {"MDANIM_FEATURES": str(LAB / "features" / "windy")}
    for name, more in (("one", ()), ("two", ("-n", "2"))):
        command = [sys.executable, "-m", "mdanim_lammps", "run", "windy.txt", "--no-movie", "-o", f"{name}.out", *more]
        done = subprocess.run(command, capture_output=True, text=True, timeout=200, cwd=tmp_path, env=env)
        assert done.returncode == 0, done.stderr
    found = compare(tmp_path / "one.out", tmp_path / "two.out")
    assert found.equal and found.frames == 6


def test_without_it_nothing_is_left(windy):
    """No wind, no column, and no contact of objects that fly apart; and without its folder its words are unknown."""
    assert windy["told"]["calm"] == [False, False, "springs", False]
    with pytest.raises(SceneError, match="wind"):
        parse_scene((LAB / "windy.txt").read_text())
