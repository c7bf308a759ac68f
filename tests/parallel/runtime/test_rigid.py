# SPDX-License-Identifier: GPL-2.0-only
"""Rigid objects in all forms of the distribution: blows on each other, on the ground and on soft ones, with friction, have the
same bits on executors, in teams, after a resume, and in plain `lmp`."""

from dataclasses import replace

import numpy as np
import pytest
from distribution_lab import SEQUENTIAL, WINDOWS, film_of_lammps, matrix, readied, scene, ways  # noqa: F401
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.ledger import Ledger
from paths import MESHES

pytestmark = pytest.mark.mpi

PAIRS = "".join(
    f"""object box[{i}] {{ shape box (10, 10, 10) cm  position ({50 * i}, 0, 9) cm  density 1000  elasticity rigid
  velocity ({1 if i == 1 else 0}, 0, -1) m/s  spin (0, 2, 0)  orientation axis (1, 1, 0) angle 20 deg }}
object ball[{i}] {{ shape sphere 5 cm  position ({50 * i}, 2, 24) cm  density 1000  elasticity rigid
  velocity (0, 0, -3) m/s  rolling 2 mm }}
"""
    for i in (1, 2)
)
SCENE = f"""gravity (0, 0, -9.81) m/s^2
ground z 0 m
{PAIRS}
object soft {{ shape box (10, 10, 10) cm  position (150, 0, 6) cm  density 1000  elasticity 200 kPa }}
object barbell {{ shape mesh "{MESHES}/sliver.obj" scale 0.02  position (150, 0, 16) cm
  density 1000  elasticity rigid  velocity (0, 0, -1) m/s }}
object neck {{ shape mesh "{MESHES}/dumbbell.obj" scale 0.02  position (-150, 0, 3.05) cm
  density 1000  elasticity rigid  velocity (0, 0, -1) m/s }}
object pin {{ shape sphere 3 cm  position (-150, 0, 9.06) cm  density 1000  elasticity rigid  velocity (0, 0, -2) m/s }}
control {{ time 0.1 s  frames 100 fps  friction 0.5  resolution 2.5 cm }}
"""
"""Two pairs by features, whose balls resist rolling, a mesh with a triangle of no area on something soft by surfaces, one that
is not convex below a ball; the first box flies to the second pair."""


def records(folder) -> dict:
    """Records of both fixes at the last checkpoint, by objects."""
    both = Checkpoint.read(folder / "checkpoint").records
    return {
        (fix, *key): found.data[a:b].tobytes()
        for fix, found in ((fix, both[fix]) for fix in ("rigid", "rigid_rest"))
        for key, a, b in zip(found.keys.tolist(), found.first[:-1].tolist(), found.first[1:].tolist())
    }


def test_rigid_objects_are_the_same_in_all_forms(scene):  # noqa: F811
    """Executors under both controls, windows begun again, migration of all, teams; stopped amid blows and taken up by others."""
    cases = (
        matrix((3,), ["central"], "again ", settings=WINDOWS | {"safety": 0.3})
        | matrix((3,), ["peers"], "all move ", rotate=True)
        | matrix((2,), ["peers"], "teams ", settings={"least": 50})
        | {
            "a": {"executors": 3, "control": "central", "stop": 4},
            "a alone": SEQUENTIAL | {"resume": True, "in": "a"},
            "b": SEQUENTIAL | {"stop": 5},
            "b spread": {"executors": 2, "control": "peers", "resume": True, "in": "b"},
        }
    )
    found = ways(scene(SCENE), cases, timeout=200.0)
    alone = records(found["sequential"])
    assert {(fix, a) for fix, a, b in alone if not b} == {*(("rigid", a) for a in (1, 2, 3, 4, 7, 8)), ("rigid_rest", 6)}
    taken = Ledger.read(found["sequential"] / "ledger.csv")
    assert all(taken.array(term)[-1] > 0.0 for term in ("friction_heat", "contact_damping_loss"))
    for way in cases:
        assert compare(found["sequential"], found[way]).equal, way
        assert records(found[way]) == alone, way
        assert (np.diff(Ledger.read(found[way] / "ledger.csv").array("contact_bound")) >= 0.0).all(), way  # since the start


def test_executors_take_up_states_without_what_they_have_laid_aside(scene):  # noqa: F811
    """Boxes and balls that move among each other: windows begin again in instances that have given objects away."""
    bodies = [
        f"object body[{n + 1}] {{ shape {'sphere 5 cm' if n % 2 else 'box (10, 10, 10) cm'}  density 1000  elasticity rigid\n"
        f"position ({35 * (n % 4)}, {35 * (n // 4)}, 6) cm  velocity ({vx:.2f}, {vy:.2f}, -0.5) m/s }}\n"
        for n, (vx, vy) in enumerate(np.random.default_rng(1).uniform(-3, 3, (14, 2)))
    ]
    text = f"""gravity (0, 0, -9.81) m/s^2
ground z 0 m
{"".join(bodies)}
control {{ time 0.1 s  frames 50 fps  friction 0.3 }}
"""
    found = ways(scene(text), {"spread": {"executors": 2, "control": "central", "settings": WINDOWS | {"safety": 0.3}}}, ranks=3)
    assert compare(found["sequential"], found["spread"]).equal


def test_a_state_is_taken_up_without_what_is_laid_aside(tmp_path):
    """One of three boxes is laid aside. States with and without its record are taken up, and the others go on as before."""
    boxes = "".join(
        f"object {name} {{ shape box (10, 10, 10) cm  position {at} cm  density 1000  elasticity rigid }}\n"
        for name, at in (("lower", "(0, 0, 5)"), ("upper", "(0, 0, 15)"), ("other", "(60, 0, 5)"))
    )
    ready, _ = readied(
        tmp_path, f"gravity (0, 0, -9.81) m/s^2\nground z 0 m\n{boxes}control {{ time 0.1 s  frames 100 fps  friction 0.5 }}\n"
    )
    rows = slice(0, ready.plan.system.first[2])
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(400)
        before = instance.state()
        instance.lay_aside([2])
        instance.run(10)
        without, touching = instance.state(), instance.fix_value("rigid", "touching")
        instance.run(10)
        end = instance.state()
        for step, state, steps in ((410, without, 10), (400, before, 20)):
            instance.put(step, state)
            assert instance.fix_value("rigid", "touching") == touching
            instance.run(steps)
            again = instance.state()
            assert np.array_equal(again.x[rows], end.x[rows]) and np.array_equal(again.v[rows], end.v[rows])
            assert [k for k in again.records["rigid"].keys.tolist() if 3 in k] == []
        kept = before.records["rigid"]
        some = replace(before, records=before.records | {"rigid": kept.where(kept.keys[:, 0] == 1)})
        with Instance(ready.plan) as other:  # one that has all; a body without a record begins anew
            ends = []
            for one in (instance, other):
                one.put(400, some)
                one.run(20)
                ends.append(one.state())
        assert np.array_equal(ends[0].x[rows], ends[1].x[rows]) and np.array_equal(ends[0].v[rows], ends[1].v[rows])
        assert np.array_equal(ends[0].x[rows.stop :], before.x[rows.stop :]) and instance.fix_value("rigid", "bodies") == 3.0


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.soak), 2])
def test_lammps_alone_makes_the_same_frames(tmp_path, ranks):
    """The script that `build` writes, with its tables."""
    ready, folder = readied(tmp_path, SCENE)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        last = instance.array("x").copy()
    assert np.array_equal(film_of_lammps(folder, len(last), ranks=ranks)[-1], last)
