# SPDX-License-Identifier: GPL-2.0-only
"""Friction is what was written, whatever lies on what: thickness of a plate, spacing, load; and who bears the weight."""

import math

import bearing
import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.loop import simulate

G = 9.81
RAMP = """gravity ({gx!r}, 0, {gz!r}) m/s^2
object ramp {{ shape box (160, 30, {d}) cm  position (0, 0, {middle}) cm  density 1000  elasticity 5 MPa  {ramp} }}
object block {{ shape box (16, 16, 12) cm  position (-50, 0, 6) cm  density {density}  elasticity 2 MPa  damping 0.2 }}
control {{ time 1 s  resolution {h} cm  friction {mu} }}
{more}
"""


def ramp(d, h, mu=0.2, slope=25.0, ramp="hold all", density=1000, more=""):
    """A block on a slope [deg], drawn level under tilted gravity; the ramp is d [cm] thick at a spacing of h [cm]."""
    a = math.radians(slope)
    gx, gz = G * math.sin(a), -G * math.cos(a)
    return RAMP.format(gx=gx, gz=gz, d=d, middle=-d / 2, h=h, mu=mu, ramp=ramp, density=density, more=more)


class Slide:
    """The last object of a scene as it slides."""

    def __init__(self, ready):
        self.ready, self.instance = ready, Instance(ready.plan)
        self.mass = np.where(ready.system.object == len(ready.system.names) - 1, ready.system.mass, 0.0)
        self.instance.setup()

    def run(self, time):
        """Go on for so long [s]; what was gained in speed along x [m/s]."""
        before = self.speed
        self.instance.run(round(time / self.ready.certificate.timestep))
        return self.speed - before

    @property
    def speed(self):
        """Along x [m/s]."""
        return float(self.mass @ self.instance.array("v")[:, 0] / self.mass.sum())

    def friction(self, slope=25.0):
        """mu that acts from 0.2 to 0.4 s [-]: what is missing to g sin, over g cos."""
        a = math.radians(slope)
        self.run(0.2)
        return math.tan(a) - self.run(0.2) / 0.2 / (G * math.cos(a))


LAYERS = [(4, 4), (5, 4), (5.8, 4), (6, 4), (6.2, 4), (7, 4), (12, 4), (3, 3), (4, 3), (5, 3), (9, 3), (6, 5), (7.3, 5), (15, 5)]
"""Thickness of a plate and spacing [cm]: from one to three spacings, and layers thinner and thicker than those of the block."""


@pytest.mark.parametrize(("d", "h"), LAYERS)
def test_friction_is_the_same_on_plates_of_every_thickness(prepared, d, h):
    """mu within 1 %: the plate's second layer, however near to its surface, bears nothing of a body of a coarser spacing, nor
    does the body's own a coarser plate. Measured: within 2e-4 of 0.2; 0.044 to 0.15 where the barrier behind reached the body.
    """
    slide = Slide(prepared(ramp(d, h)))
    with slide.instance as instance:
        assert slide.friction() == pytest.approx(0.2, rel=0.01)
        by = bearing.borne(instance, 1)
        assert by["barrier"].tolist() == [0.0, 0.0, 0.0]
        weight = slide.mass.sum() * G * math.cos(math.radians(25.0))
        assert by["contact"][2] == pytest.approx(weight, rel=0.2)  # it rings a little


def test_a_block_stands_on_a_plate_of_thin_layers(prepared):
    """mu 0.5 holds it at 20 degrees: it moves less than a hundredth of a spacing in half a second. It slid with 2 m/s^2."""
    slide = Slide(prepared(ramp(5.8, 4, mu=0.5, slope=20.0)))
    with slide.instance:
        slide.run(0.4)
        assert abs(slide.speed) < 4e-4


# --- dashpots of contact at every ratio of masses ---------------------------------------------------------------------

HEAVY = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object light {{ shape box (30, 30, 20) cm  position (0, 0, 10) cm  density 10  elasticity 1 MPa }}
object heavy {{ shape {shape}  position (0, 0, {z}) cm  velocity (0.2, 0, -0.2) m/s  density {density}  elasticity 5 MPa }}
control {{ time 0.1 s  friction 0.4  {step} }}
"""
BALL, BOX = ("sphere 12 cm", 32.2), ("box (16, 12, 14) cm", 27.2)


@pytest.mark.parametrize(("shape", "z"), [pytest.param(*BALL, id="ball"), pytest.param(*BOX, id="box")])
@pytest.mark.parametrize("density", [10, 300, 10_000])
def test_a_heavy_body_on_a_light_one_is_stable_up_to_the_bound(prepared, tmp_path, shape, z, density):
    """At 0.9 of the bound, 1:1 to 1000:1, the residual of the landing stays below 1 %, and dashpots take less than there was.

    Measured: 1e-3 and less. A dashpot of the heavy body's density made 0.4 of it at half of the bound for 1000:1, and more on.
    """
    text = HEAVY.format(shape=shape, z=z, density=density, step="")
    bound = prepared(text).certificate.bound
    result = simulate(prepared(HEAVY.format(shape=shape, z=z, density=density, step=f"timestep {0.9 * bound} s")), tmp_path)
    assert result.ledger.residual < 0.01
    assert 0.0 < result.ledger.rows[-1]["contact_damping_loss"] < result.ledger.rows[0]["kinetic"] * 3.0


@pytest.mark.parametrize("density", [1, 100_000])
def test_the_density_of_what_is_held_does_not_matter(prepared, density):
    """It does not swing: the same dashpots, and the same bits, on a held ramp of any density."""
    speeds = []
    for of_ramp in (1000, density):
        slide = Slide(prepared(ramp(8, 4).replace("density 1000", f"density {of_ramp}", 1)))
        with slide.instance:
            slide.run(0.1)
            speeds.append(slide.speed)
    assert speeds[0] == speeds[1]
