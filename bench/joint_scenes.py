#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-only
"""Joints of scenes against closed forms (docs/physics-joints.md), and what they cost.

python bench/joint_scenes.py [forms] [cost] [welds]
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.joints.rows import BROKEN, FORCE, NUMBER, RATE, WAY
from mdanim_lammps.run.energy import energies, tell
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene, parse_scene
from scipy.special import ellipk

G = 9.81
CRANK = Path(__file__).parents[1] / "scenes" / "crank.txt"
STROKE = 0.4
"""Stroke of its piston [m]."""
DOWN = "gravity (0, 0, -9.81) m/s^2\n"
ROD = (
    DOWN
    + """let a = {angle} deg
object rod {{
  shape box (4, 4, 100) cm position (0.5*sin(a), 0, 2 - 0.5*cos(a)) m orientation axis (0, 1, 0) angle -a
  density 700 elasticity {elasticity}
}}
joint hinge rod world {{ at (0, 0, 2) m axis (0, 1, 0) }}
control {{ time 20 s {more} }}
"""
)
DOUBLE = (
    DOWN
    + """let wood = { density 700 elasticity rigid }
object upper { use wood shape box (50, 4, 4) cm position (25, 0, 200) cm }
object lower { use wood shape box (50, 4, 4) cm position (75, 4.5, 200) cm }
joint hinge upper world { at (0, 0, 2) m axis (0, 1, 0) }
joint hinge lower upper { at (0.5, 0.0225, 2) m axis (0, 1, 0) }
control { time 10 s }
"""
)
CHAIN = (
    DOWN
    + """repeat i in 1 .. 20 {
  object link[i] { shape box (1, 1, 5.4) cm position (0, 0, 200 - 6*(i - 0.5)) cm density 7800 elasticity rigid }
}
joint ball link[1] world { at (0, 0, 2) m }
repeat i in 1 .. 19 { joint ball link[i] link[i + 1] { at (0, 0, 200 - 6*i) cm } }
control { time 60 s }
"""
)
WHEEL = """object wheel { shape cylinder 20 cm 5 cm density 7800 position (0, 0, 1) m elasticity rigid }
joint hinge wheel world { axis (0, 0, 1) motor speed 60 rpm torque 2 N*m }
control { time 10 s }
"""
BREAKS = """let water = { density 1000 elasticity rigid shape sphere 5 cm }
object mass { use water position (0, 0, 1) m }
object puller { use water position (0, 0, 0) m }
joint ball mass world { at (0, 0, 1.05) m breaks 20 N }
joint slider puller world { axis (0, 0, -1) motor speed 0.2 m/s }
joint spring mass puller { stiffness 100 N/m }
control { time 3 s }
"""
SPRING = """object mass { shape sphere 5 cm density 1000 elasticity rigid position (0, 0, 0.6) m }
joint spring mass world { to (0, 0, 1) m length 30 cm stiffness 80 N/m }
control { time 10 s }
"""
NET = (
    DOWN
    + """let n = {n}
repeat i in 0 .. n {{ repeat k in 0 .. n {{
  object knot[1000*i + k] {{ shape sphere 5 mm position (10*i, 10*k, 200) cm density 7800 elasticity rigid }}
}} }}
repeat i in 0 .. n {{ repeat k in 0 .. n - 1 {{
  joint spring knot[1000*i + k] knot[1000*i + k + 1] {{ pulls only }}
  joint spring knot[1000*k + i] knot[1000*k + 1000 + i] {{ pulls only }}
}} }}
repeat i in 0 .. 1 {{ repeat k in 0 .. 1 {{ joint ball knot[1000*n*i + n*k] world {{ }} }} }}
control {{ time 1 s }}
"""
)


class Run:
    """A scene for a time [s], looked at several times."""

    def __init__(self, text: str, seconds: float, looks: int = 200):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "joints.txt"
            path.write_text(text)
            ready = prepare(load_scene(path))
        dt = ready.certificate.timestep
        times, rows, self.energies = [], [], []
        with Instance(ready.plan) as instance:
            instance.setup()
            for _ in range(looks + 1):
                told = tell(instance)["joint"]["value"]
                rows.append(told[np.argsort(told[:, NUMBER])])
                times.append(instance.step * dt)
                self.energies.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
                instance.run(max(1, round(seconds / dt / looks)))
            self.place = instance.array("x").copy() - ready.system.position
        self.time, self.rows = np.array(times), np.array(rows)

    def column(self, which: int, joint: int = 0) -> np.ndarray:
        return self.rows[:, joint, which]

    def period(self, about: float) -> float:
        """Mean time between passages upwards."""
        y = self.column(WAY) - about
        up = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
        at = self.time[up] - y[up] * np.diff(self.time)[up] / np.diff(y)[up]
        return float((at[-1] - at[0]) / (len(at) - 1))

    @property
    def residual(self) -> float:
        total = [sum(-v if k == "work" else v for k, v in e.items()) for e in self.energies]
        return float(np.ptp(total) / max(np.ptp([e[k] for e in self.energies]) for k in self.energies[0]))


def period_of_rod(angle: float, length: float = 1.0, wide: float = 0.04) -> float:
    """4 K(sin(a/2)) sqrt(I/(m g l/2)) [s]."""
    inertia = length**2 * (1.0 + wide**2) / 12.0 + length**2 / 4.0
    return float(4.0 * ellipk(np.sin(np.radians(angle) / 2.0) ** 2) * np.sqrt(inertia / (G * length / 2.0)))


def rod(angle: int, elasticity: str) -> tuple[float, float]:
    """Period of a rod on a hinge [s]."""
    more = "" if elasticity == "rigid" else "accuracy preview"
    run = Run(ROD.format(angle=angle, elasticity=elasticity, more=more), 3.3 * period_of_rod(angle), 400)
    return run.period(np.radians(angle)), period_of_rod(angle)


def bob() -> tuple[float, float]:
    """Period of a ball on a spring [s]."""
    return Run(SPRING, 4.0, 400).period(0.3), 2.0 * np.pi * np.sqrt(1000 * 4 / 3 * np.pi * 0.05**3 / 80.0)


def hangs() -> tuple[float, float]:
    """Force in the first joint of 20 links, and their weight [N]."""
    return Run(CHAIN, 1.0, 10).column(FORCE)[-1], 20 * 7800 * 1e-4 * 0.054 * G


@cache
def wheel() -> Run:
    """The flywheel on its motor."""
    return Run(WHEEL, 4.0)


def runs_up() -> tuple[float, float]:
    """Speed of a flywheel 1.5 s after its motor began with 2 N m, M t/I [rad/s]."""
    inertia, run = 0.5 * 7800 * np.pi * 0.2**2 * 0.05 * 0.2**2, wheel()
    at = int(np.searchsorted(run.time, 1.5))
    return run.column(RATE)[at], 2.0 * run.time[at] / inertia


def parts() -> tuple[float, float]:
    """Force at which a joint parts under a load that rises slowly [N]."""
    run = Run(BREAKS, 2.0, 2000)
    at = int(np.argmax(run.column(BROKEN) > 0.0))
    return 100.0 * (run.column(WAY, 2)[at] - 1.0), 20.0


def crank(turns: int) -> tuple[float, float]:
    """Place of the piston of scenes/crank.txt at the time in the last of these turns when its error is largest, and where it has
    to be [m]."""
    text = CRANK.read_text().partition("expect")[0].replace("time 4 s", f"time {turns} s")
    ready = prepare(parse_scene(text, "crank.txt"))
    dt, r, rod_length = ready.certificate.timestep, 0.2, 0.6
    found, step = [], 0
    with Instance(ready.plan) as instance:
        instance.setup()
        for time in turns - 1.0 + np.arange(1, 13) / 12.0:
            instance.run(round(time / dt) - step)
            step = round(time / dt)
            phase = 2.0 * np.pi * step * dt
            place = instance.system.center_of_mass(instance.array("x"))[2, 0]
            found.append((place, r * np.cos(phase) + np.sqrt(rod_length**2 - (r * np.sin(phase)) ** 2)))
    return max(found, key=lambda pair: abs(pair[0] - pair[1]))


Case = Callable[[], tuple[float, float]]
CASES: dict[str, tuple[Case, str]] = {
    **{
        f"period of a rod on a hinge, {angle}°, {kind}": (partial(rod, angle, kind), "s")
        for angle in (5, 120)
        for kind in ("rigid", "20 MPa")
    },
    "period of a ball on a spring": (bob, "s"),
    "force in the first joint of 20 links": (hangs, "N"),
    "speed of a wheel after 1.5 s of 2 N m, M t/I": (runs_up, "rad/s"),
    "its speed at last, that of the motor": (lambda: (wheel().column(RATE)[-1], 2.0 * np.pi), "rad/s"),
    "force at which a joint breaks": (parts, "N"),
}
"""Cases that give what is found and the closed form, and their unit."""


def double_pendulum() -> float:
    """Energy residual of ten seconds."""
    return Run(DOUBLE, 10.0).residual


def forms() -> None:
    """The table of closed forms."""
    print("| case | closed form | found | off |\n|---|---|---|---|")
    for what, (case, unit) in CASES.items():
        found, wanted = case()
        print(f"| {what} | {wanted:.5g} {unit} | {found:.5g} {unit} | {found / wanted - 1.0:+.1e} |", flush=True)
    print(f"\ndouble pendulum, 10 s: energy residual {double_pendulum():.1e}")


def cost() -> None:
    """Processor time of a joint in a step: that of the process, by the share that the fix has of the wall time."""
    for text, name in ((CHAIN, "chain of 20"), *((NET.format(n=n), f"net of {2 * n * (n + 1) + 4} joints") for n in (10, 70))):
        began = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "joints.txt"
            path.write_text(text)
            ready = prepare(load_scene(path))
        made = time.perf_counter() - began
        joints, steps = len(ready.plan.tables["joints"].splitlines()) - 1, 200
        with Instance(ready.plan) as instance:
            instance.setup()
            tries = []
            for _ in range(5):
                before, began, own = instance.fix_seconds("joints"), time.perf_counter(), time.process_time()
                instance.run(steps)
                wall, own = time.perf_counter() - began, time.process_time() - own
                tries.append((own * (instance.fix_seconds("joints") - before) / wall, own))
            took, all_of_it = np.min(tries, axis=0)
        print(
            f"{name}: {1e6 * took / steps / joints:.2f} us a joint and step, all of the step {1e3 * all_of_it / steps:.2f} ms, "
            f"modelling {made:.1f} s, time step {1e6 * ready.certificate.timestep:.0f} us",
            flush=True,
        )


TABLE = """gravity (0, 0, -9.81) m/s^2
ground z 0
object top { shape box (100, 60, 4) cm position (0, 0, 72) cm density 600 elasticity rigid }
repeat i in 1 .. 2 { repeat k in 1 .. 2 {
  object leg[i][k] { shape box (4, 4, 70) cm position (90*i - 135 cm, 50*k - 75 cm, 35 cm) density 600 elasticity rigid }
  joint weld leg[i][k] top { at (90*i - 135 cm, 50*k - 75 cm, 70 cm) }
} }
object crate { shape box (40, 40, 40) cm position (0, 0, 94) cm density 600 elasticity rigid }
control { time 2 s friction 0.5 }
"""


def welds() -> None:
    """Steps and processor time of scenes whose welds make one body of what they join, and with springs in place of them: a weld
    that may break is one."""
    scenes = Path(__file__).parents[1] / "scenes"
    print("scene: steps and processor time [s] with springs, as one body")
    for name in ("pendulum", "chairs", "table"):
        record = parse_scene(TABLE) if name == "table" else load_scene(scenes / f"{name}.txt")
        springs = [replace(j, breaks=(1e12, None)) if j.kind == "weld" else j for j in record.joints]
        found = []
        for joints in (tuple(springs), record.joints):
            ready = prepare(replace(record, joints=joints, expects=()))
            took = []
            for _ in range(3):
                with Instance(ready.plan) as instance:
                    instance.setup()
                    began = time.process_time()
                    instance.run(ready.certificate.steps)
                    took.append(time.process_time() - began)
            found.append(f"{ready.certificate.steps} {min(took):.2f}")
        print(f"{name}: {', '.join(found)}", flush=True)


if __name__ == "__main__":
    for name in sys.argv[1:] or ("forms", "cost", "welds"):
        {"forms": forms, "cost": cost, "welds": welds}[name]()
