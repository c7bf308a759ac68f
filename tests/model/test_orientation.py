# SPDX-License-Identifier: GPL-2.0-only
"""Inside and outside of meshes of several parts: cavities, parts beside each other, parts that cross each other."""

from itertools import product

import numpy as np
import pytest
from mdanim_lammps.model import shapes
from mdanim_lammps.model.cells import fill_cells
from mdanim_lammps.model.orientation import MeshError, outward
from mdanim_lammps.model.triangles import volume_and_centre
from mdanim_lammps.scene.scene import Box, Mesh, Sphere
from mesh_samples import joined


@pytest.mark.parametrize("turned", list(product((False, True), repeat=3)))
def test_a_part_inside_is_a_cavity_whichever_way_it_faces(turned):
    """A box of 1 in one of 2 in one of 4: 64 - 8 + 1."""
    boxes = zip((4.0, 2.0, 1.0), turned)
    points, triangles = joined([(Box((a,) * 3), (0.1 * a, 0.0, 0.0), t) for a, t in boxes])
    volume, _ = volume_and_centre(points, outward(points, triangles, "boxes"))
    assert volume == pytest.approx(57.0)


@pytest.mark.parametrize("turned", list(product((False, True), repeat=2)))
def test_parts_beside_each_other_face_outward(turned):
    """Also where they touch along a side, whose points they share or not."""
    points, triangles = joined([(Box((1.0,) * 3), (1.5 * k, 0.0, 0.0), t) for k, t in enumerate(turned)])
    assert volume_and_centre(points, outward(points, triangles, "boxes"))[0] == pytest.approx(2.0)
    points[points[:, 0] > 0.6] -= (0.5, 0.0, 0.0)
    assert volume_and_centre(points, outward(points, triangles, "boxes"))[0] == pytest.approx(2.0)


def test_mass_and_cells_of_a_hollow_body_agree(tmp_path):
    """A ball in a box, both outward as many programs write them: cells leave the ball out, and so do volume and mass."""
    import pyvista

    points, triangles = joined([(Box((2.0,) * 3), (0.0, 0.0, 0.0), False), (Sphere(0.8), (0.0, 0.0, 0.0), False)])
    pyvista.PolyData.from_regular_faces(points, triangles).save(tmp_path / "hollow.stl")
    shape = Mesh(tmp_path / "hollow.stl")
    assert shapes.volume(shape) == pytest.approx(8 - 4 / 3 * np.pi * 0.8**3, rel=0.01)  # facets
    cells = fill_cells(shape, 0.1)
    assert np.count_nonzero(cells.filled) * cells.edge.prod() == pytest.approx(shapes.volume(shape), rel=0.01)


def test_parts_that_cross_are_refused():
    """Two boxes that share half a box: of the inside, 1.5, a third is enclosed twice. A thousandth would do no harm."""
    points, triangles = joined([(Box((1.0,) * 3), (0.5 * k, 0.0, 0.0), False) for k in range(2)])
    with pytest.raises(MeshError, match=r"3[34] % of the inside is enclosed more than once") as caught:
        outward(points, triangles, "boxes")
    assert "write solid in place of mesh" in caught.value.hint
    points, triangles = joined([(Box((1.0,) * 3), (0.999 * k, 0.0, 0.0), False) for k in range(2)])
    outward(points, triangles, "boxes")


def test_many_parts():
    """1 000 boxes beside each other, every other one inside out."""
    parts = [(Box((1.0,) * 3), (2.0 * i, 2.0 * j, 2.0 * k), (i + j + k) % 2) for i, j, k in product(range(10), repeat=3)]
    points, triangles = joined(parts)
    assert volume_and_centre(points, outward(points, triangles, "boxes"))[0] == pytest.approx(1000.0)
