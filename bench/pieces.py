# SPDX-License-Identifier: GPL-2.0-only
"""Objects in pieces: ``python bench/pieces.py heights|blows|cost|many|rebound`` prints the tables of docs/physics-pieces.md.

``heights``: from which height a plate breaks, by strength, accuracy and pieces; ``blows``: what a cylinder of glass bears, by the
stiffness of contact; ``cost``: processor time of a step before and after; ``many``: ten thousand pieces; ``rebound``: speed after
a blow in which an object comes apart.
"""

from __future__ import annotations

import itertools
import sys
import tempfile
import time

import numpy as np
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

PLATE = """object plate {{ shape box (30, 30, 1) cm  position (0, 0, {height!r}) m  orientation axis (1, 0.3, 0) angle 20 deg
  elasticity rigid  density 2500  friction 0.4  pieces {pieces}  strength {strength} MPa }}
gravity (0, 0, -9.81) m/s^2
ground z 0 m
control {{ time {time!r} s  frames 10 fps  accuracy {accuracy} }}
"""
CYLINDER = """object glass {{ shape cylinder 4 cm 12 cm  position (0, 0, 1.07) m  orientation axis (1, 0.3, 0) angle 20 deg
  material glass  pieces 24  strength 100 GPa }}
gravity (0, 0, -9.81) m/s^2
ground z 0 m
control {{ time 0.5 s  frames 10 fps  contact-stiffness {stiffness} }}
"""
BLOCK = """object {name} {{ shape box (20, 10, 10) cm  position (0, 0, 5.2) cm  orientation axis (0, 1, 0) angle {angle} deg
  elasticity rigid  density 2000  pieces 2  strength {strength} Pa  restitution 0.5  velocity (0, 0, -2) m/s }}
gravity (0, 0, -9.81) m/s^2
ground z 0 m
control {{ time 0.02 s  frames 500 fps }}
"""
LOWEST, HIGHEST, HALVINGS = 0.1, 6.4, 6
WALL = """object wall {{ shape box ({wide}, 0.2, {high}) m  position (0, 0, {middle}) m  elasticity rigid  density 1900
  friction 0.6  pieces bricks (20, 20, 10) cm  strength 0.3 MPa }}
object ball {{ shape sphere 50 cm  position (0, -0.8, {at}) m  velocity (0, 8, 0) m/s
  elasticity rigid  density 7800  friction 0.6 }}
gravity (0, 0, -9.81) m/s^2
ground z 0 m
control {{ time {time} s  frames 100 fps }}
"""


def broken(text: str) -> tuple[int, float]:
    """Faces that broke in a run, and processor seconds of a step."""
    ready = prepare(parse_scene(text, "scene.txt"))
    with Instance(ready.plan) as instance:
        instance.setup()
        start = time.process_time()
        instance.run(ready.certificate.steps)
        return int(instance.fix_value("rigid", "broken_faces")), (time.process_time() - start) / ready.certificate.steps


def breaks(height: float, **more) -> bool:
    """Whether the plate breaks when it falls from a height [m]."""
    fall = float(np.sqrt(2.0 * height / 9.81)) + 0.1
    return broken(PLATE.format(**{"pieces": 20, "accuracy": "balanced", "time": fall, "height": height} | more))[0] > 0


def height(**more) -> float:
    """The height from which the plate breaks [m]."""
    low, high = LOWEST, HIGHEST
    for _ in range(HALVINGS):
        middle = (low * high) ** 0.5
        low, high = (low, middle) if breaks(middle, **more) else (middle, high)
    return (low * high) ** 0.5


def heights() -> None:
    """A table of heights."""
    print("| strength [MPa] | balanced [m] | half the time step | 40 pieces |\n|---|---|---|---|")
    for strength in (100, 200, 400):
        found = [height(strength=strength, **more) for more in ({}, {"accuracy": "reference"}, {"pieces": 40})]
        print(f"| {strength} | " + " | ".join(f"{h:.2f}" for h in found) + " |", flush=True)


def blows() -> None:
    """Prints what a cylinder of glass of 8 x 12 cm bears that falls 1 m, and the load of a ball by Hertz."""
    print("| contact-stiffness | bore [MPa] | steps |\n|---|---|---|")
    for stiffness in (1, 4, 16, 36):
        ready = prepare(parse_scene(CYLINDER.format(stiffness=stiffness), "scene.txt"))
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(ready.certificate.steps)
            bore = ready.scene.solids[0].strength * instance.fix_value("rigid", "stress_share")
            print(f"| {stiffness} | {1e-6 * bore:.0f} | {ready.certificate.steps} |", flush=True)
    mass, radius, twice = float(ready.system.mass.sum()), 0.04, 2.0 * 9.81  # v^2 after 1 m
    hertz = (4.0 / 3.0 * 70e9 / (1.0 - 0.22**2) * radius**0.5) ** 0.4 * (1.25 * mass * twice) ** 0.6
    print(
        f"a ball of {mass:.2g} kg by Hertz: {hertz / (mass * twice / (0.02 * 2.0 * radius)):.2g} times the load of one 2 % deep"
    )


def cost() -> None:
    """Processor time of a step of a plate that lies still, by its pieces."""
    print("| pieces | glued [us] | apart [us] |\n|---|---|---|")
    for pieces in (2, 20, 200):
        row = []
        for strength in (1e6, 1e-3):
            text = PLATE.format(pieces=pieces, strength=strength, height=0.4, time=0.5, accuracy="balanced")
            row.append(1e6 * broken(text)[1])
        print(f"| {pieces} | {row[0]:.0f} | {row[1]:.0f} |", flush=True)


def many() -> None:
    """A wall of 10 000 bricks that a ball breaks: seconds to read, to model, and of a step."""
    start = time.process_time()
    scene = parse_scene(WALL.format(wide=20.0, high=10.0, middle=5.0, at=4.0, time=0.06), "scene.txt")
    read = time.process_time() - start
    ready = prepare(scene)
    made = time.process_time() - start - read
    with Instance(ready.plan) as instance:
        instance.setup()
        start, steps = time.process_time(), 20
        instance.run(steps)
        a_step = (time.process_time() - start) / steps
        print(f"{len(scene.solids) - 1} bricks: read {read:.1f} s, modelled {made:.1f} s, a step {1e3 * a_step:.1f} ms, "
              f"{instance.fix_value('rigid', 'broken_faces'):.0f} faces broken")  # fmt: skip


def rebound() -> None:
    """Largest upward speed of the centre of a block in two pieces, over that at which it came: whole, apart in the middle of the
    blow, and at once."""
    print("| cut | leans | whole | apart on the way | apart at once |\n|---|---|---|---|---|")
    for name, angle in itertools.product("abcd", (0.0, 0.5)):
        row = []
        for strength in (1e9, 3e4, 10.0):
            scene = Scene.from_text(BLOCK.format(name=name, angle=angle, strength=strength))
            with tempfile.TemporaryDirectory() as folder:
                scene.run(f"{folder}/out", movie=False, progress=False)
                with Trajectory(f"{folder}/out") as found:
                    mass = scene.prepared.system.mass_of
                    up = np.array(found.center_velocities)[:, :, 2] @ mass / mass.sum()
            row.append(f"{up.max() / abs(up).max():.2f}")
        print(f"| {name} | {angle:g}° | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    for what in sys.argv[1:] or ["heights", "blows", "cost", "many", "rebound"]:
        {"heights": heights, "blows": blows, "cost": cost, "many": many, "rebound": rebound}[what]()
