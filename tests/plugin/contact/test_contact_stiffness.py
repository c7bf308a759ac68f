# SPDX-License-Identifier: GPL-2.0-only
"""The stiffness that fix mdanim/contact gives a pair is that which the bound on the step is made from (contact_surface.ALONE)."""

import numpy as np
import pytest
from contact_lab import contacts
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.contact.surface import ALONE
from state_lab import Records

YOUNG, H = 0.5e6, 0.01
SOLID = "density 1000  elasticity 0.5 MPa"
BALL = f"object b {{ shape sphere 3 cm  position (0.1, 0.2, 3.05) cm  {SOLID}  velocity (0, 0, -2) }}"
BOX = f"object b {{ shape box (6, 6, 6) cm  position (0.1, 0.2, 3.05) cm  {SOLID}  velocity (0, 0, -2) }}"
SLAB = f"object a {{ shape box (12, 12, 4) cm  position (0, 0, -2) cm  {SOLID}  hold all }}"
LOWER_BALL = f"object a {{ shape sphere 3 cm  position (0, 0, -3) cm  {SOLID}  hold all }}"
CASES = {
    "ball on the ground": ("ground z 0", BALL, ALONE),
    "box on the ground": ("ground z 0", BOX, 1.0),
    "ball on a slab": (SLAB, BALL, ALONE),
    "ball on a ball": (LOWER_BALL, BALL, 1.0),
}


@pytest.mark.parametrize("name", CASES)
def test_stiffness_of_a_contact(prepared, name):
    """Energy of a contact over the area of its point and g of its depth, with f E/h, of all points that count in full. The onset
    is 0.05 h; points of balls on what is flat have none."""
    below, above, times = CASES[name]
    fix = "ground" if below.startswith("ground") else "contact"
    plan = prepared(f"{below}\n{above}\ncontrol {{ time 1 s  frames 25 fps  resolution 1 cm }}\n").plan
    with Instance(plan) as instance:
        instance.setup()
        for _ in range(100):
            instance.run(5)
            if instance.fix_value(fix, 4) > 0.05 * H:
                break
        energy = instance.fix_scalar(fix)
        kept = instance.state().records[fix]
        found = contacts(Records(kept.keys, kept.first, kept.data))
    assert energy > 0.0 and found
    h = max(np.cbrt(plan.contact_bodies[kind].edge.prod()) for kind in plan.system.contact_kind)
    area = 0.0  # times g of the depth
    for (of, _), rows in found.items():
        body = plan.contact_bodies[plan.system.contact_kind[of]]
        onset = (0.0 if name in ("ball on the ground", "ball on a slab") else 0.05) * np.cbrt(body.edge.prod())
        d = rows["depth"] - rows["offset"]
        g = 0.5 * (d - 0.5 * onset) ** 2 + onset**2 / 24
        g = np.where(d < onset, d**3 / (6 * max(onset, 1e-300)), g)
        area += (body.area[rows["point"]] * np.where(d > 0.0, g, 0.0)).sum()
    assert energy / area == pytest.approx(times * YOUNG / h, rel=1e-9)
