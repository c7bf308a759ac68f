# SPDX-License-Identifier: GPL-2.0-only
"""Random solids and sheets that yield and fall, or are hit: none diverges, and their energies add up."""

import random

import pytest
from changing_springs import RESIDUAL, all_changed

LOOKS, LONG = 10, 30_000


def scene(seed: int) -> str:
    """A solid that falls on its corner, lies on a ground or is held, and a ball or a box that flies into it."""
    chance = random.Random(seed)
    e, young, damping = 10 ** chance.uniform(-2.3, -0.7), 10 ** chance.uniform(2.3, 3.5), chance.choice([0.05, 0.2, 0.5])
    kind, hold = chance.choice([("box (20, 16, 12) cm", "hold face -x"), ("box (20, 16, 12) cm", ""), ("sphere 8 cm", "")])
    thing = chance.choice(["sphere 5 cm", "box (8, 10, 6) cm"])
    soft = chance.choice(["rigid", "300 kPa  damping 0.2  resolution 3 cm", f"300 kPa  damping 0.2  yield-strain {e:.4f}"])
    tears = chance.choice(["", "", "tear-strain 0.4"])
    return "\n".join(
        [
            "gravity (0, 0, -9.81) m/s^2\nground z 0 m",
            f"object target {{ shape {kind}  position (0, 0, 0.3) m  density 1500",
            f"  orientation axis (1, 1, 0) angle {chance.uniform(0.0, 90.0):.1f} deg  {hold}  elasticity {young:.1f} kPa",
            f"  resolution 4 cm  damping {damping}  yield-strain {e:.4f}  {tears} }}",
            f"object thing {{ shape {thing}  position ({chance.uniform(-0.05, 0.05):.3f}, 0, 0.55) m",
            f"  velocity (0, 0, {-chance.uniform(1.0, 4.0):.2f}) m/s  density {chance.uniform(500.0, 2000.0):.0f}",
            f"  elasticity {soft} }}",
            f"control {{ time 0.3 s  seed {seed}  friction {chance.choice([0, 0.4])} }}\n",
        ]
    )


def sheet(seed: int) -> str:
    """The same of a flat or curved sheet."""
    chance = random.Random(seed)
    e, young, thick = 10 ** chance.uniform(-2.7, -1.3), 10 ** chance.uniform(3.0, 4.5), chance.choice([1, 2, 4])
    kinds = ["sheet (20, 16) cm", "cylinder 5 cm 12 cm sheet", "sphere 6 cm sheet"]
    kind, hold = chance.choice(kinds), chance.choice(["", "hold face -x"])
    thing, soft = (
        chance.choice(["sphere 3 cm", "box (6, 5, 4) cm"]),
        chance.choice(["rigid", "300 kPa  damping 0.2  resolution 2 cm"]),
    )
    return "\n".join(
        [
            "gravity (0, 0, -9.81) m/s^2\nground z 0 m",
            f"object target {{ shape {kind} thickness {thick} mm  position (0, 0, 0.2) m  density 1200  resolution 2 cm",
            f"  orientation axis (1, 1, 0) angle {chance.uniform(0.0, 90.0):.1f} deg  {hold}  elasticity {young:.0f} kPa",
            f"  damping {chance.choice([0.05, 0.2, 0.5])}  yield-strain {e:.5f}  {chance.choice(['', 'tear-strain 0.3'])} }}",
            f"object thing {{ shape {thing}  position ({chance.uniform(-0.03, 0.03):.3f}, 0, 0.4) m",
            f"  velocity (0, 0, {-chance.uniform(1.0, 4.0):.2f}) m/s  density {chance.uniform(200.0, 1500.0):.0f}",
            f"  elasticity {soft} }}",
            f"control {{ time 0.2 s  seed {seed}  friction {chance.choice([0, 0.4])} }}\n",
        ]
    )


def yielded(seeds) -> tuple[int, list[float]]:
    """Scenes in which something yielded, and residuals."""
    return all_changed(map(scene, seeds), "grown", looks=LOOKS, longest=LONG)


def test_four_random_bodies_that_yield():
    """A few of them."""
    many, off = yielded(range(11, 15))
    assert many == 4 and max(off) < RESIDUAL


@pytest.mark.soak
@pytest.mark.timeout(1200)
def test_sixty_random_bodies_that_yield():
    """Four of all have more than RESIDUAL: stiff contacts that let go within a few steps."""
    many, off = yielded(range(60))
    assert many >= 50 and max(off) < 15.0 * RESIDUAL and sum(one > RESIDUAL for one in off) <= 4


@pytest.mark.soak
@pytest.mark.timeout(1200)
def test_twenty_random_sheets_that_yield():
    """Flat and curved, some of which tear."""
    many, off = all_changed(map(sheet, range(20)), "bent", looks=LOOKS, longest=LONG)
    assert many == 20 and max(off) < RESIDUAL
