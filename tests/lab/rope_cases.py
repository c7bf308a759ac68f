# SPDX-License-Identifier: GPL-2.0-only
"""Ropes against closed forms: scenes, what is measured of them, and what theory says. Printed by ``python bench/ropes.py``."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from scipy.optimize import brentq

G = 9.81
DOWN = f"gravity (0, 0, -{G}) m/s^2\n"


def rope(shape: str, *more: str, name: str = "line") -> str:
    """An object of a density of 1000 kg/m^3."""
    return f"object {name} {{ shape {shape}  density 1000 kg/m^3  {'  '.join(more)} }}\n"


def made(text: str, time: float = 1.0):
    """A prepared scene."""
    return prepare(parse_scene(f"{text}control {{ time {time} s }}\n"))


def settled(text: str, time: float, *commands: str) -> tuple[np.ndarray, object]:
    """Positions after this time [s], with further commands for LAMMPS, and the prepared scene."""
    ready = made(text, time)
    with Instance(ready.plan) as instance:
        for command in commands:
            instance.lammps.lmp.command(command)
        instance.setup()
        instance.run(round(time / ready.certificate.timestep))
        return instance.array("x").copy(), ready


def tension(ready, x: np.ndarray) -> np.ndarray:
    """Pull of the links of the first object, a rope [N], shape (L,): of all springs that a section between two particles cuts."""
    system, links = ready.system, int(ready.system.first[1]) - 1
    pair = system.spring[np.searchsorted(system.object[system.spring[:, 0]], [0])[0] :]
    keep = pair[:, 1] <= links
    pair, k, rest = pair[keep], system.stiffness[: len(keep)][keep], system.rest[: len(keep)][keep]
    pull = k * (np.linalg.norm(x[pair[:, 0]] - x[pair[:, 1]], axis=1) - rest)
    found = np.zeros(links)
    for (i, j), force in zip(pair, pull):
        found[i:j] += force
    return found


def sag(kind: str, thickness: str, young: str, links: int, slack: float = 1.1) -> tuple[float, float]:
    """Sag of a rope of a length of `slack` m over a span of 1 m, after it has swung and come to rest, and of the catenary [m]."""
    drag = 0.05 if kind == "chain" else 0.02
    text = DOWN + rope(
        f"{kind} from (0, 0, 1) m to (1, 0, 1) m thickness {thickness} length {slack} m",
        f"elasticity {young}  hold ends  velocity (0.5, 0.8, 0.3) m/s  drag {drag} N*s/m  damping 0.2",
        f"resolution {slack / links} m",
    )
    x, _ = settled(text, 12.0)
    half = brentq(lambda t: math.sinh(t) / t - slack, 1e-6, 20.0)
    return 1.0 - float(x[:, 2].min()), (math.cosh(half) - 1.0) / (2.0 * half)


def stretch(kind: str, thickness: str = "1 cm") -> tuple[float, float]:
    """Elongation of a rope of 1 m that hangs from its start, and rho g L^2/2 E [m]."""
    text = DOWN + rope(
        f"{kind} from (0, 0, 1) m to (0, 0, 0) m thickness {thickness}", "elasticity 200 kPa  hold start  drag 0.6 N*s/m"
    )
    x, _ = settled(text, 6.0)
    return -float(x[-1, 2]), 1000.0 * G / (2.0 * 200e3)


def note(kind: str, strain: float, young: float = 100e6, thickness: float = 5e-3) -> tuple[float, float]:
    """Frequency of a rope that is stretched over 1 m, plucked softly, and sqrt(T/mu)/2 L [Hz]."""
    length = 1.0 / (1.0 + strain)
    text = rope(
        f"{kind} from (0, 0, 0) m to (1, 0, 0) m thickness {thickness} m length {length!r} m",
        f"elasticity {young} Pa  hold ends  velocity (0, 0, 0.01) m/s",
    )
    ready = made(text)
    area = math.pi * thickness**2 / 4.0
    expected = math.sqrt(young * area * strain / (1000.0 * area * length)) / 2.0
    mode = np.sin(math.pi * ready.system.position[:, 0])
    dt = ready.certificate.timestep
    steps = max(1, round(0.02 / expected / dt))
    crossed, before = [], 0.0
    with Instance(ready.plan) as instance:
        instance.setup()
        for n in range(1, 300):
            instance.run(steps)
            now = float(mode @ instance.array("x")[:, 2])
            if before and now * before < 0.0:
                crossed.append((n - now / (now - before)) * steps * dt)
            before = now
    return (len(crossed) - 1) / (2.0 * (crossed[-1] - crossed[0])), expected


def cantilever(thickness: float, young: float, length: float = 0.5) -> tuple[float, float]:
    """Deflection of the tip of a rope whose first link is held, by its weight, and w l^4/8 E I [m]; the clamp is in the middle of
    that link."""
    links = round(length / thickness)
    h = length / links
    text = DOWN + rope(
        f"rope from (0, 0, 0) m to ({length}, 0, 0) m thickness {thickness} m",
        f"elasticity {young} Pa  hold within box (-1, -1, -1) m to ({1.5 * h}, 1, 1) m  drag 2 N*s/m  resolution {h!r} m",
    )
    x, _ = settled(text, 3.0)
    free = length - 0.5 * h
    inertia, weight = math.pi * thickness**4 / 64.0, 1000.0 * G * math.pi * thickness**2 / 4.0
    return -float(x[-1, 2]), weight * free**4 / (8.0 * young * inertia)


ROLLER = "object roller {{ shape cylinder {R} m 20 cm  orientation axis (1, 0, 0) angle 90 deg  position (0, 0, 0) m\n" \
    "  density 1000 kg/m^3  elasticity {young}  hold all  friction {mu} }}\n"  # fmt: skip


def capstan(kind: str, wrap: int, mu: float = 0.3, thickness: float = 0.01, radius: float = 0.1) -> tuple[float, float]:
    """T2/T1 of a rope around a held roller that slips towards T2, and e^(mu alpha).

    It lies on the roller, and is pulled down at one end, for 180 degrees at both; then one is held, and the pull on the other one
    grows slowly.
    """
    top, reach = radius + thickness / 2 + 1e-4, 0.35
    text = rope(
        f"{kind} from (-{reach}, 0, {top}) m to ({reach}, 0, {top}) m thickness {thickness} m",
        f"elasticity 5 MPa  friction {mu}  drag 0.3 N*s/m  damping 0.2",
        "hold start" if wrap == 90 else "",
    ) + ROLLER.format(R=radius, young="5 MPa", mu=mu)
    ready = made(text)
    last, dt = int(ready.system.first[1]), ready.certificate.timestep
    soft, full = 2.0, 16.0
    begin, grows = round(0.8 / dt), round(1.2 / dt)
    with Instance(ready.plan) as instance:
        lmp = instance.lammps.lmp
        lmp.command(f"group tip id {last}")
        lmp.command("group root id 1")
        lmp.command(f"variable pull equal -{soft}-{full - soft}*(step>{begin})*(step-{begin})/{grows}")
        lmp.command("fix pull tip addforce 0 0 v_pull")
        if wrap == 180:
            lmp.command(f"fix hang root addforce 0 0 -{soft}")
        instance.setup()
        instance.run(begin)
        if wrap == 180:
            lmp.command("unfix hang")
            lmp.command("fix anchor root spring/self 1e5")
            instance.setup()
        instance.run(grows)
        x = instance.array("x").copy()
    pull = tension(ready, x)
    return float(pull[-8:-2].mean() / pull[2:8].mean()), math.exp(mu * math.radians(wrap))


def fall(friction: float, thickness: float = 0.02) -> float:
    """Energy that a rope has gained after it has fallen flat on the ground from 0.5 m, over that of the fall."""
    shape = f"rope from (0, 0, {0.5 + thickness / 2}) m to (1, 0, {0.5 + thickness / 2}) m thickness {thickness} m"
    ready = made("ground z 0 m\n" + DOWN + rope(shape, f"elasticity 5 MPa  friction {friction}"), 0.5)
    with Instance(ready.plan) as instance:
        instance.setup()
        begin = energies(instance, ready.system.center_of_mass(instance.array("x")))
        instance.run(round(0.45 / ready.certificate.timestep))
        end = energies(instance, ready.system.center_of_mass(instance.array("x")))
    assert (end.get("friction_heat", 0.0) + end.get("contact_damping_loss", 0.0) > 0.0) == (friction > 0.0)
    return float(sum(end.values()) - sum(begin.values())) / (G * float(ready.system.mass.sum()) * 0.5)


def pulley(kind: str, mu: float = 0.5, density: float = 2000.0, thickness: float = 0.01, radius: float = 0.1):
    """Acceleration of a rope that runs over a pulley on a hinge, pulled by F1 and F2 at its ends, which rubs without slipping:
    (F1 - F2)/(m + I/r^2) with r in the middle of the rope [m/s^2]. An Atwood machine has the weights m1 g and m2 g, and these
    masses besides."""
    r, wide, low, more = radius + 0.5 * thickness, 0.1, 8.0, 4.0
    line = rope(
        f"{kind} from ({-r}, 0, -0.25) m to ({r}, 0, -0.25) m thickness {thickness} m",
        f"runs over wheel  elasticity 20 MPa  friction {mu}  damping 0.5",
    )
    wheel = f"shape cylinder {radius} m {wide} m  orientation axis (1, 0, 0) angle 90 deg  position (0, 0, 0) m"
    ready = made(
        f"{line}object wheel {{ {wheel}  density {density}  elasticity rigid  friction {mu} }}\n"
        "joint hinge wheel world { axis (0, 1, 0) }\n"
    )
    last, dt = int(ready.system.first[1]), ready.certificate.timestep
    own = slice(last, None)
    inertia, mass = 0.5 * density * math.pi * radius**4 * wide, float(ready.system.mass[:last].sum())
    with Instance(ready.plan) as instance:
        lmp = instance.lammps.lmp
        for command in (f"group tip id {last}", "group root id 1", "group both union tip root", f"group line id 1:{last}"):
            lmp.command(command)
        lmp.command(f"fix pull both addforce 0 0 -{low}")
        lmp.command("fix calm line viscous 0.02")
        instance.setup()
        instance.run(round(0.1 / dt))
        lmp.command("unfix calm")
        lmp.command(f"fix more tip addforce 0 0 -{more}")
        instance.setup()
        spins = []
        for seconds in (0.1, 0.15):
            instance.run(round(seconds / dt))
            x, v = instance.array("x")[own], instance.array("v")[own]
            arm = x - x.mean(axis=0)
            arm[:, 1] = 0.0
            spins.append(float(np.cross(arm, v)[:, 1].sum() / (arm**2).sum()))
    return abs(spins[1] - spins[0]) / 0.15 * r, more / (mass + inertia / r**2)


def whirl(kind: str, speed: float = 5.0, radius: float = 0.04) -> tuple[float, float]:
    """Mean pull of a rope of 1 m that whirls a ball of 1 kg on a joint at its end, and m v^2/r [N]."""
    reach, pull = 1.0 + radius, speed**2 / (1.0 + radius)
    length = 1.0 / (1.0 + pull / (20e6 * math.pi * 0.01**2 / 4.0))
    turn = f"spin (0, 0, {speed / reach!r}) rad/s"
    text = rope(
        f"{kind} from (0, 0, 0) m to (1, 0, 0) m thickness 1 cm length {length!r} m",
        f"elasticity 20 MPa  damping 0.2  hold start  {turn}  velocity (0, {0.5 * speed / reach!r}, 0) m/s",
    )
    text += f"object ball {{ shape sphere {radius} m  position ({reach}, 0, 0) m  mass 1 kg  elasticity rigid  {turn}\n"
    text += f"  velocity (0, {speed!r}, 0) m/s }}\njoint ball line ball {{ at (1, 0, 0) m }}\n"
    ready = made(text)
    of_ball, pulls, wanted = slice(int(ready.system.first[1]), None), [], []
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(60):
            instance.run(round(0.02 / ready.certificate.timestep))
            x, v = instance.array("x"), instance.array("v")[of_ball]
            pulls.append(tension(ready, x)[-1])
            wanted.append(float((v.mean(0) ** 2).sum() / np.linalg.norm(x[of_ball].mean(0))))
    return float(np.mean(pulls[20:])), float(np.mean(wanted[20:]))


CASES: dict[str, tuple[Callable[[], tuple[float, float]], float]] = {
    "sag of a chain of 40 particles, slack 1.1": (lambda: sag("chain", "5 mm", "100 MPa", 39), 0.005),
    "sag of a rope of 2 mm, 20 MPa": (lambda: sag("rope", "2 mm", "20 MPa", 80), 0.005),
    "stretch of a chain by its weight": (lambda: stretch("chain"), 0.005),
    "stretch of a rope by its weight": (lambda: stretch("rope"), 0.005),
    "frequency of a stretched chain, strain 1 %": (lambda: note("chain", 0.01), 0.01),
    "frequency of a stretched rope, strain 1 %": (lambda: note("rope", 0.01), 0.01),
    "capstan, chain, 90 degrees": (lambda: capstan("chain", 90), 0.03),
    "capstan, rope, 90 degrees": (lambda: capstan("rope", 90), 0.03),
    "capstan, chain, 180 degrees": (lambda: capstan("chain", 180), 0.03),
    "capstan, rope, 180 degrees": (lambda: capstan("rope", 180), 0.03),
    "pulley that turns, chain": (lambda: pulley("chain"), 0.015),
    "pulley that turns, rope": (lambda: pulley("rope"), 0.015),
    "whirls a ball on a joint, chain": (lambda: whirl("chain"), 0.01),
    "whirls a ball on a joint, rope": (lambda: whirl("rope"), 0.01),
    "cantilever, 2 cm, 25 links": (lambda: cantilever(0.02, 50e6), 0.03),
    "cantilever, 1 cm, 50 links": (lambda: cantilever(0.01, 200e6), 0.03),
}
"""Cases and the largest error of each."""
