# SPDX-License-Identifier: GPL-2.0-only
"""How hard a sheet that is held has to be where it touches, and how close its points, so that it bears what comes onto it.

Points are the only contacts of a sheet: springs k = kappa w of the depth d below the surface of the other object, which passes
where these are pressed through its middle. Up to there those in its cross-section A hold U_A = k/h^2 int_A d^2/2 dA, for a ball
of radius R pi k R^4/(12 h^2), and press with B = 16/9 U_A/R at most (that is where a level sheet is R/3 below the middle; 2 U_A/R
for a cuboid). The sheet itself bears the rest, as a round membrane of the radius a does that is held around and has nu = 1/3
(Schwerin 1929):

    F = c E t delta^3/a^2,  U = F delta/4,  c = 9 pi/16        U = that of the blow, and m g delta
    epsilon = sqrt(U/(pi E t R^2))                             beside the object, where F/(2 pi r) pulls at a distance r

so contact has to be (1 + epsilon)^2 F/B as stiff as by the material of the sheet, because a stretched one has fewer points. Nor
need it bear more than U; and the blow on a particle alone may press that halfway to the middle. A sheet that tears at the
strain e bears no more than at TORN e, where it has torn beside the object.
"""

from __future__ import annotations

import math

import numpy as np

from ...effects.context import Context
from ...effects.envelope import Envelope
from ...errors import Problem
from ...model import shapes
from ...model.system import hardness, parts
from ...records import dataclass
from ...scene.formatting import number, say
from ...scene.scene import Box, Cone, Cylinder, Ellipsoid, Shape, Solid, Sphere
from ..contact.rigid_surfaces import moduli
from ..contact.surface import LINE, SurfaceContact, own_area
from ..contact.words import CONTACT_STIFFNESS
from ..ropes.advice import FINE
from ..tearing.rules import strain_of
from ..tearing.words import tears
from .words import finest, is_sheet, width

ACROSS = 32
"""Places along either axis of a cross-section."""
SCHWERIN = 9.0 * math.pi / 16.0
NEARER = 0.5
"""Distance of the place of a blow from what is held, over half of the shorter side."""
SPARE = 1.1
"""Over the least stiffness, in what is chosen or is to be written."""
HARDEST = 100.0
"""Stiffness over that by the material, at most: a step is then a tenth as long and less."""
MOST_PARTS = 4
"""Parts of a link, at most."""
TORN = 2.0
"""Strain beside an object up to which its sheet is to bear it, over that at which it tears."""
SURE = 2.5
"""Press over what points bear above which an object goes through; up to here some are borne."""


@dataclass(frozen=True, slots=True)
class Blow:
    """An object that comes onto a sheet, and what it asks of it."""

    sheet: int
    other: int
    energy: float
    """[J]"""
    force: float
    """With which it presses, at most [N]."""
    borne: float
    """Force that points bear, with the hardness of 1 [N]."""
    hardness: float
    parts: float
    """Parts of a link that points have to be apart [-], any number."""


def fits(context: Context) -> dict[int, tuple[int, float]]:
    """Parts of a link, and hardness, of each sheet that is another one by what it meets."""
    found = {m: (fine, float(fine)) for m, (fine, _) in laid_over(context).items()}
    for blow in blows(context):
        fine = min(MOST_PARTS, math.ceil(blow.parts * (1.0 - 1e-9)))
        hard = float(number(min(HARDEST, SPARE * blow.hardness), 2)) if blow.hardness > 1.0 else 1.0
        if fine > 1 or hard > 1.0:
            finer, harder = found.get(blow.sheet, (1, 1.0))
            found[blow.sheet] = max(fine, finer), max(hard, harder)
    return found


def laid_over(context: Context) -> dict[int, tuple[int, int]]:
    """Parts of a link of each sheet whose particles are farther apart than something that it may meet is narrow, and that object,
    which stays where it is if the sheet is held or tied somewhere: its points are as close as that is narrow, as far as
    MOST_PARTS goes, and as much harder, so that a row of them on a rod bears what a row of particles does."""
    system, solids = context.system, context.scene.solids
    found = {}
    loose = set(_sheets(context, loose=True))
    for m in sorted(loose | set(_sheets(context, loose=False))):
        stays = system.held_whole | system.still  # what moves onto a sheet that is held is a blow
        if not (met := _met(context, m, ~system.bare & (stays | (m in loose)))):
            continue
        narrowest = min(met, key=lambda k: narrow(solids[k].shape))
        fine = math.ceil(float(system.spacing[m]) / narrow(solids[narrowest].shape) * (1.0 - 1e-9))
        if fine > 1:
            found[m] = min(MOST_PARTS, fine), narrowest
    return found


def narrow(shape: Shape) -> float:
    """How narrow a shape is for what is laid over it [m]: a plate is as wide as its narrower side, a rod as its thickness."""
    low, high = shapes.extent(shape)
    wide = isinstance(shape, Box | Sphere | Ellipsoid | Cylinder | Cone)  # they have no holes
    return float(np.sort(high - low)[1]) if wide else shapes.thickness(shape)


def borne(envelope: Envelope) -> dict[int, int]:
    """Sheets of `laid_over` whose points are as close as the narrowest object that they may meet is narrow, and that object."""
    spacing, solids = envelope.system.spacing, envelope.scene.solids
    found = laid_over(envelope.context).items()
    return {m: k for m, (fine, k) in found if spacing[m] / fine <= narrow(solids[k].shape) * (1.0 + 1e-9)}


def laid(envelope: Envelope) -> list[Problem]:
    """Notes of sheets that lie on something, with points between particles."""
    system, found = envelope.system, []
    for m, k in borne(envelope).items():
        apart = say(float(system.spacing[m] / parts(system)[m]), "m")
        hard = float(hardness(system)[m])
        cause = f"{system.names[m]} has points of contact {apart} apart and a contact {number(hard, 2)} times as stiff as by its "
        cause += (
            f"material, as {system.names[k]} is thin; steps are {number(_of_steps(envelope, m, hard), 2)} of what they would be"
        )
        found.append(Problem(envelope.place(m, "shape"), cause, f"a thicker {system.names[k]} takes less", severity="note"))
    return found


def blows(context: Context) -> list[Blow]:
    """Blows of all that may come onto a sheet which is held or tied, where objects touch."""
    system, found = context.system, []
    low, high = system.bounds(system.position)
    for sheet in _sheets(context, loose=False):
        others = _met(context, sheet, ~system.bare & ~system.held_whole & ~system.still)
        found += [blow_of(context, sheet, other, low, high) for other in others]
    return found


def _sheets(context: Context, *, loose: bool) -> list[int]:
    """Sheets that can move, where objects touch: those that are held or tied somewhere, or all others."""
    system, solids = context.system, context.scene.solids
    sheets = [m for m, solid in enumerate(solids) if is_sheet(solid) and not system.held_whole[m]]
    if not sheets or not any(effect.touches for effect in context.resolved.effects):
        return []
    held = np.logical_or.reduceat(system.held, system.first[:-1])
    tied = {m for pair in context.reach.region.passing for m in pair}
    return [m for m in sheets if loose != bool(held[m] or m in tied)]


def _met(context: Context, sheet: int, some: np.ndarray) -> list[int]:
    """Numbers of some objects, bool, shape (M,), that a sheet may meet."""
    swept = context.reach.region
    near = ((swept.low[sheet] < swept.high) & (swept.low < swept.high[sheet])).all(axis=1) & some
    return [k for k in np.flatnonzero(near).tolist() if (min(k, sheet), max(k, sheet)) not in swept.passing]


def blow_of(context: Context, sheet: int, other: int, low: np.ndarray, high: np.ndarray) -> Blow:
    """Force and hardness that an object asks of a sheet; ``low`` and ``high`` are the bounds of all objects at the start [m],
    shape (M, 3)."""
    system, skin, solid = context.system, context.scene.solids[sheet], context.scene.solids[other]
    falls, energy = _energy(context, sheet, other, low, high)
    shorter = min(width(skin.shape), float(np.sort(high[sheet] - low[sheet])[1]))
    across, tension = NEARER * 0.5 * shorter, float(system.young[sheet]) * skin.shape.thickness
    weight = float(system.mass_of[other]) * context.reach.g if falls else 0.0
    deep = 0.0
    for _ in range(20):  # goes on by a quarter of the change
        deep = (4.0 * (energy + weight * deep) * across**2 / (SCHWERIN * tension)) ** 0.25
    comes = energy = energy + weight * deep
    half, h = 0.5 * shapes.thickness(solid.shape), float(system.spacing[sheet])
    if tears(skin):
        most = math.pi * tension * (max(half, h) * TORN * strain_of(system, sheet, skin)) ** 2
        energy, deep = min(energy, most), min(deep, (4.0 * most * across**2 / (SCHWERIN * tension)) ** 0.25)
    force = SCHWERIN * tension * deep**3 / across**2
    stretch = math.sqrt(energy / (math.pi * tension * half**2))
    spring, held = _springs(context, sheet, other), _half_through(solid, system.frames[system.contact_kind[sheet]].contact.radius)
    holds = spring / h**2 * held
    borne = holds / half * (2.0 if isinstance(solid.shape, Box) else 16.0 / 9.0)
    struck = 2.0 * comes / float(system.mass_of[other]) * float(system.density[sheet]) * skin.shape.thickness * h**2
    alone = struck / (spring * (0.5 * half) ** 2)
    hard = max((1.0 + stretch) ** 2 * min(force / borne, energy / holds), alone)
    return Blow(sheet, other, comes, force, borne, hard, h * (1.0 + stretch) / (FINE * 2.0 * half))


def pressed_through(envelope: Envelope) -> list[Problem]:
    """The object that a sheet bears least, where it may not bear it: a warning, or a note where it may yet."""
    hard = hardness(envelope.system)
    found = [(blow.hardness / hard[blow.sheet], n, blow) for n, blow in enumerate(blows(envelope.context))]
    over, _, worst = max(found, default=(0.0, 0, None))
    return [_warning(envelope, over, worst)] if worst and over > 1.0 else []


def hardened(envelope: Envelope) -> list[Problem]:
    """Notes of what touches harder than its material says, or has points between particles, and of what that costs."""
    system, all_blows = envelope.system, blows(envelope.context)
    hard, fine, found = hardness(system), parts(system), []
    for m in np.flatnonzero((hard > 1.0) | (fine > 1)).tolist():
        if not (onto := [blow for blow in all_blows if blow.sheet == m]):
            continue
        by = max(onto, key=lambda blow: (blow.hardness, blow.parts))
        ways = [f"points of contact {say(float(system.spacing[m]) / fine[m], 'm')} apart"] * bool(fine[m] > 1)
        ways += [f"a contact {number(hard[m], 2)} times as stiff as by its material"] * bool(hard[m] > 1.0)
        share = _of_steps(envelope, m, float(hard[m]))
        takes = f"; steps are {number(share, 2)} of what they would be" if share < 0.99 else ""
        other = system.names[by.other]
        cause = f"{system.names[m]} has {' and '.join(ways)}, so that it bears {other}, which comes with {say(by.energy, 'J')}"
        way_out = f"a lighter or slower {other} takes less"
        found.append(Problem(envelope.place(m, "shape"), cause + takes, way_out, severity="note"))
    return found


def _of_steps(envelope: Envelope, m: int, harder: float) -> float:
    """The bound on the time step over that with a hardness of 1 of this sheet."""
    system, rates = envelope.system, envelope.rates
    own = np.where(system.object == m, rates.get(SurfaceContact.name, 0.0), 0.0)
    hard = np.where(system.held, 0.0, sum(rates.values()))
    soft = np.where(system.held, 0.0, hard - own * (1.0 - 1.0 / harder))
    return math.sqrt(float(soft.max() / hard.max()))


def _energy(context: Context, sheet: int, other: int, low: np.ndarray, high: np.ndarray) -> tuple[bool, float]:
    """Whether an object falls onto a sheet, and the energy with which it comes to be half through it [J]: that of its start, and
    of its fall where it is above."""
    system, mass = context.system, float(context.system.mass_of[other])
    velocity = system.center_of_mass(system.velocity)
    energy = 0.5 * mass * float(((velocity[other] - velocity[sheet]) ** 2).sum())
    over = (low[other, :2] < high[sheet, :2]).all() and (low[sheet, :2] < high[other, :2]).all()
    middle = 0.5 * (low + high)[:, 2]
    falls = bool(over and middle[other] >= middle[sheet])
    return falls, energy + (mass * context.reach.g * float(middle[other] - middle[sheet]) if falls else 0.0)


def _springs(context: Context, sheet: int, other: int) -> float:
    """k of a particle of a sheet on an object with the hardness of 1 [N/m]."""
    system, young = context.system, moduli(context)
    pair = 2.0 * young[sheet] * young[other] / (young[sheet] + young[other])
    kappa = LINE * context.scene.control.contact_stiffness * pair / np.cbrt(system.cell_volume[sheet])
    return float(kappa * own_area(system)[system.object == sheet].max())


def _half_through(solid: Solid, radius: float) -> float:
    """int_A d^2/2 dA over the level cross-section through the middle of an object as it is placed [m^4], for round points of this
    radius [m]. A cuboid is left by the side that was met first."""
    turn = np.asarray(solid.rotation, float)
    low, high = shapes.extent(solid.shape)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    reach = np.abs(turn) @ half
    step = (np.arange(ACROSS) + 0.5) / ACROSS * 2.0 - 1.0
    x, y = np.meshgrid(reach[0] * step, reach[1] * step, indexing="ij")
    place = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]) @ turn + middle
    depth = shapes.depth(solid.shape, place)
    pressed = np.where(depth > 0.0, float(half.min()) if isinstance(solid.shape, Box) else depth + radius, 0.0)
    return 0.5 * float((pressed**2).sum()) * 4.0 * reach[0] * reach[1] / ACROSS**2


def _warning(envelope: Envelope, over: float, blow: Blow) -> Problem:
    names, control, solid = envelope.system.names, envelope.scene.control, envelope.scene.solids[blow.sheet]
    h, more, sheet, other = float(envelope.system.spacing[blow.sheet]), SPARE * over, names[blow.sheet], names[blow.other]
    stiffness, fine = control.contact_stiffness * more, h / np.sqrt(more)
    ways = [f"resolution {say(fine, 'm')} in {sheet}"] if fine >= finest(solid.shape) else []
    if stiffness <= CONTACT_STIFFNESS.most:
        ways.append(f"contact-stiffness {number(stiffness, 2)} in control")
    bears = say(float(hardness(envelope.system)[blow.sheet]) * blow.force / blow.hardness, "N")
    comes = f"it comes with {say(blow.energy, 'J')} and presses with up to {say(blow.force, 'N')}"
    return Problem(
        envelope.place(blow.other, "shape"),
        f"{other} may fall through {sheet}: {comes}, and particles of {sheet} that are {say(h, 'm')} apart bear {bears} before "
        "they are pressed through it",
        "write " + ", or ".join(ways) if ways else f"make {other} lighter or slower, or {sheet} thicker",
        severity="warning" if over > SURE else "note",
    )
