# SPDX-License-Identifier: GPL-2.0-only
"""Random drives of rigid and elastic plates, held as a whole or at their lower face, with objects on them: the books close."""

import random

import pytest
from campaign import rounds
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

RESIDUAL = 1e-3
"""Error of energy that `accuracy balanced` stands for."""
WORST, RARE = 1e-2, 0.05
"""The largest one, and the part of scenes that may be off by more than RESIDUAL: blows of edges and corners of rigid objects
without dashpots, as in test_rigid.py. Of 188 scenes one was off by 1.2e-3."""
SECONDS, STRETCHES = 0.3, 6
FEW = (1, 9, 21, 32)
"""Seeds of scenes that are run every day."""


def drive(kind: str, of: random.Random) -> str:
    """A line of an object."""
    u = of.uniform
    if kind == "velocity":
        return f"drive velocity ({u(-0.5, 0.5)}, {u(-0.5, 0.5)}, {u(-0.2, 0.4)}) m/s\n"
    if kind == "turn":
        return f"drive turn ({u(-3, 3)}, {u(-3, 3)}, {u(-6, 6)}) rad/s\n"
    if kind == "oscillation":
        way = f"({u(-2, 2)}, {u(-2, 2)}, {u(-2, 2)}) cm"
        return f"drive oscillation {way} frequency {u(1, 10)} Hz phase {u(-180, 180)} deg\n"
    there = f"({u(-5, 5)}, {u(-5, 5)}, {u(-4, 6)}) cm"
    return f"key {u(0.1, 0.3)} s at {there} axis (0, {u(-1, 1)}, 1) angle {u(-60, 60)} deg\n"


def scene(seed: int) -> str:
    """A plate with one or two drives, and one to four objects above it."""
    of = random.Random(seed)
    kinds = of.sample(["velocity", "turn", "oscillation", "key"], of.choice((1, 1, 2)))
    material = of.choice(["rigid", "1 MPa"])
    hold = "all" if material == "rigid" else of.choice(["all", "face -z"])
    drives = "".join(drive(kind, of) for kind in kinds)
    text = "gravity (0, 0, -9.81) m/s^2\nground z -20 cm\n"
    text += "object plate { shape box (40, 40, 4) cm position (0, 0, -2) cm density 1000\n"
    text += f"elasticity {material}\nhold {hold}\n{drives}}}\n"
    for n in range(of.randint(1, 4)):
        shape = of.choice(["box (8, 8, 8) cm", "sphere 4 cm", "cylinder 4 cm 8 cm"])
        place = f"({9 * n - 14}, {of.uniform(-8, 8)}, {of.uniform(4.5, 9)}) cm"
        soft = of.choice(["rigid", "300 kPa damping 0.1", "1 MPa"])
        text += f"object o[{n}] {{ shape {shape} position {place} density {of.uniform(300, 2000)} elasticity {soft} }}\n"
    return f"{text}control {{ time {SECONDS} s  resolution 2 cm  friction {of.choice((0, 0.3, 0.6))} }}\n"


def residual(seed: int) -> float:
    """Run a scene; what all columns have gained more than the work, at most, over the most that was in play."""
    ready = prepare(parse_scene(scene(seed)))

    def ledger(instance):
        return energies(instance, instance.system.center_of_mass(instance.array("x")))

    with Instance(ready.plan) as instance:
        instance.setup()
        first, most, worst = ledger(instance), 1e-3, 0.0
        for _ in range(STRETCHES):
            instance.run(round(SECONDS / ready.certificate.timestep) // STRETCHES)
            now = ledger(instance)
            most = max(most, sum(abs(now[term] - first[term]) for term in now))
            off = sum(now[term] - first[term] for term in now if term != "work") - now["work"]
            worst = max(worst, abs(off) / most)
    return worst


@pytest.mark.parametrize("seed", FEW)
def test_a_few_random_drives(seed):
    """The short form of the next one."""
    assert residual(seed) < RESIDUAL


@pytest.mark.soak
def test_random_drives():
    """Two hundred of them."""
    found = {seed: residual(seed) for seed in range(rounds(200))}
    assert max(found.values()) < WORST, found
    assert sum(off > RESIDUAL for off in found.values()) <= max(1.0, RARE * len(found)), found
