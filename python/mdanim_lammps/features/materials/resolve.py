# SPDX-License-Identifier: GPL-2.0-only
"""Settings of an object by its material: those that it has not itself and that suit it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from ...scene.evaluated import EvaluatedBlock, EvaluatedSetting
from ...scene.keywords import KEYWORDS, did_you_mean
from ...scene.shapes import HoldAll, Sheet, Shell, Young
from ..drives.words import RELEASE
from ..rigid.words import SENSELESS, Rigid
from .table import MATERIALS, MEANT, Material

STIFF = 200.0
"""Wave speed sqrt(E/rho) from which on what is made of a material is rigid [m/s]: where it is struck at 10 m/s, as after
a fall from 5 m, it is strained by about v/c, a twentieth, which is not seen; and a step of its springs would last h/c at
most, less than 0.1 ms at h = 2 cm."""

Settings = dict[str, list[EvaluatedSetting]]


def fill(v: Any) -> None:
    """Give objects what their materials say; v is the scene/validate.Validator."""
    own = {block.name: block for block in v.blocks("material")}
    for block in v.blocks("object"):
        given = block.first("material")
        found = _made_of(v, own, given, (), block.where, _is_sheet(block)) if given is not None else {}
        if found is None or "material" in block.broken:
            block.broken |= set(KEYWORDS["material"])
        else:
            mine = block.words()
            block.settings |= {word: s for word, s in _suited(block, found).items() if word not in mine}
    for name, block in own.items():
        if (given := block.first("material")) is not None:
            _made_of(v, own, given, (name,), "", False)


def _made_of(
    v: Any, own: dict[str, EvaluatedBlock], given: EvaluatedSetting, within: tuple[str, ...], where: str, sheet: bool
) -> Settings | None:
    """Settings of the material that a setting names, where it stands in the blocks ``within``, of a sheet or another object; None
    after a problem. A block that names its own name means the known material."""
    name = given.values[0]
    block = own.get(name) if name not in within else None
    if block is not None:
        used_at = (*given.used_at, given.entry.source.span(given.entry.token))
        said = {
            word: [replace(one, used_at=used_at) for one in found] for word, found in block.settings.items() if word != "material"
        }
        base = block.first("material")
        under = _made_of(v, own, base, (*within, name), where, sheet) if base is not None else {}
        if block.broken:
            return None
        return None if under is None else under | said
    if name in MATERIALS:
        return _known(given, MATERIALS[name], sheet)
    if name in within:
        cause = f"the material {name} is made of itself: {' -> '.join((*within, name))}"
        v.problem(given.span(0), cause, "take one of them out", key=("material", *sorted(within)))
    else:
        cause, known = f"no material is called {name}{where}", [*(one for one in own if one not in within), *MATERIALS]
        meant = f"did you mean {' or '.join(map(repr, MEANT[name]))}?" if name in MEANT else did_you_mean(name, known)
        v.problem(given.span(0), cause, meant or f"known here: {', '.join(known)}", key=("material", given.entry))
    return None


def _known(given: EvaluatedSetting, material: Material, sheet: bool) -> Settings:
    """Settings of a known material, at the place that names it."""
    figures = material.figures() | (dict(material.sheet) if sheet else {})
    values: dict[str, Any] = {word: figure.value for word, figure in figures.items()}
    values |= {"elasticity": Young(figures["elasticity"].value), "color": material.color}
    return {
        word: [given.following(KEYWORDS["object"][word], value)] for word, value in values.items() if word in KEYWORDS["material"]
    }


def _suited(block: EvaluatedBlock, found: Settings) -> Settings:
    """Settings of a material that suit an object: its form of elasticity decides on damping and restitution."""
    found = dict(found)
    holds = [s.kind for s in block.settings.get("hold", ())]
    held = HoldAll in holds
    shape = block.first("shape")
    bends = shape is not None and getattr(shape.kind, "BENDS", False) and not _is_shell_in_pieces(block)
    if "elasticity" in found and not bends and (held or not holds) and _stiff(found):
        given = found["elasticity"][0]
        found["elasticity"] = [given.following(given.entry.keyword, Rigid())]
    elasticity = block.first("elasticity") or next(iter(found.get("elasticity", ())), None)
    rigid = elasticity is not None and elasticity.kind is Rigid
    stays = held and block.first(RELEASE) is None
    left_out = set(SENSELESS) if rigid else set() if stays and not bends else {"restitution"}
    if block.first("pieces") is None:
        left_out |= {"strength"}
    return {word: s for word, s in found.items() if word not in left_out}


def _stiff(found: Settings) -> bool:
    """Whether waves in a material are so fast that it counts as rigid."""
    elasticity, density = found["elasticity"][0], found.get("density")
    if elasticity.kind is not Young or not density:
        return False
    return math.sqrt(elasticity.values[0] / density[0].values[0]) >= STIFF


def _is_sheet(block: EvaluatedBlock) -> bool:
    shape = block.first("shape")
    return shape is not None and shape.kind in (Sheet, Shell) and not _is_shell_in_pieces(block)


def _is_shell_in_pieces(block: EvaluatedBlock) -> bool:
    """Whether an object is a shell that breaks, which is rigid."""
    shape = block.first("shape")
    return shape is not None and shape.kind is Shell and block.first("pieces") is not None
