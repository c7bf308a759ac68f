# SPDX-License-Identifier: GPL-2.0-only
"""Surfaces of what is torn, in files and on the page."""

import numpy as np
import pyvista
from mdanim_lammps import Scene
from mdanim_lammps.view.feed import Feed

TORN = """
object cloth { shape sheet (12, 8) cm thickness 1 mm  position (0, 0, 0.1) m  resolution 2 cm
  density 300  elasticity 200 kPa  damping 0.1  hold faces x  tear-strain 0.1 }
object stone { shape sphere 2 cm  position (0, 0, 0.125) m  velocity (0, 0, -8) m/s  density 3000  elasticity rigid }
control { time 0.03 s  frames 200 fps }
"""


def test_what_is_torn_has_no_triangles_without_area(tmp_path):
    """In `vtk`, whose files have triangles of their own; and the page draws layers nearer to the eye, as the movie does."""
    run = Scene.from_text(TORN, "torn").run(tmp_path / "r")
    reader, areas = pyvista.get_reader(str(run.export("vtk").files[0])), []
    for time in reader.time_values:
        reader.set_active_time_value(time)
        mesh = reader.read()[0]
        areas.append(mesh.compute_cell_sizes()["Area"])
        assert (areas[-1] > 0.0).all()
    assert len(areas[0]) != len(areas[-1])
    feed = Feed(tmp_path / "r", finished=True)
    lift = feed.buffers()["lift"]
    assert len(np.unique(lift)) == 2 and lift.min() == 0.0 and 0.005 < lift.max() <= 0.01  # about half of the spacing
    assert lift.dtype == "<f4" and len(lift) == len(feed.object_of_vertex)
    feed.close()
