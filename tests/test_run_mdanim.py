# SPDX-License-Identifier: GPL-2.0-only
"""run_style mdanim against run_style verlet, bit for bit: shapes, effects, widths, orders of particles, pieces, ranks."""

import ctypes
from pathlib import Path

import numpy as np
import plugin_lab as lab
import plugin_path
import pytest
from mdanim_lammps.driver.prepare import prepare
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.scene.parse import parse_scene

WIDTHS = ("common", "avx2", "avx512")
SOLID = "density 1000 elasticity 0.2 MPa"
FALL = "gravity (0, 0, -9.81)\n"
END = "control { time 10 s resolution 1 cm }\n"
MESHES = Path(__file__).parent / "meshes"

SHAPES = {
    "block": f"object a {{ shape box (7, 6, 5) cm position (0, 0, 0) spin (3, 2, 40) rad/s {SOLID} }}",
    "sphere": f"object a {{ shape sphere 5 cm position (0, 0, 0) {SOLID} spin (3, 2, 40) rad/s }}",
    "plate": f"object a {{ shape box (12, 12, 1) cm position (0, 0, 0) {SOLID} spin (9, 2, 4) rad/s }}",
    "needle": f"object a {{ shape box (1, 1, 9) cm position (0, 0, 0) {SOLID} spin (9, 2, 4) rad/s }}",
    "several": "\n".join(f"object a{i} {{ shape box ({2 + i}, 3, {5 - i}) cm position ({9 * i}, 0, 0) cm {SOLID} spin (9, {i}, 4) rad/s }}"
                         for i in range(4)),
    "held": f"object a {{ shape box (9, 4, 4) cm position (0, 0, 0) {SOLID} hold face -x }}",
}
EFFECTS = {
    "contact": f"object a {{ shape sphere 4 cm position (0, 0, 0) {SOLID} velocity (1, 0.1, 0) }}\n"
               f"object b {{ shape box (5, 6, 7) cm position (9, 0, 0.5) cm {SOLID} velocity (-1, 0, 0) }}",
    "ground": f"ground z -5 cm\nobject a {{ shape sphere 4 cm position (0, 0, 0) {SOLID} velocity (1, 0, -2) spin (0, 8, 0) rad/s }}",
    "walls and contact": "walls from (-8, -8, -8) cm to (14, 8, 12) cm\n"
                         f"object a {{ shape box (5, 5, 5) cm position (0, 0, 0) {SOLID} velocity (2, 0, -2) }}\n"
                         f"object b {{ shape box (5, 5, 5) cm position (6.5, 0, 2) cm {SOLID} velocity (-1, 0, 1) }}",
    "air": f"object a {{ shape sphere 4 cm position (0, 0, 0) {SOLID} drag 0.5 velocity (3, 0, 0) }}\n"
           f"object b {{ shape box (5, 5, 5) cm position (1, 0, 0) {SOLID} }}",
    "liquid": f"object a {{ shape box (6, 6, 6) cm position (0, 0, 14) cm density 500 elasticity 0.2 MPa drag 0.1 }}\n"
              f"object b {{ shape box (4, 4, 4) cm position (0, 0, 24) cm density 500 elasticity 0.2 MPa velocity (0, 0, -3) }}\n"
              "liquid w { basin from (-10, -10, 0) cm to (10, 10, 40) cm density 1000 level 12 cm drag 4 }",
}


def passes(instance: Instance) -> int:
    """How many steps were taken by passes over blocks."""
    instance._library.mdanim_passes.restype = ctypes.c_longlong
    return instance._library.mdanim_passes(instance._handle)


def film(text: str, style: str, pieces=(1, 150, 149)) -> tuple[np.ndarray, list[float], int]:
    """x, v and f after every piece of a run, the energies at its end, and how many passes were taken."""
    ready = prepare(parse_scene(FALL + text + "\n" + END))
    with Instance(ready.plan) as instance:
        instance._lmp.command(f"run_style {style}")
        instance.setup()
        instance.start_trace()
        frames = []
        for steps in pieces:
            instance.run(steps)
            frames.append([instance.array(a).copy() for a in "xvf"])
        energies = [e.energy(instance, ready.scene, ready.system) for e in ready.plan.effects]
        return np.array([*frames]), [*energies, *np.ravel(instance.trace())], passes(instance)


@pytest.mark.parametrize("name", [*SHAPES, *EFFECTS])
def test_blocks_give_the_bits_of_verlet(name):
    """Compare positions, velocities, forces and energies with those of the plain step, for all widths that run here."""
    text = (SHAPES | EFFECTS)[name]
    plain, energies, none = film(text, "verlet")
    assert none == 0 and np.abs(plain[-1, 0] - plain[0, 0]).max() > 0.002
    widths = [w for w in WIDTHS if supported(w)]
    assert "common" in widths
    for width in widths:
        found, told, taken = film(text, f"mdanim width {width}")
        assert taken > 200
        assert np.array_equal(found, plain), width
        np.testing.assert_allclose(told, energies, rtol=1e-12, atol=1e-15)


def supported(width: str) -> bool:
    """Whether this processor has it."""
    lmp = plugin_path.lammps()
    try:
        for command in ("region box block 0 1 0 1 0 1", "create_box 1 box", f"run_style mdanim width {width}"):
            lmp.command(command)
        return True
    except Exception as error:
        assert "this processor does not have it" in str(error)
        return False
    finally:
        lmp.close()
