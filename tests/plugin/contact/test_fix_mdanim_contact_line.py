# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/contact: lines of round particles, which touch planes and other objects with the surface around them."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import contact_lab
import numpy as np
import plugin_lab as lab
import pytest
from contact_lab import Cuboid, State, load
from mdanim_lammps.engine.data_file import bodies_text

RADIUS, YOUNG = 0.3, 2.0
STIFF = 0.2
"""kappa of a line of particles, over that of points of both (docs/physics-contact.md)."""


@dataclass(frozen=True)
class Line(Cuboid):
    """A straight line of particles, one spacing apart along x, from its place on."""

    young: float = YOUNG

    @property
    def particles(self) -> lab.Body:
        count, h = self.cells[0], self.spacing
        x = np.arange(count)[:, None] * [h, 0.0, 0.0] + self.centre
        v, ones = np.tile(np.asarray(self.velocity, float), (count, 1)), np.ones(count - 1)
        loose = lab.particles(x, np.ones(count, int), v=v, mass=np.full(count, self.density * h**3))
        bond = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
        return replace(loose, bond=bond, k=YOUNG * h * ones, r0=h * ones)

    @property
    def arrays(self) -> dict:
        return contact_lab.line_arrays(self.cells[0], self.spacing, RADIUS)


def force_of(depth: float, kappa: float, area: float) -> float:
    """Force on a point [N] (docs/physics-contact.md)."""
    eps = 0.05
    return kappa * area * (depth - eps / 2 if depth > eps else depth**2 / (2 * eps))


def pushed(lmp) -> np.ndarray:
    """Forces after a step, in which contacts begin."""
    lmp.command("run 1 pre no post no")
    return lab.by_tag(lmp, "f")


def test_a_line_lies_on_a_plane_with_the_surface_around_it(tmp_path):
    """Its depth is that of its particles plus the radius."""
    for depth in (0.02, 0.11):
        down = Line((4, 1, 1), (0.0, 0.0, RADIUS + 0.01), velocity=(0.0, 0.0, -(depth + 0.01) / 0.15))
        lmp = load([down], tmp_path, "plane z lo 0", 0.15)
        found = pushed(lmp)
        lmp.close()
        np.testing.assert_allclose(found[:, 2], force_of(depth, STIFF * YOUNG, 2 * RADIUS), rtol=1e-12)
        assert not found[:, :2].any()


@pytest.mark.parametrize("rigid", [False, True])
def test_a_line_lies_on_a_cuboid_that_it_pushes_as_much(tmp_path, rigid):
    """On an elastic one, and on a held one by its frame."""
    host, depth = Cuboid((4, 3, 2), held=rigid, rigid=rigid), 0.1
    line = Line((3, 1, 1), (-1.0, 0.2, 1.01 + RADIUS), velocity=(0.0, 0.0, -(depth + 0.01) / 0.15))
    lmp = load((host, line), tmp_path, "objects", 0.15)
    found = pushed(lmp)
    lmp.close()
    kappa = STIFF * 2.0 * YOUNG / (1.0 + YOUNG)
    np.testing.assert_allclose(found[-3:, 2], force_of(depth, kappa, 2 * RADIUS), rtol=1e-9)
    if not rigid:
        np.testing.assert_allclose(found.sum(axis=0), 0.0, atol=1e-12)


def test_a_line_is_as_stiff_on_wide_cells_as_on_narrow_ones(tmp_path):
    """It gives way by its own links, so that it does not sink into what is coarse."""
    depth, found = 0.1, []
    for width in (1.0, 2.0):
        host = Cuboid((round(4 / width), round(4 / width), round(2 / width)), spacing=width, held=True, rigid=True)
        line = Line((3, 1, 1), (-1.0, 0.2, 1.01 + RADIUS), velocity=(0.0, 0.0, -(depth + 0.01) / 0.15))
        lmp = load((host, line), tmp_path, "objects", 0.15)
        found.append(pushed(lmp)[-3:, 2])
        lmp.close()
    assert found[0].min() > 0.0
    np.testing.assert_allclose(found[1], found[0], rtol=1e-9)


@dataclass(frozen=True)
class Shared(Line):
    """Three particles, one point between the first two, and one between all; twice as hard."""

    @property
    def arrays(self) -> dict:
        return contact_lab.line_arrays(5, self.spacing, RADIUS) | {
            "node": np.arange(3, dtype=np.int32),
            "hardness": 2.0,
            "spread": 2.0,
            "sharer": np.array([[0, 1, 2], [0, 1, 2]], np.int32),
            "share": np.array([[0.25, 0.75, 0.0], [0.2, 0.3, 0.5]]),
        }


def test_points_between_particles_push_these_by_their_weights(tmp_path):
    """Level on a cuboid, all five at one depth."""
    host, depth = Cuboid((4, 3, 2), held=True, rigid=True), 0.1
    line = Shared((3, 1, 1), (-1.0, 0.2, 1.01 + RADIUS), velocity=(0.0, 0.0, -(depth + 0.01) / 0.15))
    lmp = load((host, line), tmp_path, "objects", 0.15)
    found = pushed(lmp)[-3:, 2]
    lmp.close()
    one = force_of(depth, 2.0 * STIFF * 2.0 * YOUNG / (1.0 + YOUNG), 2 * RADIUS)
    np.testing.assert_allclose(found, one * np.array([1.0 + 0.25 + 0.2, 1.0 + 0.75 + 0.3, 1.0 + 0.5]), rtol=1e-9)


def test_lines_do_not_touch_each_other(tmp_path):
    """One across the other."""
    lmp = load((Line((3, 1, 1)), Line((3, 1, 1), (0.5, 0.0, 0.7), velocity=(0.0, 0.0, -2.0))), tmp_path, "objects", 0.15)
    assert not pushed(lmp).any()
    lmp.close()


@pytest.mark.parametrize(("of", "steps"), [(Line((6, 1, 1)), 120), (Shared((3, 1, 1)), 40)])
def test_passes_and_single_contacts_have_the_same_bits_with_a_line(tmp_path, of, steps):
    """It falls onto an elastic cuboid, slides over its edge, and lies on a plane beside it; a body from a file, too."""
    slab = Cuboid((3, 3, 2), friction=0.5)
    line = replace(of, centre=(-1.0, 0.3, 1.4), friction=0.4, velocity=(0.05, 0.0, -0.1))
    words = "objects plane z lo -1.05"
    states = []
    (tmp_path / "bodies").write_text(
        "".join(bodies_text({n: SimpleNamespace(**one.arrays) for n, one in enumerate((slab, line))}))
    )
    for run_style, more in (("verlet", ""), ("verlet/mdanim", ""), ("verlet", f" bodies {tmp_path}/bodies")):
        lmp = load((slab, line), tmp_path, words + more, 0.15, give=not more)
        lmp.command(f"run_style {run_style}")
        lmp.command(f"run {steps}")
        states.append(State.of(lmp))
        lmp.close()
    assert contact_lab.contacts(states[0].contacts)
    assert states[1].same(states[0]) and states[2].same(states[0])


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        ({"radius": -1.0}, "the radius of its particles is not a length"),
        ({"hardness": 0.0}, "the hardness of a line is not a number above 0"),
        ({"cell": np.array([0, 2, 1], np.int32)}, "points of a line do not ascend"),
        ({"count": np.array([4, 1, 1], np.int32), "filled": np.ones(4, np.uint8)}, "a line has a cell and a point a particle"),
    ],
)
def test_arrays_that_are_no_line_are_refused(tmp_path, wrong, why):
    """With the reason."""
    lmp = load([Line((3, 1, 1))], tmp_path, "plane z lo 0", 0.15)
    with pytest.raises(RuntimeError, match=why):
        contact_lab.give_body(lmp, "contact", 0, contact_lab.line_arrays(3, 1.0, RADIUS) | wrong)
    lmp.close()
