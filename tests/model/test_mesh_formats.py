# SPDX-License-Identifier: GPL-2.0-only
"""STL, OBJ and PLY as other programs write them: every form of one tetrahedron, and what messages say of damaged ones."""

import struct

import numpy as np
import pytest
from mdanim_lammps.model import mesh
from mdanim_lammps.model.mesh_formats import UnreadableMesh, read
from mdanim_lammps.scene.scene import Mesh
from model_samples import MESHES

SCENES = MESHES.parents[2] / "scenes"
POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]

V = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS)


def obj(corner, before=V) -> bytes:
    """An OBJ file; ``corner`` writes a corner from the number of its point, from 1."""
    return (before + "".join("f " + " ".join(corner(i + 1) for i in face) + "\n" for face in FACES)).encode()


def stl(form="{:g}", begin="solid", facet="facet normal 0 0 0", vertex="vertex", space="  ") -> bytes:
    """An STL file as text."""
    lines = [f"{begin} a name"]
    for face in FACES:
        corners = [f"{space}{vertex} " + " ".join(form.format(float(x)) for x in POINTS[i]) for i in face]
        lines += [f"{space}{facet}", "outer loop", *corners, "endloop", f"{space}endfacet"]
    return "\n".join([*lines, "endsolid"]).encode()


def stl_bytes(told=4, header=b"", more=b"") -> bytes:
    return (
        header.ljust(80)
        + struct.pack("<I", told)
        + b"".join(struct.pack("<12fH", 0, 0, 0, *(x for i in face for x in POINTS[i]), 0) for face in FACES)
        + more
    )


def ply(form: str, faces: list[str], rows: list[tuple], vertex=("float",) * 3, quads=FACES) -> bytes:
    """A PLY file with columns of faces (lines of the header) and what stands in them beside the corners, by column."""
    order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[form]
    kinds = {"float": "f", "double": "d", "int": "i", "uchar": "B", "short": "h", "uint": "I"}
    names = "".join(f"property {kind} {axis}\n" for kind, axis in zip(vertex, "xyz"))
    header = f"ply\nformat {form} 1.0\ncomment x\nelement vertex 4\n{names}element face {len(quads)}\n" + "".join(
        f"property {f}\n" for f in faces
    )
    body = [[(kind, x) for kind, x in zip(vertex, p)] for p in POINTS]
    for face, row in zip(quads, rows):
        values = []
        for column, given in zip(faces, row):
            words = column.split()
            given = list(face) if given is None else given
            if words[0] == "list":
                values += [(words[1], len(given)), *((words[2], x) for x in given)]
            else:
                values.append((words[0], given))
        body.append(values)
    if not order:
        return (header + "end_header\n" + "".join(" ".join(f"{x:g}" for _, x in row) + "\n" for row in body)).encode()
    return (header + "end_header\n").encode() + b"".join(struct.pack(order + kinds[kind], x) for row in body for kind, x in row)


CORNERS = "list uchar int vertex_indices"
TEXTURE = "list uchar float texcoord"
FORMS = ("ascii", "binary_little_endian", "binary_big_endian")

GOOD = {
    "plain.obj": obj(str),
    "texture.obj": obj("{0}/1".format, V + "vt 0 0\nvt 1 1\n"),
    "texture-not-there.obj": obj("{0}/9".format),
    "empty-texture.obj": obj("{0}/1/".format, V + "vt 0 0\n"),
    "slash.obj": obj("{0}/".format),
    "normals.obj": obj("{0}//1".format, V + "vn 0 0 1\n"),
    "all.obj": obj("{0}/1/1".format, V + "vt 0 0\nvn 0 0 1\n"),
    "backwards.obj": obj(lambda i: str(i - 5)),
    "indented.obj": obj(str).replace(b"v ", b"  v\t").replace(b"f ", b"\t f  "),
    "remarks.obj": obj(str).replace(b"\n", b" # a remark\n"),
    "material.obj": b"mtllib not-there.mtl\nusemtl\ng\no\ns off\n" + obj(str),
    "windows.obj": b"\xef\xbb\xbf" + obj(str).replace(b"\n", b"\r\n"),
    "old-mac.obj": obj(str).replace(b"\n", b"\r"),
    "continued.obj": obj(str).replace(b"f 1 ", b"f 1 \\\n"),
    "weights.obj": obj(str, V.replace("\n", " 1.0\n")),
    "exponents.obj": obj(str, V.replace(" 1", " +1.0E+000")),
    "fortran.obj": obj(str, V.replace(" 1", " 0.1D+01")),
    "old-faces.obj": obj(str).replace(b"f ", b"fo "),
    "faces-first.obj": obj(str, "") + V.encode(),
    "lines-and-points.obj": b"p 1\nl 1 2\ncurv 0 1 1 2\n" + obj(str),
    "plain.stl": stl(),
    "upper.stl": stl().upper(),
    "exponents.stl": stl("{:+.6E}"),
    "indented.stl": b"\n\t" + stl(space="\t\t").replace(b"\n", b"\r\n"),
    "no-name.stl": stl().replace(b"solid a name", b"solid"),
    "bytes.stl": stl_bytes(),
    "bytes-of-a-solid.stl": stl_bytes(header=b"solid facet vertex"),
    "more-bytes.stl": stl_bytes(more=b"\0" * 30),
    "more-bytes-of-a-solid.stl": stl_bytes(header=b"solid facet vertex", more=b"\0" * 30),
    **{f"{form}.ply": ply(form, [CORNERS], [(None,)] * 4) for form in FORMS},
    **{f"texture-{form}.ply": ply(form, [CORNERS, TEXTURE], [(None, [0.5] * 6)] * 4) for form in FORMS},
    **{f"texture-first-{form}.ply": ply(form, [TEXTURE, "uchar flags", CORNERS], [([0.5] * 6, 3, None)] * 4) for form in FORMS},
    **{
        f"uneven-{form}.ply": ply(form, [TEXTURE, CORNERS], [([], None), ([0.5] * 6, None), ([0.5] * 6, None), ([], None)])
        for form in FORMS
    },
    "double.ply": ply("binary_big_endian", ["list int uint vertex_index"], [(None,)] * 4, ("double", "float", "double")),
}


@pytest.mark.parametrize("name", GOOD)
def test_every_form_is_read(tmp_path, name):
    """Each is the same closed body."""
    (tmp_path / name).write_bytes(GOOD[name])
    found = read(GOOD[name], (tmp_path / name).suffix)
    np.testing.assert_array_equal(found.points[found.index].reshape(4, 3, 3), np.array(POINTS)[np.array(FACES)])


@pytest.mark.parametrize(
    ("prefix", "kind", "read_as"), [("", "uchar", [10, 20, 30]), ("diffuse_", "uchar", [10, 20, 30]), ("", "float", None)]
)
def test_colours_of_points_have_two_names(prefix, kind, read_as):
    """Colours that are not bytes are passed over: whether they end at 1 or at 255 is not told."""
    names = "".join(f"property {kind} {prefix}{name}\n" for name in ("red", "green", "blue"))
    text = GOOD["ascii.ply"].replace(b"property float z\n", b"property float z\n" + names.encode())
    for point in POINTS:
        row = " ".join(map(str, point)).encode() + b"\n"
        text = text.replace(b"\n" + row, b"\n" + row[:-1] + b" 10 20 30\n", 1)
    found = read(text, ".ply")
    np.testing.assert_array_equal(found.points[found.index].reshape(4, 3, 3), np.array(POINTS)[np.array(FACES)])
    assert found.color.tolist() == ([read_as] * 4 if read_as else [])


def test_points_are_as_fine_as_stl_has_them():
    """In every format: the same body is the same to the last bit."""
    assert read(GOOD["plain.obj"], ".obj").points.dtype == read(GOOD["double.ply"], ".ply").points.dtype == np.float32


@pytest.mark.parametrize("name", ["texture-not-there.obj", "upper.stl", "uneven-binary_little_endian.ply"])
def test_it_becomes_a_body(tmp_path, name):
    (tmp_path / name).write_bytes(GOOD[name])
    assert mesh.load(Mesh(tmp_path / name)).volume == pytest.approx(1 / 6)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.obj", obj(str).replace(b"f 1 3 2", b"f 1 3 7"), "line 5: names point 7, there are 4"),
        ("a.obj", obj(str).replace(b"f 1 3 2", b"f 0 3 2"), "line 5: names point 0, there are 4"),
        ("a.obj", obj(str).replace(b"f 1 2 4", b"f 1 2 7"), "line 6: names point 7, there are 4"),
        ("a.obj", obj(str).replace(b"f 1 3 2", b"f 1 x/2 2"), "line 5: 'x/2' is not a corner of a face"),
        ("a.obj", obj(str).replace(b"v 1 0 0", b"v 1 0"), "line 2: a point has three numbers, found 2"),
        ("a.obj", obj(str).replace(b"v 1 0 0", b"v 0,5 0 0"), "line 2: '0,5' is not a number"),
        ("a.obj", obj(str).replace(b"v 1 0 0", b"v 1 0 \x1b[31m"), r"line 2: '\?\[31m' is not a number"),
        ("a.obj", b"\x01\x02\x03", "has no point"),
        ("a.stl", stl_bytes(99), "it declares 99 triangles and has bytes for 4"),
        ("a.stl", stl_bytes(5), "it declares 5 triangles and has bytes for 4"),
        ("a.stl", stl().replace(b"outer loop", b"", 1), "line 4: a vertex has three numbers and stands between"),
        ("a.stl", stl_bytes()[:200], "it declares 4 triangles and has bytes for 2"),
        ("a.stl", b"short", "too short"),
        ("a.stl", stl().replace(b"vertex 1 0 0", b"vertex 1 0", 1), "line 6: a vertex has three numbers"),
        ("a.stl", stl().replace(b"vertex 1 0 0", b"vertex 1 y 0", 1), "line 6: 'y' is not a number"),
        ("a.stl", stl().replace(b"endloop", b"enddloop", 1), "line 7: 'enddloop' is not a word of an STL file"),
        ("a.stl", stl().rsplit(b"endloop", 1)[0], "it ends inside of a triangle"),
        ("a.ply", GOOD["ascii.ply"].replace(b"vertex 4", b"vertex -4"), "line 4: 'element vertex -4' is not a line"),
        ("a.ply", GOOD["ascii.ply"].replace(b"float x", b"float80 x"), "line 5: 'property float80 x' is not a line"),
        ("a.ply", GOOD["ascii.ply"].replace(b"float x", b"float w"), "no element 'vertex' with x, y and z"),
        ("a.ply", GOOD["ascii.ply"].replace(b"3 0 2 1", b"3 0 2 9"), "face 1: names point 9, there are 4"),
        ("a.ply", GOOD["ascii.ply"].replace(b"3 0 1 3", b"3 0 1 9"), "face 2: names point 9, there are 4"),
        ("a.ply", GOOD["ascii.ply"].replace(b"3 0 2 1", b"-1"), "line 15: is too short for a row of 'face'"),
        ("a.ply", GOOD["ascii.ply"].replace(b"3 0 2 1", b"3 0 2"), "line 15: is too short for a row of 'face'"),
        ("a.ply", GOOD["ascii.ply"].replace(b"face 4", b"face 9"), "it declares 9 rows of 'face' and has 4"),
        ("a.ply", GOOD["binary_big_endian.ply"][:-5], "it declares 4 rows of 'face' and has 3"),
        (
            "a.ply",
            GOOD["binary_big_endian.ply"].replace(b"vertex 4", b"vertex 99999999999"),
            "declares 99999999999 rows of 'vertex'",
        ),
        ("a.ply", b"plyx\n", "does not begin with the header"),
    ],
)
def test_messages_name_the_place(tmp_path, name, content, words):
    with pytest.raises(UnreadableMesh, match=words):
        read(content, name[-4:])
    (tmp_path / name).write_bytes(content)
    with pytest.raises(mesh.MeshError, match=words) as caught:
        mesh.load(Mesh(tmp_path / name))
    assert "export it again" in caught.value.hint


@pytest.mark.parametrize("name", ["boat.stl", "bottle.stl", "duck.ply", "knot.ply", "mixed.obj", "two-parts.obj"])
def test_files_are_read_as_vtk_reads_them(name):
    """Points, polygons and colours, bit by bit; VTK merges equal points of an STL file while it reads."""
    import pyvista

    path = next(folder / name for folder in (SCENES / "meshes", MESHES) if (folder / name).exists())
    found, theirs = read(path.read_bytes(), path.suffix), pyvista.read(path)
    cells = theirs.GetPolys()
    from vtkmodules.util.numpy_support import vtk_to_numpy

    first, index = vtk_to_numpy(cells.GetOffsetsArray()), vtk_to_numpy(cells.GetConnectivityArray())
    np.testing.assert_array_equal(found.count, np.diff(first))
    np.testing.assert_array_equal(found.points[found.index], theirs.points[index])
    if len(found.color):
        np.testing.assert_array_equal(found.color, theirs.point_data["RGB"])
