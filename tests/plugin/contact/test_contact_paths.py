# SPDX-License-Identifier: GPL-2.0-only
"""Work along closed paths past a corner that is pressed flat or turned over, step by step without dynamics."""

import contact_lab
import numpy as np
import plugin_lab as lab
import pytest
from contact_lab import Cuboid
from twin.maps import smooth_spot

HOST = Cuboid((3, 3, 2))
ON_CORNER = {"axis": (1.0, -1.0, 0.0), "angle": 54.7356}
CORNER = np.array([1.5, 1.5, 1.0])
"""Corner of the host: the particle that is pressed in."""
STEPS = 400
"""Steps of each leg."""
LET_GO, TOUCHING = 3, 5
"""Entries of the vector of fix mdanim/contact."""


class Path:
    """A cuboid whose lowest corner goes down beside the corner of a host; what is there is moved, and the work is counted."""

    def __init__(self, folder):
        tip = Cuboid((2, 2, 2), (1.3, 1.25, 1.02 + 3**0.5), **ON_CORNER)
        self.cuboids = (HOST, tip)
        self.lmp = contact_lab.load(self.cuboids, folder, "objects", 1e-6)
        self.x = lab.by_tag(self.lmp, "x")
        self.host, self.tip = contact_lab.rows(self.cuboids)
        self.corner = int(np.linalg.norm(self.x[self.host] - CORNER, axis=1).argmin())
        self.force, self.work, self.off, self.steepest = None, 0.0, [], 0.0
        self._look(np.zeros_like(self.x))
        self.start = self.energy

    @property
    def energy(self) -> float:
        """Energy of contacts and springs, and of released contacts."""
        fix = lambda *which: self.lmp.extract_fix("contact", 0, *which)
        return fix(0) + fix(1, LET_GO) + self.lmp.get_thermo("ebond")

    def _look(self, way):
        self.lmp.numpy.extract_atom("v")[:] = 0.0
        order = self.lmp.numpy.extract_atom("id")[: len(self.x)] - 1
        self.lmp.numpy.extract_atom("x")[: len(self.x)] = self.x[order]
        self.lmp.command("run 1 pre no post no")
        before, self.force = self.force, lab.by_tag(self.lmp, "f")
        if before is not None:
            self.work += 0.5 * float(((before + self.force) * way).sum())
            self.off.append(self.energy - self.start + self.work)

    def leg(self, tip=(0.0, 0.0, 0.0), corner=(0.0, 0.0, 0.0)):
        """Both go this way evenly."""
        way = np.zeros_like(self.x)
        way[self.tip], way[self.corner] = np.divide(tip, STEPS), np.divide(corner, STEPS)
        for _ in range(STEPS):
            self.x = self.x + way
            self._look(way)

    def seen(self):
        """How long the gradient of the depth is for each contact of the tip, and the volume of the cell, undeformed 1."""
        found = contact_lab.contacts(contact_lab.state_lab.pack(self.lmp, "contact")).get((1, 0), [])
        spots = [(row, smooth_spot(self.x[self.host], np.array(HOST.cells), row["X"][None])) for row in found]
        return [(np.linalg.norm(s.K[0, row["side"] // 2]), np.linalg.det(s.J[0])) for row, s in spots]


PRESSED = {"flat": (np.array([-0.15, -0.1, -0.55]), False), "turned over": (np.array([-0.7, -0.7, -1.0]), True)}


@pytest.mark.parametrize("name", PRESSED)
def test_no_energy_comes_of_a_closed_path(tmp_path, name):
    """Down, the corner pressed in, aside, the corner back, aside back, up: energy and work add up at every step. Sums over these
    steps are good to 1e-6; where the way changes a point is found to 1e-3 cells only, 5e-6 of energy. 2e-2 is in play."""
    (corner, turns), path = PRESSED[name], Path(tmp_path)
    path.leg(tip=(0.0, 0.0, -0.3))
    path.leg(tip=0.4 * corner, corner=corner)
    steep = path.seen()
    path.leg(tip=(0.04, 0.03, 0.0))
    path.leg(tip=-0.4 * corner, corner=-corner)
    path.leg(tip=(-0.04, -0.03, 0.0))
    path.leg(tip=(0.0, 0.0, 0.3))
    assert turns or max(n for n, _ in steep) > 1.4
    assert np.abs(path.off).max() < 1e-5
    path.lmp.close()
