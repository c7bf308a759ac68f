# SPDX-License-Identifier: GPL-2.0-only
"""Meshes that move and turn, in glTF and USD, of what keeps its shape."""

import json
import struct

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.export import export
from mdanim_lammps.export.csv import elastic
from mdanim_lammps.export.cut import Cut
from mdanim_lammps.export.stiff import stiff_motion
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.system import assemble
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.scene.parse import parse_scene

TEXT = """object top { shape box (8, 6, 4) cm position (0, 0, 1) m mass 1 kg elasticity rigid velocity (1, 2, 0) spin (9, 40, 3) }
object jelly { shape box (6, 6, 6) cm position (1, 0, 1) m density 1000 elasticity 10 kPa spin (0, 0, 30) rad/s }
object wall { shape box (6, 6, 6) cm position (-1, 0, 1) m density 1000 hold all elasticity 1 MPa }
control { time 0.2 s frames 40 fps resolution 3 cm }
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("stiff")
    (place / "s.txt").write_text(TEXT)
    Scene.load(place / "s.txt").run(place / "s.out")
    return place / "s.out"


def turned(q: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Places x turned by a quaternion x, y, z, w."""
    return x + 2.0 * np.cross(q[:3], np.cross(q[:3], x) + q[3] * x)


def test_rotations_are_found():
    """Rotations of flat and solid bodies, half turns too; what bends, mirrors itself, or is on a line keeps no shape."""
    rng = np.random.default_rng(3)
    body, flat, line = rng.normal(size=(7, 3)), rng.normal(size=(5, 3)) * [1, 1, 0], np.arange(3.0)[:, None] * [1, 2, 3]
    turns = [np.array([0, 0, 0, 1.0]), np.array([0, 0, 1.0, 0]), np.array([0.6, 0, 0.8, 0]), np.array([0.5, -0.5, 0.5, 0.5])]
    frames = [
        np.concatenate(
            [turned(q, body) + n, turned(q, flat), turned(q, line), turned(q, body) * (1 + 1e-3 * n), body * (-1) ** n]
        )
        for n, q in enumerate(turns)
    ]
    found = stiff_motion(frames, np.cumsum([0, 7, 5, 3, 7, 7]))
    assert found.keeps.tolist() == [True, True, False, False, False]
    for n, q in enumerate(turns):
        assert abs(found.rotation[n, 0] @ q) == pytest.approx(1.0, abs=1e-12) == abs(found.rotation[n, 1] @ q)
        np.testing.assert_allclose(found.centre[n, 0], turned(q, body).mean(axis=0) + n, atol=1e-12)
    assert ((found.rotation[1:] * found.rotation[:-1]).sum(axis=2) >= 0.0)[:, :2].all()


def test_gltf_has_nodes(folder, tmp_path):
    """Nodes take the mesh to where it is in each frame; only the jelly has morph targets."""
    export(folder, "gltf", tmp_path / "s.glb")
    data = (tmp_path / "s.glb").read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    file, blob = json.loads(data[20 : 20 + size]), data[28 + size :]

    def read(number):
        accessor = file["accessors"][number]
        view, width = file["bufferViews"][accessor["bufferView"]], {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        return np.frombuffer(blob, np.float32, accessor["count"] * width, view["byteOffset"]).reshape(-1, width).astype(float)

    targets = {mesh["name"]: len(mesh["primitives"][0].get("targets", [])) for mesh in file["meshes"]}
    assert targets == {"top": 0, "jelly": 8, "wall": 0}
    (animation,) = file["animations"]
    ways = {
        (c["target"]["node"], c["target"]["path"]): animation["samplers"][c["sampler"]]["output"] for c in animation["channels"]
    }
    assert ways.keys() == {(1, "translation"), (1, "rotation"), (2, "weights")}
    base = read(file["meshes"][0]["primitives"][0]["attributes"]["POSITION"])
    with Trajectory(folder) as run:
        cut = Cut(run, (), 1, slice(None))
        for frame, (at, q) in enumerate(zip(read(ways[1, "translation"]), read(ways[1, "rotation"]))):
            np.testing.assert_allclose(turned(q, base) + at, cut.surfaces(frame)[0][0], atol=1e-6)


def test_usd_moves_it(folder, tmp_path):
    """The points are given once, and are where they are in glTF."""
    from pxr import Usd, UsdGeom

    export(folder, "usd", tmp_path / "s.usdc")
    stage = Usd.Stage.Open(str(tmp_path / "s.usdc"))
    mesh = UsdGeom.Mesh.Get(stage, "/scene/top")
    assert (
        mesh.GetPointsAttr().GetNumTimeSamples() == 0
        and UsdGeom.Mesh.Get(stage, "/scene/jelly").GetPointsAttr().GetNumTimeSamples() == 9
    )
    points = np.array(mesh.GetPointsAttr().Get(), float)
    with Trajectory(folder) as run:
        cut = Cut(run, (), 1, slice(None))
        for frame in (0, 5, 8):
            matrix = np.array(mesh.ComputeLocalToWorldTransform(frame))
            np.testing.assert_allclose(points @ matrix[:3, :3] + matrix[3, :3], cut.surfaces(frame)[0][0], atol=1e-6)


def test_rigid_objects_have_no_elastic_energy():
    """Where a scene has no spring at all it is 0, not left out."""
    text = "object a { shape box (1, 1, 1) cm  position (0, 0, 1) m  density 900  elasticity rigid }\ncontrol { time 1 s }\n"
    scene = parse_scene(text)
    system = assemble(build_models(scene, inside=False), scene)
    energy = elastic(system, np.zeros((system.particles, 3)))
    assert len(system.spring) == 0 and energy.tolist() == [0.0] and energy.dtype == float
