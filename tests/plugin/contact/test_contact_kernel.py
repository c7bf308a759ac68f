# SPDX-License-Identifier: GPL-2.0-only
"""Contacts four at a time against contacts one at a time, bit for bit: maps, kinds of points, hosts, what is hard on the way."""

import numpy as np
import pytest
from filming import SOLID, WIDTHS, passes, supported
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

ROUGH = f"{SOLID} friction 0.4"
SLAB = f"object slab {{ shape box (9, 8, 3) cm position (0, 0, 0) cm {ROUGH} }}"
SCENES = {
    "pressed, without friction": f"""
object a {{ shape box (7, 6, 4) cm position (0, 0, 0) cm {SOLID} velocity (0, 0, 0.4) m/s }}
object b {{ shape box (6, 7, 4) cm position (0.3, 0.2, 4.02) cm {SOLID} velocity (0, 0, -0.4) m/s }}""",
    "slides over an edge": f"""
{SLAB}
object b {{ shape box (5, 4, 3) cm position (3.2, 0.3, 3.05) cm {ROUGH} velocity (2.5, 0.4, -0.6) m/s spin (0, 0, 9) rad/s }}""",
    "on a corner": f"""
{SLAB}
object b {{ shape box (4, 4, 4) cm position (0.3, 0.2, 5.0) cm orientation axis (1, -1, 0.1) angle 54 deg {ROUGH}
velocity (0.5, 0, -3) m/s }}""",
    "ball on a slab": f"""
{SLAB}
object b {{ shape sphere 2.5 cm position (0.3, 0.2, 4.2) cm {ROUGH} velocity (1, 0.3, -2) m/s spin (0, 30, 0) rad/s }}""",
    "ball on a ball": f"""
object a {{ shape sphere 3 cm position (0, 0, 0) cm {ROUGH} }}
object b {{ shape sphere 2.5 cm position (1, 0.2, 5.6) cm {ROUGH} velocity (0, 0.3, -3) m/s spin (0, 30, 0) rad/s }}""",
    "crushed": f"""
object a {{ shape box (2, 2, 2) cm position (0, 0, 0) cm {ROUGH} velocity (0, 0, 5) m/s }}
object b {{ shape box (2, 2, 2) cm position (0.6, 0.5, 2.3) cm {ROUGH} velocity (0, 0, -5) m/s }}""",
}
END = "control {\ntime 10 s\nresolution 1 cm\ncontact-model surface\n}"


def film(text: str, style: str):
    """x, v and the books of contact after every piece of a run, the most points in touch, all records at the end, passes."""
    ready = prepare(parse_scene(f"{text}\n{END}"))
    with Instance(ready.plan) as instance:
        instance.lammps.lmp.command(f"run_style {style}")
        instance.setup()
        frames, books = [], []
        for _ in range(60):
            instance.run(8)
            frames.append(np.array([instance.array("x"), instance.array("v")]))
            books.append([instance.fix_scalar("contact"), *(instance.fix_value("contact", k) for k in range(6))])
        records = instance.records()["contact"]
        return np.array(frames), np.array(books), records, passes(instance)


@pytest.mark.parametrize("name", SCENES)
def test_several_at_once_have_the_bits_of_each_alone(name):
    """Compare places, speeds, energies and what contacts remember, for all widths that run here, with the plain step."""
    frames, books, records, none = film(SCENES[name], "verlet")
    assert none == 0 and books[:, 6].max() > 6 and books[:, 5].max() > 0.0
    assert "friction" not in SCENES[name] or books[-1, 2] > 0.0
    for width in filter(supported, WIDTHS):
        found, told, kept, taken = film(SCENES[name], f"verlet/mdanim width {width}")
        assert taken > 300
        assert np.array_equal(found, frames), width
        assert np.array_equal(told, books), width
        assert np.array_equal(kept.keys, records.keys) and np.array_equal(kept.data, records.data), width
