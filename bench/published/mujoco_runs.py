# SPDX-License-Identifier: GPL-2.0-only
"""Scenes of rigid objects run by MuJoCo: written as its XML, and read back as a run of ours is.

Objects are boxes, balls, ellipsoids, cylinders, convex meshes, cones as such, and rings as discs with a ring's mass; there are a
ground, gravity that may change, friction, also of rolling, and joints. Joined objects are a tree, as MuJoCo has it; a joint that
closes a loop is its `connect`, and a spring of a string's length is a tendon of that length.
MuJoCo takes the larger friction of two, so that of a pair is written as one of its own. Restitution is the damping of a linear
spring over ten steps, where a scene has it; without it what blows leave is by MuJoCo's defaults.
"""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from mdanim_lammps.features.contact.words import ContactPair
from mdanim_lammps.features.joints.words import WORLD, Joint
from mdanim_lammps.model.shapes import second_moments, volume
from mdanim_lammps.scene import shapes
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.scene.scene import SceneRecord, Solid
from mdanim_lammps.scene.units import magnitude
from scipy.optimize import brentq

from .case import ROOT, SCENES, Change, Runs, unchanged

PYTHON = ROOT / ".venv-peers" / "bin" / "python"
WAYS = {
    "MuJoCo, its defaults": (0.002, ""),
    "MuJoCo, 2 ms, RK4": (0.002, 'integrator="RK4"'),
    "MuJoCo, 0.2 ms, elliptic cones": (0.0002, 'cone="elliptic" impratio="100"'),
}
"""Time step [s] and settings by the name under which they are kept: those that it has, and those that its manual advises for free
motion and against slip."""
TOUCHES = 10
"""Steps of a blow with restitution."""
HARD = 1e4
"""Torque of a motor over what it lacks in speed [N m s/rad]."""


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
            "xml": xml(scene, *WAYS[self.accuracy]),
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
        case shapes.Torus():
            form = f'type="cylinder" size="{shape.major + shape.minor} {shape.minor}"'
        case shapes.Mesh() | shapes.Cone():
            form = f'type="mesh" mesh="{asset}"'
        case _:
            raise NotImplementedError(f"{solid.name}: {type(shape).__name__} is not written for MuJoCo")
    density = solid.density if solid.mass is None else solid.mass / volume(shape)
    return f'<geom name="{solid.name}" {form} density="{density}"'


def _mesh(solid: Solid) -> tuple[tuple, str] | None:
    """Key of its mesh, and how it is written: a file, or the points of a cone; None of other shapes."""
    shape = solid.shape
    if isinstance(shape, shapes.Mesh):
        s = shape.scale
        return (shape.path, s), f'file="{shape.path}" scale="{s} {s} {s}"'
    if not isinstance(shape, shapes.Cone):
        return None
    around = np.linspace(0.0, 2.0 * math.pi, 96, endpoint=False)
    rim = shape.radius * np.array([np.cos(around), np.sin(around), np.full(96, -shape.height / 4.0 / shape.radius)]).T
    points = np.vstack([rim, (0.0, 0.0, 0.75 * shape.height)])
    return (shape.radius, shape.height), f'vertex="{_words(points)}"'


def _inertia(solid: Solid) -> str:
    """Mass and moments of what MuJoCo has another shape for."""
    shape = solid.shape
    if not isinstance(shape, shapes.Torus | shapes.Cone):
        return ""
    mass, about = solid.mass or solid.density * volume(shape), np.diag(second_moments(shape))
    return f'<inertial pos="0 0 0" mass="{mass}" diaginertia="{_words(mass * (about.sum() - about))}"/>'


def _damps(restitution: float) -> float:
    """Damping over critical of a linear spring that does not pull, by what it leaves (Schwager and Pöschel 2007)."""

    def left(zeta: float) -> float:
        root = math.sqrt(1.0 - zeta * zeta)
        return math.exp(-zeta / root * math.atan2(2.0 * zeta * root, 2.0 * zeta * zeta - 1.0)) - restitution

    return 0.0 if restitution == 1.0 else brentq(left, 0.0, 0.999)


def _rubs(solid: Solid, usual: float, step: float) -> str:
    """Attributes of how it touches others."""
    friction = f'friction="{usual if solid.friction is None else solid.friction} 0 {solid.rolling or 0.0}"'
    bounce = ""
    if solid.restitution:
        turn = math.pi / (TOUCHES * step)
        bounce = f' solref="{-(turn**2)} {-2.0 * _damps(solid.restitution) * turn}" priority="1"'
    return f'condim="{6 if solid.rolling else 3}" {friction}{bounce}'


def _is(name: str, word: str) -> bool:
    """Whether a word of a contact means an object: its name, or that of its repeat."""
    return name == word or name.startswith(f"{word}[")


def _pairs(scene: SceneRecord, pair: ContactPair) -> str:
    """The friction of a pair, of all objects that its words mean."""
    of = [[s.name for s in scene.solids if _is(s.name, word)] or [word] for word in (pair.first, pair.second)]
    mu = f"{pair.friction} {pair.friction}"
    return "".join(f'<pair geom1="{a}" geom2="{b}" condim="3" friction="{mu} 0 0 0"/>' for a in of[0] for b in of[1])


@dataclass(frozen=True)
class Tree:
    """How objects hang together: the joint on which each hangs, if any, those that close loops, and tendons."""

    scene: SceneRecord
    on: Mapping[str, Joint]
    loops: tuple[Joint, ...]

    @classmethod
    def of(cls, scene: SceneRecord) -> Tree:
        """The tree of a scene; sliders first, as no loop is closed by one. Raises NotImplementedError where one has to be."""
        on, loops = {}, []
        for joint in sorted(scene.joints, key=lambda joint: joint.kind != "slider"):
            if joint.kind == "spring":
                continue
            if joint.first not in on:
                on[joint.first] = joint
            elif joint.kind in ("ball", "hinge"):
                loops.append(joint)
            else:
                raise NotImplementedError(f"{joint.words} closes a loop")
        return cls(scene, on, tuple(loops))

    def bodies(self, step: float, assets: dict, parent: str = WORLD) -> str:
        """Objects that hang on one, or in the world, each with those that hang on it."""
        text, solids = "", {solid.name: solid for solid in self.scene.solids}
        at, turned = np.zeros(3), np.eye(3)
        if parent != WORLD:
            at, turned = np.array(solids[parent].position), np.array(solids[parent].rotation)
        for solid in self.scene.solids:
            joint = None if solid.hold else self.on.get(solid.name)
            # Held objects stand in the world, and so does what hangs on it.
            if (WORLD if joint is None or joint.second == WORLD or solids[joint.second].hold else joint.second) != parent:
                continue
            asset = "" if (mesh := _mesh(solid)) is None else assets.setdefault(mesh[0], (f"mesh{len(assets)}", mesh[1]))[0]
            own = np.array(solid.rotation)
            place = _words(turned.T @ (np.array(solid.position) - at))
            text += (
                f'<body name="{solid.name}" pos="{place}" quat="{_words(_quaternion(turned.T @ own))}">'
                f"{self._joint(solid, joint)}{_inertia(solid)}{_geom(solid, asset)} "
                f"{_rubs(solid, self.scene.control.friction, step)}/>{self._ends(solid)}"
                f"{self.bodies(step, assets, solid.name)}</body>"
            )
        return text

    def _joint(self, solid: Solid, joint: Joint | None) -> str:
        if solid.hold:
            return ""
        if joint is None:
            return "<freejoint/>"
        if joint.kind == "weld":
            return ""
        kind, own = {"slider": "slide"}.get(joint.kind, joint.kind), np.array(solid.rotation)
        axis = "" if joint.axis is None else f' axis="{_words(own.T @ np.array(joint.axis))}"'
        return f'<joint name="{solid.name}" type="{kind}" pos="{_words(_within(solid, joint.at))}"{axis}/>'

    def _ends(self, solid: Solid) -> str:
        """Places where tendons begin."""
        return "".join(
            f'<site name="{k}"/>' for k, one in enumerate(self.scene.joints) if one.kind == "spring" and one.first == solid.name
        )

    def rest(self) -> str:
        """Tendons, closed loops and motors."""
        solids = {solid.name: solid for solid in self.scene.solids}
        strings = [(k, one) for k, one in enumerate(self.scene.joints) if one.kind == "spring"]
        tendons = "".join(f'<spatial name="{k}"><site site="{k}"/><site site="end{k}"/></spatial>' for k, _ in strings)
        equal = "".join(f'<tendon tendon1="{k}"/>' for k, _ in strings)
        for one in self.loops:
            anchor = _words(_within(solids[one.first], one.at))
            equal += f'<connect body1="{one.first}" body2="{one.second}" anchor="{anchor}"/>'
        motor = 'gaintype="fixed" gainprm="0" biastype="affine"'
        motors = "".join(
            f'<general joint="{name}" {motor} biasprm="{HARD * magnitude(one.motor.speed)} 0 {-HARD}"/>'
            for name, one in self.on.items()
            if one.motor is not None
        )
        return f"<tendon>{tendons}</tendon><equality>{equal}</equality><actuator>{motors}</actuator>"


def _within(solid: Solid, at: Sequence[float]) -> np.ndarray:
    """A place in the axes of an object."""
    return np.array(solid.rotation).T @ (np.array(at) - np.array(solid.position))


def xml(scene: SceneRecord, step: float, options: str) -> str:
    """The scene as MuJoCo reads it. Raises NotImplementedError where it has what is not written."""
    usual, assets, tree = scene.control.friction, {}, Tree.of(scene)
    bodies = tree.bodies(step, assets)
    bodies += "".join(
        f'<site name="end{k}" pos="{_words(one.end)}"/>' for k, one in enumerate(scene.joints) if one.kind == "spring"
    )
    if scene.ground is not None:
        bodies += f'<geom name="ground" type="plane" size="0 0 1" pos="0 0 {scene.ground}" condim="3" friction="{usual} 0 0"/>'
    if any(joint.motor is not None for joint in scene.joints):
        if "integrator" in options:
            raise NotImplementedError("a stiff motor needs MuJoCo's implicit integrator")
        options += ' integrator="implicitfast"'
    meshes = "".join(f'<mesh name="{name}" {written}/>' for name, written in assets.values())
    pairs = "".join(_pairs(scene, pair) for pair in scene.contacts if pair.friction is not None)
    return (
        f'<mujoco><size memory="1G"/><option timestep="{step}" gravity="{_words(scene.gravity)}" {options}/>'
        f"<asset>{meshes}</asset><worldbody>{bodies}</worldbody><contact>{pairs}</contact>{tree.rest()}</mujoco>"
    )


def _quaternion(rotation: np.ndarray) -> np.ndarray:
    """The quaternion of a rotation matrix, w first: the eigenvector of the largest eigenvalue of Bar-Itzhack's matrix."""
    (a, b, c), (d, e, f), (g, h, i) = rotation
    k = np.array([[a - e - i, 0, 0, 0], [d + b, e - a - i, 0, 0], [g + c, h + f, i - a - e, 0], [h - f, c - g, d - b, a + e + i]])
    x, y, z, w = np.linalg.eigh(k)[1][:, -1]
    return np.array([w, x, y, z])
