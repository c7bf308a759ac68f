# SPDX-License-Identifier: GPL-2.0-only
"""Meshes that stay where their file has them."""

import numpy as np
import pytest
from mdanim_lammps import Scene, SceneError
from mdanim_lammps.model import shapes
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.scene import Box

AT = np.array([3.0, -2.0, 5.0])
"""Centre of a box in its file."""


@pytest.fixture
def scene(tmp_path):
    """Read an object with these settings, in the group around it if there is one."""
    import pyvista

    points, triangles = shapes.surface(Box((1.0, 2.0, 4.0)), 10.0)
    pyvista.PolyData.from_regular_faces(points + AT, triangles).save(tmp_path / "box.stl")

    def read(settings: str, shape='mesh "box.stl"', group="") -> Scene:
        text = f"object box {{ shape {shape}\n density 500 kg/m^3 elasticity rigid\n {settings} }}\n"
        if group:
            text = f"group g {{\n{text}}}\nplace g {{ {group} }}\n"
        (tmp_path / "a.txt").write_text(text + "control { time 1 s }\n")
        return Scene.load(tmp_path / "a.txt")

    return read


def test_it_stays_where_the_file_has_it(scene):
    """Also at a scale."""
    assert scene("origin file").record.solids[0].position == pytest.approx(AT)
    shape = 'solid "box.stl" scale 0.01'
    assert scene("origin file", shape).record.solids[0].position == pytest.approx(0.01 * AT)
    assert scene("origin centre position (1, 2, 3) m").record.solids[0].position == (1.0, 2.0, 3.0)


def test_the_origin_of_the_file_is_placed_and_turned_about(scene):
    """A quarter about z takes x to y and y to -x."""
    solid = scene("origin file position (10, 0, 0) m orientation axis (0, 0, 1) angle 90 deg").record.solids[0]
    assert solid.position == pytest.approx((10.0 + 2.0, 3.0, 5.0))


def test_a_group_moves_the_whole(scene):
    """Its spin gives the centre of mass W x r."""
    solid = scene("origin file", group="position (0, 0, 1) m spin (0, 0, 2) rad/s").record.solids[0]
    assert solid.position == pytest.approx((3.0, -2.0, 6.0))
    assert solid.velocity == pytest.approx((4.0, 6.0, 0.0))


def test_the_text_of_a_scene_has_the_position(scene):
    """Read back, it is not shifted again."""
    record = scene("origin file").record
    again = parse_scene(lock_text(record), record.name)
    assert again.solids[0].position == record.solids[0].position and "origin" not in lock_text(record)


@pytest.mark.parametrize(("shape", "message"), [
    ("box (1, 1, 1) m", "origin file is for a mesh or a solid"),
    ('mesh "other.stl"', "the mesh file 'other.stl' is not there"),
    ("sphere -1 m", "must be"),
])  # fmt: skip
def test_one_message_for_one_mistake(scene, shape, message):
    """A missing position follows from it."""
    with pytest.raises(SceneError) as caught:
        scene("origin file", shape)
    assert message in str(caught.value) and len(caught.value.problems) == 1


def test_the_unit_of_a_large_mesh_is_asked_about(scene, tmp_path):
    """With the scale of the units that files often have; before the error that its size brings."""
    import pyvista

    assert not scene("origin file").record.warnings
    box = pyvista.read(tmp_path / "box.stl")
    box.points *= 10.0
    box.save(tmp_path / "large.stl")
    (told,) = scene("origin file", 'mesh "large.stl"').record.warnings
    assert told.message == "box is 40 m long if the unit of its file is a metre"
    assert "scale 0.001 if it is a millimetre, 4 cm or scale 0.01 if it is a centimetre, 40 cm" in told.hint
    assert not scene("origin file", 'mesh "large.stl" scale 0.01').record.warnings
    text = 'ground z 0\nobject box { shape mesh "large.stl" density 1 elasticity rigid position (0, 0, 1) }\n'
    low = parse_scene(text + "control { time 1 s }\n", folder=tmp_path)
    with pytest.raises(SceneError, match=r"(?s)if the unit of its file.*below the ground"):
        prepare(low)
