# SPDX-License-Identifier: GPL-2.0-only
"""Random scenes in which joints hold objects, ropes and what is driven together, above a ground."""

from __future__ import annotations

import random

SHAPES = (
    "box ({a:.3f}, {b:.3f}, {c:.3f}) m",
    "sphere {r:.3f} m",
    "cylinder {r:.3f} m {a:.3f} m",
    "ellipsoid ({r:.3f}, {b:.3f}, {c:.3f}) m",
)
APART = 0.28
"""Distance of objects that are joined [m]."""


def scene(seed: int) -> str:
    """One to six objects in a tree of joints, the first one at the world or at something driven; a rope at the last of them; one
    that stands by."""
    of = random.Random(seed)
    text = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n"
    places, driven, above = [(0.0, 0.0, 1.6)], of.random() < 0.35, (0.0, 0.0, 1.6 + APART)
    if driven:
        text += f"object base {{ shape box (20, 20, 6) cm position {_vector(above)} m density 1000 elasticity rigid hold all\n"
        text += f"{_drive(of)} }}\n"
    soft = of.random() < 0.2
    for n in range(of.randint(1, 6)):
        if n:
            places.append(_beside(of, places))
        text += _object(of, n, places[n], "1 MPa" if soft and n == 1 else "rigid")
    text += _joint(of, 0, "base" if driven else "world", places[0], above)
    for n in range(1, len(places)):
        other = of.randrange(n)
        text += _joint(of, n, f"o[{other}]", places[n], places[other])
    if of.random() < 0.35:
        text += _rope(of, len(places) - 1, places[-1])
    if of.random() < 0.5:
        text += "object idle { shape sphere 8 cm position (0.1, 0, 0.4) m density 1000 elasticity rigid }\n"
    return f"{text}control {{ time 0.4 s  friction {of.choice((0, 0.3, 0.6))} }}\n"


def _beside(of: random.Random, places: list) -> tuple:
    """A place beside one of these, and not near any."""
    while True:
        x, y, z = of.choice(places)
        ways = [of.gauss(0, 1) for _ in range(3)]
        size = sum(w * w for w in ways) ** 0.5
        at = tuple(c + APART * w / size for c, w in zip((x, y, z), ways))
        if at[2] > 0.5 and all(
            sum((a - b) ** 2 for a, b in zip(at, one)) > (0.99 * APART) ** 2 for one in [*places, (0.0, 0.0, 1.6 + APART)]
        ):
            return at


def _vector(values) -> str:
    return f"({', '.join(f'{v:.4f}' for v in values)})"


def _object(of: random.Random, n: int, at, stuff: str) -> str:
    sizes = {"a": of.uniform(0.08, 0.2), "b": of.uniform(0.05, 0.16), "c": of.uniform(0.05, 0.16), "r": of.uniform(0.04, 0.09)}
    shape = of.choice(SHAPES[:2] if stuff != "rigid" else SHAPES).format(**sizes)
    moves = ""
    if of.random() < 0.2:
        moves = f"velocity {_vector(of.uniform(-1, 1) for _ in range(3))} m/s "
        moves += f"spin {_vector(of.uniform(-3, 3) for _ in range(3))} rad/s"
    return (
        f"object o[{n}] {{ shape {shape}  position {_vector(at)} m  density {of.choice((300, 900, 2700, 7800))}\n"
        f"  elasticity {stuff}  {moves} }}\n"
    )


def _joint(of: random.Random, n: int, other: str, at, there) -> str:
    """A joint of a random kind beside the first one, towards the other."""
    kind = of.choice(("weld", "ball", "hinge", "hinge", "slider", "spring"))
    words = [f"at {_vector(a + 0.3 * (b - a) for a, b in zip(at, there))} m"]
    if kind == "spring":
        words = [f"to {_vector(there)} m"]
        words += of.choice(
            ([], ["pulls only"], [f"stiffness {10 ** of.uniform(2, 4):.0f} N/m  length {of.uniform(0.2, 0.4):.3f} m"])
        )
    if kind in ("hinge", "slider"):
        unit, way, force = ("rad", 1.0, "N*m") if kind == "hinge" else ("m", 0.1, "N")
        most = 10 ** of.uniform(-1, 1.3)
        words.append(f"axis {_vector(of.gauss(0, 1) for _ in range(3))}")
        if of.random() < 0.4:
            limit = of.choice(("", f"{'torque' if kind == 'hinge' else 'force'} {most:.3f} {force}"))
            words.append(f"motor speed {of.uniform(-3, 3) * way:.3f} {unit}/s {limit}")
        if of.random() < 0.3:
            words.append(f"friction {0.3 * most:.3f} {force}")
        if of.random() < 0.5:
            words.append(f"limits {-way * of.uniform(0.05, 1):.3f} {unit} to {way * of.uniform(0.05, 1):.3f} {unit}")
    if of.random() < 0.08:
        words.append(f"breaks {10 ** of.uniform(0.5, 2.5):.2f} N")
    return f"joint {kind} o[{n}] {other} {{ {'  '.join(words)} }}\n"


def _drive(of: random.Random) -> str:
    u = of.uniform
    return of.choice(
        (
            f"drive oscillation {_vector(u(-2, 2) for _ in range(3))} cm frequency {u(1, 6):.2f} Hz",
            f"drive turn {_vector(u(-3, 3) for _ in range(3))} rad/s",
            f"drive velocity {_vector(u(-0.4, 0.4) for _ in range(3))} m/s",
        )
    )


def _rope(of: random.Random, n: int, at) -> str:
    """A rope from the world to the middle of an object, which a ball joint holds."""
    start = (at[0] + of.uniform(0.2, 0.5), at[1] + of.uniform(-0.3, 0.3), at[2] + of.uniform(0.2, 0.5))
    kind = of.choice(("rope", "chain"))
    return (
        f"object line {{ shape {kind} from {_vector(start)} m to {_vector(at)} m thickness {of.uniform(0.006, 0.02):.4f} m\n"
        f"  density {of.choice((600, 1500))} elasticity {10 ** of.uniform(6, 8):.0f} damping 0.1  hold start }}\n"
        f"joint ball line o[{n}] {{ at {_vector(at)} m }}\n"
    )
