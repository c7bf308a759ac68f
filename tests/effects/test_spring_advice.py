# SPDX-License-Identifier: GPL-2.0-only
"""Notes of ``check`` on what lattices get wrong: how much too stiff a bar of few cells is that a torque twists."""

import pytest

BAR = """object bar {{ shape box (40, 10, 10) cm  position (0, 0, 0) m  density 1000 kg/m^3  elasticity 1 MPa  {more} }}
control {{ time 0.1 s }}
"""
JOINED = """torque (1, 0, 0) N*m }}
object other {{ shape box (10, 10, 10) cm  position (0.5, 0, 0) m  density 1000 kg/m^3  elasticity rigid }}
object post {{ shape box (10, 10, 10) cm  position (0.3, 0, 0) m  hold all }}
joint weld {} post {{ at (0.2, 0, 0) m """


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("hold face -x  torque (1, 0, 0) N*m", "bar has 4 cells across, with which a bar is 16 % too stiff against twist"),
        ("hold face -x  torque (0, 1, 0) N*m", ""),  # it bends
        ("torque (1, 0, 0) N*m", ""),  # it turns
        (JOINED.format("bar"), "bar has 4 cells across"),
        (JOINED.format("other"), ""),  # it turns beside a joint of others
        ("hold face -x  torque (1, 0, 0) N*m  resolution 1.25 cm", ""),
    ],
)
def test_a_bar_of_few_cells_that_is_twisted_is_told(prepared, more, told):
    """The figure is that of docs/physics-solids.md, and the resolution that the note names ends it."""
    notes = [n for n in prepared(BAR.format(more=more)).certificate.notes if "twist" in n.message]
    assert len(notes) == bool(told) and all(told in n.message and n.hint == "write resolution 1.25 cm in it" for n in notes)
