# SPDX-License-Identifier: GPL-2.0-only
"""Objects that touch by the law of surfaces, with friction: the same bits where they are cut out, put back, laid aside."""

import numpy as np
import plugin_path
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.state import State, join_all
from mdanim_lammps.engine.sub_plan import SubPlans
from mdanim_lammps.run.loop import write_inputs
from mpi.follow import follow
from paths import MPI
from ranks_lab import on_ranks

SOLID = "density 1000 elasticity 0.3 MPa"
END = "control { time 1 s resolution 5 cm contact-model surface friction 0.4 }"
PAIRS = f"""
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object a {{ shape box (20, 20, 10) cm position (0, 0, 5.1) cm velocity (0.3, 0, 0) m/s {SOLID} }}
object b {{ shape box (10, 10, 10) cm position (5, 2, 17.2) cm orientation axis (1, 0, 0) angle 20 deg {SOLID} }}
object c {{ shape box (15, 20, 10) cm position (70, 0, 5.1) cm velocity (0.1, 0.4, 0) m/s {SOLID} }}
object d {{ shape box (10, 10, 10) cm position (72, 3, 17.2) cm orientation axis (0, 1, 0) angle 15 deg {SOLID} }}
{END}
"""
"""Two heaps that do not meet."""
TOUCHING = f"""
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object a {{ shape box (20, 20, 10) cm position (0, 0, 5) cm velocity (0.4, 0, -0.3) m/s {SOLID} }}
object b {{ shape box (15, 10, 10) cm position (3, 2, 15) cm velocity (0, 0.2, -0.5) m/s {SOLID} }}
object c {{ shape box (10, 10, 15) cm position (5, 3, 27.6) cm velocity (0, 0, -1) m/s {SOLID} }}
{END}
"""


def rows(plan, objects) -> np.ndarray:
    """Their particles in the whole."""
    return np.concatenate([np.arange(*plan.system.first[[m, m + 1]]) for m in objects])


def evolve(instance, steps: int) -> State:
    instance.run(steps)
    return instance.state()


def same(a: State, b: State) -> None:
    """Every bit of places, velocities, forces and records."""
    for name in "xvf":
        assert getattr(a, name).tobytes() == getattr(b, name).tobytes(), name
    assert a.records == b.records


def cut(state: State, plan, objects) -> State:
    """The part of a state of the whole."""
    at = rows(plan, objects)
    records = {fix: found.take(objects, False) for fix, found in state.records.items()}
    return State(state.x[at], state.v[at], state.f[at], records)


def contacts(state: State) -> int:
    """Bytes of what contacts remember."""
    return sum(len(found.data) for found in state.records.values())


def test_a_heap_goes_on_in_an_instance_of_its_own_and_back(prepared):
    """Cut two objects that touch and rub out of the whole, let them go on alone, and put them back."""
    plan = prepared(PAIRS).plan
    parts, heaps = SubPlans(plan), ((0, 1), (2, 3))
    with Instance(plan) as whole:
        whole.setup()
        before = evolve(whole, 400)
        middle = evolve(whole, 300)
        after = evolve(whole, 300)
    assert min(contacts(cut(before, plan, heap)) for heap in heaps) > 2000
    pieces = []
    for heap in heaps:
        with Instance(parts.part(heap, False)) as alone:
            alone.put(400, cut(before, plan, heap))
            pieces.append(evolve(alone, 300))
            same(pieces[-1], cut(middle, plan, heap))
    together = [np.concatenate([getattr(piece, name) for piece in pieces]) for name in "xvf"]
    records = [{fix: found.renumbered(heap) for fix, found in piece.records.items()} for piece, heap in zip(pieces, heaps)]
    joined = State(*together, join_all(records))
    same(joined, middle)
    with Instance(plan) as whole:
        whole.put(700, joined)
        same(evolve(whole, 300), after)


def test_a_heap_that_is_laid_aside_touches_nothing(prepared):
    """Two heaps: one is laid aside while its objects touch; the other goes on as before, also through where the first began."""
    fast = "velocity (1.6, 0, 0) m/s"  # it has gone farther than two skins, and so is put where it began
    text = PAIRS.replace("(70, 0, 5.1) cm velocity (0.1, 0.4, 0) m/s", f"(38, 0, 5.1) cm {fast}")
    plan = prepared(text.replace("(72, 3, 17.2) cm", f"(40, 3, 17.2) cm {fast}")).plan
    with Instance(plan) as whole, Instance(SubPlans(plan).part((0, 1), False)) as alone:
        whole.setup()
        state = evolve(whole, 400)
        assert contacts(cut(state, plan, (2, 3))) > 2000
        whole.lay_aside((2, 3))
        moved = cut(state, plan, (0, 1))
        moved.v[:, 0] += 3.0
        alone.put(400, moved)
        whole.array("v")[: len(moved.v), 0] += 3.0
        for _ in range(4):
            now = evolve(whole, 250)
            same(cut(now, plan, (0, 1)), evolve(alone, 250))
        assert np.ptp(now.v[rows(plan, (2, 3))]) == 0.0
        assert now.x[rows(plan, (0,)), 0].max() > 0.4


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 3, 4])
def test_ranks_see_what_one_sees(tmp_path, ranks):
    """In the middle of contacts: followed, taken back, and taken up in a fresh instance with all particles elsewhere."""
    path = tmp_path / "small.txt"
    path.write_text(TOUCHING)
    alone = follow(path)
    on_ranks(MPI / "follow.py", ranks, "together", path, tmp_path / "film.npz")
    found = np.load(tmp_path / "film.npz")
    assert len(alone["end contact"]) > 4000 and len(alone["end ground"]) > 2000
    for name, value in alone.items():
        if name.endswith(("energies", "depths")):
            np.testing.assert_allclose(found[name], value, rtol=1e-9, atol=1e-12, err_msg=name)
        else:
            assert found[name].tobytes() == value.tobytes(), name
    for what in ("x", "v", "f", "contact", "ground"):
        for when in ("again", "new"):
            assert found[f"{when} {what}"].tobytes() == found[f"end {what}"].tobytes(), (when, what)


HAND = TOUCHING.replace("time 1 s", "time 0.06 s frames 50 fps").replace(
    "control {", f"object ball {{ shape sphere 7 cm position (-17.1, 0, 7) cm velocity (1, 0, 0) m/s {SOLID} }}\ncontrol {{"
)


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [1, 2])
def test_lmp_gives_the_bits_of_the_driver(prepared, tmp_path, ranks):
    """Run the written input by hand, which reads the bodies, cuboids and a ball, from contact.NAME."""
    ready = prepared(HAND)
    film = []
    with Instance(ready.plan) as instance:
        instance.setup()
        for steps in (0, *[ready.certificate.steps_per_frame] * ready.certificate.frames):
            instance.run(steps) if steps else None
            film.append(np.concatenate([instance.array("x"), instance.array("v")], axis=1))
        assert contacts(instance.state()) > 4000
    write_inputs(ready, tmp_path)
    done = plugin_path.lmp(tmp_path / "in.small", ranks, "-screen", "none", timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr
    blocks = (tmp_path / "small.lammpstrj").read_text().split("ITEM: ATOMS")[1:]
    found = [np.array([row.split()[3:9] for row in block.partition("ITEM")[0].splitlines()[1:]], float) for block in blocks]
    assert np.array_equal(found, film)


def test_a_scene_without_surfaces_has_no_file_of_bodies(prepared, tmp_path):
    """Nor names one."""
    write_inputs(prepared(HAND.replace("contact-model surface friction 0.4", "contact-model paper")), tmp_path)
    assert not (tmp_path / "contact.small").exists() and "bodies" not in (tmp_path / "in.small").read_text()
