# SPDX-License-Identifier: GPL-2.0-only
"""Every format is read back by its own library, with the numbers of the run."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas
import pytest
from command_line import call
from mdanim_lammps import Scene, Trajectory, open_universe
from mdanim_lammps.errors import OutputError, UsageError
from mdanim_lammps.export import FORMATS
from mdanim_lammps.export.write import export
from mdanim_lammps.results.ledger import Ledger

pytestmark = pytest.mark.filterwarnings("error")

TEXT = """
gravity (0, 0, -9.81) m/s^2
object block[1] {
  shape box (10, 12, 14) cm
  position (0, 0, 45) cm
  mass 1 kg
  elasticity 100 kPa
  spin (0, 0, 2) rad/s
}
object stone {
  shape sphere 5 cm
  position (25, 0, 45) cm
  mass 2 kg
  elasticity 100 kPa
  velocity (0, 1, 0) m/s
  color "#ff0000"
}
liquid water {
  basin from (-50, -30, 0) cm to (50, 30, 60) cm
  density 1000 kg/m^3
  level 20 cm
}
render { camera from (0, -3, 1) m look (0, 0, 0.3) m  light from (-3, 0, 4) }
control { time 0.2 s  frames 20 fps  resolution 5 cm }
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The output folder of a short run."""
    place = tmp_path_factory.mktemp("run")
    (place / "pond.txt").write_text(TEXT, encoding="utf-8")
    Scene.load(place / "pond.txt").run(place / "pond.out")
    return place / "pond.out"


@pytest.fixture(scope="module")
def run(folder):
    with Trajectory(folder) as trajectory:
        yield trajectory


def exported(folder, to, tmp_path, **options) -> Path:
    """The file that an export has left, beside nothing else than what it names."""
    done = export(folder, to, tmp_path / f"a{FORMATS[to].suffixes[0]}", **options)
    assert sorted(done.files) == sorted(tmp_path.iterdir())
    return done.files[0]


def corners(folder, run, frame, index):
    """Places of the vertices of one object in the skin, without doubles, in rising order."""
    vertices = run.metadata.skin.vertices(run.position(frame))
    return np.unique(np.round(vertices[run.metadata.skin.object_of_vertex == index], 5), axis=0)


@pytest.mark.parametrize("flush", [1, 10**9], ids=["saved frame by frame", "saved at once"])
def test_usd(folder, run, tmp_path, monkeypatch, flush):
    """Meshes, times, units, materials, liquid and camera, as pxr reads them."""
    from pxr import Gf, Usd, UsdGeom, UsdLux, UsdShade

    monkeypatch.setattr("mdanim_lammps.export.usd.FLUSH", flush)
    stage = Usd.Stage.Open(str(exported(folder, "usd", tmp_path)))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0 and UsdGeom.GetStageUpAxis(stage) == "Z"
    assert stage.GetTimeCodesPerSecond() == pytest.approx(20.0)
    block, stone = (UsdGeom.Mesh.Get(stage, f"/scene/{name}") for name in ("block_1_", "stone"))
    assert block.GetPrim().GetDisplayName() == "block[1]"
    codes = block.GetPointsAttr().GetTimeSamples()
    np.testing.assert_allclose(np.array(codes) / stage.GetTimeCodesPerSecond(), run.times, rtol=1e-12)
    for index, mesh in enumerate((block, stone)):
        points = np.array(mesh.GetPointsAttr().Get(codes[3]))
        np.testing.assert_allclose(np.unique(np.round(points, 5), axis=0), corners(folder, run, 3, index), atol=2e-5)
        faces = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
        a, b, c = (points[faces[:, k]].astype(float) for k in range(3))
        assert len(faces) == (run.metadata.skin.object_of_triangle == index).sum()
        assert np.einsum("td,td->t", a, np.cross(b, c)).sum() > 0.0  # seen from outside
        normals = np.array(mesh.GetNormalsAttr().Get(codes[3]))[faces[:, 0]]
        assert (np.einsum("td,td->t", normals, np.cross(b - a, c - a)) > 0.0).all()
    water = UsdGeom.Mesh.Get(stage, "/scene/water")
    top = np.array(water.GetPointsAttr().Get(codes[2]))[:, 2].max()
    assert top == pytest.approx(run.liquid_height(2).max(), abs=1e-6)
    look = UsdShade.MaterialBindingAPI(stone.GetPrim()).ComputeBoundMaterial()[0]
    shader = look.ComputeSurfaceSource()[0]
    assert shader.GetIdAttr().Get() == "UsdPreviewSurface"
    np.testing.assert_allclose(shader.GetInput("diffuseColor").Get(), (1.0, 0.0, 0.0))
    camera = UsdGeom.Camera.Get(stage, "/scene/camera").GetCamera(0.0)
    np.testing.assert_allclose(camera.frustum.GetPosition(), (0.0, -3.0, 1.0), atol=1e-9)
    ahead = np.array((0.0, 3.0, -0.7)) / np.linalg.norm((3.0, 0.7))
    np.testing.assert_allclose(camera.frustum.ComputeViewDirection(), ahead, atol=1e-6)
    assert camera.GetFieldOfView(camera.FOVVertical) == pytest.approx(30.0, abs=1e-3)
    lamp = UsdLux.DistantLight.Get(stage, "/scene/lamp")
    shines = UsdGeom.Xformable(lamp.GetPrim()).ComputeLocalToWorldTransform(0.0).TransformDir(Gf.Vec3d(0, 0, -1))
    np.testing.assert_allclose(shines, np.array((0.3, 0.0, -0.4)) / 0.5, atol=1e-9)  # from where the scene has its light
    assert lamp.GetIntensityAttr().Get() > 0 and UsdLux.DomeLight.Get(stage, "/scene/sky").GetIntensityAttr().Get() > 0


@pytest.fixture(scope="module")
def splash(tmp_path_factory):
    """A run in which drops fly, and a frame that has some."""
    folder = tmp_path_factory.mktemp("splash") / "a"
    text = (
        TEXT.replace("level 20 cm", "level 20 cm  drops 1")
        .replace("(0, 0, 45)", "(0, 0, 29)")
        .replace("spin (0, 0, 2) rad/s", "velocity (0, 0, -4) m/s")
    )
    Scene.from_text(text).run(folder)
    with Trajectory(folder) as t:
        frame = max(range(len(t)), key=lambda frame: len(t.liquid_drops(frame)))
        assert len(t.liquid_drops(frame)) and not len(t.liquid_drops(0))
        yield folder, frame, t.liquid_drops(frame)


def test_usd_has_drops(splash):
    """Points as wide as the drops, of the liquid's material; none before the splash."""
    from pxr import Usd, UsdGeom, UsdShade

    folder, frame, drops = splash
    stage = Usd.Stage.Open(str(export(folder, "usd").files[0]))
    points = UsdGeom.Points.Get(stage, "/scene/water_drops")
    codes = points.GetPointsAttr().GetTimeSamples()
    np.testing.assert_array_equal(points.GetPointsAttr().Get(codes[frame]), drops[:, :3])
    np.testing.assert_array_equal(points.GetWidthsAttr().Get(codes[frame]), 2.0 * drops[:, 3])
    assert not len(points.GetPointsAttr().Get(codes[0]))
    look, water = (
        UsdShade.MaterialBindingAPI(p).ComputeBoundMaterial()[0] for p in (points.GetPrim(), stage.GetPrimAtPath("/scene/water"))
    )
    assert look.GetPath() == water.GetPath() != ""


def test_vtk_has_drops(splash):
    """A fourth part of each frame; empty before the splash."""
    import pyvista

    folder, frame, drops = splash
    reader = pyvista.get_reader(str(export(folder, "vtk").files[0]))
    for which, expected in ((0, drops[:0]), (frame, drops)):
        reader.set_active_time_value(reader.time_values[which])
        found = reader.read()[3]
        np.testing.assert_array_equal(np.array(found.points).reshape(-1, 3), expected[:, :3])
        if len(expected):
            np.testing.assert_array_equal(found["radius"], expected[:, 3])


def test_gltf_tells_that_it_has_no_drops(splash):
    """A note names what the format cannot hold."""
    assert any("drops" in note for note in export(splash[0], "gltf").notes)


def test_usd_paints_what_a_mesh_file_paints(tmp_path):
    """Colours of a mesh's points reach its vertices; a name that is taken gets another one."""
    from pxr import Usd, UsdGeom

    corner = [(x, y, z, 200 * x, 90 * y, 50 + z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    side = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    header = "ply\nformat ascii 1.0\nelement vertex 8\n" + "".join(f"property float {axis}\n" for axis in "xyz")
    header += "".join(f"property uchar {name}\n" for name in ("red", "green", "blue"))
    header += "element face 6\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [" ".join(map(str, row)) for row in (*corner, *((4, *face) for face in side))]
    (tmp_path / "box.ply").write_text(header + "\n".join(rows) + "\n")
    text = (
        f'object a[1] {{ shape mesh "{tmp_path / "box.ply"}" scale 0.2 position (0, 0, 0) m mass 1 kg elasticity 1 MPa }}\n'
        "object a_1_ { shape sphere 5 cm position (1, 0, 0) m mass 1 kg elasticity 1 MPa }\n"
        "object camera { shape sphere 5 cm position (2, 0, 0) m mass 1 kg elasticity 1 MPa }\n"
        "control { time 0.04 s  resolution 5 cm }"
    )
    Scene.from_text(text).run(tmp_path / "r")
    with Trajectory(tmp_path / "r") as t:
        wanted = np.unique(t.metadata.skin.paint, axis=0)
    assert len(wanted) == 8
    stage = Usd.Stage.Open(str(export(tmp_path / "r", "usd").files[0]))
    color = UsdGeom.Mesh.Get(stage, "/scene/a_1_").GetDisplayColorPrimvar()
    assert color.GetInterpolation() == "vertex" and UsdGeom.Mesh.Get(stage, "/scene/a_1__")
    assert UsdGeom.Mesh.Get(stage, "/scene/camera_") and UsdGeom.Camera.Get(stage, "/scene/camera")
    linear = np.array(color.Get(), float)
    shown = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    np.testing.assert_array_equal(np.unique(np.round(255 * shown).astype(int), axis=0), wanted)


def test_gltf(folder, run, tmp_path):
    """Morph targets give every frame, at its time, with z turned up to y."""
    from pygltflib import GLTF2

    file = GLTF2().load(str(exported(folder, "gltf", tmp_path)))
    blob = file.binary_blob()

    def read(number):
        accessor, width = file.accessors[number], {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[file.accessors[number].type]
        kind = {5126: np.float32, 5125: np.uint32}[accessor.componentType]
        return np.frombuffer(blob, kind, accessor.count * width, file.bufferViews[accessor.bufferView].byteOffset).reshape(
            -1, width
        )

    assert [node.name for node in file.nodes] == ["a", "block[1]", "stone", "water"]
    x, y, z, w = file.nodes[0].rotation
    assert w**2 == pytest.approx(0.5) and (y, z) == (0, 0) and x == -w  # a quarter turn about x, z to y
    sampler = file.animations[0].samplers[0]
    np.testing.assert_allclose(read(sampler.input).ravel(), run.times, rtol=1e-6)
    weights = read(sampler.output).reshape(len(run), len(run) - 1)
    assert {(c.target.node, c.target.path) for c in file.animations[0].channels} == {(n, "weights") for n in (1, 2, 3)}
    for index in (0, 1):
        shape = file.meshes[index].primitives[0]
        base = read(shape.attributes.POSITION).astype(float)
        for frame in range(len(run)):
            places = base + sum(k * read(t["POSITION"]) for k, t in zip(weights[frame], shape.targets))
            np.testing.assert_allclose(np.unique(np.round(places, 5), axis=0), corners(folder, run, frame, index), atol=2e-5)
        lengths = np.linalg.norm(read(shape.attributes.NORMAL) + read(shape.targets[2]["NORMAL"]), axis=1)
        np.testing.assert_allclose(lengths, 1.0, atol=1e-5)
    assert file.materials[file.meshes[1].primitives[0].material].pbrMetallicRoughness.baseColorFactor == [1.0, 0.0, 0.0, 1.0]
    assert file.materials[file.meshes[2].primitives[0].material].alphaMode == "BLEND"


def test_gltf_that_would_be_too_large_is_refused(folder, tmp_path, monkeypatch):
    """Before anything is written, with a way out; nothing is left."""
    monkeypatch.setattr("mdanim_lammps.export.gltf.LARGEST", 10_000)
    with pytest.raises(UsageError, match=r"the format allows 4 GB; take fewer frames \(every=\d+\)"):
        exported(folder, "gltf", tmp_path)
    assert not list(tmp_path.iterdir())


def test_vtk(folder, run, tmp_path):
    """The series has a time and three meshes for each frame; particles have velocity and strain."""
    import pyvista

    reader = pyvista.get_reader(str(exported(folder, "vtk", tmp_path)))
    np.testing.assert_array_equal(reader.time_values, run.times)
    reader.set_active_time_value(reader.time_values[3])
    surfaces, particles, water = reader.read()
    np.testing.assert_array_equal(particles.points, run.position(3))
    np.testing.assert_array_equal(particles["velocity"], run.velocity(3))
    np.testing.assert_array_equal(particles["object"], run.metadata.object_of)
    bonds = np.searchsorted(run.metadata.id, run.metadata.bond)
    length = lambda frame: np.linalg.norm(np.subtract(*(run.position(frame)[end] for end in bonds.T)), axis=1)
    stretch = np.abs(length(3) / length(0) - 1.0)
    for particle in (0, 17, len(particles.points) - 1):
        assert particles["strain"][particle] == stretch[(bonds == particle).any(axis=1)].max() > 0.0
    assert surfaces.volume == pytest.approx(run.surface(3).volume, rel=1e-9)
    assert set(surfaces["object"]) == {0, 1}
    np.testing.assert_allclose(water.points[:, 2].max(), run.liquid_height(3).max())


def test_xyz(folder, run, tmp_path):
    """ASE, from which the format comes, reads positions, velocities, masses, box and time."""
    from ase.io import read

    frames = read(exported(folder, "xyz", tmp_path), index=":")
    assert [frame.info["Time"] for frame in frames] == run.times.tolist()
    np.testing.assert_array_equal(frames[2].positions, run.position(2))
    np.testing.assert_array_equal(frames[2].arrays["velo"], run.velocity(2))
    np.testing.assert_array_equal(frames[2].get_masses(), run.metadata.mass)
    np.testing.assert_array_equal(frames[2].arrays["molid"], run.metadata.object_of + 1)
    np.testing.assert_array_equal(np.diag(frames[2].cell), np.ptp(run.position(2), axis=0))
    assert frames[2].info["length_unit"] == "m" and not frames[2].pbc.any()


def test_xtc(folder, run, tmp_path):
    """MDAnalysis reads it with its GRO, in ångström; neighbours are as far apart as atoms are; the scale is told."""
    import MDAnalysis

    done = export(folder, "xtc", tmp_path / "a.xtc")
    assert "1 m of the scene is 100 angstrom, 1 s is 1 ps" in done.notes
    # GRO has no masses; guesses from the names of atoms would be wrong.
    universe = MDAnalysis.Universe(str(tmp_path / "a.gro"), str(tmp_path / "a.xtc"), to_guess=())
    assert list(universe.residues.resnames) == ["block", "stone"]
    times = []
    for frame, step in enumerate(universe.trajectory):
        times.append(step.time)
        np.testing.assert_allclose(universe.atoms.positions, 100.0 * run.position(frame), atol=1e-4)
    np.testing.assert_allclose(times, run.times, rtol=1e-6)


def test_csv(folder, run, tmp_path):
    """pandas reads a row for each object and frame; energies are those of the ledger. Beside a liquid there are no forces."""
    done = export(folder, "csv", tmp_path / "a.csv")
    table = pandas.read_csv(tmp_path / "a.csv")
    assert len(table) == 2 * len(run) and "contact_fx" not in table
    assert any("contact forces are left out: lift and drag of the liquid" in note for note in done.notes)
    block = table[table.object == "block[1]"]
    np.testing.assert_array_equal(block.time, run.times)
    np.testing.assert_array_equal(block[["x", "y", "z"]], run.objects["block[1]"].center_of_mass)
    np.testing.assert_array_equal(block[["vx", "vy", "vz"]], run.objects["block[1]"].velocity)
    assert block.wz.iloc[0] == pytest.approx(2.0, rel=1e-9) and abs(block.wx.iloc[0]) < 1e-9
    ledger = Ledger.read(folder / "ledger.csv")
    np.testing.assert_allclose(table.groupby("frame").elastic.sum(), ledger.array("elastic"), rtol=1e-9, atol=1e-15)
    v = run.velocity(4)
    np.testing.assert_allclose(table[table.frame == 4].kinetic.sum(), 0.5 * (run.metadata.mass[:, None] * v**2).sum(), rtol=1e-12)


TOUCHING = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object block { shape box (10, 10, 10) cm  position (0, 0, 5) cm  mass 2 kg  elasticity 1 MPa  damping 0.5 }
object left { shape sphere 5 cm  position (100, -8, 90) cm  mass 1 kg  elasticity 1 MPa  velocity (0, 1, 0) m/s }
object right { shape sphere 5 cm  position (100, 8, 90) cm  mass 3 kg  elasticity 1 MPa }
object flies { shape sphere 5 cm  position (200, 0, 90) cm  mass 1 kg  elasticity 1 MPa }
object held { shape box (10, 10, 10) cm  position (300, 0, 50) cm  mass 1 kg  elasticity 1 MPa  hold face +z }
object slow { shape sphere 5 cm  position (400, 0, 90) cm  mass 1 kg  elasticity 1 MPa  drag 0.1 N*s/m }
control { time 0.3 s  frames 30 fps  resolution 5 cm  friction 0.5 }
"""


def test_contact_forces(tmp_path):
    """A block on the ground is carried, what flies is not, a blow acts on both alike; where other forces act there is none."""
    run = Scene.from_text(TOUCHING, "touching").run(tmp_path / "r")
    done = run.export("csv")
    assert any("are means since the frame before" in note for note in done.notes)
    table = pandas.read_csv(done.files[0])
    pandas.testing.assert_frame_equal(table.drop(columns="elastic"), run.trajectory.to_pandas())
    force = {name: part[["contact_fx", "contact_fy", "contact_fz"]].to_numpy() for name, part in table.groupby("object")}
    assert np.isnan(force["block"][0]).all() and not np.isnan(force["block"][1:]).any()
    np.testing.assert_allclose(force["block"][-3:], np.tile((0.0, 0.0, 2.0 * 9.81), (3, 1)), atol=0.02)
    np.testing.assert_allclose(force["flies"][1:], 0.0, atol=1e-9)
    np.testing.assert_allclose(force["left"][1:], -force["right"][1:], atol=1e-9)
    assert force["right"][1:, 1].sum() / 30 > 0.9  # N s, of a blow at 1 m/s of 1 kg and 3 kg
    assert np.isnan(force["held"]).all()
    np.testing.assert_allclose(force["slow"][1:], 0.0, atol=1e-6)  # its drag is known
    held = TOUCHING[TOUCHING.index("object held") : TOUCHING.index("object slow")]
    still = TOUCHING[: TOUCHING.index("object block")] + held + TOUCHING[TOUCHING.index("control") :]
    notes = Scene.from_text(still, "still").run(tmp_path / "s").export("csv").notes
    assert any("it is held, and what holds it is not told from contact" in note for note in notes)


def test_csv_of_boundary_particles_tells_no_spin(tmp_path):
    """Where inner particles are not stored, what needs them is left out, and said so."""
    text = TEXT.replace("control {", "control { save boundary").replace("5 cm }", "2.5 cm }")
    Scene.from_text(text).run(tmp_path / "r")
    done = export(tmp_path / "r", "csv")
    table = pandas.read_csv(done.files[0])
    assert list(table) == ["frame", "time", "object", "x", "y", "z", "vx", "vy", "vz"]
    assert any("spin and energy are left out" in note for note in done.notes)


@pytest.fixture(scope="module")
def made_by_lmp(folder, tmp_path_factory):
    """A folder that ``build`` has made and in which plain ``lmp`` has run."""
    place = tmp_path_factory.mktemp("lmp") / "pond.out"
    scene = folder.parent / "pond.txt"
    assert call("build", scene, "-o", place, "-q").returncode == 0
    subprocess.run([Path(sys.executable).parent / "lmp", "-in", "in.pond"], cwd=place, check=True, capture_output=True)
    return place


def test_lammpstrj_is_what_lmp_writes(folder, made_by_lmp, tmp_path):
    """Lines of particles are those of ``lmp -in in.NAME``, digit for digit."""
    ours = exported(folder, "lammpstrj", tmp_path).read_text().splitlines()
    theirs = (made_by_lmp / "pond.lammpstrj").read_text().splitlines()
    box = {n + k for n, line in enumerate(theirs) if line.startswith("ITEM: BOX") for k in (1, 2, 3)}
    assert len(ours) == len(theirs) > 500
    assert [n for n, pair in enumerate(zip(ours, theirs)) if n not in box and pair[0] != pair[1]] == []


def test_a_dump_of_plain_lmp_is_drawn_and_reported(run, made_by_lmp):
    """``render`` and ``report`` take the dump; its frames are those of the run, to the last bit. The liquid is not in it."""
    (made_by_lmp / "trajectory.h5").unlink(missing_ok=True)
    said = call("render", made_by_lmp, "--size", "64", "48")
    assert (
        said.returncode == 0
        and "adopted  5 frames of pond.lammpstrj" in said.stdout
        and "the liquid is not in a dump" in said.stdout
    )
    assert (made_by_lmp / "movie.mp4").stat().st_size > 1000
    with Trajectory(made_by_lmp) as adopted:
        np.testing.assert_allclose(adopted.times, run.times, rtol=1e-15)
        for frame in range(len(run)):
            np.testing.assert_array_equal(adopted.position(frame), run.position(frame))
            np.testing.assert_array_equal(adopted.velocity(frame), run.velocity(frame))
    assert call("report", made_by_lmp, "-q").returncode == 0
    assert (made_by_lmp / "report.html").stat().st_size > 10_000


def test_a_dump_of_something_else_is_refused(made_by_lmp, tmp_path):
    """With what is wrong about it; no trajectory is left."""
    for p in made_by_lmp.iterdir():
        if p.is_file() and p.name not in ("trajectory.h5", "progress.jsonl"):
            (tmp_path / p.name).write_bytes(p.read_bytes())
    text = (tmp_path / "pond.lammpstrj").read_text()
    (tmp_path / "pond.lammpstrj").write_text(text.replace("id mol type", "id type mol"))
    said = call("render", tmp_path)
    assert said.returncode == 7 and "its columns are not 'id mol type x y z vx vy vz'" in said.stderr
    assert not (tmp_path / "trajectory.h5").exists()


def test_universe_of_what_build_writes(run, made_by_lmp, tmp_path):
    """Masses, springs, objects, and with the dump all frames."""
    universe = open_universe(made_by_lmp / "data.pond")
    np.testing.assert_allclose(universe.atoms.masses, run.metadata.mass, rtol=1e-15)
    np.testing.assert_allclose(universe.atoms.positions, run.position(0), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(universe.atoms.velocities, run.velocity(0), rtol=1e-6, atol=1e-9)
    assert len(universe.bonds) == len(run.metadata.bond) and len(universe.residues) == 2
    assert universe.residues[1].atoms.total_mass() == pytest.approx(2.0)
    assert list(universe.residues.resnames) == ["block[1]", "stone"] and universe.select_atoms("resname stone").n_residues == 1
    moving = open_universe(made_by_lmp / "data.pond", made_by_lmp / "pond.lammpstrj")
    assert len(moving.trajectory) == len(run)
    moving.trajectory[3]
    np.testing.assert_allclose(moving.residues[1].atoms.center_of_mass(), run.centers[3, 1], atol=1e-6)
    (tmp_path / "data.x").write_text("something else\n")
    with pytest.raises(OutputError, match="is not a data file that 'mdanim-lammps build' has written"):
        open_universe(tmp_path / "data.x")


def test_some_objects_and_some_frames(folder, run, tmp_path):
    """Objects by name, every n-th frame of a range; the liquid belongs to the whole scene."""
    done = export(folder, "csv", tmp_path / "a.csv", objects=["stone"], every=2, frames=slice(1, None))
    table = pandas.read_csv(tmp_path / "a.csv")
    assert done.frames == 2 and list(table.frame) == [1, 3] and set(table.object) == {"stone"}
    np.testing.assert_array_equal(table.x, run.objects["stone"].center_of_mass[[1, 3], 0])
    export(folder, "vtk", tmp_path / "a.pvd", objects=["stone"])
    assert {p.name.split("-")[0] for p in (tmp_path / "a.vtk").iterdir()} == {"surfaces", "particles"}


def test_what_cannot_be_exported_is_refused(folder, tmp_path):
    """Names with a suggestion, ranges, suffixes, folders that are not there."""
    for options, words in (
        (dict(to="gtlf"), "did you mean 'gltf'"),
        (dict(to="csv", objects=["stoen"]), "did you mean 'stone'"),
        (dict(to="csv", every=0), "every=0: must be 1 or more"),
        (dict(to="csv", frames=slice(9, None)), "the run has frames 0 to 4"),
        (dict(to="usd", path=tmp_path / "a.usda"), r"give it a name such as a\.usdc"),
    ):
        with pytest.raises(UsageError, match=words):
            export(folder, **options)
    with pytest.raises(OutputError, match="there is no folder"):
        export(folder, "csv", tmp_path / "no" / "a.csv")


def test_what_is_there_is_kept(folder, tmp_path):
    """An earlier export is refused, and replaced with ``force``; a folder with other files never is."""
    export(folder, "vtk", tmp_path / "a.pvd")
    with pytest.raises(OutputError, match="exists; overwrite it with force=True"):
        export(folder, "vtk", tmp_path / "a.pvd")
    export(folder, "vtk", tmp_path / "a.pvd", every=4, force=True)
    assert len(list((tmp_path / "a.vtk").iterdir())) == 6
    (tmp_path / "a.vtk" / "thesis.tex").touch()
    with pytest.raises(OutputError, match="holds files that are not of an export"):
        export(folder, "vtk", tmp_path / "a.pvd", force=True)
    assert (tmp_path / "a.vtk" / "thesis.tex").exists()


@pytest.mark.parametrize("to", FORMATS)
def test_a_failed_export_leaves_nothing(folder, tmp_path, to):
    """Neither under its name nor beside it, whatever happens after the first frame."""

    def fail(done, total):
        raise RuntimeError("in the middle")

    with pytest.raises(RuntimeError, match="in the middle"):
        export(folder, to, tmp_path / f"a{FORMATS[to].suffixes[0]}", on_progress=fail)
    assert not list(tmp_path.iterdir())


def test_the_command_says_what_it_wrote(folder, tmp_path):
    """Files, frames, and what the format cannot hold."""
    said = call("export", folder, "--to", "csv", "-o", tmp_path / "a.csv", "--frames", ":3").stdout
    assert said.startswith(f"export   {tmp_path}/a.csv   3 frames, ") and "contact forces are left out" in said


def test_types_of_particles_are_those_of_the_data_file(tmp_path):
    """Layers, and four more where particles are held."""
    text = TEXT.replace('color "#ff0000"', "hold face -x").replace("velocity (0, 1, 0) m/s", "")
    scene = Scene.from_text(text)
    scene.run(tmp_path / "r")
    first = export(tmp_path / "r", "lammpstrj", frames=slice(0, 1)).files[0].read_text().split("ITEM: ATOMS")[1]
    kinds = [int(line.split()[2]) for line in first.splitlines()[1:]]
    assert kinds == scene.prepared.plan.kind.tolist() and max(kinds) > 4


@pytest.mark.parametrize("page", ["README.md", "docs/export.md", "docs/command-line.md"])
def test_pages_name_every_format(page):
    """As a word of its own."""
    text = (Path(__file__).parents[2] / page).read_text(encoding="utf-8")
    assert not [name for name in FORMATS if not re.search(rf"\b{name}\b", text)]
