# SPDX-License-Identifier: GPL-2.0-only
"""Energies of scenes with drag close to third order in the time step, whether drag slows a flight or a vibration."""

import pytest
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

BLOCKS = """
object a {{ shape box (10, 10, 10) cm position (-8, 0, 0) cm density 1000 elasticity 1 MPa velocity (3, 0, 0) drag {drag} }}
object b {{ shape box (10, 10, 10) cm position (8, 1, 0.5) cm density 1000 elasticity 1 MPa velocity (-3, 0, 0) drag {drag} }}
control {{ time 0.04 s frames 1000 fps resolution 2.5 cm timestep {timestep!r} s contact-model paper }}
"""
"""The barrier of the paper: a blow on edges at the surfaces leaves some 2e-5 of the energy at any time step, without drag too."""


def residual(folder, drag: float, fraction: float) -> float:
    """Largest energy residual of two blocks that fly at each other, at this part of the bound."""
    first = prepare(parse_scene(BLOCKS.format(drag=drag, timestep=1e-6)))
    bound = 1e-6 / first.certificate.fraction
    found = simulate(prepare(parse_scene(BLOCKS.format(drag=drag, timestep=fraction * bound))), folder).ledger
    assert found.rows[-1]["drag_loss"] > 0.5 * found.rows[0]["kinetic"]
    return found.residual


def test_of_vibrations_after_an_impact(tmp_path):
    """With drag the residual at half the bound is as good as without, and falls with the third power of the step."""
    # Without what loss() adds to v_n these are 4e-4, 1.1e-4 and 2.9e-5.
    found = [residual(tmp_path, 20.0, fraction) for fraction in (0.5, 0.25, 0.125)]
    assert found[0] < 1.5e-4
    # Over both halvings more than the 16 of second order (measured 31; 277 over three); one alone may be 5 to 9 times.
    assert found[1] < found[0] / 4 and found[2] < found[1] / 4 and found[2] < found[0] / 24


def test_of_flight_alone(tmp_path):
    """Drag that stops the blocks before they meet is accounted for exactly."""
    assert residual(tmp_path, 2000.0, 0.5) == pytest.approx(0.0, abs=1e-13)
