# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ...scene.formatting import number, say, vector
from ...scene.schema import Block, Observable, setting
from ...scene.units import show
from ..contact.words import ContactModel
from ..drives.words import DriveOscillation, ShiftKey, check_shift
from .record import Liquid

SWITCHES = {
    "basin": "the basin of a liquid and an object that can move",
    "liquid": "`liquid`",
    "buoyancy": "a liquid that an object can reach",
    "liquid-drag": "a liquid that an object can reach",
}

QUANTITIES = {
    ("NAME", "draft"): Observable(
        "m", "depth of the lowest point of an object below the surface around it, 0 of what is dry", "liquid"
    ),
    ("NAME", "immersed"): Observable("1", "share of an object's volume below the surface", "liquid"),
    ("liquid", "volume"): Observable("m^3", "volume of the liquid", "liquid"),
    ("liquid", "residual"): Observable("1", "cells gained or lost, to the unit", "liquid", bound=True),
    ("liquid", "level"): Observable("m", "mean height of the surface", "liquid"),
    ("liquid", "height"): Observable(
        "m", "height of the surface at a place: `liquid.height(0.2 m, 0 m)`", "liquid", takes="place"
    ),
    **{
        ("liquid", f"flow.{axis}"): Observable(
            "m^3/s",
            f"flow through the plane at this {axis}, mean since the frame before: `liquid.flow.{axis}(0.2 m)`",
            "liquid",
            takes="cut",
        )
        for axis in "xy"
    },
    ("liquid", "crest"): Observable("m", "highest point of the liquid at any frame, without drops", "liquid"),
    ("liquid", "waves"): Observable(
        "J",
        "energy of the liquid, of height and motion, less that at the start; at rest what floats has lifted it by so much; "
        "0 without `model waves`",
        "liquid",
    ),
}

MARGINS = {
    "sweeps": "how often the liquid is swept while an object travels one cell; below 4 it is pushed up before it can flow away"
}


BLOCKS = (
    Block("liquid", Liquid, "liquid", "The liquid of the scene; there is at most one, and it needs gravity along -z.",
          names=("name",), order=10, enough=True),
)  # fmt: skip

TOUCHED = {"basin": "liquid"}


class LiquidWords:
    """The liquid in a scene."""

    liquid: Liquid | None = None


SCENE = LiquidWords


class LiquidPictures:
    """Settings of ``render``."""

    liquid: str = setting(
        "<smooth|cells>",
        "`smooth`: the surface of the liquid as a smooth sheet. `cells`: the columns of the automaton as they are.",
        "cells", default="smooth", after="background")  # fmt: skip


RENDER = LiquidPictures


def touched(scene) -> bool:
    """Whether it brings something into a scene that objects may touch."""
    return scene.liquid is not None


def width(scene) -> tuple[float, str] | None:
    """The width that sets the spacing of a scene without objects: an eighth of the basin's narrower side [m], so that a balanced
    basin is 32 cells, and its name."""
    if scene.liquid is None:
        return None
    return min(b - a for a, b in zip(scene.liquid.low[:2], scene.liquid.high[:2])) / 8, scene.liquid.name


# --- checks: v is the scene/validate.Validator ----------------------------------------------------------------------


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """Check further needs of a scene with a liquid; ``held`` are the records of blocks."""
    gravity_fits(v, v.blocks("liquid"))
    if held["liquid"] and held["liquid"].moves and held["control"] and held["control"].contact_model is ContactModel.PAPER:
        span = held["liquid"].spans.get("drive") or held["liquid"].spans.get("key")
        v.problem(span, "the basins of contact-model paper stand", "take contact-model paper out of control")
    ground_below(v, held["liquid"])
    within_basin(v, held["liquid"])


def gravity_fits(v: Any, liquids: list) -> None:
    """A liquid lies flat only under gravity along -z."""
    if not liquids or v.out.excused("gravity"):
        return
    several = v.out.settings.get("gravity", ())
    if len(several) > 1:
        cause = "gravity changes here, and a liquid lies under one gravity: its waves, its levels and its lift are those of one g"
        v.problem(several[1].span(), cause, "write gravity once, or take the liquid out", key="gravity")
        return
    given = several[0] if several else None
    g = given.values[1] if given else (0.0, 0.0, 0.0)
    if g[0] != 0.0 or g[1] != 0.0 or g[2] >= 0.0:
        span = given.span(1) if given else liquids[0].head
        found = f"found {show(g)} m/s^2" if given else "the scene has no gravity"
        v.problem(span, f"a liquid needs gravity along -z, {found}", "e.g. gravity (0, 0, -9.81) m/s^2", key="gravity")


def ground_below(v: Any, liquid: Any) -> None:
    """Ground above the floor of the basin holds solids up within the liquid."""
    ground = v.out.value("ground")
    if liquid is None or ground is None or not liquid.low[2] < ground < liquid.high[2]:
        return
    v.problem(
        v.out.first("ground").span(0),
        f"the ground at z = {say(ground, 'm', 6)} is above the floor of the basin, {say(liquid.low[2], 'm', 6)}: "
        "nothing sinks below it, liquid does",
        f"the basin has a floor of its own: leave the ground out, or write ground z {say(liquid.low[2], 'm', 6)}",
        severity="warning",
    )


def within_basin(v: Any, liquid: Any) -> None:
    """Places whose heights are asked for lie in the basin."""
    for (_, quantity, place), span in v.quantities() if liquid is not None else ():
        if place is None:
            continue  # it is missing, or the quantity takes none
        if (axis := {"flow.x": 0, "flow.y": 1}.get(quantity)) is not None and not liquid.low[axis] < place < liquid.high[axis]:
            cause = f"the plane at {number(place, 6)} m lies outside the basin"
            v.problem(span, cause, f"the basin goes from {number(liquid.low[axis])} to {number(liquid.high[axis])} m")
        if quantity == "height" and not all(a <= x <= b for a, x, b in zip(liquid.low, place, liquid.high)):
            cause = f"the place {vector(place)} m lies outside the basin"
            v.problem(span, cause, f"the basin goes from {vector(liquid.low[:2])} to {vector(liquid.high[:2])} m")


def check_liquid(v: Any, block: Any, liquid: Any) -> Any:
    """Volume or level against what the liquid starts in: the basin, or part of it."""
    v.corners(block.first("basin"), "the basin")
    low, high = liquid.low, liquid.high
    if liquid.fill is not None:
        s = block.first("fill")
        v.corners(s, "the part that is filled")
        for which, (corner, name) in enumerate(zip(liquid.fill, ("lower", "upper"))):
            if not all(a <= x <= b for a, x, b in zip(low, corner, high)):
                cause = f"the {name} corner of fill lies outside the basin: {vector(corner)} m"
                v.problem(s.span(which), cause, f"the basin goes from {vector(low)} to {vector(high)} m")
    check_pools(v, block, liquid)
    where = "the basin" if liquid.fill is None else "the fill region"
    bottom, top = liquid.fill or (low, high)
    room = math.prod(b - a for a, b in zip(bottom, top))
    if liquid.volume is not None and liquid.volume > room > 0.0:
        cause = f"{say(liquid.volume, 'm^3', 6)} of liquid do not fit into {where} of {say(room, 'm^3', 6)}"
        way_out = "less liquid, or a larger basin" if liquid.fill is None else "less liquid, or a larger fill region"
        v.problem(block.first("volume").span(0), cause, way_out)
    if liquid.level is not None and not bottom[2] < liquid.level <= top[2]:
        cause = f"the level {say(liquid.level, 'm', 6)} is outside {where}, which goes from "
        cause += f"{say(bottom[2], 'm', 6)} to {say(top[2], 'm', 6)}"
        v.problem(block.first("level").span(0), cause, "the level is a height, not a depth")
    check_waves(liquid, block, v.problem)
    check_motion(v, block, liquid)
    if liquid.model.value == "paper":
        v.problem(
            block.first("model").span(0),
            "model paper takes the rules literally: not Archimedes, objects denser than about 0.4 of the liquid sink",
            "leave the line out for drafts after Archimedes",
            severity="warning",
        )
    return liquid


def check_pools(v: Any, block: Any, liquid: Any) -> None:
    """Pools lie in the basin beside what is filled, below its level."""
    taken = [] if liquid.fill is None else [("the part that is filled", *liquid.fill)]
    for s, pool in zip(block.settings.get("pool", ()), liquid.pool):
        v.corners(s, "the pool")
        if liquid.fill is None:
            v.problem(s.span(), "all of the basin is filled, the pool too", "write fill from ... to ..., or leave the pool out")
        if liquid.level is None:
            v.problem(s.span(), "a pool is beside what is filled to a level", "write level in place of volume")
        elif pool.high[2] > liquid.level:
            cause = f"the pool goes up to {say(pool.high[2], 'm', 6)}, above the level of {say(liquid.level, 'm', 6)}"
            v.problem(s.span(), cause, "fill what stands higher, and make a pool of what is lower")
        if not all(a <= x <= b for corner in (pool.low, pool.high) for a, x, b in zip(liquid.low, corner, liquid.high)):
            cause = f"the pool from {vector(pool.low)} to {vector(pool.high)} m is not all in the basin"
            v.problem(s.span(), cause, f"the basin goes from {vector(liquid.low)} to {vector(liquid.high)} m")
        for name, low, high in taken:
            if all(a < d and c < b for a, b, c, d in zip(pool.low, pool.high, low, high)):
                v.problem(s.span(), f"the pool and {name} overlap", "let each end where the other begins")
        taken.append(("another pool", pool.low, pool.high))


def check_motion(v: Any, block: Any, liquid: Any) -> None:
    """A basin moves along x and y, with a liquid that has momentum and to which nothing comes."""
    said = [*zip(block.settings.get("drive", ()), liquid.drive), *zip(block.settings.get("key", ()), liquid.keys)]
    if not said:
        return
    check_shift(v, f"the basin of {liquid.name}", said)
    first = said[0][0]
    for s, one in said:
        up = (one.by if isinstance(one, ShiftKey) else one.way if isinstance(one, DriveOscillation) else one.velocity)[2]
        if up:
            cause = f"the basin of {liquid.name} moves up and down, which would change the weight of the liquid"
            v.problem(s.span(), cause, "write 0 for z: a basin moves along x and y")
    if liquid.model.value != "waves":
        cause = f"the basin moves, and a liquid of model {liquid.model.value} has no momentum: it would stay level"
        v.problem(first.span(), cause, "leave the model out, which is waves then")
    for word in ("wave", "current", "inflow", "drain", "drops"):
        if getattr(liquid, word):
            cause = f"the basin moves, and {word} is of one that stands"
            v.problem(block.first(word).span(), cause, f"leave {word} out, or what moves the basin")


def check_waves(liquid: Any, block: Any, problem: Any) -> None:
    """Makers only with waves, only inside the basin, and with a rate; ``problem`` takes a span, a cause and a way out."""
    waves = liquid.model.value == "waves"
    for word in ("sweeps",) if waves else ("calm", "manning", "drops", "wave", "current", "inflow", "drain"):
        if getattr(liquid, word):
            cause, way_out = f"model {liquid.model.value} has no {word}", "surface" if waves else "waves"
            problem(block.first(word).span(), cause, f"leave the line out, or write model {way_out}")
    for word in ("inflow", "drain"):
        for s, flow in zip(block.settings.get(word, ()), getattr(liquid, word)):
            corners = list(zip(flow.low, flow.high, liquid.low, liquid.high))
            if any(high < low or high < bottom or low > top for low, high, bottom, top in corners):
                cause = f"the {word} from {vector(flow.low)} to {vector(flow.high)} m is not a part of the basin"
                problem(s.span(), cause, f"the basin goes from {vector(liquid.low)} to {vector(liquid.high)} m")
            if not flow.rate > 0.0:
                problem(s.span(), f"the rate of the {word} must be > 0, found {say(flow.rate, 'm^3/s')}", "e.g. 0.002 m^3/s")


CHECKS = {"liquid": check_liquid}
