# SPDX-License-Identifier: GPL-2.0-only
"""Quantities that a page tells beside its picture have the values of records; where there are none it says why."""

import numpy as np
import pytest
from mdanim_lammps import Run, Scene, Trajectory
from mdanim_lammps.errors import MdanimError
from mdanim_lammps.results.records import Records
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.view.told import ShownQuantities, shown

SCENE = """gravity (0, 0, -9.81)
ground z 0
object block { shape box (10, 10, 10) cm  position (0, 0, 0.05) m  density 1000  elasticity rigid }
object shelf { shape box (10, 10, 2) cm  position (1, 0, 0.5) m  density 1000  elasticity rigid  hold all }
control { time 0.04 s  frames 100 fps }
record block.contact.z
record block.kinetic
record block.distance(shelf)
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A block that lies on the ground, and a shelf."""
    made = tmp_path_factory.mktemp("told")
    (made / "told.txt").write_text(SCENE)
    return Scene.load(made / "told.txt").run(made / "told.out").folder


def test_curves_are_those_of_the_records(folder):
    """Also those that any object has; a mean is told as one, and weight bears a block at rest."""
    told, records = ShownQuantities(folder), Run(folder).records
    assert isinstance(records, Records)
    assert told.head()["own"] == {"block.contact.z": "N", "block.kinetic": "J", "block.distance(shelf)": "m"}
    for what in told.head()["own"]:
        head, found = told.curve(what)
        np.testing.assert_array_equal(found["value"], records[what].astype("f4"))
        assert head == {"what": what, "unit": records.units[what], "mean": what == "block.contact.z"}
    assert told.curve(["block", "weight.z"])[1]["value"] == pytest.approx(-9.81)
    vectors = told.vectors("contact")
    np.testing.assert_array_equal(vectors[:, 0, 2], records["block.contact.z"].astype("f4"))
    assert np.isfinite(vectors[1:, 0]).all() and np.isnan(vectors[0]).all()
    with Trajectory(folder) as t:
        np.testing.assert_array_equal(told.vectors("velocity"), t.center_velocities.astype("f4"))
    assert told.head()["means"] == ["contact", "force"] and not told.head()["untold"]


def test_what_the_run_does_not_tell(folder):
    """A quantity that was not recorded is refused with a reason; what is not a quantity is a wrong question."""
    told = ShownQuantities(folder)
    with pytest.raises(MdanimError, match=r"record block\.spin\.z"):
        told.curve(["block", "spin.z"])
    assert "spin" not in told.head()["arrows"] and "kinetic" in told.head()["words"]
    for wrong in ("block.speed", ["block", "distance"], ["nobody", "speed"], ["block", "colour"]):
        with pytest.raises(ValueError):  # noqa: PT011 -- it holds what was asked for
            told.curve(wrong)


def test_what_a_scene_shows_has_numbers_of_objects():
    """Also of names that stand for several objects; of a trajectory without them they are left out."""
    words = 'render { arrows contact scale 0.1  arrows force of b  trail b 1 s  label a "x"  caption "c" to 1 s  plot a.speed }'
    text = (
        SCENE.split("object shelf")[0].replace("object block", "object a")
        + "repeat i in 1 .. 2 { object b[i] { shape sphere 1 cm  position (i, 0, 1) m  density 1000  elasticity rigid } }\n"
    )
    render = parse_scene(text + "control { time 1 s }\n" + words).render
    told = shown(render, ("a", "b[1]", "b[2]"))
    assert told["arrows"] == [["contact", None, 0.1], ["force", [1, 2], None]] and told["plots"] == ["a.speed"]
    assert told["trails"] == [[1, 1.0], [2, 1.0]] and told["labels"] == [[[0], "x"]] and told["captions"] == [["c", None, 1.0]]
    assert shown(render, ("c",))["trails"] == []
    assert shown(render, ("b[1]", "a.piece[1]", "a.piece[2]"))["labels"] == [[[1, 2], "x"]]
