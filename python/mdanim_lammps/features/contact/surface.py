# SPDX-License-Identifier: GPL-2.0-only
"""Contact at the drawn surfaces, with friction (docs/physics-contact.md): objects, ground, walls and basin under
``contact-model surface``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ...effects.context import Context
from ...effects.fields import Field, column
from ...effects.readings import Readings
from ...errors import Problem
from ...model.boxes import box_pairs
from ...model.model import Layer, Model
from ...model.overlap import BORN_AT_REST
from ...model.system import System, hardness
from ...reach import by, thrower_of
from ...scene.formatting import at_least, say
from ...scene.scene import Box, SceneRecord
from ..tearing.words import tears
from .barrier import GAP, ObjectContact, barrier, barrier_rate, excluded
from .fineness import too_thin
from .forms import particle_stiffness
from .pairs import USUAL_DAMPING, any_friction, belts, damping, frictions, largest_of_partners, pair_rules, runs
from .planes import STIFFNESS, BarrierPlanes, Planes, Sides, word_of, yielding
from .resting import one_sided
from .rigid_surfaces import moduli, spread_mobility

SHORT, FULL = 0.8, 1.6
"""Reach of the barrier behind the surface, over the shortest edge of its own cells: a particle inside is at least one edge below
its surface, so the barrier does not reach what touches that surface and leaves friction alone, however coarse the other body
is; that of objects which meet others faster than SLOW, over the spacing."""
SPARE = 1.6
"""Weight in the bound of a share of critical damping above USUAL_DAMPING: both sides of a body and the barrier never act along
one direction at once, and the excess that `rate` counts covers the usual damping."""
ALONE = 2.0
"""kappa where only the dense points of one act, over that where both have points."""
LINE = 0.2
"""The same of a line or a sheet of particles, of which each bears all that it meets."""
RESOLVED = {1: 60.0, 2: 15.0}
"""How many times the share of a line and of a sheet counts in the bound: in a blow all of its energy goes through its contact,
which is then resolved to 1e-3 (a rope and a sheet that fall flat on a floor, bench/ropes.py, bench/sheets.py)."""
SLOW = 0.3
"""Closing speed over the wave speed up to which a short barrier stops all that meets."""
SLOW_NEEDLE = 0.1
"""The same for a body that is one cell across along two axes."""
UNGUARDED, NEEDLE = 0.35, 0.2
"""Closing speed over the wave speed that passes what is one cell thin, or across along two axes (`guards`, bench/contact.py)."""
HEAT, DAMPED, LET_GO, WORK = "friction_heat", "contact_damping_loss", "let_go", "work"
"""Columns of the ledger; the last is what surfaces and planes that move bring in."""
TAKEN = {HEAT: "friction_heat", DAMPED: "damping_loss", LET_GO: "let_go", WORK: "work"}
"""Their entries of the fix's vector."""
DEEPEST = "deepest"
"""In the fix's vector: the deepest point below a surface in this run [m]."""


class SurfaceLaw:
    """The common law of contact of objects, and of planes, at drawn surfaces: U = sum kappa w g(d) over points of an area
    w [m^2] at a depth d [m], with friction up to mu times the normal force, and a dashpot (docs/physics-contact.md, "At the drawn
    surfaces, with friction").
    """

    def __init__(self, fix: str, plane: str = ""):
        self.fix, self.plane = fix, plane
        """ID of the fix; the word of contact blocks for what objects touch, empty for other objects."""

    def columns(self, context: Context) -> dict[Field, np.ndarray]:
        """As `Effect.columns`."""
        scene, system = context.scene, context.system
        return {
            column("body", "1"): system.contact_kind[system.object].astype(float),
            column("young", "Pa"): moduli(context)[system.object],
            column(self.friction_column(scene), "1"): np.array(frictions(scene, self.plane))[system.object],
        }

    def friction_column(self, scene: SceneRecord) -> str:
        """The column with the friction of each particle's object."""
        return f"friction_{self.plane}" if any(self.plane in (c.first, c.second) for c in scene.contacts) else "friction"

    def commands(self, context: Context, touched: str) -> list[str]:
        """The command of the fix, with what objects touch, behind that of the group of all that is there: what is laid aside
        leaves it."""
        scene, group = context.scene, context.pushed
        words = [f"fix {self.fix} {group} mdanim/contact d_body d_young d_{self.friction_column(scene)}"]
        words.append(f"stiffness {scene.control.contact_stiffness!r}")
        if damping(scene) != USUAL_DAMPING:
            words.append(f"damping {damping(scene)!r}")
        words += [f"except {group}" for _, group in settled(context, planes=bool(self.plane))]
        groups, among = yielding(context, "solid") if self.plane else ([], "solid")
        return ["group solid type 1:8", *groups, " ".join([*words, f"among {among}", touched])]

    def rubs(self, scene: SceneRecord) -> bool:
        """Whether some contact may have friction."""
        return any(frictions(scene, self.plane)) or (not self.plane and any(c.friction for c in scene.contacts))

    def damping(self, scene: SceneRecord) -> float:
        """Largest share of critical damping of a contact [-]."""
        most = damping(scene) if self.rubs(scene) else 0.0
        return most if self.plane else max(most, *(c.contact_damping or 0.0 for c in scene.contacts), 0.0)

    def losses(self, scene: SceneRecord) -> tuple[str, ...]:
        """As `Effect.losses`."""
        return (*[HEAT] * self.rubs(scene), *[DAMPED] * (self.damping(scene) > 0.0))

    def lost(self, readings: Readings, terms: Iterable[str]) -> dict[str, float]:
        """Present values of these columns [J]."""
        return {term: readings.fix_value(self.fix, TAKEN[term]) for term in terms}

    def dashpots(self, context: Context, kappa: np.ndarray) -> np.ndarray | None:
        """eta_i s_i / m_i [1/s], shape (N,), of the part of the damping that counts in the bound; None where none does.

        The dashpot of a point is eta w_q with eta = 2 beta sqrt(kappa rho h/2), of an area s_i at most for a particle; rho is
        that of the lighter of a pair, so no more than that of either. ``kappa`` of each solid [N/m^3], shape (M,).
        """
        system = context.system
        beta = SPARE * (self.damping(context.scene) - USUAL_DAMPING)
        if beta <= 0.0:
            return None
        h = float(np.cbrt(system.cell_volume).max())
        eta = 2.0 * beta * np.sqrt(kappa * (system.density * h) / 2.0)
        area = np.where(system.bare[system.object], own_area(system), borne_area(system))
        return eta[system.object] * _of_bodies(context, area / system.mass)

    def penetration(self, readings: Readings) -> float:
        """As `Effect.penetration`."""
        return readings.fix_value(self.fix, DEEPEST)


class SurfaceContact(ObjectContact):
    """Points of each drawn surface against the depth below that of the other body, and a short barrier behind it.

    kappa = f 2 E_A E_B/(E_A + E_B)/max(h_A, h_B) [N/m^3] (docs/physics-contact.md, "At the drawn surfaces, with friction").
    """

    styles = (("fix", "mdanim/contact"), ("fix", "mdanim/barrier"))
    rests_inside = BORN_AT_REST
    behind = "barrier"
    """ID of the barrier's fix."""
    law = SurfaceLaw(ObjectContact.fix)

    @property
    def fixes(self):
        return (self.fix, self.behind)

    def columns(self, context):
        system = context.system
        own = self.law.columns(context) | {STIFFNESS: self.barrier_stiffness(context), GAP: self.barrier_reach(context)}
        thin = system.layer == Layer.THIN
        return {**own, column("thin", "1"): (thin & self.guards(context)[system.object]).astype(float)} if thin.any() else own

    def needs_inside(self, context):
        """Barriers bear what meets others fast; what is rigid has none."""
        return bool((fast(context) & np.isfinite(context.system.young)).any())

    def guards(self, context: Context) -> np.ndarray:
        """Solids whose surface is a barrier where nothing is inside, bool, shape (M,): those that may be met fast. The faces of
        what touches at the start coincide."""
        system, found = context.system, fast(context) & np.isfinite(context.system.young)
        if found.any():
            low, high = system.bounds(system.position)
            gap = 0.5 * BORN_AT_REST * system.spacing[:, None]
            for i, j in box_pairs(low - gap, high + gap):
                found[i] = found[j] = False
        return found

    def barrier_stiffness(self, context: Context) -> np.ndarray:
        """Stiffness of the barrier at each particle [N/m], shape (N,); 0 without a barrier.

        Cells of a shape that is not a cuboid extend beyond its drawn surface: a barrier would bear it on their corners, so balls
        would not roll. The surface alone stops it up to SLOW. What never moves has particles at the corners of a box.
        """
        system = context.system
        boxed = np.array([frame.corners is not None for frame in system.frames])[system.contact_kind]
        with_barrier = (~are_dense(system) | fast(context)) & np.isfinite(system.young) & ~boxed & ~system.bare
        return np.where(with_barrier[system.object], particle_stiffness(context.scene, system), 0.0)

    def barrier_reach(self, context: Context) -> np.ndarray:
        """Reach of the barrier of each particle [m], shape (N,); of a pair the larger one counts.

        Particles on the surface of a slow body have none: the distance by which the barrier of another body reaches out of its
        inside is that body's own, as its layers are.
        """
        system = context.system
        quick = fast(context)[system.object]
        edge = np.array([frame.cells.edge.min() for frame in system.frames])[system.contact_kind]
        behind = np.where(system.boundary, 0.0, SHORT * edge[system.object])
        reach = np.where(quick, FULL * system.spacing[system.object], behind)
        return np.where((np.isfinite(system.young) & ~system.bare)[system.object], reach, 0.0)

    def longest_reach(self, context: Context) -> float:
        """No barrier of the scene reaches farther [m]."""
        system = context.system
        return float((np.where(fast(context), FULL, SHORT) * system.spacing).max())

    def commands(self, context):
        scene, system = context.scene, context.system
        rules = [f"pair {i + 1} {j + 1} {mu!r} {beta!r}" for i, j, mu, beta in pair_rules(scene, system.names)]
        return [
            *self.law.commands(context, " ".join(["objects", *rules, *excluded(context), *belts(context)])),
            *barrier(self.behind, context, self.thin(system)),
        ]

    def tunnelling(self, envelope):
        found, system = super().tunnelling(envelope), envelope.system
        bare = (envelope.cells < 1.5) & ~self.guards(envelope.context)
        found = np.minimum(found, np.where(needles(system), NEEDLE, np.where(bare, UNGUARDED, np.inf)))
        found = np.where(fast_late(envelope.context), np.minimum(found, slowest(system)), found)
        return np.where(meet_here(envelope.context), found, np.inf)

    def thin(self, system: System) -> tuple[str, ...]:
        """Commands that make the group of `guards`."""
        return ("variable thin atom d_thin", "group thin variable thin") if (system.layer == Layer.THIN).any() else ()

    def rate(self, context):
        """A contact is a spring along one direction, kappa w G G^T with node weights whose sum is 2: those of the point and those
        of the place that it presses on. K <= 2 blockdiag as for springs gives

            a_i = 2 kappa (w_i + s_i) / m_i,    w_i = sum over the points q of the own body of w_q |W_qi| sum_a |W_qa|

        with s_i the area of another body that a particle may bear: h^2 within a face, h^2/2 on an edge, h^2/4 in a corner.
        Between a cuboid and another shape only the points of the other one act, with ALONE kappa: 2 w_i or 2 s_i stand for the
        sum where they are larger. The barrier behind is added. The stick spring of friction, 0.8 kappa along the surface, adds
        nothing to the norm of a contact. No strict bound: the gradient of depth grows in pressed cells, and a folded sheet bears
        more than one layer.
        """
        system = context.system
        if not meet_here(context).any():  # nothing reads points of surfaces, which may take long to find
            return np.zeros(len(system.object))
        kappa = self.stiffness(context)[system.object]
        own, borne, dense = own_area(system), borne_area(system), are_dense(system)
        area = own + borne
        if dense.any() and not dense.all():
            area = np.maximum(area, ALONE * np.where(dense[system.object], own, borne))
        load = pressed_by_points(system, kappa, borne)
        area = np.where(system.bare[system.object], resolved(system)[system.object] * own, area)
        surface = 2.0 * kappa * _of_bodies(context, area / system.mass, 2.0) + 2.0 * load / system.mass
        return surface + barrier_rate(context, self.barrier_stiffness(context), self.longest_reach(context))

    def own_rate(self, context):
        system = context.system
        if not meet_here(context).any():
            return np.zeros(len(system.object))
        kappa = self.stiffness(context)[system.object]
        share = resolved(system)[system.object]
        return 2.0 * kappa * share * _of_bodies(context, own_area(system) / system.mass)

    def drag_rate(self, context):
        """Points of the own body and of another, and the factor 2 as in `rate`."""
        if not meet_here(context).any():
            return None
        one = self.law.dashpots(context, self.stiffness(context))
        return None if one is None else 4.0 * one

    def stiffness(self, context: Context) -> np.ndarray:
        """kappa of the surface of each solid with the stiffest partner [N/m^3], shape (M,); 0 without a partner."""
        young = moduli(context)
        partner = largest_of_partners(context, young, [own for own, _ in settled(context)])
        return surface_stiffness(context, young, 2.0 * partner / (young + partner)) * hardness(context.system)

    def problems(self, resolved, models, grid):
        return [*super().problems(resolved, models, grid), *too_fine(resolved.scene, models)]

    def notes(self, envelope):
        return [p for p in self.about_friction(envelope.context) if p.severity == "note"]

    def warnings(self, context):
        return [p for p in self.about_friction(context) if p.severity == "warning"]

    def about_friction(self, context: Context) -> list[Problem]:
        """Where it does not act, as notes and warnings."""
        return [*self.full_reaches(context), *one_sided(context.scene, context.system, context.passing), *too_thin(context)]

    def full_reaches(self, context: Context) -> list[Problem]:
        """Warning that the barrier keeps fast objects apart: without friction, whatever was written."""
        scene, system = context.scene, context.system
        found = np.flatnonzero(fast(context) & np.isfinite(system.young))
        if not len(found):
            return []
        m, reach, spans = int(found[0]), context.reach, scene.solids[found[0]].spans
        thrower = thrower_of(reach.acting, m, float(reach.closing(reach.drop, reach.thrown_across)[m]), others=True)
        more = f" and {len(found) - 1} more" if len(found) > 1 else ""
        so = ": friction with others works as 0" if (rubs := self.law.rubs(scene)) else ""
        return [
            Problem(
                thrower.span if thrower else next((spans[k] for k in ("velocity", "position", "object") if k in spans), None),
                f"{system.names[m]}{more} may meet others at more than {slowest(system)[m]:g} of the wave speed{by(thrower)} and "
                f"keeps the full reach of the barrier, which bears objects without friction{so}",
                f"{thrower.way_out}, or a higher elasticity where friction matters"
                if thrower
                else "write a lower speed or a higher elasticity where friction matters",
                severity="warning" if rubs else "note",
            )
        ]

    def told(self, scene):
        return super().told(scene) + ("" if self.law.rubs(scene) else "; no object has friction")

    def losses(self, scene):
        return (*self.law.losses(scene), LET_GO)

    def sources(self, scene):
        return (WORK,) if runs(scene) else ()

    def lost(self, readings):
        return self.law.lost(readings, (*self.losses(readings.context.scene), *self.sources(readings.context.scene)))

    def energy(self, readings):
        return readings.fix_scalar(self.fix) + readings.fix_scalar(self.behind)

    def clocks(self, readings):
        return {**super().clocks(readings), self.behind: readings.fix_seconds(self.behind)}

    def penetration(self, readings):
        return self.law.penetration(readings)


class SurfacePlanes(Planes):
    """Planes that points of drawn surfaces are pushed back by: kappa = f E/h [N/m^3] (docs/physics-contact.md, "At the drawn
    surfaces, with friction").
    """

    styles = (("fix", "mdanim/contact"),)
    rests_inside = BORN_AT_REST

    def __init__(self, sides: Sides):
        super().__init__(sides)
        self.law = SurfaceLaw(sides.name, sides.name)

    def rough(self, scene):
        return np.full(len(scene.solids), any_friction(scene)) if scene.contacts else np.array(frictions(scene)) > 0.0

    def columns(self, context):
        return self.law.columns(context)

    def commands(self, context):
        return self.law.commands(context, " ".join(map(word_of, self.planes(context.scene))))

    def rate(self, context):
        """a_i = kappa w_i / m_i with w_i as in `SurfaceContact.rate`: the plane does not move, so there is no factor 2."""
        system, kappa = context.system, self.stiffness(context)
        areas = _of_bodies(context, own_area(system) / system.mass) if kappa.any() else 0.0  # they may take long to find
        return np.where(system.held, 0.0, kappa[system.object] * areas)

    def own_rate(self, context):
        return self.rate(context)

    def drag_rate(self, context):
        return self.law.dashpots(context, self.stiffness(context))

    def losses(self, scene):
        return (*self.law.losses(scene), *((LET_GO,) if any(map(tears, scene.solids)) else ()))  # contact of what is torn ends

    def sources(self, scene):
        return (WORK,) if any(p.motion for p in self.planes(scene)) else ()

    def lost(self, readings):
        return self.law.lost(readings, (*self.losses(readings.context.scene), *self.sources(readings.context.scene)))

    def penetration(self, readings):
        return self.law.penetration(readings)

    def stiffness(self, context: Context) -> np.ndarray:
        """kappa of the surface of each solid against a plane, which has no points of its own [N/m^3], shape (M,); 0 of what is
        held as a whole."""
        system = context.system
        share = np.where(are_dense(system), np.where(system.bare, 2.0 * resolved(system), ALONE), 1.0)
        for own in (system.held_whole, *(own for own, _ in settled(context, planes=True))):
            share = np.where(own, 0.0, share)
        return surface_stiffness(context, moduli(context), share) if share.any() else share


def touching_planes(sides: Sides) -> Planes:
    """The effect of these sides, in both forms."""
    return BarrierPlanes(sides, SurfacePlanes(sides))


def too_fine(scene: SceneRecord, models: Sequence[Model]) -> list[Problem]:
    """Objects that deform and whose cells are finer than lines or sheets of particles are thick around
    these: a cell beyond its surface the map of such a host leads nowhere."""
    bare = [m for m, model in enumerate(models) if model.frame.bare]
    if not bare:
        return []
    thickest = max(bare, key=lambda m: models[m].frame.contact.radius)
    radius, name = models[thickest].frame.contact.radius, models[thickest].name
    found = []
    for solid, model in zip(scene.solids, models):
        h = float(np.cbrt(np.prod(model.cell)))
        if model.frame.bare or model.frame.rigid or model.inertia is not None or model.still or h >= radius * (1.0 - 1e-9):
            continue
        cause = f"{name} is {say(2.0 * radius, 'm')} thick, more than two cells of {solid.name}, which are {say(h, 'm')} wide"
        way_out = f"write resolution {say(at_least(radius), 'm')} in {solid.name}, elasticity rigid, or a thinner {name}"
        place = solid.spans.get("resolution") or solid.spans.get("elasticity")
        found.append(Problem(place, f"{cause}: their contact would be lost", way_out))
    return found


def _of_bodies(context: Context, of_particles: np.ndarray, sides: float = 1.0) -> np.ndarray:
    """Areas of surface over masses [m^2/kg], shape (N,): at each particle of what deforms, of a rigid body as a whole, from this
    number of sides."""
    system = context.system
    if not system.rigid.any():
        return of_particles
    return np.where(system.rigid[system.object], sides * spread_mobility(context)[system.object], of_particles)


def settled(context: Context, planes: bool = False) -> list[tuple[np.ndarray, str]]:
    """Solids whose contact with each other, or with planes, another fix has (Effect.settles), and their groups."""
    on = (e for e in context.resolved.effects if e.acts_on(context))
    return [found for e in on if (found := e.settles(context, planes=planes)) is not None]


def meet_here(context: Context) -> np.ndarray:
    """Solids that may meet another one whose contact with them is in no other fix, bool, shape (M,)."""
    moving = ~context.system.still
    found = np.ones(len(moving), bool)
    for own, _ in settled(context):
        found &= ~own | np.where(moving, (~own).any(), (moving & ~own).any())
    return found


def surface_stiffness(context: Context, young: np.ndarray, share: np.ndarray | float = 1.0) -> np.ndarray:
    """kappa = f E/h of the surface of each solid with these moduli [Pa], times a share that a partner leaves of it [N/m^3], shape
    (M,).

    Between two solids kappa = f 2 E_A E_B/(E_A + E_B)/max(h_A, h_B): the share is 2 E_B/(E_A + E_B).
    """
    return context.scene.control.contact_stiffness * young * share / np.cbrt(context.system.cell_volume)


def are_dense(system: System) -> np.ndarray:
    """Solids that are not cuboids, with dense points on their surfaces, bool, shape (M,)."""
    return np.array([not isinstance(frame.shape, Box) for frame in system.frames])[system.contact_kind]


def resolved(system: System) -> np.ndarray:
    """LINE times RESOLVED of lines and sheets of particles, 1 of all others, shape (M,)."""
    return np.array([LINE * RESOLVED[frame.dimensions] if frame.bare else 1.0 for frame in system.frames])[system.contact_kind]


def own_area(system: System) -> np.ndarray:
    """w_i, the area of the surface that each particle carries [m^2], shape (N,); 0 of what is rigid, which moves as a whole,
    and of what is held as a whole, unless it is a line or a sheet, whose points press on others."""
    found = np.zeros(len(system.object))
    for m in np.flatnonzero(system.bare | ~(system.rigid | system.held_whole)).tolist():
        found[system.first[m] : system.first[m + 1]] = system.frames[system.contact_kind[m]].contact.carried
    return found


def borne_area(system: System) -> np.ndarray:
    """s_i, the area of another surface that each particle may bear [m^2], shape (N,): h^2 within a face, less where fewer cells
    are behind it."""
    area = np.where(system.bare, 0.0, np.cbrt(system.cell_volume) ** 2)
    return area[system.object] * np.minimum(1.0, 2.0 * system.share)


def pressed_by_points(system: System, kappa: np.ndarray, borne: np.ndarray) -> np.ndarray:
    """Stiffness [N/m] with which points of lines and sheets of particles may press on each particle of what deforms, shape (N,):
    of one point, or of all on the area that the particle bears [m^2], shape (N,). ``kappa`` of each particle [N/m^3], shape (N,).

    They give way by their own links, whatever the cells that they lie on."""
    bare = system.bare
    if not bare.any():
        return np.zeros(1)
    point = (kappa * own_area(system))[bare[system.object]].max()
    area = float((system.spacing[bare] ** 2).min())
    deforms = ~bare & ~system.rigid & ~system.held_whole
    return np.where(deforms[system.object], LINE * point * np.maximum(1.0, borne / area), 0.0)


def fast(context: Context) -> np.ndarray:
    """Solids that may meet others at more than SLOW of the wave speed of the softest, as if through air, bool, shape (M,).

    Forces and wind count by the way between the solids at the start: not by how long they may act, on which no motion depends."""
    return _above_slow(context, context.reach.thrown_across)


def fast_late(context: Context) -> np.ndarray:
    """Solids that are not `fast`, and may get so until the end by what pushes them or another one, bool, shape (M,)."""
    return _above_slow(context, context.reach.acting.thrown_at) & ~fast(context)


def _above_slow(context: Context, thrown: np.ndarray) -> np.ndarray:
    reach = context.reach
    return (reach.closing(reach.drop, thrown) > slowest(reach.system) * float(reach.wave.min())) & ~reach.system.bare


def slowest(system: System) -> np.ndarray:
    """Closing speed over the wave speed up to which a short barrier stops each solid, shape (M,)."""
    return np.where(needles(system), SLOW_NEEDLE, SLOW)


def needles(system: System) -> np.ndarray:
    """Solids that are one cell across along two axes, bool, shape (M,)."""
    return np.array([np.sort(frame.cells.count)[1] == 1 for frame in system.frames])[system.contact_kind]
