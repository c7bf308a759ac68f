# SPDX-License-Identifier: GPL-2.0-only
"""Tables of bench/contact.py: what lies still on something, or slides on it without friction."""

import itertools
import math

import numpy as np
from contact_world import DENSITY, MODELS, STUFF, WAVE, YOUNG, World

LOADS = (0.001, 0.01)
"""rho g L / E with L = SIZE."""
SIZE = 0.2
"""Size of all bodies, about [m]."""
LYING = "orientation axis (1, 0, 0) angle 90 deg"
SHAPES = {
    "cube": ("box (20, 20, 20) cm", 10.0, 10.0, ""),
    "ball": ("sphere 10 cm", 10.0, 10.0, ""),
    "cylinder": ("cylinder 8 cm 12 cm", 6.0, 6.0, ""),
    "roller": ("cylinder 8 cm 20 cm", 8.0, 8.0, LYING),
    "cone": ("cone 10 cm 16 cm", 4.0, 12.0, ""),
    "torus": ("torus 10 cm 4 cm", 4.0, 4.0, ""),
}
"""Shape, height of its centre above its lowest point and below its highest one [cm], orientation."""
FIELD_CONTACT, OFFSET, DEPTH = 240, 12, 13
"""Bytes of a contact in the records of fix mdanim/contact (plugin/contact/field_contact.h), and numbers in it."""
LONGEST = 40
"""Tenths of a second until what moves is taken as it is."""
HERTZ_LOAD = 0.003
"""rho g R / E of a ball of radius R that lies still."""


VOLUME = {
    "cube": 8e-3,
    "ball": 4.0 / 3.0 * math.pi * 1e-3,
    "cylinder": math.pi * 0.08**2 * 0.12,
    "roller": math.pi * 0.08**2 * 0.2,
    "cone": math.pi / 3.0 * 0.1**2 * 0.16,
    "torus": 2.0 * math.pi**2 * 0.1 * 0.04**2,
}
"""[m^3]"""
CURVED = {"ball": (10.0, 10.0), "roller": (12.5, 0.0)}
"""Curvature along and across at the point in which others touch it [1/m]; others are flat there, but for those in NO_POINT."""
NO_POINT = {("torus", name) for name in SHAPES} | {(name, "torus") for name in SHAPES}
"""Pairs that touch along a ring."""
HALF_ANGLE = 0.1 / 0.16
"""Tangent of that of the cone's tip."""


def approach(below: str, above: str, load: float) -> float | None:
    """How much nearer two elastic bodies come than to where they touch [h], the lower one rigid: Hertz, and Sneddon for the tip
    of a cone, which is taken to press into a half-space. None for what touches along a line or over a face."""
    if (below, above) in NO_POINT:
        return None
    h, stiffness = SIZE / 8, 1.0 / (1.0 - 0.25**2)
    force = load / SIZE * VOLUME[above]  # over Young's modulus
    if below == "cone":
        return math.sqrt(0.5 * math.pi * force / (stiffness * HALF_ANGLE)) / h
    k, across = (a + b for a, b in zip(CURVED.get(below, (0.0, 0.0)), CURVED.get(above, (0.0, 0.0))))
    if not (k > 0.0 and across > 0.0):
        return None
    radius = 1.0 / math.sqrt(k * across)  # exact of circles, and a few hundredths off of the ellipses here
    return (9.0 / 16.0 * force**2 / (radius * stiffness**2)) ** (1.0 / 3.0) / h


def rest() -> tuple[list[str], list[list]]:
    """How deep the deepest point is below a surface, of what rests on a held body and touched it at the start [h], and in
    brackets how much nearer elastic bodies come by the closed form, at two loads; under the paper's law the gap on a cube."""
    rows = [[below, *(" / ".join(lies(below, above, load) for load in LOADS) for above in SHAPES)] for below in SHAPES]
    rows.append(["cube, paper's law", *(f"{-sunk('cube', above, LOADS[0], 'paper'):.2f}" for above in SHAPES)])
    return ["lies on", *SHAPES], rows


def lies(below: str, above: str, load: float) -> str:
    """Row of one pair; empty if it has fallen off."""
    depth, way = sunk(below, above, load), approach(below, above, load)
    return (f"{depth:.3f}" if depth > 0.0 else "-") + (f" ({way:.3f})" if way else "")


def sunk(below: str, above: str, load: float, model: str = "surface") -> float:
    """How deep the deepest point is below the other surface [h]; under the paper's law the lowest point below a cube."""
    (held, _, top, turned), (shape, bottom, _, tilt) = SHAPES[below], SHAPES[above]
    g, h = load * YOUNG / (DENSITY * SIZE), SIZE / 8
    z = bottom if (below, above) != ("torus", "ball") else math.sqrt(14.0**2 - 10.0**2) - top  # on the inner side of the ring
    world = World(
        f"gravity (0, 0, {-g})\nobject low {{ shape {held}  position (0, 0, {-top}) cm  {turned}  {STUFF}  hold all }}\n"
        f"object c {{ shape {shape}  position (0, 0, {z + (0.0 if model == 'surface' else 150 * h * 0.45)}) cm  {tilt}  {STUFF}  "
        f"drag 400 N*s/m }}",
        f"resolution {100 * h} cm  contact-model {model}",
    )
    before = math.inf
    for _ in range(LONGEST):
        world.run(0.1)
        if abs(world.place[2] - before) < 2e-4 * h:
            break
        before = world.place[2]
    if model == "surface":
        deepest = deepest_since(world)
    else:
        deepest = -world.ready.models[-1].surface.vertices(world.instance.array("x")[world.mine])[:, 2].min()
    world.close()
    return deepest / h


def deepest_since(world: World) -> float:
    """The deepest point below a surface, from where it was at the start [m]; -1 where nothing touches.

    The depth of a point that touches at the start, the offset of its contact, is not pushed: around a cylinder's rim that depth
    is an error of the spline, 0.06 h.
    """
    deepest = -1.0
    records = world.instance.state().records["contact"]
    for start, end in itertools.pairwise(records.first.tolist()):
        data = records.data[start + 8 : end].tobytes()  # behind the version, points of each of the two objects, and how many
        while data:
            n = int(np.frombuffer(data[:8], "i8")[0])
            rows = np.frombuffer(data[8 : 8 + n * FIELD_CONTACT], "f8").reshape(n, FIELD_CONTACT // 8)
            deepest = max([deepest, *(rows[:, DEPTH] - np.maximum(rows[:, OFFSET], 0.0))])
            data = data[8 + n * FIELD_CONTACT :]
    return deepest


def hertz() -> tuple[list[str], list[list]]:
    """A ball that lies still on the ground, and on a held ball as large: its weight over Hertz's force for its centre's way."""
    rows = [
        [cells, *(pressed(cells, below, model) for below in ("ground", "ball") for model in MODELS)] for cells in (4, 6, 8, 12)
    ]
    return ["cells across the radius"] + [f"on {what}, {m}" for what in ("the ground", "a ball") for m in MODELS], rows


def pressed(cells: int, below: str, model: str) -> str:
    """Weight over force; a dash where it hovers higher than it could touch."""
    radius = 0.5 * SIZE
    g, h = HERTZ_LOAD * YOUNG / (DENSITY * radius), radius / cells
    mass = DENSITY * 4.0 / 3.0 * math.pi * radius**3
    swing = math.sqrt(0.1 * YOUNG * radius / mass)  # about the frequency at which it bounces on its contact [1/s]
    gap = 0.0 if model == "surface" else 1.3 * h
    held = (
        "ground z 0" if below == "ground" else f"object low {{ shape sphere 10 cm  position (0, 0, -10) cm  {STUFF}  hold all }}"
    )
    world = World(
        f"gravity (0, 0, {-g})\n{held}\n"
        f"object c {{ shape sphere 10 cm  position (0, 0, {radius + gap}) m  {STUFF}  drag {1.6 * swing * mass} N*s/m }}",
        f"resolution {100 * h} cm  contact-model {model}",
    )
    before = math.inf
    for _ in range(LONGEST):
        world.run(1.6 / swing)
        if abs(world.place[2] - before) < 1e-5 * radius:
            break
        before = world.place[2]
    way, weight = radius - world.place[2], world.mass.sum() * g
    world.close()
    if way <= 0.0:
        return f"- (gap {-way / h:.2f} h)"
    curved = radius if below == "ground" else 0.5 * radius
    return f"{weight / (4.0 / 3.0 * YOUNG / (1.0 - 0.25**2) * math.sqrt(curved) * way**1.5):.3f}"


def lattice() -> tuple[list[str], list[list]]:
    """A cube slides without friction at 0.01 c over the lattice of a soft slab, load 0.003: the largest lateral force over its
    weight."""
    rows = [[cells, *(f"{slid(cells, angle, model):.1e}" for angle in (0, 23) for model in MODELS)] for cells in (2, 4, 8)]
    return ["cells"] + [f"{way}, {m}" for way in ("along the cells", "turned by 23 deg") for m in MODELS], rows


def slid(cells: int, angle: float, model: str) -> float:
    """The largest of 150 forces, each in the mean of a fiftieth of a spacing."""
    h, g = SIZE / cells, 0.003 * YOUNG / (DENSITY * SIZE)
    height = 10.0 if model == "surface" else 10.0 + 40 * h
    world = World(
        f"gravity (0, 0, {-g})\n"
        f"object slab {{ shape box (60, 40, 20) cm  position (0, 0, -10) cm  {STUFF}  hold face -z  damping 1 }}\n"
        f"object c {{ shape box (20, 20, 20) cm  position (-8.3, 0.17, {height}) cm  {STUFF}  damping 1\n"
        f"orientation axis (0, 0, 1) angle {angle} deg  velocity ({0.01 * WAVE}, 0, 0) }}",
        f"resolution {100 * h} cm  contact-model {model}",
    )
    world.run(0.12)
    steps = max(1, round(0.02 * h / (0.01 * WAVE) / world.ready.plan.certificate.timestep))
    speeds = [world.velocity]
    for _ in range(150):
        world.instance.run(steps)
        speeds.append(world.velocity)
    forces = np.diff(speeds, axis=0)[:, :2] / (steps * world.ready.plan.certificate.timestep * g)
    world.close()
    return float(np.hypot(*forces.T).max())
