# SPDX-License-Identifier: GPL-2.0-only
"""Tables of bench/contact.py: what lies still on something, or slides on it without friction."""

import math

import numpy as np
from contact_world import DENSITY, MODELS, STUFF, WAVE, YOUNG, World

LOADS = (0.001, 0.01)
"""rho g L / E with L = SIZE."""
SIZE = 0.2
"""Of all bodies, about [m]."""
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
LONGEST = 40
"""Tenths of a second until what moves is taken as it is."""
HERTZ_LOAD = 0.003
"""rho g R / E of a ball of radius R that lies still."""


def rest() -> tuple[list[str], list[list]]:
    """The deepest point below a surface at rest on a held body [h], at two loads; under the paper's law the gap on a cube."""
    rows = [[below, *(" / ".join(told(sunk(below, above, load)) for load in LOADS) for above in SHAPES)] for below in SHAPES]
    rows.append(["cube, paper's law", *(f"{-sunk('cube', above, LOADS[0], 'paper'):.2f}" for above in SHAPES)])
    return ["lies on", *SHAPES], rows


def told(depth: float) -> str:
    """Nothing where it has fallen off."""
    return f"{depth:.3f}" if depth > 0.0 else "-"


def sunk(below: str, above: str, load: float, model: str = "surface") -> float:
    """How deep the deepest point is below the other surface [h]; under the paper's law the lowest point below a cube."""
    (held, _, top, turned), (shape, bottom, _, lies) = SHAPES[below], SHAPES[above]
    g, h = load * YOUNG / (DENSITY * SIZE), SIZE / 8
    z = bottom if (below, above) != ("torus", "ball") else math.sqrt(14.0**2 - 10.0**2) - top  # on the inner side of the ring
    world = World(
        f"gravity (0, 0, {-g})\nobject low {{ shape {held}  position (0, 0, {-top}) cm  {turned}  {STUFF}  hold all }}\n"
        f"object c {{ shape {shape}  position (0, 0, {z + (0.0 if model == 'surface' else 150 * h * 0.45)}) cm  {lies}  {STUFF}  "
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
        world.instance.setup()  # the deepest point is told from here on
        world.run(0.0)
        deepest = world.instance.fix_value("contact", 4)
    else:
        deepest = -world.ready.models[-1].surface.vertices(world.instance.array("x")[world.mine])[:, 2].min()
    world.close()
    return deepest / h


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
