# SPDX-License-Identifier: GPL-2.0-only
"""Gas in closed sheets, by ``fix mdanim/inflate``."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any

import numpy as np

from ...bodies import all_held
from ...effects.context import Context, Verdict
from ...effects.effect import Effect
from ...effects.facets import StandardSteps
from ...effects.fields import Field
from ...errors import Problem
from ...model import shapes
from ...model.triangles import areas, edge_keys, normals
from ...reach import Throw
from ...scene.formatting import number, say
from ...scene.once import once_for
from ...scene.shapes import Box, Sphere
from ..tearing.words import tears
from .words import Inflate

VOLUME, PRESSURE = "gas_volume", "gas_pressure"
LOST = "gas_loss"
"""Column of the ledger: energy of gas that went out where a sheet tore."""
BAGS = "bags"
"""Table of surfaces."""
FAR, MOST_GROWN = 1.3, 4.0
"""Growth of a ball above which a warning is given, and up to which its sheet is asked."""
MOST_LEFT = 0.5
"""Part of the pressure below which a note tells what is left of it."""
NU = 1.0 / 3.0
"""Poisson's ratio of sheets."""


class Gas(StandardSteps, Effect):
    """p = (p1 + p0) V1/V - p0 on each triangle of a closed sheet, V its volume, p1 and V1 those at the start: the gradient of
    U(V) = p0 (V - V*) - C ln(V/V*), C = (p1 + p0) V1, V* = C/p0 (docs/physics-inflate.md); nothing once the sheet has torn.
    """

    styles = (("fix", "mdanim/inflate"),)
    name = fix = "inflate"
    order = 86
    ledger = "gas"
    if_off = "what is inflated is hollow, and falls in"

    def called_for(self, scene, reach):
        found = [solid for solid in scene.solids if solid.inflate is not None]
        if not found:
            return Verdict(self.name, False, "no object is inflated")
        span = found[0].spans.get("inflate")
        if all(map(all_held, found)):
            return Verdict(self.name, False, "what is inflated is held as a whole", span)
        return Verdict(self.name, True, f"gas in {found[0].name} at {say(found[0].inflate.pressure, 'Pa')}", span)

    def acts_on(self, context):
        return bool(_inflated(context))

    def throws(self, scene):
        return _throws(scene)

    # --- what it brings into a run ------------------------------------------------------------------------------------

    def commands(self, context):
        return [f"fix {self.fix} {context.pushed} mdanim/inflate bags table:{BAGS}"]

    def tables(self, context):
        first: dict[int, int] = {}
        lines = ["# Closed surfaces with gas, written by mdanim-lammps: object MOLECULE P V P0, or like another one\n"]
        for m in _inflated(context):
            triangle, gas = context.system_models[m].frame.triangle, context.solids[m].inflate
            head = f"object {m + 1} {gas.pressure!r} {_volume(context, m)!r} {gas.outside!r}"
            if id(triangle) in first:
                lines.append(f"{head} like {first[id(triangle)]}\n")
                continue
            first[id(triangle)] = m + 1
            lines += [f"{head}\n", *(f"triangle {a} {b} {c}\n" for a, b, c in (triangle + 1).tolist())]
        return {BAGS: "".join(lines)}

    def rate(self, context):
        """Two parts: that of the gas as a spring, (p + p0)/V g g' with the gradient g of the volume, of which the share in any
        particle's bound is (p + p0)/V sum g_i^2/m_i; and p times the change of areas: p |c - d|/6 between the ends of an edge
        with the corners c and d beside it."""
        found = np.zeros(context.system.particles)
        for m in _inflated(context):
            gas, model = context.solids[m].inflate, context.system_models[m]
            x, triangle = model.position, model.frame.triangle
            own = slice(context.system.first[m], context.system.first[m + 1])
            mass = context.system.mass[own]
            area = np.zeros((len(x), 3))
            normal = normals(x, triangle) / 6.0
            beside = np.zeros(len(x))
            for k in range(3):
                np.add.at(area, triangle[:, k], normal)
                a, b, c = (triangle[:, (k + n) % 3] for n in range(3))
                # Both triangles of an edge have a part of it, towards its middle.
                part = np.linalg.norm(x[c] - 0.5 * (x[a] + x[b]), axis=1) / 6.0
                np.add.at(beside, a, part)
                np.add.at(beside, b, part)
            whole = float(((area**2).sum(axis=1) / mass).sum())
            found[own] = (gas.pressure + gas.outside) / _volume(context, m) * whole + gas.pressure * beside / mass
        return found

    # --- accounts and frames ------------------------------------------------------------------------------------------

    def energy(self, readings):
        return readings.fix_scalar(self.fix)

    def losses(self, scene):
        return (LOST,) if any(solid.inflate is not None and tears(solid) for solid in scene.solids) else ()

    def lost(self, readings):
        return {term: readings.fix_value(self.fix, "energy") for term in self.losses(readings.context.scene)}

    def fields(self, scene):
        count = (len(scene.solids),)
        return Field(VOLUME, "m^3", per="object", counts=count), Field(PRESSURE, "Pa", per="object", counts=count)

    def tell(self, readings):
        inflated = _inflated(readings.context)
        found = np.zeros((len(readings.system.names), 2))
        found[inflated] = readings.fix_rows(self.fix, len(inflated), 2)
        return {VOLUME: found[:, 0], PRESSURE: found[:, 1]}

    # --- advice -------------------------------------------------------------------------------------------------------

    def problems(self, resolved, models, grid):
        """Sheets that are open."""
        found = []
        for model, solid in zip(models, resolved.scene.solids):
            if solid.inflate is None or all_held(solid):
                continue
            if many := _open_edges(model):
                cause = f"the surface of {solid.name} is open at {many} edges, and gas would go out"
                found.append(Problem(solid.spans.get("inflate"), cause, "close it in a mesh editor, or leave inflate out"))
        return found

    def warnings(self, context):
        """Objects that swell far, or without end, as a ball of their volume and surface would."""
        found = []
        for m in _inflated(context):
            solid = context.solids[m]
            if (grown := _grown(context, m)) > FAR:
                size = f"to {number(grown, 2)} times its size" if math.isfinite(grown) else "without end"
                cause = f"{solid.name} swells {size}, as a ball of its volume and surface would"
                way = "write a lower pressure, a thicker sheet or more elasticity"
                found.append(Problem(solid.spans.get("inflate"), cause, way, severity="warning"))
        return found

    def notes(self, envelope):
        """The pressure that is left in balls, where most of it goes; boxes of which it is as little."""
        found = []
        for m in _inflated(envelope.context):
            solid = envelope.context.solids[m]
            if isinstance(solid.shape.shape, Box) and _left_in_box(solid) < MOST_LEFT * solid.inflate.pressure:
                cause = f"the flat sides of {solid.name} bulge, which takes most of {say(solid.inflate.pressure, 'Pa')}"
                way = "write a higher pressure, or a thicker sheet or more elasticity, which bulge less"
                found.append(Problem(solid.spans.get("inflate"), cause, way, severity="note"))
                continue
            gas, grown = solid.inflate, _grown(envelope.context, m)
            left = (gas.pressure + gas.outside) / grown**3 - gas.outside
            if isinstance(solid.shape.shape, Sphere) and grown <= FAR and left < MOST_LEFT * gas.pressure:
                cause = f"{solid.name} swells to {number(grown, 4)} times its size, and {say(left, 'Pa', 2)} of "
                cause += f"{say(gas.pressure, 'Pa')} are left"
                found.append(Problem(solid.spans.get("inflate"), cause, severity="note"))
        return found


def _grown(context: Context, m: int) -> float:
    """By how much a ball of the volume and surface of an object swells until its sheet bears the gas [-]: the least s > 1 with
    2 E t (s - 1)/((1 - nu) s^2 r) = (p + p0)/s^3 - p0; infinite for none up to MOST_GROWN."""
    from scipy.optimize import brentq  # takes 0.2 s

    model, solid = context.system_models[m], context.solids[m]
    gas = solid.inflate
    r = 3.0 * _volume(context, m) / float(areas(model.position, model.frame.triangle).sum())
    stiff = 2.0 * solid.elasticity.modulus * solid.shape.thickness / ((1.0 - NU) * r)

    def spare(s):
        return stiff * (s - 1.0) / s**2 - (gas.pressure + gas.outside) / s**3 + gas.outside

    s = np.linspace(1.0, MOST_GROWN, 4001)
    enough = np.flatnonzero(spare(s) >= 0.0)
    if not len(enough):
        return math.inf
    # A pressure that is left is the small difference of two large ones: it needs s far more exactly than these steps.
    return float(brentq(spare, s[enough[0] - 1], s[enough[0]])) if enough[0] else 1.0


def _left_in_box(solid: Any) -> float:
    """Pressure that is left in a box whose sides bulge [Pa], by strips across the narrower way b of each side whose edges stay:
    q = 64 E t w^3/(3 (1 - nu^2) b^4) with the height w of the bulge, of the volume 2/3 w b (a - b/2) with its round ends."""
    from scipy.optimize import brentq  # takes 0.2 s

    gas, ends = solid.inflate, np.array(shapes.extent(solid.shape))
    size = np.sort(ends[1] - ends[0])
    stiff = 64.0 / 3.0 * solid.elasticity.modulus * solid.shape.thickness / (1.0 - NU**2)

    def spare(q):
        more = sum(4.0 / 3.0 * (q * b**4 / stiff) ** (1.0 / 3.0) * b * (a - 0.5 * b) for b, a in combinations(size, 2))
        whole = float(size.prod())
        return (gas.pressure + gas.outside) * whole / (whole + more) - gas.outside - q

    return float(brentq(spare, 0.0, gas.pressure))


@once_for(lambda scene: scene)
def _throws(scene: Any) -> dict[int, Throw]:
    """The speed that the gas gives a sheet that bears nothing, and the acceleration p/(rho t) by it."""
    found = {}
    for m, solid in enumerate(scene.solids):
        if solid.inflate is None or all_held(solid):
            continue
        gas, mass = solid.inflate, shapes.mass(solid)
        low, high = shapes.extent(solid.shape)
        volume = float(np.prod(high - low))
        speed = math.sqrt(2.0 * _stored(gas, volume) / mass)
        acceleration = gas.pressure * 0.5 * shapes.area(solid.shape) / mass
        found[m] = Throw(
            speed,
            acceleration,
            speed,
            acceleration,
            f"the gas in {solid.name}",
            "write a lower pressure",
            solid.spans.get("inflate"),
        )
    return found


def _stored(gas: Inflate, volume: float) -> float:
    """Energy that the gas can give [J]: all of it where there is something outside, else until it has twice its volume."""
    amount = (gas.pressure + gas.outside) * volume
    if gas.outside == 0.0:
        return amount * math.log(2.0)
    rest = amount / gas.outside
    return gas.outside * (volume - rest) - amount * math.log(volume / rest)


@once_for(lambda context: context.system)
def _inflated(context: Context) -> list[int]:
    """Numbers of the objects of a context with gas that can move."""
    return [m for m in np.flatnonzero(~context.system.still).tolist() if context.solids[m].inflate is not None]


def _volume(context: Context, m: int) -> float:
    """Volume of an object at the start [m^3]."""
    model = context.system_models[m]
    return volume_in(model.position, model.frame.triangle)


def volume_in(x: np.ndarray, triangle: np.ndarray) -> float:
    """Volume that triangles of points x [m], shape (N, 3), enclose [m^3]."""
    a, b, c = (x[triangle[:, k]] - x[0] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def _open_edges(model: Any) -> int:
    """Edges with a triangle on one side only."""
    _, uses = np.unique(edge_keys(model.frame.triangle), return_counts=True)
    return int(np.count_nonzero(uses != 2))


EFFECTS = (Gas(),)
