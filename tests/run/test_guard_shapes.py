# SPDX-License-Identifier: GPL-2.0-only
"""The guard tells rigid objects that lie on each other from those that are in each other, whatever the boxes around them say."""

from unittest.mock import Mock

import numpy as np
import pytest
import rigid_meshes
from mdanim_lammps import Trajectory
from mdanim_lammps.engine.geometry import Geometry
from mdanim_lammps.engine.hosts import Hosts
from mdanim_lammps.model import mesh
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.scene.scene import Mesh

SCENE = """gravity (0, 0, -9.81) m/s^2
object a {{ shape {a}  position (0, 0, 0) m  density 1000  elasticity rigid {turn_a} }}
object b {{ shape {b}  position ({x!r}, {y!r}, {z!r}) m  density 1000  elasticity rigid {turn_b} }}
control {{ time 0.1 s }}
"""
CORNER = np.array([1.0, 1.0, 1.0]) / 3**0.5
SIDE = np.array([1.0, 1.0, 0.0]) / 2**0.5
TO_CORNER = "orientation axis (-1, 1, 0) angle 54.735610317245346 deg"
TO_SIDE = "orientation axis (0, 0, 1) angle 45 deg"


def write(path, points, triangles):
    """A mesh as a file."""
    lines = [*(f"v {x} {y} {z}" for x, y, z in points.tolist()), *(f"f {a} {b} {c}" for a, b, c in (triangles + 1).tolist())]
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture
def wedge(tmp_path):
    """Half of a cube of 10 cm, cut along a diagonal of its sides; its centre is a third of an edge from both square sides."""
    points, triangles = rigid_meshes.profile([(0, 0), (0.1, 0), (0, 0.1)], 0.1)
    write(tmp_path / "wedge.obj", points, triangles)
    return f'mesh "{tmp_path}/wedge.obj" scale 1'


def look(prepared, a, b, at, moved, turn_a="", turn_b=""):
    """Objects that the guard finds in each other: as they are, and with the second one moved."""
    x, y, z = map(float, at)
    ready = prepared(SCENE.format(a=a, b=b, x=x, y=y, z=z, turn_a=turn_a, turn_b=turn_b))
    assert len(ready.system.position) == 16 and len(ready.system.hexahedron) == 2
    x, geometry = ready.system.position.copy(), Geometry(ready.system)
    found = geometry.sunk(x)
    x[8:] += moved
    return found, geometry.sunk(x)


@pytest.mark.parametrize(
    ("a", "b", "way", "apart", "turn_a", "turn_b"),
    [
        pytest.param("sphere 10 cm", "box (4, 4, 1) cm", CORNER, 0.105, "", TO_CORNER, id="a plate at a ball"),
        pytest.param("ellipsoid (10, 11, 12) cm", "ellipsoid (4, 4, 1) cm", CORNER, 0.121, "", TO_CORNER, id="ellipsoids"),
        pytest.param("cylinder 10 cm 10 cm", "box (1, 4, 4) cm", SIDE, 0.105, "", TO_SIDE, id="a plate at a cylinder"),
    ],
)
def test_what_touches_a_round_side_is_not_in_it(prepared, a, b, way, apart, turn_a, turn_b):
    """Objects that touch where the box around one has a corner: found only once one is moved to the middle of the other."""
    at = way * apart
    before, after = look(prepared, a, b, at, -0.9 * at, turn_a, turn_b)
    assert before is None and set(after or ()) == {0, 1}


def test_a_board_at_a_ball_of_few_cells_is_not_in_it(prepared, monkeypatch):
    """Cells of the ball reach 3.7 cm beyond it in this direction, and the board is 4 cm thick: it rose below a ball that floats,
    and its run was stopped. Ctrl-C during the look at the surface, which C code asks for, is not lost."""
    way = np.array([1.0, 1.0, 2.0]) / 6**0.5
    at = (0.172 * way).tolist()
    text = f"""object ball {{ shape sphere 15 cm  density 60  elasticity 50 kPa  position (0, 0, 0) m }}
    object board {{ shape box (60, 20, 4) cm  density 700  elasticity rigid  position ({at[0]}, {at[1]}, {at[2]}) m
      orientation axis (-1, 1, 0) angle 35.26438968 deg }}
    control {{ time 0.1 s  resolution 7.5 cm }}
    """
    system = prepared(text).system
    x, geometry = system.position.copy(), Geometry(system)
    found = []
    for sunk in (0.0, 0.03, 0.06):
        x[system.first[1] :] = system.position[system.first[1] :] - sunk * way
        found.append(geometry.sunk(x))
    assert found == [None, None, (1, 0)]
    monkeypatch.setattr(Hosts, "holds_centre", Mock(side_effect=KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        geometry.sunk(x)


def test_wedges_on_each_other(prepared, wedge):
    """Their centres are a third of an edge apart in the cube that both fill; each is in the box around the other."""
    at = np.array([0.1 / 3, 0.0, 0.1 / 3]) * 1.001
    before, after = look(prepared, wedge, wedge, at, -0.6 * at, turn_b="orientation axis (0, 1, 0) angle 180 deg")
    assert before is None and set(after or ()) == {0, 1}


def test_wedges_stay_on_each_other(prepared, wedge, tmp_path):
    """They lie on the ground as a block, and the guard says nothing."""
    text = f"""gravity (0, 0, -9.81) m/s^2
    ground z 0 m
    object a {{ shape {wedge}  density 300  elasticity rigid  position (0, 0, 0.0334) m  friction 0.5 }}
    object b {{ shape {wedge}  density 300  elasticity rigid  position (0.034, 0, 0.068) m
      orientation axis (0, 1, 0) angle 180 deg  friction 0.5 }}
    control {{ time 0.1 s }}
    """
    (tmp_path / "r.out").mkdir()
    simulate(prepared(text), tmp_path / "r.out")
    with Trajectory(tmp_path / "r.out" / "trajectory.h5") as trajectory:
        assert trajectory.centers[-1, 1, 2] == pytest.approx(0.2 / 3, abs=1e-3) and trajectory.times[-1] == pytest.approx(0.1)


@pytest.mark.parametrize(("size", "pieces"), [((20, 10, 10), 4), ((20, 10, 10), 5), ((10, 10, 20), 4)])
def test_pieces_are_not_in_each_other(prepared, size, pieces):
    """Long boxes of few pieces, whose neighbours have their centres in the boxes around each other."""
    text = f"""gravity (0, 0, -9.81) m/s^2
    ground z 0 m
    object v {{ shape box {size} cm  density 300  elasticity rigid  position (0, 0, 0.2) m  pieces {pieces}  strength 50 MPa }}
    control {{ time 0.1 s }}
    """
    system = prepared(text).system
    assert len(system.hexahedron) == pieces and Geometry(system).sunk(system.position) is None


HELD, FREE = "hold all", "mass 9 kg elasticity rigid"
OTHERS = {
    "elastic": "box (6, 6, 6) cm {at}  density 300  elasticity 1 MPa  resolution 2 cm",
    "rigid": "box (6, 6, 6) cm {at}  density 300  elasticity rigid",
    "ring": "torus 10 cm 2 cm {at}  density 300  elasticity rigid",
}


@pytest.mark.parametrize(("other", "held"), [("elastic", HELD), ("rigid", HELD), ("ring", HELD), ("rigid", FREE)])
def test_what_is_in_a_body_without_cells(prepared, tmp_path, other, held):
    """A trough, held or rigid: an object in its hollow, or that lies on its rim, is not in it; one in its wall is. The centre of
    a ring is in nothing."""
    outline = [(0.0, 0.0), (0.3, 0.0), (0.3, 0.3), (0.2, 0.3), (0.2, 0.1), (0.1, 0.1), (0.1, 0.3), (0.0, 0.3)]
    points, triangles = rigid_meshes.profile(outline, 0.3)
    write(tmp_path / "trough.obj", points, triangles)
    place = "({}, {}, {}) m".format(*mesh.load(Mesh(tmp_path / "trough.obj")).centre.tolist())
    text = f"""object trough {{ shape mesh "{tmp_path}/trough.obj"  position {place}  {held} }}
    object it {{ shape {OTHERS[other].format(at="position (0, 0, 2) m")} }}
    control {{ time 0.1 s }}
    """
    system = prepared(text).system
    x, geometry = system.position.copy(), Geometry(system)
    assert np.diff(geometry.first_cell)[0] == 0
    found = []
    for at in ((0.15, 0.0, 0.2), (0.05, 0.0, 0.33), (0.05, 0.0, 0.2), (0.15, 0.0, 0.05)):
        x[8:] = system.position[8:] - (0, 0, 2) + at
        found.append(geometry.sunk(x))
    inside = None if other == "ring" else (1, 0)
    assert found == [None, None, inside, inside]
