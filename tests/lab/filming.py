# SPDX-License-Identifier: GPL-2.0-only
"""Films of scenes: every step of a run as arrays, with the scenes and effects that steps are compared in."""

from __future__ import annotations

import ctypes

import numpy as np
import plugin_path
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

SOLID = "density 1000 elasticity 0.2 MPa"


WIDTHS = ("common", "avx2", "avx512")
"""Instruction sets of verlet/mdanim."""


FALL = "gravity (0, 0, -9.81)\n"


END = "control { time 10 s resolution 1 cm contact-model paper }\n"
"""The engine takes steps by passes with the fixes of the contact of the paper in them."""


SOFT = f"{SOLID} damping 0.1"


SHAPES = {
    "block": f"object a {{ shape box (7, 6, 5) cm position (0, 0, 0) spin (3, 2, 40) rad/s {SOLID} }}",
    "sphere": f"object a {{ shape sphere 5 cm position (0, 0, 0) {SOLID} spin (3, 2, 40) rad/s }}",
    "plate": f"object a {{ shape box (17, 17, 1) cm position (0, 0, 0) {SOLID} spin (9, 2, 4) rad/s }}",
    "needle": f"object a {{ shape box (1, 1, 9) cm position (0, 0, 0) {SOLID} spin (9, 2, 4) rad/s }}",
    "several": "\n".join(
        f"object a{i} {{ shape box ({2 + i}, 3, {5 - i}) cm position ({9 * i}, 0, 0) cm {SOLID} spin (9, {i}, 4) rad/s }}"
        for i in range(4)
    ),
    "damped": f"object a {{ shape sphere 4 cm position (0, 0, 0) {SOFT} spin (30, 20, 40) rad/s }}",
    "damped beside others": f"object a {{ shape box (5, 4, 6) cm position (0, 0, 0) {SOFT} spin (3, 40, 4) rad/s }}\n"
    f"object b {{ shape box (6, 5, 4) cm position (9, 0, 0) cm {SOLID} spin (40, 2, 4) rad/s }}\n"
    f"object c {{ shape sphere 3 cm position (-9, 0, 0) cm {SOFT} drag 0.3 spin (4, 2, 40) rad/s }}",
    "damped and held": f"object a {{ shape box (9, 4, 4) cm position (0, 0, 0) {SOFT} hold face -x }}",
    "held": f"object a {{ shape box (9, 4, 4) cm position (0, 0, 0) {SOLID} hold face -x }}",
}


EFFECTS = {
    "contact": f"object a {{ shape sphere 4 cm position (0, 0, 0) {SOLID} velocity (1, 0.1, 0) }}\n"
    f"object b {{ shape box (5, 6, 7) cm position (9, 0, 0.5) cm {SOLID} velocity (-1, 0, 0) }}",
    "ground": f"ground z -5 cm\nobject a {{ shape sphere 4 cm position (0, 0, 0) {SOLID} velocity (1, 0, -2) "
    "spin (0, 8, 0) rad/s }",
    "walls and contact": "walls from (-8, -8, -8) cm to (14, 8, 12) cm\n"
    f"object a {{ shape box (5, 5, 5) cm position (0, 0, 0) {SOLID} velocity (2, 0, -2) }}\n"
    f"object b {{ shape box (5, 5, 5) cm position (6.5, 0, 2) cm {SOLID} velocity (-1, 0, 1) }}",
    # Both share a velocity above that of their collision.
    "contact in flight": f"object a {{ shape sphere 4 cm position (0, 0, 0) {SOLID} velocity (4, 5.1, 0) }}\n"
    f"object b {{ shape box (5, 6, 7) cm position (9, 0, 0.5) cm {SOLID} velocity (2, 5, 0) }}",
    "beside each other": f"object a {{ shape sphere 4 cm position (0, 0, 0) {SOLID} velocity (1, 0, 0) }}\n"
    f"object b {{ shape box (5, 6, 7) cm position (7.6, 0, 0) cm {SOLID} velocity (1, 0, 0) }}",
    "damped, all at once": "walls from (-8, -8, -8) cm to (11, 8, 12) cm\n"
    f"object a {{ shape box (5, 5, 5) cm position (0, 0, 0) {SOFT} drag 0.3 velocity (2, 0, -2) }}\n"
    f"object b {{ shape box (5, 5, 5) cm position (6.5, 0, 2) cm {SOLID} velocity (-1, 0, 1) }}\n"
    "liquid w { basin from (-7, -7, -7) cm to (10, 7, 20) cm density 1000 level -5 cm drag 4 model surface }",
    "air": f"object a {{ shape sphere 4 cm position (0, 0, 0) {SOLID} drag 0.5 velocity (3, 0, 0) }}\n"
    f"object b {{ shape box (5, 5, 5) cm position (1, 0, 0) {SOLID} }}",
    "damped contact": f"object a {{ shape sphere 4 cm position (0, 0, 0) {SOFT} velocity (1, 0.1, 0) }}\n"
    f"object b {{ shape box (5, 6, 7) cm position (9, 0, 0.5) cm {SOLID} velocity (-1, 0, 0) }}\n"
    f"object c {{ shape box (4, 4, 4) cm position (0, 0, 9) cm {SOFT} velocity (0, 0, -2) }}",
    "damped walls": "walls from (-8, -8, -8) cm to (14, 8, 12) cm\n"
    f"object a {{ shape box (5, 5, 5) cm position (0, 0, 0) {SOFT} velocity (2, 0, -2) }}\n"
    f"object b {{ shape box (5, 5, 5) cm position (6.5, 0, 2) cm {SOLID} velocity (-1, 0, 1) }}",
    "damped in liquid": "object a { shape box (6, 6, 6) cm position (0, 0, 14) cm density 500 elasticity 0.2 MPa damping 0.1 }\n"
    "object b { shape box (4, 4, 4) cm position (0, 0, 24) cm density 500 elasticity 0.2 MPa "
    "velocity (0, 0, -3) }\n"
    "liquid w { basin from (-10, -10, 0) cm to (10, 10, 40) cm density 1000 level 12 cm drag 4 model surface }",
    "liquid": "object a { shape box (6, 6, 6) cm position (0, 0, 14) cm density 500 elasticity 0.2 MPa drag 0.1 }\n"
    "object b { shape box (4, 4, 4) cm position (0, 0, 24) cm density 500 elasticity 0.2 MPa velocity (0, 0, -3) }\n"
    "liquid w { basin from (-10, -10, 0) cm to (10, 10, 40) cm density 1000 level 12 cm drag 4 model surface }",
    "waves": "object a { shape box (6, 6, 6) cm position (0, 0, 14) cm density 500 elasticity 0.2 MPa drag 0.1 }\n"
    "object b { shape sphere 3 cm position (2, 1, 22) cm density 700 elasticity 0.2 MPa velocity (0.2, 0, -3) }\n"
    "liquid w { basin from (-10, -10, 0) cm to (10, 10, 40) cm density 1000 level 12 cm model waves }",
    "damped in waves": "object a { shape box (6, 6, 6) cm position (0, 0, 14) cm density 500 elasticity 0.2 MPa damping 0.1 }\n"
    "object b { shape box (4, 4, 4) cm position (0, 0, 20) cm density 500 elasticity 0.2 MPa velocity (0, 0, -3) }\n"
    "liquid w { basin from (-10, -10, 0) cm to (10, 10, 40) cm density 1000 level 12 cm drag 4 model waves }",
}


# After contact and walls, whose forces passes ask for beforehand, a shallow liquid, which acts in the pass, and then walls again,
# whose particles are held back, some of which have felt it.
POND = (
    "region pond block -0.08 0.13 -0.08 0.08 -0.03 0.12",
    "fix pond mobile mdanim/liquid pond 1000 grid 21 16 60 level -0.015 gravity 9.81 buoyancy 1e-6",
)
OTHER_WALLS = ("region room block -0.08 0.13 -0.08 0.08 -0.0285 0.12", "fix room mobile mdanim/wall room d_stiffness")
LATER = (*POND, *OTHER_WALLS)


BETWEEN = (
    "walls from (-8, -8, -2.9) cm to (13, 8, 12) cm\n"
    f"object a {{ shape box (5, 5, 5) cm position (0, 0, 0) {SOFT} velocity (2, 0, -2) }}\n"
    f"object b {{ shape box (5, 5, 5) cm position (6.2, 0, 0) cm {SOLID} velocity (-2, 0, -2) }}"
)
"""Two blocks that hit each other and both floors at the same time."""


def passes(instance: Instance) -> int:
    """How many steps were taken by passes over blocks."""
    instance.lammps.library.mdanim_passes.restype = ctypes.c_longlong
    return instance.lammps.library.mdanim_passes(instance.lammps.handle)


def ranges(instance: Instance) -> int:
    """Into how many ranges threads share a pass."""
    return instance.lammps.library.mdanim_ranges(instance.lammps.handle)


def supported(width: str) -> bool:
    """Whether this processor has it."""
    lmp = plugin_path.lammps()
    try:
        for command in ("region box block 0 1 0 1 0 1", "create_box 1 box", f"run_style verlet/mdanim width {width}"):
            lmp.command(command)
        return True
    except Exception as error:
        assert "this processor does not have it" in str(error)
        return False
    finally:
        lmp.close()


def film(
    text: str, style: str, pieces=(1, 150, 149), comm=None, more=(), end: str = END
) -> tuple[np.ndarray, list[float], np.ndarray, int]:
    """x, v and f after every piece of a run, at its end the energies, the trace, and how many passes were taken."""
    ready = prepare(parse_scene(FALL + text + "\n" + end))
    with Instance(ready.plan, comm) as instance:
        for command in (*more, f"run_style {style}"):
            instance.lammps.lmp.command(command)
        instance.setup()
        instance.trace.start()
        frames = []
        for steps in pieces:
            instance.run(steps)
            frames.append([instance.array(a).copy() for a in "xvf"])
        energies = [instance.kinetic_energy(), *(e.energy(instance) for e in ready.plan.effects)]
        return np.array(frames), energies, np.array(instance.trace.boxes()), passes(instance)
