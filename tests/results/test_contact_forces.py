# SPDX-License-Identifier: GPL-2.0-only
"""Forces of contact on what is held: action is reaction where nothing else can have taken it."""

import numpy as np
import pytest
from mdanim_lammps import Scene

ON_A_SLAB = """
gravity (0, 0, -9.81) m/s^2
object slab { shape box (30, 30, 10) cm  position (0, 0, -5) cm  mass 5 kg  elasticity 1 MPa  hold HELD }
object block { shape box (10, 10, 10) cm  position (0, 0, 5) cm  mass 2 kg  elasticity 1 MPa  damping 0.5 }
object other { shape box (10, 10, 10) cm  position (0, 0, 15) cm  mass 1 kg  elasticity 1 MPa  damping 0.5 }
control { time 0.3 s  frames 30 fps  resolution 5 cm  friction 0.5 }
"""


@pytest.mark.parametrize("held", ["all", "face -z"])
def test_what_is_held_alone_has_the_reaction(tmp_path, held):
    """The weight of what lies on it, and on two slabs, or with a ground, no number."""
    text = ON_A_SLAB.replace("HELD", held)
    table = Scene.from_text(text, "slab").run(tmp_path / "a").trajectory.to_pandas()
    force = {name: part[["contact_fx", "contact_fy", "contact_fz"]].to_numpy() for name, part in table.groupby("object")}
    np.testing.assert_allclose(force["slab"][1:], -(force["block"] + force["other"])[1:], atol=1e-12)
    np.testing.assert_allclose(force["slab"][-1], (0.0, 0.0, -3.0 * 9.81), atol=1.5)  # it rings a little
    assert np.isnan(force["slab"][0]).all()
    more = "object far { shape box (10, 10, 10) cm  position (2, 0, 0) m  mass 1 kg  elasticity 1 MPa  hold all }\n"
    for k, also in enumerate(("ground z -1 m\n", more)):
        run = Scene.from_text(text + also, "more").run(tmp_path / f"b{k}").trajectory.to_pandas()
        assert run[run.object == "slab"].contact_fz.isna().all()
