# SPDX-License-Identifier: GPL-2.0-only
"""The catalogue of quantities: every word of the language has its measure, and no measure is without a word."""

from __future__ import annotations

import numpy as np
from mdanim_lammps import Scene
from mdanim_lammps.effects.measured import Measurable
from mdanim_lammps.results.quantities import quantity_of
from mdanim_lammps.scene.explain import explain
from mdanim_lammps.scene.scene import GLOBALS, QUANTITIES, Asked
from mdanim_lammps.scene.shown import ARROWS
from mdanim_lammps.view.told import ShownQuantities

ALL_BUT_FLUIDS = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object ball { shape sphere 6 cm  position (0, 0, 0.06) m  density 1000 kg/m^3  elasticity rigid }
object cube { shape box (10, 10, 10) cm  position (0.4, 0, 0.05) m  material rubber  tear-strain 0.5  yield-strain 0.2 }
object door { shape box (10, 10, 10) cm  position (0.8, 0, 0.4) m  density 1000 kg/m^3  elasticity rigid }
object cart { shape box (10, 10, 10) cm  position (1.2, 0, 0.4) m  density 1000 kg/m^3  elasticity rigid }
object bag { shape sphere 10 cm sheet thickness 1 mm  position (0, 0.5, 0.4) m  density 1000  elasticity 1 MPa  inflate 1 kPa }
joint hinge door world { at (0.8, 0, 0.4) m  axis (0, 1, 0)  motor speed 2 rad/s torque 0.1 N*m }
joint slider cart world { at (1.2, 0, 0.4) m  axis (1, 0, 0) }
control { time 0.02 s  frames 100 fps  resolution 5 cm }
"""
OF = {"joint": "door", "pressure": "bag", "volume": "bag"} | dict.fromkeys(
    ("torn", "pieces", "yielded", "strain", "elastic", "stress"), "cube"
)
IN_BRACKETS = {"joined": "(world)", "object": "(cube)"}


def test_every_quantity_is_found_and_explained():
    """By `expect`, `record`, `plot` and `explain` alike."""
    from mdanim_lammps.features import facets

    measures = {of for facet in facets("measure") for of in getattr(facet, "MEASURES", {})}
    assert measures | {("energy", "residual")} == set(QUANTITIES)
    for subject, word in QUANTITIES:
        of = Asked(subject if subject in GLOBALS else "ball", word, of=subject if subject == "NAMES" else "NAME")
        assert isinstance(quantity_of(of), Measurable) and of.kind is QUANTITIES[subject, word]
        assert "a quantity, in" in explain(word if subject in ("NAME", "NAMES") else f"{subject}.{word}")


def test_arrows_are_all_vectors_but_places_and_angles():
    """Found by their components."""
    assert set(ARROWS) == {"velocity", "spin", "force", "contact", "weight"}


def test_every_quantity_is_expected_recorded_and_shown(tmp_path):
    """By `expect` as it is and as its mean and most, in the table and as a curve of the page, each with a value in every
    frame where it has one. Those of liquid, air, pieces and the world have scenes of their own; kinds of joints theirs."""
    asked = []
    for (kind, word), of in QUANTITIES.items():
        if kind in ("liquid", "world", "NAMES") or of.needs in ("liquid", "air") or of.narrows:
            continue
        subject = kind if kind in GLOBALS else "cart" if word == "joint.way" else OF.get(word.split(".")[0], "ball")
        asked.append(f"{subject}.{word}{'' if of.alone else IN_BRACKETS.get(of.takes, '')}")
    forms = ("record {}", "expect {} = 0 +- 1e9", "expect mean {} from 0 s to 0.02 s < 1e9", "expect max {} < 1e9")
    lines = "".join(form.format(what) + "\n" for what in asked for form in forms)
    run = Scene.from_text(ALL_BUT_FLUIDS + lines, "all").run(tmp_path / "r")
    records = run.records
    assert not run.missed and set(records) == {"time", *asked} and len(asked) > 45
    told = ShownQuantities(run.folder)
    for what in asked:
        assert np.isfinite(records[what][1:]).all(), what
        np.testing.assert_array_equal(told.curve(what)[1]["value"], records[what].astype("f4"), what)
