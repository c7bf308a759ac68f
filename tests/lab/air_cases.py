# SPDX-License-Identifier: GPL-2.0-only
"""Objects in air against closed forms: scenes, what is measured of them, and what theory says; ``python bench/air.py``."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from scipy.optimize import brentq

G, RHO, C = 9.81, 1.2, 1.2
DOWN = f"gravity (0, 0, -{G}) m/s^2\n"


def made(text: str, time: float):
    """A prepared scene of this length [s]."""
    return prepare(parse_scene(f"{text}control {{ time {time!r} s  frames {10.0 / time!r} fps }}\n"))


def after(text: str, time: float) -> tuple[np.ndarray, np.ndarray, object]:
    """Places [m] and velocities [m/s] of all particles after this time [s], shape (N, 3) each, and the prepared scene."""
    ready = made(text, time)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(round(time / ready.certificate.timestep))
        return instance.array("x").copy(), instance.array("v").copy(), ready


def mean(ready, values: np.ndarray) -> np.ndarray:
    """Mean of the particles of the first object, weighted by masses, shape (3,)."""
    return ready.system.center_of_mass(values)[0]


def turning(ready, x: np.ndarray, v: np.ndarray, axis: np.ndarray) -> float:
    """Angular velocity of the first object, which does not deform, about an axis through its centre [rad/s]."""
    own = slice(0, int(ready.system.first[1]))
    arm = x[own] - x[own].mean(axis=0)
    across = arm - np.outer(arm @ axis, axis)
    return float((np.cross(across, v[own] - v[own].mean(axis=0)) @ axis).sum() / (across**2).sum())


def face_on(size: float, thick: float, density: float, elasticity: str, part: float) -> tuple[float, float]:
    """Speed of a plate that falls face on, after `part` of v/g, where it is v tanh(part) with v = sqrt(2 m g/(rho C A)) [m/s]."""
    last = math.sqrt(2.0 * density * thick * G / (RHO * C))
    plate = f"shape box ({size}, {size}, {thick}) m  position (0, 0, 0) m  density {density}  elasticity {elasticity}"
    _, v, ready = after(f"{DOWN}air {{ }}\nobject plate {{ {plate} }}\n", part * last / G)
    return -float(mean(ready, v)[2]), last * math.tanh(part)


def falling_sheet(size: float, thick: float, density: float, part: float) -> tuple[float, float]:
    """The same of a sheet, which air pushes at from both sides."""
    last = math.sqrt(2.0 * density * thick * G / (RHO * C))
    sheet = f"shape sheet ({size}, {size}) m thickness {thick} m  position (0, 0, 0) m  density {density}  elasticity 1 MPa"
    _, v, ready = after(f"{DOWN}air {{ }}\nobject sheet {{ {sheet} }}\n", part * last / G)
    return -float(mean(ready, v)[2]), last * math.tanh(part)


def ball_rate(radius: float, density: float) -> float:
    """k of dv/dt = -k v^2 for a ball, with half of C: rho C A/4 m [1/m]."""
    return 3.0 * RHO * C / (16.0 * density * radius)


def falling_ball(radius: float, density: float, elasticity: str, part: float) -> tuple[float, float]:
    """The same of a ball, with v = sqrt(g/k) [m/s]."""
    last = math.sqrt(G / ball_rate(radius, density))
    ball = f"shape sphere {radius} m  position (0, 0, 0) m  density {density}  elasticity {elasticity}"
    _, v, ready = after(f"{DOWN}air {{ }}\nobject ball {{ {ball} }}\n", part * last / G)
    return -float(mean(ready, v)[2]), last * math.tanh(part)


def ball_in_wind(radius: float, density: float, elasticity: str, wind: float, part: float) -> tuple[float, float]:
    """Speed of a ball at rest in wind w after `part` of 1/(k w): w part/(1 + part) [m/s]."""
    ball = f"shape sphere {radius} m  position (0, 0, 0) m  density {density}  elasticity {elasticity}"
    time = part / (ball_rate(radius, density) * wind)
    _, v, ready = after(f"air {{ wind ({wind}, 0, 0) m/s }}\nobject ball {{ {ball} }}\n", time)
    return float(mean(ready, v)[0]), wind * part / (1.0 + part)


def closed_sheet(radius: float, thick: float, wind: float, inside: str = "") -> tuple[float, float]:
    """Force of wind on a ball that is a closed sheet, at the start, which air pushes at from outside alone, as at a solid one:
    C rho pi r^2 w^2/4 [N]."""
    skin = f"shape sphere {radius} m sheet thickness {thick} m  position (0, 0, 0) m  density 900  elasticity 1 MPa  {inside}"
    ready = made(f"air {{ wind ({wind}, 0, 0) m/s }}\nobject skin {{ {skin} }}\n", 0.1)
    with Instance(ready.plan) as instance:
        instance.setup()
        return float(instance.fix_rows("air", 1, 3)[0, 0]), C * RHO * math.pi * (radius * wind) ** 2 / 4.0


def turning_plate(elasticity: str, part: float = 2.0, thick: float = 0.01) -> tuple[float, float]:
    """Angular velocity of a plate that turns about a line in its middle: w/(1 + c w t), c = rho C b a^4/64 I, after `part` of
    1/(c w) [rad/s]."""
    a, b, density, spin = 0.4, 0.3, 60.0 * 0.01 / thick, 20.0
    inertia = density * a * b * thick * (a**2 + thick**2) / 12.0
    rate = RHO * C * b * a**4 / 64.0 / inertia
    plate = f"shape box ({a}, {b}, {thick}) m  position (0, 0, 0) m  density {density}  elasticity {elasticity}"
    plate += f"  spin (0, {spin}, 0) rad/s"
    x, v, ready = after(f"air {{ }}\nobject plate {{ {plate} }}\n", part / (rate * spin))
    return turning(ready, x, v, np.array([0.0, 1.0, 0.0])), spin / (1.0 + part)


PITCH, HUB, TIP, CHORD, THICK = 60.0, 0.07, 0.5, 0.12, 0.01
"""Angle of blades to the axis [deg]; radii of their ends, width and thickness [m]."""


def rotor(elasticity: str = "rigid") -> str:
    """Four pitched blades, which a hub holds together, on a hinge without friction along x."""
    text = "object hub { shape box (4, 16, 16) cm  position (0, 0, 0) m  density 300  elasticity rigid }\n"
    text += "joint hinge hub world { axis (1, 0, 0) }\n"
    text += "effects { contact off }\n"  # its parts never meet
    middle = 0.5 * (HUB + TIP)
    for n in range(4):
        angle = math.radians(90.0 * n)
        at = (0.0, -round(HUB * math.sin(angle), 9), round(HUB * math.cos(angle), 9))
        turn = f"orientation axis (1, 0, 0) angle {90 * n} deg"
        blade = f"shape box ({100 * THICK}, {100 * CHORD}, {100 * (TIP - HUB)}) cm  density 100  elasticity {elasticity}"
        text += (
            f"group sail{n} {{ object blade {{ {blade}  position (0, 0, {middle}) m"
            f"  orientation axis (0, 0, 1) angle {90.0 - PITCH} deg }} }}\n"
            f"place sail{n} as s{n} {{ {turn} }}\n"
            f"joint weld s{n}.blade hub {{ at ({at[0]}, {at[1]}, {at[2]}) m }}\n"
        )
    return text


def autorotation(wind: float) -> tuple[float, float]:
    """Angular velocity W of the rotor where the torque of all strips of its blades is 0 [rad/s]: the sum over both pairs of sides
    of their widths, times int |u| u r dr n_t with u = w n_x - W r n_t."""
    x, v, ready = after(f"air {{ wind ({wind}, 0, 0) m/s }}\n{rotor()}", 40.0 / wind)
    turn, r = math.radians(90.0 - PITCH), np.linspace(HUB, TIP, 4001)

    def torque(rate: float) -> float:
        found = 0.0
        for width, x, y in ((CHORD, math.cos(turn), math.sin(turn)), (THICK, -math.sin(turn), math.cos(turn))):
            u = wind * x - rate * r * y
            found += width * y * float(np.trapezoid(np.abs(u) * u * r, r))
        return found

    expected = brentq(torque, 0.0, 100.0 * wind)
    return abs(turning(ready, x, v, np.array([1.0, 0.0, 0.0]))), expected


def leaning_rope(thickness: float, density: float, wind: float) -> tuple[float, float]:
    """Angle from the vertical of a rope that hangs in wind: rho C d (w cos a)^2/2 = rho_s (pi d^2/4) g sin a [rad]."""
    end = "from (0, 0, 1) m to (0, 0, 0) m"
    line = f"shape rope {end} thickness {thickness} m  density {density}  elasticity 100 kPa  hold start  damping 0.5"
    x, _, _ = after(f"{DOWN}air {{ wind ({wind}, 0, 0) m/s }}\nobject line {{ {line} }}\n", 8.0)
    weight = density * math.pi * thickness / 4.0 * G
    expected = brentq(lambda a: RHO * C / 2.0 * (wind * math.cos(a)) ** 2 - weight * math.sin(a), 0.0, math.pi / 2)
    return math.atan2(x[-1, 0] - x[0, 0], x[0, 2] - x[-1, 2]), expected


def falling_rope(thickness: float, density: float) -> tuple[float, float]:
    """Last speed of a rope that falls across its length: sqrt(pi rho_s d g/(2 rho C)) [m/s]."""
    last = math.sqrt(math.pi * density * thickness * G / (2.0 * RHO * C))
    line = f"shape rope from (0, 0, 1) m to (1, 0, 1) m thickness {thickness} m  density {density}  elasticity 2 MPa"
    _, v, ready = after(f"{DOWN}air {{ }}\nobject line {{ {line} }}\n", 3.0 * last / G)
    return -float(mean(ready, v)[2]), last * math.tanh(3.0)


Case = Callable[[], tuple[float, float]]
CASES: dict[str, tuple[Case, float]] = {
    "plate face on, rigid, 40 cm, 1 cm of 40 kg/m^3": (lambda: face_on(0.4, 0.01, 40.0, "rigid", 3.0), 0.005),
    "plate face on, rigid, 2 m, 5 mm of 800 kg/m^3": (lambda: face_on(2.0, 0.005, 800.0, "rigid", 3.0), 0.005),
    "plate face on, half way, rigid": (lambda: face_on(0.4, 0.01, 40.0, "rigid", 0.5), 0.005),
    "plate face on, 1 MPa, 20 cm, 5 cm of 20 kg/m^3": (lambda: face_on(0.2, 0.05, 20.0, "1 MPa", 1.0), 0.01),
    "sheet face on, 40 cm, 1 mm of 300 kg/m^3": (lambda: falling_sheet(0.4, 0.001, 300.0, 2.0), 0.005),
    "ball falls, rigid, 10 cm of 30 kg/m^3": (lambda: falling_ball(0.1, 30.0, "rigid", 3.0), 0.005),
    "ball falls, 100 kPa, 10 cm of 10 kg/m^3": (lambda: falling_ball(0.1, 10.0, "100 kPa", 2.0), 0.02),
    "ball in wind, rigid, 5 m/s": (lambda: ball_in_wind(0.1, 10.0, "rigid", 5.0, 3.0), 0.01),
    "ball in wind, rigid, 30 m/s": (lambda: ball_in_wind(0.02, 50.0, "rigid", 30.0, 10.0), 0.01),
    "ball in wind, 100 kPa, 10 m/s": (lambda: ball_in_wind(0.1, 5.0, "100 kPa", 10.0, 1.0), 0.02),
    "closed sheet in wind, 10 cm, 5 m/s": (lambda: closed_sheet(0.1, 0.001, 5.0), 0.02),
    "closed sheet in wind, 30 cm, 10 m/s, inflated": (lambda: closed_sheet(0.3, 0.002, 10.0, "inflate 1 kPa"), 0.02),
    "plate that turns, rigid": (lambda: turning_plate("rigid"), 0.01),
    "plate that turns, 1 MPa": (lambda: turning_plate("1 MPa", 0.5, 0.05), 0.02),
    "windmill, 4 m/s": (lambda: autorotation(4.0), 0.01),
    "windmill, 12 m/s": (lambda: autorotation(12.0), 0.01),
    "rope hangs in wind of 4 m/s": (lambda: leaning_rope(0.02, 100.0, 4.0), 0.01),
    "rope falls across": (lambda: falling_rope(0.01, 100.0), 0.01),
}
"""Each with the largest relative difference."""


def residual(text: str, time: float) -> float:
    """Energy that is missing or too much after a time [s], over the largest term of the ledger."""
    ready = made(text, time)
    with Instance(ready.plan) as instance:
        instance.setup()
        center = ready.system.center_of_mass(instance.array("x"))
        first = energies(instance, center)
        instance.run(round(time / ready.certificate.timestep))
        last = energies(instance, ready.system.center_of_mass(instance.array("x")))
    change = {term: last[term] - first[term] for term in first}
    sources = change.pop("work", 0.0)
    return abs(sum(change.values()) - sources) / max(abs(sources), *map(abs, change.values()))


def closed_rows(cases: dict) -> tuple[list[str], list[list]]:
    """All cases that have a closed form, as a table."""
    rows = []
    for name, (case, most) in cases.items():
        found, expected = case()
        rows.append([name, f"{found:.4g}", f"{expected:.4g}", f"{100 * (found / expected - 1):+.2f} %", f"{100 * most:g} %"])
    return ["case", "found", "closed form", "off by", "at most"], rows
