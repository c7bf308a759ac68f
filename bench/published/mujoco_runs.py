# SPDX-License-Identifier: GPL-2.0-only
"""Scenes of rigid objects run by MuJoCo: written as its XML, and read back as a run of ours is.

Objects are boxes, balls, ellipsoids, cylinders, or convex meshes; there are a ground, gravity that may change, and friction.
MuJoCo takes the larger friction of two, so that of a pair is written as one of its own. What blows leave is by its defaults.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from mdanim_lammps.features.contact.words import ContactPair
from mdanim_lammps.scene import shapes
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.scene.scene import SceneRecord, Solid

from .case import ROOT, SCENES, Change, Runs, unchanged

PYTHON = ROOT / ".venv-peers" / "bin" / "python"
WAYS = {
    "MuJoCo, its defaults": 'timestep="0.002"',
    "MuJoCo, 0.2 ms, elliptic cones": 'timestep="0.0002" cone="elliptic" impratio="100"',
}
"""Settings by the name under which they are kept: those that it has, and those that its manual advises against slip."""


@dataclass(frozen=True)
class Track:
    """One object, as `mdanim_lammps.Trajectory.objects` has them; shapes (F, 3)."""

    center_of_mass: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray


@dataclass(frozen=True)
class Tracks:
    """The part of a trajectory that cases read."""

    times: np.ndarray
    objects: Mapping[str, Track]

    @property
    def trajectory(self) -> Tracks:
        return self

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.objects)


@dataclass
class MujocoRuns(Runs):
    """Runs scenes with one of the `WAYS`, by its name in `accuracy`."""

    def run(self, name: str, change: Change = unchanged, /, **lets: float | str) -> Tracks:  # type: ignore[override]
        scene = change(load_scene(SCENES / f"{name}.txt", overrides=lets))
        folder = self.folder()
        gravity = [[0.0, *scene.gravity], *([time, *g] for time, g in scene.gravity_path)]
        asked = {
            "xml": xml(scene, WAYS[self.accuracy]),
            "time": scene.control.time,
            "frames": scene.control.frames,
            "gravity": gravity,
            "motion": [[*one.velocity, *one.spin] for one in scene.solids if not one.hold],
            "names": [one.name for one in scene.solids if not one.hold],
        }
        (folder / "scene.json").write_text(json.dumps(asked))
        script = ROOT / "bench" / "peers" / "mujoco_scene.py"
        subprocess.run([PYTHON, script, folder / "scene.json", folder / "found.npz"], check=True)
        with np.load(folder / "found.npz") as found:
            self.seconds += float(found["seconds"])
            tracks = {name: Track(*np.moveaxis(found["motion"][:, k], 1, 0)) for k, name in enumerate(asked["names"])}
            return Tracks(found["times"], tracks)


def _words(values) -> str:
    return " ".join(repr(float(value)) for value in np.ravel(values))


def _geom(solid: Solid, asset: str) -> str:
    shape = solid.shape
    match shape:
        case shapes.Box():
            form = f'type="box" size="{_words(np.array(shape.size) / 2.0)}"'
        case shapes.Sphere():
            form = f'type="sphere" size="{shape.radius}"'
        case shapes.Ellipsoid():
            form = f'type="ellipsoid" size="{_words(shape.radii)}"'
        case shapes.Cylinder():
            form = f'type="cylinder" size="{shape.radius} {shape.height / 2.0}"'
        case shapes.Mesh():
            form = f'type="mesh" mesh="{asset}"'
        case _:
            raise NotImplementedError(f"{solid.name}: {type(shape).__name__} is not written for MuJoCo")
    mass = f'density="{solid.density}"' if solid.mass is None else f'mass="{solid.mass}"'
    return f'<geom name="{solid.name}" {form} {mass}'


def _is(name: str, word: str) -> bool:
    """Whether a word of a contact means an object: its name, or that of its repeat."""
    return name == word or name.startswith(f"{word}[")


def _pairs(scene: SceneRecord, pair: ContactPair) -> str:
    """The friction of a pair, of all objects that its words mean."""
    of = [[s.name for s in scene.solids if _is(s.name, word)] or [word] for word in (pair.first, pair.second)]
    mu = f"{pair.friction} {pair.friction}"
    return "".join(f'<pair geom1="{a}" geom2="{b}" condim="3" friction="{mu} 0 0 0"/>' for a in of[0] for b in of[1])


def xml(scene: SceneRecord, options: str) -> str:
    """The scene as MuJoCo reads it. Raises NotImplementedError where an object has a shape that is not written."""
    usual, assets, bodies = scene.control.friction, {}, ""
    for solid in scene.solids:
        asset = ""
        if isinstance(solid.shape, shapes.Mesh):
            asset = assets.setdefault((solid.shape.path, solid.shape.scale), f"mesh{len(assets)}")
        place = f'pos="{_words(solid.position)}" quat="{_words(_quaternion(np.array(solid.rotation)))}"'
        friction = f'condim="3" friction="{usual if solid.friction is None else solid.friction} 0 0"/>'
        joint = "" if solid.hold else "<freejoint/>"
        bodies += f"<body {place}>{joint}{_geom(solid, asset)} {friction}</body>"
    if scene.ground is not None:
        bodies += f'<geom name="ground" type="plane" size="0 0 1" pos="0 0 {scene.ground}" condim="3" friction="{usual} 0 0"/>'
    meshes = "".join(f'<mesh name="{name}" file="{path}" scale="{s} {s} {s}"/>' for (path, s), name in assets.items())
    pairs = "".join(_pairs(scene, pair) for pair in scene.contacts if pair.friction is not None)
    return (
        f'<mujoco><size memory="1G"/><option gravity="{_words(scene.gravity)}" {options}/><asset>{meshes}</asset>'
        f"<worldbody>{bodies}</worldbody><contact>{pairs}</contact></mujoco>"
    )


def _quaternion(rotation: np.ndarray) -> np.ndarray:
    """The quaternion of a rotation matrix, w first: the eigenvector of the largest eigenvalue of Bar-Itzhack's matrix."""
    (a, b, c), (d, e, f), (g, h, i) = rotation
    k = np.array([[a - e - i, 0, 0, 0], [d + b, e - a - i, 0, 0], [g + c, h + f, i - a - e, 0], [h - f, c - g, d - b, a + e + i]])
    x, y, z, w = np.linalg.eigh(k)[1][:, -1]
    return np.array([w, x, y, z])
