# SPDX-License-Identifier: GPL-2.0-only
"""One scene in several unit systems of LAMMPS is the same motion: for every style, in plain steps and in passes.

A scene is told in SI numbers. A unit system has units of length, mass and energy [m, kg, J]; its unit of time is the one in which
LAMMPS moves particles, length √(ftm2v mass/energy), as all digits of LAMMPS's own constants count here.
"""

from dataclasses import dataclass, replace
from functools import cache

import contact_lab
import numpy as np
import plugin_lab as lab
import plugin_path
import pytest
from contact_lab import Cuboid
from liquid_lab import lattice

LENGTH_MASS_ENERGY = {
    "si": (1.0, 1.0, 1.0),
    "lj": (0.013, 0.0021, 0.37),
    "cgs": (1e-2, 1e-3, 1e-7),
    "micro": (1e-6, 1e-15, 1e-15),
    "nano": (1e-9, 1e-21, 1e-21),
    "metal": (1e-10, 1.66053907e-27, 1.602176634e-19),
    "real": (1e-10, 1.66053907e-27, 6.9477e-21),
    "electron": (5.29177e-11, 1.66053907e-27, 4.3597447e-18),
}


class Units:
    """A unit system: attributes are units in SI, so that a value is written as value/unit."""

    def __init__(self, name: str):
        self.name = name
        self.length, self.mass, self.energy = LENGTH_MASS_ENERGY[name]
        lmp = plugin_path.lammps()
        lmp.command(f"units {name}")
        self.time = self.length * (lmp.extract_global("ftm2v") * self.mass / self.energy) ** 0.5
        lmp.close()
        self.number = 1.0
        self.velocity = self.length / self.time
        self.rate = 1.0 / self.time
        self.manning = self.time / self.length ** (1 / 3)
        self.per_length = 1.0 / self.length
        self.area, self.volume = self.length**2, self.length**3
        self.flow = self.volume / self.time
        self.density = self.mass / self.volume
        self.force = self.energy / self.length
        self.gravity = self.force / self.mass
        self.stiffness = self.energy / self.area
        self.young = self.energy / self.volume
        self.softness = self.volume / self.young
        self.dashpot = self.force / self.velocity
        self.momentum = self.mass * self.velocity

    def write(self, text: str) -> str:
        """Words such as 0.3:rate, with the number in these units."""
        words = []
        for word in text.split(" "):
            number, colon, unit = word.partition(":")
            words.append(repr(float(number) / getattr(self, unit)) if colon and number else word)
        return " ".join(words)


units = cache(Units)


@dataclass(frozen=True)
class Scene:
    """Particles and commands in SI numbers."""

    body: lab.Body
    commands: tuple
    outputs: dict
    """Words of thermo_style that are compared, and their units."""
    dt: float = 0.1
    steps: int = 60
    dashpot: float | None = None
    columns: dict | None = None
    """Properties of particles: values and their unit."""
    bodies: tuple = ()
    velocities: bool = False

    def run(self, u: Units, folder, style: str):
        """Positions, velocities, forces and outputs at the end, in SI."""
        body = replace(
            self.body, x=self.body.x / u.length, v=self.body.v / u.velocity, mass=self.body.mass / u.mass,
            k=self.body.k / u.stiffness, r0=self.body.r0 / u.length,
        )  # fmt: skip
        script = lab.script(
            body, folder, [u.write(c) for c in self.commands], c=None if self.dashpot is None else self.dashpot / u.dashpot,
            columns={name: value / getattr(u, unit) for name, (value, unit) in (self.columns or {}).items()},
            skin=0.4 / u.length, cutoff=3.0 / u.length, velocities=self.velocities,
        )  # fmt: skip
        script[script.index("units lj")] = f"units {u.name}"
        lmp = plugin_path.lammps()
        ends = [f"run_style {style}", f"timestep {self.dt / u.time!r}", f"thermo_style custom step {' '.join(self.outputs)}"]
        for command in [*script, *ends, "thermo_modify norm no"]:
            lmp.command(command)
        for n, one in enumerate(self.bodies):
            arrays = {**one.arrays, "edge": one.arrays["edge"] / u.length, "area": one.arrays["area"] / u.area}
            contact_lab.give_body(lmp, "contact", n, arrays)
        lmp.command(f"run {self.steps}")
        found = [lab.by_tag(lmp, name) * unit for name, unit in zip("xvf", (u.length, u.velocity, u.force))]
        _, *numbers = lmp.last_thermo().values()  # get_thermo() gives 0 for what fixes tell
        told = {word: number * getattr(u, unit) for (word, unit), number in zip(self.outputs.items(), numbers, strict=True)}
        lmp.close()
        return found, told


BLOCK = lab.block((3, 2, 2), (0.0, 0.0, 1.0), (0.3, 0.1, -0.4))
MOVE = "fix run all mdanim/leapfrog"
BOUND = "compute step all mdanim/timestep"
ENERGIES = {"ebond": "energy", "f_run": "energy", "f_run[2]": "energy"}


def springs() -> Scene:
    """With dashpots, gravity and drag."""
    return Scene(
        lab.shaken(BLOCK, 0.05),
        ("fix weight all mdanim/gravity 0.001:gravity 0.0:gravity -0.02:gravity", MOVE + " lambda 0.01:dashpot", BOUND),
        {**ENERGIES, "f_weight": "energy", "f_run[1]": "number", "c_step": "time"}, dashpot=0.05,
    )  # fmt: skip


def exponential_drag() -> Scene:
    """The other form of drag."""
    return Scene(BLOCK, (MOVE + " lambda 0.05:dashpot drag exp",), ENERGIES)


def wall() -> Scene:
    """A block that bounces."""
    commands = ("region up plane 0 0 0.95:length 0 0 1", "fix w all mdanim/wall up 1.5:stiffness", MOVE, BOUND)
    return Scene(BLOCK, commands, {**ENERGIES, "f_w": "energy", "f_w[3]": "force", "f_w[5]": "length", "c_step": "time"})


def barrier() -> Scene:
    """Two blocks that meet."""
    body = lab.join(lab.block((3, 3, 3)), lab.block((3, 3, 3), (0.3, 0.2, 4.0), (0.0, 0.05, -0.4)))
    return Scene(
        body, ("fix b all mdanim/barrier boundary inner 1.0:stiffness 1.5:length", MOVE),
        {**ENERGIES, "f_b": "energy", "f_b[3]": "number", "f_b[4]": "number"},
    )  # fmt: skip


def contact() -> Scene:
    """Two rough cubes on a plane, at the damping that is the default."""
    cuboids = (
        Cuboid((3, 3, 2), (0.0, 0.0, 1.02), friction=0.4, velocity=(0.0, 0.0, -0.03)),
        Cuboid((2, 2, 2), (0.2, 0.1, 3.04), friction=0.4, velocity=(0.05, 0.02, -0.06)),
    )
    body, columns = contact_lab.scene(cuboids)
    names = {"body": "number", "young": "young", "friction": "number", "moves": "number"}
    return Scene(
        body,
        ("fix weight all mdanim/gravity 0.0:gravity 0.0:gravity -0.004:gravity",
         "fix contact all mdanim/contact d_body d_young d_friction objects plane z lo 0.0:length", MOVE),
        {**ENERGIES, "f_contact": "energy", **{f"f_contact[{n}]": "energy" for n in (1, 2, 3)}, "f_contact[5]": "length",
         "f_contact[6]": "number", "f_contact[11]": "force"},
        steps=150, columns={name: (columns[name], names[name]) for name in columns}, bodies=cuboids,
    )  # fmt: skip


def liquid(more: str, drag: str = " drag 0.1:rate quadratic 0.05:per_length lambda d_lambda", outputs=None) -> Scene:
    """A block that falls into a basin, nowhere on a border of cells, with no update due just at a step."""
    shape = (3, 2, 2)
    body = lab.block(shape, (-1.4137, -1.2213, 9.0371), (0.1, 0.03, -0.3))
    volume = body.mass.copy()
    body.mass[:] *= 0.6
    return Scene(
        body,
        ("fix table all property/atom i2_cell 7 ghost yes", *lattice(body, shape),
         "region basin block -6.0:length 6.0:length -5.0:length 5.0:length 0.0:length 14.0:length",
         "region mouth block -6.0:length -4.0:length -5.0:length 5.0:length 0.0:length 8.0:length",
         "fix weight all mdanim/gravity 0.0:gravity 0.0:gravity -0.01:gravity",
         f"fix water all mdanim/liquid basin 1.0:density grid 12 10 14 level 8.0:length gravity 0.01:gravity cells i2_cell "
         f"buoyancy d_volume{drag} every 2 {more}",
         MOVE + " lambda d_lambda"),
        {**ENERGIES, "f_water": "energy", "f_water[1]": "number", "f_water[3]": "length", "f_water[5]": "number",
         "f_water[7]": "energy", **(outputs or {})},
        dt=0.29, steps=150,
        columns={"volume": (volume, "volume"), "lambda": (np.zeros(len(volume)), "dashpot"), "soft": (volume, "softness")},
    )  # fmt: skip


def waves() -> Scene:
    """All words of waves but drops."""
    told = {"f_water[12]": "energy", "f_water[13]": "length", **{f"f_water[{n}]": "momentum" for n in range(14, 22)}}
    makers = "wave -x 0.2:length 60.0:time current -y 0.01:velocity inflow mouth 0.3:flow 0.02:velocity 0.0:velocity"
    return liquid(f"model waves calm 400.0:time manning 1.0:manning softness d_soft {makers} drain mouth 0.1:flow", outputs=told)


def joints() -> Scene:
    """Two blocks on a hinge with all of its words, one of them on a spring, the other on a slider."""
    body = lab.shaken(lab.join(lab.block((3, 2, 2)), lab.block((3, 2, 2), (0.0, 0.0, 3.0))), 0.02)
    words = (
        "joint hinge 1 2 at 1.5:length 1.0:length 2.5:length axis 0.3:length 1:length 0:length patch 1.9:length 1.9:length "
        "frequency 1.0:rate damping-ratio 0.1 motor 0.3:rate 0.05:energy friction 0.02:energy limits -0.2 0.3 "
        "joint spring 1 world from 0:length 0:length 0:length to 0:length 0:length -2:length stiffness 0.3:stiffness "
        "damping 0.1:dashpot length 1.5:length breaks 0.1:force "
        "joint slider 2 world at 1.5:length 1:length 5:length axis 1:length 0:length 0.2:length patch 1.9:length all "
        "stiffness 0.5:stiffness arm 1.5:length damping 0.1:dashpot servo 0.4:stiffness 0.2:dashpot motor 0.1:velocity none "
        "preload 0.01:force 0.02:force 0:force 0.01:energy 0.02:energy 0:energy"
    )
    return Scene(
        body,
        ("fix weight all mdanim/gravity 0.002:gravity 0.0:gravity -0.02:gravity", f"fix j all mdanim/joint {words}", MOVE),
        {**ENERGIES, "f_j": "energy", **{f"f_j[{n}]": "energy" for n in (1, 2, 3)}, "f_j[4]": "number",
         "f_j[1][1]": "force", "f_j[1][2]": "energy", "f_j[1][3]": "number", "f_j[1][4]": "rate", "f_j[1][5]": "energy",
         "f_j[3][3]": "length", "f_j[3][4]": "velocity", "f_j[3][5]": "force", "f_j[3][6]": "length"},
        steps=200,
    )  # fmt: skip


def forces() -> Scene:
    """In windows of time, on elastic objects."""
    words = "force 0.01:force 0.0:force 0.02:force to 5.1:time torque 0.0:energy 0.02:energy 0.01:energy to 7.0:time"
    return Scene(lab.block((1, 1, 4)), (f"fix p all mdanim/force {words}", MOVE), {**ENERGIES, "f_p[1]": "energy"}, steps=100)


SCENES = {
    "joints": joints,
    "forces": forces,
    "springs": springs,
    "exponential drag": exponential_drag,
    "wall": wall,
    "barrier": barrier,
    "contact": contact,
    "surface": lambda: liquid("model surface seed 5"),
    "paper": lambda: liquid("model paper seed 5"),
    "waves": waves,
}
ROUGH = {"waves"}
"""Scenes in which rounding makes more than rounding: liquid is counted in 2^-20 of a cell, and its solver goes on to 2e-3."""


@cache
def reference(name: str, style: str, folder):
    """The same in SI numbers."""
    return SCENES[name]().run(units("si"), folder, style)


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    return tmp_path_factory.mktemp("si")


@pytest.mark.parametrize("system", [name for name in LENGTH_MASS_ENERGY if name != "si"])
@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_is_the_same_motion_in_every_unit_system(tmp_path, shared, scene, system):
    """Positions, velocities, forces and all energies and momenta that the styles tell."""
    style = "verlet" if system == "real" else "verlet/mdanim"
    found, told = SCENES[scene]().run(units(system), tmp_path, style)
    expected, expected_told = reference(scene, style, shared)
    # Rounding of a few hundred steps, and of the constants of electron, whose mvv2e and 1/ftm2v differ by 1e-9.
    limit = 1e-5 if scene in ROUGH else 1e-8
    for name, one, other in zip("xvf", found, expected):
        assert np.abs(one - other).max() < limit * np.abs(other).max(), name
    for word, value in told.items():
        assert value == pytest.approx(expected_told[word], rel=limit, abs=1e-3 * limit), word
