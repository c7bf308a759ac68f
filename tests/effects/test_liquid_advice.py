# SPDX-License-Identifier: GPL-2.0-only
"""Notes of ``check`` on what waves get wrong: where they are told, where not, and that they tell what the page has measured."""

import json
import re

import pytest
from mdanim_lammps.features.liquid import advice
from mdanim_lammps.features.liquid.advice import SHORTFALLS
from paths import REPOSITORY

POOL = """gravity (0, 0, -9.81) m/s^2
liquid water {{
  basin   from (0, 0, 0) m to (2, 0.8, 1) m
  density 1000 kg/m^3
  {liquid}
}}
{objects}
control {{ time 1 s  frames 10 fps  resolution 5 cm }}
"""
HELD = "density 2000 kg/m^3  elasticity 1 MPa  hold all"
DAM = "fill from (0, 0, 0) m to ({width}, 0.8, 1) m  level 0.6 m"
BLOCK = "object block {{ shape box (20, 20, 20) cm  position ({x}, 0.4, 0.1) m  density 2000 kg/m^3  elasticity rigid  {more} }}"
FLOAT = "object block {{ shape box (20, 20, 20) cm  position (1, 0.4, {z}) m  density 500 kg/m^3  elasticity rigid }}"
CORK = FLOAT.replace("density 500", "density 120").replace("elasticity rigid", "elasticity 100 kPa  {more}")
TOWED = FLOAT.format(z=0.6).replace("elasticity", "hold all  drive velocity (0.3, 0, 0) m/s  elasticity")
POST = f"object post {{ shape box (10, 10, 10) cm  position (0.5, 0.4, 0.9) m  {HELD} }}"
LIES = "shape box (100, 80, 20) cm  position (1.3, 0.4, 0.3) m  orientation axis (0, 1, 0) angle {tilt} deg"
SLOPE = f"object slope {{{{ {LIES}  {HELD} }}}}"
WALL = f"object wall {{{{ shape box ({{long}}, 80, 80) cm  position (1, 0.4, {{z}}) m  {HELD} }}}}"
INFLOW = "level 0.1 m  inflow from (1.2, 0.2, 0.8) m to (1.3, 0.6, 0.9) m rate 0.01 m^3/s"
SHAKE = "level 0.4 m  drive oscillation ({way}, 0, 0) m frequency 0.6 Hz"


@pytest.mark.parametrize(
    ("liquid", "objects", "told"),
    [
        (DAM.format(width=0.3), POST, "2 times as high as wide"),
        (DAM.format(width=0.9), POST, ""),
        (DAM.format(width=0.9), BLOCK.format(x=1.5, more="friction 0.5"), "floods block"),
        (DAM.format(width=0.9), BLOCK.format(x=0.4, more="friction 0.5"), ""),
        ("fill from (0, 0, 0) m to (0.3, 0.8, 1) m  level 0.6 m", WALL.format(long=140, z=0.5), ""),
        ("level 0.6 m", WALL.format(long=140, z=0.5), ""),
        ("level 0.3 m", SLOPE.format(tilt=-20), "has a beach, slope"),
        ("level 0.3 m  manning 0.01", SLOPE.format(tilt=-20), ""),
        ("level 0.8 m", SLOPE.format(tilt=-20), ""),
        (INFLOW, SLOPE.format(tilt=-20), "water flows down slope: nothing rubs"),
        (INFLOW + "  manning 0.03", SLOPE.format(tilt=-20), ""),
        ("level 0.6 m", BLOCK.format(x=0.15, more=""), "block stands without friction 5 cm from a side"),
        ("level 0.6 m", BLOCK.format(x=0.15, more="friction 0.5"), ""),
        ("level 0.6 m", BLOCK.format(x=1, more=""), ""),
        ("level 0.6 m", BLOCK.format(x=1, more="velocity (1.5, 0, 0) m/s"), "block starts in water at 1.5 m/s"),
        ("level 0.6 m", BLOCK.format(x=1, more="velocity (0.3, 0, 0) m/s"), ""),
        ("level 0.6 m", FLOAT.format(z=0.65), "block starts higher than it floats, and bobs"),
        ("level 0.6 m", FLOAT.format(z=0.6), ""),
        (DAM.format(width=0.9), BLOCK.format(x=1.5, more="hold all"), "water floods block, which is lower than the dam"),
        ("level 0.6 m", CORK.format(z=0.68, more=""), "block is 0.12 times as dense as water"),
        ("level 0.6 m", CORK.format(z=0.68, more="damping 0.1"), ""),
        ("level 0.6 m", TOWED, "block is towed through water"),
        (SHAKE.format(way=0.1), POST, "by the law of low ones"),
        (SHAKE.format(way=0.002), POST, ""),
    ],
)
def test_a_shortfall_is_told_where_a_scene_meets_it(prepared, liquid, objects, told):
    """One note for it, and no other one of waves."""
    notes = [n.message for n in prepared(POOL.format(liquid=liquid, objects=objects)).certificate.notes if "docs/" in n.message]
    assert len(notes) == bool(told) and all(told in note for note in notes)


def test_notes_tell_what_the_page_has_measured():
    """Each leads to a heading, and per cents of the validation are those of the rows that are kept."""
    for one in SHORTFALLS:
        page, _, anchor = one.page.partition("#")
        headings = re.findall(r"^#+ (.*)", (REPOSITORY / "docs" / page).read_text(encoding="utf-8"), re.M)
        assert anchor in {re.sub(r"[^a-z0-9 -]", "", h.lower()).replace(" ", "-") for h in headings}
    kept = [json.loads(path.read_text())["balanced"]["rows"] for path in (REPOSITORY / "bench/published/found").glob("*.json")]
    offs = {round(100 * abs((r["found"] - r["published"]) / (r["scale"] or r["published"]))) for rows in kept for r in rows}
    told = {int(n) for one in SHORTFALLS for n in re.findall(r"(\d+) %", one.text)}
    assert told == {33, 68, 5, 9, 11, 14, 28, 41} and told <= offs


@pytest.mark.parametrize(
    ("words", "resolution"),
    [
        ("elasticity rigid", "resolution 3 cm in control for about 830"),
        ("elasticity 1 MPa", "resolution 2 cm in control for about 2 800"),
    ],
)
def test_what_makes_very_many_cells_is_told(prepared, monkeypatch, words, resolution):
    """With one that will do: a rigid plate may be thinner than a cell, a soft one not."""
    monkeypatch.setattr(advice, "MANY", 10_000)
    monkeypatch.setattr(advice, "FEW", 1000)
    text = (
        "gravity (0, 0, -9.81) m/s^2\n"
        "liquid pool { basin from (0, 0, 0) cm to (30, 30, 25) cm  density 1000  level 10 cm }\n"
        f"object plate {{ shape box (20, 16, 2) cm  position (15, 15, 11) cm  density 600  {words} }}\n"
        "control { time 1 s WAY_OUT }\n"
    )
    found = [note for note in prepared(text.replace("WAY_OUT", "")).certificate.notes if "cells of" in note.message]
    assert [note.message for note in found] == ["plate is 2 cm thin, and so the liquid has 180 000 cells of 5 mm"]
    assert found[0].line == 3 and resolution in found[0].hint
    way_out = re.search(r"resolution \d+ cm", found[0].hint).group()
    assert not [note for note in prepared(text.replace("WAY_OUT", way_out)).certificate.notes if "cells of" in note.message]
