# SPDX-License-Identifier: GPL-2.0-only
"""Notes on rigid objects whose motion is not as one would have it: what turns on the spot, balls in a row that touch."""

import pytest

SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0
object puck {{ shape {shape}  position (0, 0, {z}) cm  density 1000 kg/m^3  {own} }}
control {{ time 0.1 s  {more} }}
"""
TURNS, RIGID, ROUGH = "spin (0, 0, 20) rad/s", "elasticity rigid", "friction 0.2"


@pytest.mark.parametrize(
    ("shape", "z", "own", "more", "told"),
    [
        ("cylinder 5 cm 2 cm", 1, f"{RIGID} {TURNS}", ROUGH, True),
        ("box (20, 10, 4) cm", 2, f"{RIGID} {TURNS}", ROUGH, True),
        ("box (20, 10, 4) cm", 2, f"{RIGID} {TURNS}", "", False),
        ("box (20, 10, 4) cm", 2, f"{RIGID} spin (20, 0, 0) rad/s", ROUGH, False),
        ("box (20, 10, 4) cm", 30, f"{RIGID} {TURNS}", ROUGH, False),
        ("box (20, 10, 4) cm", 2, f"elasticity 1 MPa {TURNS}", ROUGH, False),
        ("sphere 5 cm", 5, f"{RIGID} {TURNS}", ROUGH, False),
    ],
)
def test_what_turns_on_the_spot_is_told(prepared, shape, z, own, more, told):
    """Only what stands broadly on the ground, is rigid, has friction and turns about the upright axis."""
    notes = prepared(SCENE.format(shape=shape, z=z, own=own, more=more)).certificate.notes
    assert any("turns on the spot" in note.message for note in notes) == told


@pytest.mark.parametrize(
    ("elasticity", "pitch", "bend", "told"),
    [("rigid", 10.0, 0.0, True), ("rigid", 10.1, 0.0, False), ("rigid", 10.0, 6.0, False), ("1 MPa", 10.0, 0.0, False)],
)
def test_balls_in_a_row_that_touch_are_told(prepared, elasticity, pitch, bend, told):
    """Not with gaps of a hundredth, around a corner, or elastic ones."""
    own = f"density 7800 kg/m^3  elasticity {elasticity}"
    places = [(-30, 0), (0, 0), (pitch, 0), (pitch + (pitch**2 - bend**2) ** 0.5, bend)]
    balls = "".join(
        f"object b{k} {{ shape sphere 5 cm  position ({x!r}, {y!r}, 0) cm  {own} }}\n" for k, (x, y) in enumerate(places)
    )
    notes = prepared(balls + "control { time 0.1 s }").certificate.notes
    assert any("in a row of balls that touch" in note.message for note in notes) == told
