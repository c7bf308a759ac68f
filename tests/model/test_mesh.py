# SPDX-License-Identifier: GPL-2.0-only
"""Meshes from files: what is accepted, what is refused and why, and points inside."""

import os
import re
import sys

import numpy as np
import pytest
from mdanim_lammps.model import mesh, mesh_contents, mesh_reader, shapes
from mdanim_lammps.model.cells import fill_cells
from mdanim_lammps.model.crossings import crossings
from mdanim_lammps.model.mesh_formats import UnreadableMesh
from mdanim_lammps.scene.scene import Box, Mesh, Sphere, Torus
from model_samples import MESHES, assert_closed, enclosed_volume

SCENES = MESHES.parents[2] / "scenes"


def written(tmp_path, shape, size=0.1, suffix=".stl"):
    """A shape's surface as a mesh file."""
    import pyvista

    points, triangles = shapes.surface(shape, size)
    path = tmp_path / f"shape{suffix}"
    pyvista.PolyData.from_regular_faces(points, triangles).save(path)
    return Mesh(path)


@pytest.mark.parametrize("name", ["cuboid.obj", "inside-out.obj", "mixed.obj"])
def test_triangles_are_turned_outward(name):
    """Accept any orientation of a closed surface and give the same body."""
    body = mesh.load(Mesh(MESHES / name, 0.1))
    assert body.volume == pytest.approx(0.024)
    assert_closed(body.triangles)
    assert enclosed_volume(body.points, body.triangles) == pytest.approx(0.024)
    np.testing.assert_allclose(body.points.max(axis=0), [0.2, 0.15, 0.1])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        pytest.param("open.obj", ("not closed", "3 edges", "fill"), id="a triangle is missing"),
        pytest.param("fin.obj", ("not closed", "2 edges"), id="a fin of no thickness"),
        pytest.param("missing.stl", ("No such file", "folder of the scene"), id="no such file"),
        pytest.param("make_meshes.py", ("unknown kind of file '.py'", "STL, OBJ or PLY"), id="not a mesh"),
    ],
)
def test_files_that_are_no_body_are_refused(name, words):
    """Say what is wrong with the file, and what to do."""
    with pytest.raises(mesh.MeshError) as caught:
        mesh.load(Mesh(MESHES / name))
    text = f"{caught.value} {caught.value.hint}"
    assert all(word in text for word in words), text


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("empty.stl", b"", "mesh empty.stl"),
        ("noise.ply", b"\x00\x01 no mesh at all", "mesh noise.ply"),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n", "holds no triangle"),
        ("sheet.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n", "encloses no volume"),
        (
            "three.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 1\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"
            b"f 2 3 4\nf 3 1 4\nf 2 3 5\nf 3 1 5\nf 2 4 5\nf 4 1 5\n",
            "more than two triangles",
        ),
    ],
)
def test_broken_files_are_refused(tmp_path, name, content, words):
    """Raise MeshError, and nothing else, for files that hold no body."""
    (tmp_path / name).write_bytes(content)
    with pytest.raises(mesh.MeshError, match=words):
        mesh.load(Mesh(tmp_path / name))


HEADER = (
    "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
    "element face {}\nproperty list uchar int vertex_indices\nend_header\n"
)
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], "<f4").tobytes()
FACES = b"".join(b"\x03" + np.array(f, "<i4").tobytes() for f in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)))


def ply(vertices: int, faces: int, data: bytes, form: str = "binary_little_endian") -> bytes:
    """A PLY file that says that it has so many vertices and faces."""
    return HEADER.format(form, vertices, faces).encode() + data


@pytest.mark.usefixtures("meshes_read_apart")
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("vertices.ply", ply(99_999_999_999, 4, CORNERS + FACES)),
        ("many.ply", ply(2_000_000_000, 4, CORNERS + FACES)),
        ("ascii.ply", ply(2_000_000_000, 1, b"0 0 0\n", "ascii")),
        ("faces.ply", ply(4, 2_000_000_000, CORNERS + FACES)),
        ("negative.ply", ply(-4, 4, CORNERS + FACES)),
        ("header.ply", ply(4, 4, b"")),
        ("half.ply", ply(4, 4, CORNERS[:20])),
        ("index.ply", ply(4, 4, CORNERS + FACES.replace(b"\x03\0\0\0", b"\xff\xff\xff\x3f"))),
        ("triangles.stl", b"\0" * 80 + b"\x28\0\0\0" + b"\0" * 70),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999\n"),
    ],
)
def test_damaged_files_do_not_end_the_program(tmp_path, name, content):
    """Readers of other programs end on most of these: the message names the file and a way out."""
    (tmp_path / name).write_bytes(content)
    with pytest.raises(mesh.MeshError, match=name) as caught:
        mesh.load(Mesh(tmp_path / name))
    assert "export it again" in caught.value.hint


def test_texture_that_is_not_there_is_passed_over(tmp_path):
    """A corner may name texture that the file lacks, which ended the program: the message is that of an open surface."""
    (tmp_path / "texture.obj").write_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/9 2/9 3/9\n")
    with pytest.raises(mesh.MeshError, match=r"texture\.obj: not closed, 3 edges belong to one triangle only") as caught:
        mesh.load(Mesh(tmp_path / "texture.obj"))
    assert "fill its holes" in caught.value.hint


def test_an_undamaged_file_of_that_kind_is_read(tmp_path):
    """The tetrahedron that the damaged files above are made from."""
    (tmp_path / "whole.ply").write_bytes(ply(4, 4, CORNERS + FACES))
    assert mesh.load(Mesh(tmp_path / "whole.ply")).volume == pytest.approx(1 / 6)


@pytest.mark.parametrize("channels", [0, 3, 4])
def test_a_file_may_have_colours(tmp_path, channels):
    """Colours of its points, with or without opacity; new points take that of the nearest one, and a file without has none."""
    import pyvista

    points, triangles = shapes.surface(Sphere(0.1), 0.02)
    body, given = pyvista.PolyData.from_regular_faces(points, triangles), np.full((len(points), channels or 3), 7, np.uint8)
    given[points[:, 0] > 0.0, :3] = (200, 100, 50)
    body["paint"] = given
    body.save(tmp_path / "ball.ply", texture="paint" if channels else None)
    read = mesh.load(Mesh(tmp_path / "ball.ply"))
    where = np.array([[0.09, 0.0, 0.01], [-0.09, 0.0, 0.01]])
    found = mesh.colors_at(read, where)
    if channels == 0:
        assert read.color is None and found is None
    else:
        assert found.tolist() == [[200, 100, 50], [7, 7, 7]]
        np.testing.assert_array_equal(read.color[:, 0] == 200, read.points[:, 0] > 0.0)


def test_the_rim_of_the_boat_is_smooth():
    """Two level rings of points, inside and outside of the planks, that turn by a few degrees at each."""
    points = mesh.load(Mesh(SCENES / "meshes" / "boat.stl")).points
    rim = points[points[:, 2] > points[:, 2].max() - 1e-3]
    outside = np.hypot(rim[:, 0] / 60.0, rim[:, 1] / 26.0) > 0.93
    for ring in (rim[outside], rim[~outside]):
        ring = ring[np.argsort(np.arctan2(ring[:, 1], ring[:, 0]))][:, :2]
        step = np.roll(ring, -1, axis=0) - ring
        heading = np.arctan2(step[:, 1], step[:, 0])
        turn = np.degrees((np.roll(heading, -1) - heading + np.pi) % (2 * np.pi) - np.pi)
        assert len(ring) == 80 and turn.min() > 0.0 and turn.max() < 20.0


def test_the_duck_has_a_face():
    """A beak in front, and two eyes with dark pupils at either side above it."""
    duck = mesh.load(Mesh(SCENES / "meshes" / "duck.ply"))
    red, green, blue = duck.color.astype(int).T
    beak, dark, white = (duck.points[m] for m in ((green < 150) & (red > 200), red < 60, blue > 200))
    for side in (-1, 1):
        eye, pupil = (part[side * part[:, 1] > 0.5].mean(axis=0) for part in (white, dark))
        assert eye[2] > beak[:, 2].mean() + 0.5 and eye[0] < beak[:, 0].max() and np.linalg.norm(eye - pupil) < 0.5
    assert len(white) > 50 and len(dark) > 40 and abs(beak[:, 1].mean()) < 0.2


def test_large_and_irregular_files_are_not_opened(tmp_path):
    """A sparse file of 20 GB, a pipe that nothing is written to, and a folder: refused by what the file system says."""
    with open(tmp_path / "sparse.stl", "wb") as file:
        file.truncate(20 << 30)
    os.mkfifo(tmp_path / "pipe.stl")
    (tmp_path / "folder.stl").mkdir()
    for name, words in (
        ("sparse", "20480 MiB, 256 are the most"),
        ("pipe", "not a regular file"),
        ("folder", "not a regular file"),
    ):
        with pytest.raises(mesh.MeshError, match=words):
            mesh.load(Mesh(tmp_path / f"{name}.stl"))


@pytest.mark.usefixtures("meshes_read_apart")
def test_files_are_read_by_a_process_of_their_own(monkeypatch):
    """It hands on what a file holds, and says what is wrong with one; its time is bounded, and this one outlives it."""
    ours, theirs = (find(MESHES / "mixed.obj") for find in (mesh_contents.contents, mesh_reader.read_polygons))
    for field in ("points", "count", "index", "color", "names", "part"):
        np.testing.assert_array_equal(getattr(ours, field), getattr(theirs, field))
    told = {
        "import sys; print('no faces', file=sys.stderr); sys.exit(3)": "no faces",
        "import os; os.kill(os.getpid(), 9)": "too large",
    }
    for code, words in told.items():
        monkeypatch.setattr(mesh_reader, "command", lambda *_: [sys.executable, "-c", code])
        with pytest.raises(UnreadableMesh, match=words):
            mesh_reader.read_polygons(MESHES / "mixed.obj")
    monkeypatch.setattr(mesh_reader, "SECONDS", 0.05)
    monkeypatch.setattr(mesh_reader, "command", lambda *_: [sys.executable, "-c", "import time; time.sleep(9)"])
    with pytest.raises(UnreadableMesh, match=r"in 0\.05 s"):
        mesh_reader.read_polygons(MESHES / "mixed.obj")


def test_a_changed_file_is_read_again(tmp_path):
    """Keep no stale mesh when the file changes between two calls."""
    path = tmp_path / "body.obj"
    path.write_bytes((MESHES / "cuboid.obj").read_bytes())
    assert mesh.load(Mesh(path)).volume == pytest.approx(24)
    path.write_bytes((MESHES / "two-parts.obj").read_bytes())
    assert mesh.load(Mesh(path)).volume == pytest.approx(36)


def test_a_changed_file_fills_other_cells(tmp_path):
    """Cells of a shape are kept for the next scene with it, those of a mesh as long as its file is the same; the block becomes
    half as wide here."""
    path = tmp_path / "body.obj"
    text = (MESHES / "cuboid.obj").read_text()
    path.write_text(text)
    block = fill_cells(Mesh(path), 0.5)
    assert fill_cells(Mesh(path), 0.5) is block and not block.filled.flags.writeable
    path.write_text(re.sub(r"^v (\S+)", lambda found: f"v {float(found[1]) / 2:.6f}", text, flags=re.M))
    narrow = fill_cells(Mesh(path), 0.5)
    assert (narrow.count == block.count // (2, 1, 1)).all()


def test_the_origin_is_the_centre_of_mass_not_of_the_corners():
    """Weigh two blocks of 24 and 12 with centres at 2 and 7: their common centre is at 3 2/3."""
    body = mesh.load(Mesh(MESHES / "two-parts.obj"))
    np.testing.assert_allclose(body.points.min(axis=0), [-11 / 3, -1.5, -1.0], rtol=1e-9)


@pytest.mark.parametrize("suffix", [".stl", ".ply"])
@pytest.mark.parametrize("shape", [Sphere(0.5), Torus(0.5, 0.2), Box((1.0, 0.5, 0.3))], ids=["ball", "ring", "box"])
def test_a_mesh_of_a_shape_is_that_shape(tmp_path, shape, suffix):
    """Find volume, thickness and inside of a shape that comes from a file (facets cost up to 1.5 %)."""
    made = written(tmp_path, shape, suffix=suffix)
    assert shapes.volume(made) == pytest.approx(shapes.volume(shape), rel=0.015)
    assert shapes.thickness(made) == pytest.approx(shapes.thickness(shape), rel=0.03)
    points = np.random.default_rng(2).uniform(-0.8, 0.8, (20000, 3))
    clear = abs(shapes.depth(shape, points)) > 0.01
    np.testing.assert_array_equal(shapes.contains(made, points[clear]), shapes.contains(shape, points[clear]))


def test_points_in_line_with_corners_and_edges_are_not_confused():
    """Ask a lattice whose columns run through corners, edges and diagonals of the cuboid's faces."""
    shape = Mesh(MESHES / "cuboid.obj")
    axes = [np.linspace(-3, 3, 25)] * 3
    filled = shapes.fill(shape, *axes)
    z, y, x = np.meshgrid(*axes, indexing="ij")
    surface = np.minimum(np.minimum(2 - abs(x), 1.5 - abs(y)), 1 - abs(z))
    off = abs(surface) > 1e-6
    np.testing.assert_array_equal(filled[off], (surface > 0)[off])


def test_rays_agree_with_vtk():
    """Compare 20 000 points in and around a knot with VTK's own test."""
    import pyvista

    shape = Mesh(MESHES / "knot.ply", 0.01)
    low, high = shapes.extent(shape)
    points = np.random.default_rng(3).uniform(low, high, (20000, 3))
    body = mesh.load(shape)
    surface = pyvista.PolyData.from_regular_faces(body.points, body.triangles)
    distance = pyvista.PolyData(points).compute_implicit_distance(surface)["implicit_distance"]
    inside = shapes.contains(shape, points)
    np.testing.assert_array_equal(inside, distance < 0)
    # The share of points inside is that of the volume, within three standard deviations.
    share = body.volume / np.prod(high - low)
    assert inside.mean() == pytest.approx(share, abs=3 * np.sqrt(share / len(points)))


def test_batches_do_not_change_the_answer():
    """Cut the work into small batches: same crossings."""
    body = mesh.load(Mesh(MESHES / "knot.ply", 0.01))
    lines = np.random.default_rng(4).uniform(-0.6, 0.6, (200, 2))

    def sorted_hits(batch):
        pairs = np.concatenate([np.stack(h) for h in crossings(body.points, body.triangles, lines, batch)], axis=1)
        return pairs[:, np.lexsort(pairs)]

    np.testing.assert_array_equal(sorted_hits(1), sorted_hits(10**6))
    assert sorted_hits(50).shape[1] > 40


def test_large_triangles_are_divided_for_drawing():
    """Divide two triangles until no edge is longer than twice the size, without opening the surface."""
    points, triangles = shapes.surface(Mesh(MESHES / "cuboid.obj"), 0.3)
    assert_closed(triangles)
    edges = points[triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)]
    assert np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1).max() <= 0.6 * (1 + 1e-6)
    assert enclosed_volume(points, triangles) == pytest.approx(24, rel=1e-6)
