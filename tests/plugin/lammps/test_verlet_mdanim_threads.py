# SPDX-License-Identifier: GPL-2.0-only
"""run_style verlet/mdanim with threads against one thread, bit for bit: places, velocities, forces, traces, energies, losses."""

import numpy as np
import pytest
from filming import EFFECTS, FALL, SHAPES, SOFT, SOLID, WIDTHS, ranges, supported
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

FINE = "control {{ time 10 s resolution {} mm contact-model {} }}\n"
"""Cells so small that there are particles for several ranges."""
LARGE = {
    "a block": f"object a {{ shape box (7, 6, 5) cm position (0, 0, 0) spin (3, 2, 40) rad/s {SOLID} drag 0.3 }}",
    "a damped block": f"object a {{ shape box (7, 6, 5) cm position (0, 0, 0) spin (3, 2, 40) rad/s {SOFT} drag 0.3 }}",
    "a ring beside a damped ball": f"object a {{ shape torus 4 cm 1.5 cm position (0, 0, 0) spin (3, 2, 40) rad/s {SOLID} }}\n"
    f"object b {{ shape sphere 3 cm position (12, 0, 0) cm spin (3, 2, 40) rad/s {SOFT} drag 0.1 }}",
    "small ones": "repeat i in 0 .. 8 { object a[i] { shape box (2, 3, 2) cm position (4 * i, 0, 0) cm "
    f"spin (9, i, 4) rad/s {SOLID} }} }}",
    "held": f"object a {{ shape box (9, 4, 4) cm position (0, 0, 0) {SOFT} hold face -x }}",
    **{
        name: EFFECTS[name]
        for name in ("contact", "ground", "walls and contact", "damped, all at once", "damped contact", "liquid")
    },
}

HEAP = f"""
ground z 0 m
walls from (-8, -8, -10) cm to (8.5, 20, 100) cm
repeat i in 0 .. 2 {{ repeat j in 0 .. 2 {{ repeat k in 0 .. 1 {{
  object a[9*k + 3*i + j] {{ shape box (4, 4, 4) cm position (4.02*i - 4, 4*j - 4, 2 + 4.01*k) cm {SOLID} friction 0.4
    velocity (rand(-1, 1), rand(-1, 1), -0.5) spin (0, 0, 9 * rand(-1, 1)) rad/s }} }}
  object b[3*i + j] {{ shape sphere 2 cm position (4*i - 4, 4*j - 4, 10.1) cm {SOFT} friction 0.3 velocity (0, 1, -1) }} }} }}
"""
"""Cubes and balls in a bin that press and rub each other, the ground and a wall: many pairs, and points of all kinds."""


def heap(style: str) -> tuple[list[bytes], float, float]:
    """As film() of the heap, with what contacts remember; the most points in touch; bytes of what is known of points."""
    ready = prepare(parse_scene(FALL + HEAP + "\n" + FINE.format(10, "surface")))
    with Instance(ready.plan) as instance:
        instance.lammps.lmp.command(f"run_style {style}")
        instance.setup()
        told, most = [], 0.0
        for many in (1, 150, 149):
            instance.run(many)
            told += [instance.array(a).tobytes() for a in "xvf"]
            most = max(most, instance.fix_value("contact", 5))
            books = [instance.fix_value(fix, n) for fix in ("contact", "ground") for n in (0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 14)]
            told.append(np.array([instance.fix_scalar("contact"), instance.fix_scalar("ground"), *books]).tobytes())
            told += [found.data.tobytes() for _, found in sorted(instance.state().records.items())]
        assert instance.fix_value("contact", 1) > 0.0 and instance.fix_value("ground", 1) > 0.0  # friction
        return told, most, instance.fix_value("contact", 12)


def film(text: str, style: str, end: str, steps=(1, 40, 39)) -> tuple[list[bytes], int]:
    """All that a run tells, byte for byte, and how many ranges there were."""
    ready = prepare(parse_scene(FALL + text + "\n" + end))
    with Instance(ready.plan) as instance:
        instance.lammps.lmp.command(f"run_style verlet/mdanim {style}")
        instance.setup()
        instance.trace.start()
        told = []
        for many in steps:
            instance.run(many)
            told += [instance.array(a).tobytes() for a in "xvf"]
            told += [np.asarray(a).tobytes() for a in instance.trace.boxes()]
            sums = [
                instance.kinetic_energy(),
                instance.elastic_energy(),
                instance.damping_loss(),
                instance.fix_scalar("leapfrog"),
            ]
            told.append(np.array(sums).tobytes())
        return told, ranges(instance)


@pytest.mark.parametrize("name", LARGE)
def test_threads_change_no_bit(name):
    """Two, three and five threads give what one gives, the sums of losses among it."""
    end = FINE.format(4, "paper")
    alone, one = film(LARGE[name], "threads 1", end)
    assert one == 1
    for threads in (2, 3, 5):
        found, many = film(LARGE[name], f"threads {threads}", end)
        assert 1 < many <= threads
        assert found == alone, threads


@pytest.mark.parametrize("name", ["a damped block", "contact"])
def test_threads_and_widths_change_no_bit(name):
    """Each width with threads gives what the narrowest gives without; contact at the surfaces, too."""
    end = FINE.format(4, "surface")
    alone, _ = film(LARGE[name], "width common", end)
    for width in [w for w in WIDTHS if supported(w)]:
        found, many = film(LARGE[name], f"threads 3 width {width}", end)
        assert many > 1 and found == alone, width


@pytest.fixture(scope="module")
def heap_alone():
    """By one thread, with the narrowest vectors."""
    return heap("verlet/mdanim threads 1 width common")


@pytest.mark.parametrize("threads", [2, 3, 4, 8])
def test_threads_that_share_contact_change_no_bit(heap_alone, threads):
    """Forces, sums, looks and what contacts remember are those of one thread. What fields work out ahead takes room."""
    found, touching, room = heap(f"verlet/mdanim threads {threads}")
    assert found == heap_alone[0] and touching > 100
    assert room > 1.2 * heap_alone[2]


@pytest.mark.parametrize("width", WIDTHS)
def test_threads_that_share_contact_and_widths_change_no_bit(heap_alone, width):
    """The same for every width that runs here."""
    if supported(width):
        assert heap(f"verlet/mdanim threads 3 width {width}")[0] == heap_alone[0]


def test_a_small_scene_has_one_range():
    """Threads are left out where there is too little for each of them to do."""
    assert film(SHAPES["block"], "threads 4", FINE.format(10, "paper"), steps=(2,))[1] == 1


def test_instances_share_threads():
    """A second instance with more threads in the same process changes no bit of the first."""
    end, text = FINE.format(4, "paper"), LARGE["a block"]
    alone, _ = film(text, "threads 1", end)
    ready = prepare(parse_scene(FALL + text + "\n" + end))
    with Instance(ready.plan) as other:
        other.lammps.lmp.command("run_style verlet/mdanim threads 4")
        other.setup()
        other.run(10)
        assert film(text, "threads 2", end)[0] == alone
        other.run(10)
        assert ranges(other) > 2
