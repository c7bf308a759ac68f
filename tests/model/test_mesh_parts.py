# SPDX-License-Identifier: GPL-2.0-only
"""Parts of a mesh file, by name and number, and what messages say of them; files of any form hold what was written."""

import random
import struct

import numpy as np
import pytest
from mdanim_lammps import Scene, SceneError
from mdanim_lammps.model import mesh
from mdanim_lammps.model.mesh_formats import read
from mdanim_lammps.model.mesh_parts import pieces
from mdanim_lammps.model.orientation import MeshError
from mdanim_lammps.model.triangles import volume_and_centre
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.scene.scene import Mesh
from model_samples import MESHES

CUBE = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
CORNERS = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)


def boxes(*places) -> tuple[np.ndarray, list]:
    """Unit cubes at places along x: points and faces."""
    points = np.concatenate([CORNERS + (x, 0, 0) for x in places])
    return points, [[[8 * k + i for i in face] for face in CUBE] for k in range(len(places))]


def obj(heads, places=(0, 3, 9)) -> str:
    points, bodies = boxes(*places)
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in points)
    for head, body in zip(heads, bodies):
        text += head + "".join("f " + " ".join(str(i + 1) for i in face) + "\n" for face in body)
    return text


def stl(heads, places=(0, 3, 9)) -> str:
    points, bodies = boxes(*places)
    text = ""
    for head, body in zip(heads, bodies):
        text += f"{head}\n"
        for a, b, c, d in body:
            for face in ((a, b, c), (a, c, d)):
                rows = "".join("vertex {} {} {}\n".format(*points[i]) for i in face)
                text += f"facet normal 0 0 0\nouter loop\n{rows}endloop\nendfacet\n"
        text += "endsolid\n"
    return text


FILES = {
    "objects.obj": (obj(["o body\ng all\n", "o left wheel\n", "o right wheel\n"]), ["body", "left wheel", "right wheel"]),
    "groups.obj": (obj(["o car\ng body\n", "g left  wheel\n", "g right\tw\n"]), ["body", "left wheel", "right w"]),
    "again.obj": (obj(["g body\n", "g wheels\n", "g body\n"]), ["body", "wheels"]),
    "one-name.obj": (obj(["o all\n", "", ""]), []),
    "names.stl": (stl(["solid body", "SOLID left wheel", "solid "]), ["body", "left wheel", "3"]),
    "no-names.stl": (stl(["solid", "solid", "solid"]), ["1", "2", "3"]),
}


@pytest.mark.parametrize("name", FILES)
def test_parts_are_bodies_where_the_file_has_them(tmp_path, name):
    """Each by its number, and by its name where it has one; the middle of the cube is where it was in the file."""
    path = tmp_path / name
    path.write_text(FILES[name][0])
    names = FILES[name][1]
    assert mesh.read_file(path)[3] == tuple(names)
    found = [volume_and_centre(*mesh.read_file(path, k)[:2]) for k in range(1, (len(names) or 3) + 1)]
    for part, (volume, _) in zip(names, found):
        assert volume_and_centre(*mesh.read_file(path, part)[:2])[0] == volume
    if len(found) == 3:
        np.testing.assert_allclose([c for _, c in found], [(0.5, 0.5, 0.5), (3.5, 0.5, 0.5), (9.5, 0.5, 0.5)], atol=1e-6)
    else:
        assert [volume for volume, _ in found] == pytest.approx([2.0, 1.0])


def test_a_part_that_touches_others_is_a_body(tmp_path):
    """Three cubes side by side share corners, so that all of them together are not a closed surface; each one is."""
    path = tmp_path / "row.obj"
    path.write_text(obj(["o a\n", "o b\n", "o c\n"], (0, 1, 2)))
    with pytest.raises(MeshError, match="more than two triangles"):
        mesh.load(Mesh(path))
    assert [volume_and_centre(*mesh.read_file(path, part)[:2])[0] for part in ("a", "b", 3)] == pytest.approx([1.0] * 3)


@pytest.mark.parametrize(
    ("name", "part", "cause", "hint"),
    [
        (
            "objects.obj",
            "bdoy",
            'has no part "bdoy"',
            """did you mean 'body'? its parts are "body", "left wheel", "right wheel\"""",
        ),
        ("objects.obj", 4, "has no part 4", 'its parts are "body", "left wheel", "right wheel"'),
        ("one-name.obj", 4, "has no part 4", "3 pieces that do not hang together, part 1 to part 3"),
        ("one-name.obj", "all", 'has no part "all"', "the file names no parts"),
    ],
)
def test_a_part_that_is_not_there(tmp_path, name, part, cause, hint):
    (tmp_path / name).write_text(FILES[name][0])
    with pytest.raises(MeshError, match=cause) as error:
        mesh.read_file(tmp_path / name, part)
    assert hint in error.value.hint


def test_parts_that_are_not_there_are_told_with_other_problems(tmp_path):
    """Beside a file that is not there, and a number that is none."""
    (tmp_path / "cube.obj").write_text((MESHES / "cuboid.obj").read_text())
    names = {"a": 'mesh "cube.obj" part 7', "b": 'mesh "gone.obj"', "c": 'mesh "cube.obj" part 0'}
    objects = "".join(f"object {n} {{ shape {s}  position (0, 0, 0) m  hold all }}\n" for n, s in names.items())
    (tmp_path / "s.txt").write_text(f"{objects}control {{ time 1 s }}\n")
    with pytest.raises(SceneError) as told:
        load_scene(tmp_path / "s.txt")
    for words in ("has no part 7", "gone.obj' is not there", "a whole number from 1 on, found 0"):
        assert words in str(told.value)


def test_pieces_are_numbered_in_the_order_of_the_file():
    """Triangles in any order, of which some touch in a point only: those are one piece."""
    triangles = np.array([[7, 8, 9], [0, 1, 2], [8, 10, 11], [3, 2, 4], [5, 6, 12]])
    assert pieces(np.zeros((13, 3)), triangles).tolist() == [0, 1, 0, 1, 2]


SCENE = """ground z 0 m  gravity (0, 0, -9.81) m/s^2
object a {{ shape mesh "objects.obj" {part} scale 0.1  origin file  density 500 kg/m^3  elasticity rigid }}
control {{ time 1 s }}"""


def test_a_scene_has_a_part_of_a_file(tmp_path):
    """In words and in the lock; `check` names the parts of a file of which all are one object."""
    (tmp_path / "objects.obj").write_text(FILES["objects.obj"][0])
    for part, taken in (('part "left wheel"', "left wheel"), ("part 1 + 1", 2)):
        ready = Scene.from_text(SCENE.format(part=part), folder=tmp_path).prepared
        assert ready.scene.solids[0].shape.part == taken
        assert part.replace("1 + 1", "2") in ready.lock
        np.testing.assert_allclose(ready.scene.solids[0].position, (0.35, 0.05, 0.05), atol=1e-7)
        assert not [note for note in ready.certificate.notes if "parts" in note.message]
    notes = Scene.from_text(SCENE.format(part=""), folder=tmp_path).prepared.certificate.notes
    assert any('3 parts, which are one object: "body", "left wheel", "right wheel"' in note.message for note in notes)
    with pytest.raises(SceneError, match=r"a whole number from 1 on, found 1\.5"):
        Scene.from_text(SCENE.format(part="part 1.5"), folder=tmp_path)


def test_only_rigid_bodies_may_be_in_several_pieces(tmp_path):
    """An elastic one would fall apart: the message says how each piece is an object."""
    (tmp_path / "objects.obj").write_text(FILES["objects.obj"][0])
    assert Scene.from_text(SCENE.format(part=""), folder=tmp_path).prepared.system.particles == 8
    elastic = Scene.from_text(SCENE.format(part="").replace("rigid", "1 MPa  resolution 5 cm"), folder=tmp_path)
    with pytest.raises(SceneError, match="its cells are not in one piece") as error:
        elastic.prepared  # noqa: B018
    assert "an object for each, part 1 to part 3 with origin file" in error.value.problems[0].hint


# --- any file ------------------------------------------------------------------------------------------------------------


def polygons(draw: random.Random) -> tuple[np.ndarray, list[list[int]]]:
    """Points with coordinates that every format keeps, and polygons of three to seven of them."""
    many = draw.randint(3, 40)
    points = np.array([[np.float32(draw.uniform(-1, 1) * 10 ** draw.randint(-6, 6)) for _ in range(3)] for _ in range(many)])
    faces = [draw.sample(range(many), min(many, draw.randint(3, 7))) for _ in range(draw.randint(1, 30))]
    return points, faces


def any_obj(draw: random.Random, points, faces) -> bytes:
    """Any form that the format allows."""
    end = draw.choice(["\n", "\r\n"])
    odd = ["# a remark", "", "vt 0.5 0.5", "vn 0 0 1", "g some group", "s off", "usemtl stone", "l 1 2", "p 1"]
    lines = ["vt 0 0", "vn 0 0 1"]
    weights = ["", " 1", " 0.1 1 0"]
    lines += ["v " + " ".join(f"{x:.9{draw.choice('eEg')}}" for x in point) + draw.choice(weights) for point in points]
    for face in faces:
        tail = draw.choice(["", "/1", "//1", "/1/1"])
        corners = [f"{i + 1 if draw.random() < 0.5 else i - len(points)}{tail}" for i in face]
        lines.append(" ".join(["f", corners[0], draw.choice([corners[1], f"\\{end}{corners[1]}"]), *corners[2:]]))
        if draw.random() < 0.3:
            lines.append(draw.choice(odd))
    return end.join(lines).encode() + draw.choice([b"", end.encode()])


def any_ply(draw: random.Random, points, faces) -> bytes:
    """The same, with elements and columns that are not asked for."""
    form = draw.choice(["ascii", "binary_little_endian", "binary_big_endian"])
    order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[form]
    real, whole, many = (
        draw.choice(["float", "float32", "double"]),
        draw.choice(["int", "uint32", "ushort"]),
        draw.choice(["uchar", "int"]),
    )
    codes = {"float": "f", "float32": "f", "double": "d", "int": "i", "uint32": "I", "ushort": "H", "uchar": "B", "short": "h"}
    more = draw.random() < 0.5
    head = f"ply\nformat {form} 1.0\ncomment x\nelement vertex {len(points)}\n"
    head += "".join(f"property {real} {axis}\n" for axis in "xyz") + "property short quality\n" * more
    head += "element other 2\nproperty list uchar short of\nproperty double at\n" * more
    name = draw.choice(["vertex_indices", "vertex_index"])
    head += f"element face {len(faces)}\n" + "property uchar flag\n" * more + f"property list {many} {whole} {name}\nend_header\n"
    rows = [[*((real, x) for x in point), *([("short", -3)] * more)] for point in points]
    rows += [[("uchar", 2), ("short", 1), ("short", 2), ("double", 0.5)], [("uchar", 0), ("double", 1e9)]] * more
    rows += [[*([("uchar", 1)] * more), (many, len(face)), *((whole, i) for i in face)] for face in faces]
    if not order:
        return head.encode() + "".join(" ".join(f"{x:.9g}" for _, x in row) + "\n" for row in rows).encode()
    return head.encode() + b"".join(struct.pack(order + codes[kind], x) for row in rows for kind, x in row)


def any_stl(draw: random.Random, points, faces) -> bytes:
    """Text of one or several solids, or bytes, perhaps of which the name begins as text does."""
    if draw.random() < 0.5:
        head = draw.choice([b"solid of bytes", b"a part"]).ljust(80)
        rows = (struct.pack("<12fH", 0, 0, 0, *points[face].ravel(), draw.choice([0, 7])) for face in faces)
        return head + struct.pack("<I", len(faces)) + b"".join(rows)
    lines = ["solid a"]
    for face in faces:
        if draw.random() < 0.1:
            lines += ["endsolid a", "solid b"]
        corners = [" ".join(["vertex", *(f"{x:.9{draw.choice('eE')}}" for x in points[i])]) for i in face]
        lines += ["facet normal 0 0 1", "  outer loop", *corners, "endloop", "endfacet"]
    text = draw.choice(["\n", "\r\n"]).join([*lines, "endsolid"])
    return (text.upper() if draw.random() < 0.3 else text).encode()


@pytest.mark.parametrize(("kind", "written"), [(".obj", any_obj), (".ply", any_ply), (".stl", any_stl)])
def test_any_file_is_what_was_written(kind, written):
    """Corners of all polygons in order, of 60 files each, in forms chosen at random."""
    for seed in range(60):
        draw = random.Random(f"{kind}{seed}")
        points, faces = polygons(draw)
        faces = [face[:3] for face in faces] if kind == ".stl" else faces
        found = read(written(draw, points, faces), kind)
        assert found.count.tolist() == [len(face) for face in faces], seed
        np.testing.assert_array_equal(found.points[found.index], points[np.concatenate(faces)].astype(np.float32), str(seed))


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_a_file_without_faces_is_read(form):
    """A scan before anything was scanned: what is read is empty, and told as that."""
    head = f"ply\nformat {form} 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
    found = read((head + "element face 0\nproperty list uchar int vertex_indices\nend_header\n").encode(), ".ply")
    assert found.points.shape == (0, 3) and len(found.count) == len(found.index) == 0


def test_a_concave_polygon_is_one_face(tmp_path):
    """A prism over an L, whose ends have six corners, of which one points inward."""
    outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)]
    text = "".join(f"v {x} {y} {z}\n" for z in (0, 1) for x, y in outline) + "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n"
    text += "".join(f"f {k + 1} {(k + 1) % 6 + 1} {(k + 1) % 6 + 7} {k + 7}\n" for k in range(6))
    (tmp_path / "l.obj").write_text(text)
    assert mesh.load(Mesh(tmp_path / "l.obj")).volume == pytest.approx(4.0)
