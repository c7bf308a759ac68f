# SPDX-License-Identifier: GPL-2.0-only
"""The catalogue of quantities: every word of the language has its measure, and no measure is without a word."""

from __future__ import annotations

from mdanim_lammps.effects.measured import Measurable
from mdanim_lammps.results.quantities import quantity_of
from mdanim_lammps.scene.explain import explain
from mdanim_lammps.scene.scene import GLOBALS, QUANTITIES, Asked
from mdanim_lammps.scene.shown import ARROWS


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
