# SPDX-License-Identifier: GPL-2.0-only
"""Losses of a run, to the last bit."""

from mdanim_lammps import Scene
from mdanim_lammps.run import frame_source

SLIDES = """
gravity (0, 0, -9.81) m/s^2
ground z 0
object cube {
  shape box (5, 5, 3) cm  position (0, 0, 2) cm  velocity (2, 0.3, 0) m/s  spin (3, 0, 1) rad/s
  density 500 kg/m^3  elasticity 1 MPa
}
control { time 0.1 s  frames 50  resolution 1 cm  friction 0.4  contact-damping 0.1 }
"""


def test_losses_do_not_depend_on_pieces(tmp_path, monkeypatch):
    """A frame comes in pieces of steps, as many as the machine has time for: each point's losses are summed on from piece to
    piece."""
    (tmp_path / "slides.txt").write_text(SLIDES)
    whole = Scene.load(tmp_path / "slides.txt").run(tmp_path / "whole.out")
    monkeypatch.setattr(frame_source, "PIECE_SECONDS", 0.0)
    pieces = Scene.load(tmp_path / "slides.txt").run(tmp_path / "pieces.out")
    assert whole.ledger.rows[-1]["friction_heat"] > 0.0
    assert pieces.ledger.rows == whole.ledger.rows
