# SPDX-License-Identifier: GPL-2.0-only
"""Notes of ``check`` on what waves are known to get wrong, where a scene meets it: by how much, and the page that measures it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from ...bodies import kind_of
from ...effects.envelope import Envelope
from ...errors import Problem, Span
from ...model import shapes
from ...model.model import Model
from ...records import dataclass
from ...scene.formatting import number, say, whole
from ...scene.scene import Box, Ellipsoid, Solid, Sphere
from ..contact.pairs import frictions
from ..drives.motion import velocity_of
from ..drives.words import DriveOscillation
from .basin import liquid_level
from .frames import is_wavy
from .measure import immersed_share
from .occupied import filled

TALL = 1.0
"""Height of a dam over its width from which its foot runs ahead."""
GENTLE = math.cos(math.radians(35.0))
"""Upward part of the normal of a face from which water runs up it in a thin layer."""
LEVEL = 1.0 - 1e-4
"""The same from which a face is level."""
BESIDE = 2.0
"""Cells between a body and a side of its basin up to which it slides."""
SUDDEN = 0.5
"""Speed over sqrt(g L) from which a body of size L that starts in the liquid pushes it as a blow."""
SLENDER = 3.0
"""Length along its way over its width from which a body cuts through the liquid."""
OFF_REST = 0.1
"""Share of a body below the surface at the start, less that at rest, from which it bobs."""
LIGHTEST, LIGHTER, STIFF = 0.1, 0.16, 1000.0
"""Density over that of the liquid from which there is no warning of a light body, up to which an elastic one goes on shaking, and
its stiffness over the pressure of a cell of liquid from which it does not."""
HIGH = 0.2
"""Height of waves over the depth from which crests at walls are too high."""
MANY, FEW = 1_000_000, 100_000
"""Cells from which on it is told why there are so many, and how many are enough to see what happens."""
Found = tuple[Span | None, str]
"""Place of what meets a shortfall, and how a sentence about it begins."""


@dataclass(frozen=True)
class Shortfall:
    """Something that waves get wrong."""

    met: Callable[[Envelope], Found | None]
    """Where a scene meets it."""
    text: str
    """How far off it is, with the figure of the page."""
    page: str
    way_out: str = ""


def notes(envelope: Envelope) -> list[Problem]:
    """One of cells that are very many, and one for each shortfall that the scene meets."""
    if envelope.scene.liquid is None or envelope.context.grid is None:
        return []
    met = [(one, found) for one in SHORTFALLS if (found := one.met(envelope))] if is_wavy(envelope.scene) else []
    return _many_cells(envelope) + [
        Problem(found[0], f"{found[1]}: {one.text} (docs/{one.page})", one.way_out, severity="note") for one, found in met
    ]


def _many_cells(envelope: Envelope) -> list[Problem]:
    """The thin object that makes the cells so fine, where the scene does not ask for them."""
    cells, spacing = int(np.prod(envelope.context.grid.shape)), envelope.context.spacing
    solid = next((solid for solid in envelope.scene.solids if solid.name == spacing.set_by), None)
    if cells <= MANY or solid is None:
        return []
    coarse = float(f"{spacing.h * (cells / FEW) ** (1 / 3):.1g}")
    thin = shapes.thickness(solid.shape)
    if kind_of(solid).least(envelope.scene, solid):
        coarse = min(coarse, thin)
    if coarse < 2.0 * spacing.h:
        return []
    cause = f"{solid.name} is {say(thin, 'm')} thin, and so the liquid has {whole(cells)} cells of {say(spacing.h, 'm')}"
    few = int(float(f"{cells * (spacing.h / coarse) ** 3:.2g}"))
    way_out = f"write resolution {say(coarse, 'm')} in control for about {whole(few)}"
    return [Problem(solid.spans.get("shape"), cause, way_out, severity="note")]


def _held_cells(envelope: Envelope) -> np.ndarray:
    """Cells of the basin that held solids fill by half or more, shape (nz, ny, nx)."""
    held = [model for model in envelope.context.models if model.still]
    return filled(envelope.context.grid, held, spread=False) >= 0.5


# --- dams ---------------------------------------------------------------------------------------------------


def _dam(envelope: Envelope) -> tuple[int, float, float] | None:
    """The axis along which liquid is let go onto a dry floor, how wide it is along it, and how high [m]."""
    liquid = envelope.scene.liquid
    if liquid.fill is None or liquid.fill[0][2] > liquid.low[2] + envelope.context.grid.cell[2]:
        return None
    (low, high), cell = liquid.fill, envelope.context.grid.cell
    room = [max(low[k] - liquid.low[k], liquid.high[k] - high[k]) for k in (0, 1)]
    axis = int(np.argmax(room))
    if room[axis] <= cell[axis]:
        return None
    width, across = (min(high[k], liquid.high[k]) - max(low[k], liquid.low[k]) for k in (axis, 1 - axis))
    height = liquid.volume / (width * across) if liquid.level is None else liquid.level - liquid.low[2]
    return None if _walled(envelope, axis, height) else (axis, width, height)


def _walled(envelope: Envelope, axis: int, height: float) -> bool:
    """Whether held solids close more than half of the faces across an axis of the box that liquid starts in, up to a height."""
    liquid, grid = envelope.scene.liquid, envelope.context.grid
    first, last = (np.rint((np.array(side) - grid.low) / grid.cell).astype(int) for side in liquid.fill)
    first, last = np.maximum(first, 0), np.minimum(last, grid.shape)
    last[2] = max(1, round(height / grid.cell[2]))
    cells = np.moveaxis(_held_cells(envelope).T, axis, 0)
    across = tuple(slice(first[k], last[k]) for k in range(3) if k != axis)
    closed = [(cells[at - 1][across] | cells[at][across]).mean() for at in (first[axis], last[axis]) if 0 < at < grid.shape[axis]]
    return bool(closed) and min(closed) > 0.5


def _tall_dam(envelope: Envelope) -> Found | None:
    dam, liquid = _dam(envelope), envelope.scene.liquid
    if dam is None or dam[2] < TALL * dam[1] or liquid.pool:
        return None
    times = number(dam[2] / dam[1], 2)
    return liquid.spans.get("fill"), f"{liquid.name} breaks from a dam {'' if times == '1' else f'{times} times '}as high as wide"


def _in_a_flood(envelope: Envelope) -> Found | None:
    """A body that can move, on the dry floor before a dam."""
    dam, liquid = _dam(envelope), envelope.scene.liquid
    if dam is None:
        return None
    axis, _, height = dam
    for m, low, high in _free(envelope):
        dry = low[axis] >= liquid.fill[1][axis] or high[axis] <= liquid.fill[0][axis]
        if dry and low[2] < liquid.low[2] + 0.5 * height:
            return envelope.place(m, "position"), f"{liquid.name} floods {envelope.system.names[m]}"
    return None


def _box_in_a_flood(envelope: Envelope) -> Found | None:
    """A held object on the dry floor before a dam, and lower than that."""
    dam, liquid = _dam(envelope), envelope.scene.liquid
    if dam is None:
        return None
    axis, _, height = dam
    lows, highs = envelope.system.bounds(envelope.system.position)
    cell = envelope.context.grid.cell
    for m in np.flatnonzero(envelope.system.held_whole).tolist():
        low, high = lows[m], highs[m]
        dry = low[axis] >= liquid.fill[1][axis] or high[axis] <= liquid.fill[0][axis]
        inside = all(low[k] > liquid.low[k] + cell[k] and high[k] < liquid.high[k] - cell[k] for k in (0, 1))
        if dry and inside and low[2] < liquid.low[2] + cell[2] and high[2] < liquid.low[2] + height:
            return envelope.place(m, "position"), f"{liquid.name} floods {envelope.system.names[m]}, which is lower than the dam"
    return None


# --- walls and floors ---------------------------------------------------------------------------------------


def _slopes(envelope: Envelope) -> Iterator[tuple[Model, np.ndarray]]:
    """Gentle slopes of held solids: corners of their triangles, shape (T, 3, 3)."""
    for model in envelope.context.models:
        if not model.still:
            continue
        corner = model.surface.vertices(model.position)[model.surface.triangle]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        up = normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
        if (gentle := (up > GENTLE) & (up < LEVEL)).any():
            yield model, corner[gentle]


def _smooth_slope(envelope: Envelope, wet: Callable[[np.ndarray, np.ndarray], np.ndarray], what: str) -> Found | None:
    """A slope of smooth ground in the basin: `wet` tells of triangles, by their lowest and highest z, whether it is one."""
    liquid = envelope.scene.liquid
    for model, corner in () if liquid.manning else _slopes(envelope):
        low, high = corner.min(axis=1), corner.max(axis=1)
        there = wet(low[:, 2], high[:, 2])
        there &= (high[:, :2] > liquid.low[:2]).all(axis=1) & (low[:, :2] < liquid.high[:2]).all(axis=1)
        if there.any():
            return _place(envelope, model), f"{liquid.name} {what} {model.name}"
    return None


def _beach(envelope: Envelope) -> Found | None:
    level = liquid_level(envelope.scene.liquid)
    return _smooth_slope(envelope, lambda low, high: (low < level) & (high > level), "has a beach,")


def _river(envelope: Envelope) -> Found | None:
    if not (inflow := envelope.scene.liquid.inflow):
        return None
    top = max(flow.high[2] for flow in inflow)
    return _smooth_slope(envelope, lambda low, high: low < top, "flows down")


def _place(envelope: Envelope, model: Model) -> Span | None:
    return envelope.place(envelope.system.names.index(model.name), "shape")


# --- bodies -------------------------------------------------------------------------------------------------


def _free(envelope: Envelope) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Solids that can move, with the corners of the boxes around them [m]."""
    lows, highs = envelope.system.bounds(envelope.system.position)
    for m in np.flatnonzero(envelope.reach.free).tolist():
        yield m, lows[m], highs[m]


def _slides(envelope: Envelope) -> Found | None:
    """A body without friction that stands on the floor, in the liquid, near a side."""
    liquid, grid = envelope.scene.liquid, envelope.context.grid
    smooth = dict(zip((solid.name for solid in envelope.scene.solids), frictions(envelope.scene, "basin")))
    for m, low, high in _free(envelope):
        name = envelope.system.names[m]
        stands = low[2] < liquid.low[2] + grid.cell[2] and envelope.reach.weight_left[m] > 0.0
        if not stands or smooth[name] or liquid_level(liquid) <= liquid.low[2] + grid.cell[2]:
            continue
        way, cell = min((min(low[k] - liquid.low[k], liquid.high[k] - high[k]), grid.cell[k]) for k in (0, 1))
        if 0.0 <= way <= BESIDE * cell * (1.0 + 1e-9):
            return envelope.place(m, "position"), f"{name} stands without friction {say(way, 'm')} from a side of the basin"
    return None


def _slams(envelope: Envelope) -> Found | None:
    """A body that starts in the liquid, blunt and fast."""
    liquid, system = envelope.scene.liquid, envelope.system
    level = liquid_level(liquid)
    for m, low, high in _free(envelope):
        solid: Solid = envelope.context.solids[m]
        way = np.array([*solid.velocity[:2], 0.0])
        speed, size = float(np.linalg.norm(way)), float(np.cbrt(shapes.volume(solid.shape)))
        if speed < SUDDEN * math.sqrt(envelope.reach.g * size) or low[2] >= level:
            continue
        long = np.abs(way / speed) @ (high - low)
        if long < SLENDER * min(high[:2] - low[:2]):
            return envelope.place(m, "velocity"), f"{system.names[m]} starts in {liquid.name} at {say(speed, 'm/s')}"
    return None


def _bobs(envelope: Envelope) -> Found | None:
    """A body without hollows that floats in liquid which is level, and starts higher or deeper than it rests."""
    liquid, system = envelope.scene.liquid, envelope.system
    if liquid.fill is not None:
        return None
    level, grid = liquid_level(liquid), envelope.context.grid
    for m, low, high in _free(envelope):
        model, rests = envelope.context.models[m], float(system.density[m]) / liquid.density
        full = isinstance(envelope.context.solids[m].shape, (Box, Ellipsoid, Sphere))
        if not full or not low[2] < level < high[2] or rests >= 1.0:
            continue
        below = immersed_share(model.position[model.hexahedron], grid, np.full(grid.shape[1::-1], level))
        if abs(below - rests) > OFF_REST:
            deeper = "deeper" if below > rests else "higher"
            return envelope.place(m, "position"), f"{system.names[m]} starts {deeper} than it floats, and bobs"
    return None


def _shakes(envelope: Envelope) -> Found | None:
    """A light body that deforms, without damping."""
    liquid, system = envelope.scene.liquid, envelope.system
    pressure = liquid.density * envelope.reach.g * float(envelope.context.grid.cell[2])
    for m, _, _ in _free(envelope):
        share = float(system.density[m]) / liquid.density
        soft = not system.rigid[m] and system.young[m] < STIFF * pressure and not envelope.context.solids[m].damping
        if soft and LIGHTEST <= share < LIGHTER:
            return envelope.place(m, "density"), f"{system.names[m]} is {number(share, 2)} times as dense as {liquid.name}"
    return None


def _wake(envelope: Envelope) -> Found | None:
    """A held object that is driven on through the surface."""
    liquid, system = envelope.scene.liquid, envelope.system
    lows, highs = system.bounds(system.position)
    for m, solid in enumerate(envelope.context.solids):
        if velocity_of(solid)[:2].any() and lows[m][2] < liquid_level(liquid) < highs[m][2]:
            return envelope.place(m, "drive"), f"{system.names[m]} is towed through {liquid.name}"
    return None


def _high_crests(envelope: Envelope) -> Found | None:
    """A basin that is shaken near the period of its longest wave, by the linear law of that wave."""
    liquid, g = envelope.scene.liquid, envelope.reach.g
    depth = liquid_level(liquid) - liquid.low[2]
    for drive in liquid.drive:
        if not isinstance(drive, DriveOscillation):
            continue
        turn = 2.0 * math.pi * drive.frequency
        for k in (0, 1):
            long = liquid.high[k] - liquid.low[k]
            own = g * math.pi / long * math.tanh(math.pi * depth / long)
            steady = own * 4.0 * long / math.pi**2 * drive.way[k] * turn**2 / g / max(abs(own - turn**2), 0.05 * own)
            beats = 2.0 * abs(steady) / depth
            if beats > HIGH:
                cause = f"waves in {liquid.name} become {number(beats, 2)} of its depth high by the law of low ones"
                return liquid.spans.get("drive"), cause
    return None


VALIDATION, PHYSICS = "validation.md#", "physics-liquid.md#"
SHORTFALLS = (
    Shortfall(
        _tall_dam,
        "its front starts at once, and is 68 % too far at first where the dam is twice as high as wide",
        f"{VALIDATION}a-dam-breaks-onto-a-dry-floor",
    ),
    Shortfall(
        _in_a_flood,
        "a flood pushes a blunt body without a blow, and a tall column by 9 % of the impulse too little, later by 11 % too much",
        f"{VALIDATION}a-flood-meets-a-tall-column",
    ),
    Shortfall(
        _box_in_a_flood,
        "the jet at its face has no pressure, and while that stands the pressure on the upper half is 14 % too low",
        f"{VALIDATION}a-flood-meets-a-low-box",
    ),
    Shortfall(
        _beach,
        "high waves run up to 28 % too far, as nothing rubs on the ground",
        f"{VALIDATION}solitary-waves-on-a-beach",
        "write manning 0.01 in the liquid for smooth ground, 0.03 for gravel",
    ),
    Shortfall(
        _river,
        "nothing rubs on smooth ground, so that it gets faster all the way down",
        f"{PHYSICS}friction-of-the-ground",
        "write manning 0.03 in the liquid, which is gravel",
    ),
    Shortfall(
        _slides, "after some seconds it begins to slide to and fro", f"{PHYSICS}bodies-in-waves", "write friction 0.5 in it"
    ),
    Shortfall(
        _slams,
        "a blunt body that is set in motion at once gives the liquid up to twice what it loses",
        f"{PHYSICS}bodies-in-waves",
        "begin slower, or make it slender",
    ),
    Shortfall(
        _bobs,
        "its period is up to 5 % off by where it lies on the cells, and its first turning point by up to 9 %",
        f"{VALIDATION}a-sphere-bobs",
    ),
    Shortfall(
        _shakes,
        "a soft body so light goes on shaking where it floats, as nothing damps it",
        f"{PHYSICS}bodies-in-waves",
        "write damping 0.1 in it, or elasticity rigid",
    ),
    Shortfall(
        _wake,
        "waves behind it come out as low as a third, and the highest ones are 33 % farther from its course",
        f"{VALIDATION}the-wake-of-what-is-towed",
    ),
    Shortfall(_high_crests, "crests at its walls come out up to 41 % too high", f"{VALIDATION}a-tank-is-shaken"),
)
