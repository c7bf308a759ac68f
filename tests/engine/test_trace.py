# SPDX-License-Identifier: GPL-2.0-only
"""Where objects have been in the steps of a run, against a look at every step."""

import numpy as np
import plugin_path
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SetupError
from scene_texts import ON_GROUND, solid

SCENE = (
    ON_GROUND
    + solid("stone", "box (10, 10, 5) cm", "(0, 0, 20) cm", "density 2000", "hold all", elasticity="1 MPa")
    + solid("ball", "sphere 5 cm", "(2, 0, 29) cm", "mass 0.5 kg", "velocity (0.5, 0, -3) m/s", "spin (0, 30, 0)", "drag 0.5")
    + solid("beam", "box (20, 5, 5) cm", "(40, 0, 4) cm", "mass 0.5 kg", "velocity (0, 1, -2) m/s", "hold faces x")
    + "control { time 0.2 s  frames 50 fps  resolution 2.5 cm }\n"
)


def extremes(film, system):
    """Lowest and highest coordinates of each object over some states of shape (N, 3)."""
    film = np.array(film)
    low = np.minimum.reduceat(film.min(0), system.first[:-1], axis=0)
    return low, np.maximum.reduceat(film.max(0), system.first[:-1], axis=0)


def test_a_trace_is_the_box_of_all_steps(prepared):
    """Include the place at the start and every step, of held particles too; begin anew when asked."""
    system = (plan := prepared(SCENE).plan).system
    with Instance(plan) as instance, Instance(plan) as watched:
        instance.setup()
        watched.setup()
        watched.run(3)
        instance.run(3)
        for steps in (200, 1, 150):
            instance.trace.start()
            film = [watched.array("x").copy()]
            for _ in range(steps):
                watched.run(1)
                film.append(watched.array("x").copy())
            for piece in (1, steps // 2, steps - 1 - steps // 2):
                if piece > 0 and instance.step < watched.step:
                    instance.run(piece)
            assert instance.step == watched.step
            assert np.array_equal(instance.trace.boxes(), extremes(film, system))
            np.testing.assert_allclose(instance.trace.top_speeds(), system.top_speed(watched.array("v")), rtol=1e-15)
        ends = np.array(extremes([film[0], film[-1]], system))
        assert (ends != extremes(film, system)).any(), "ball and beam must turn back, otherwise their ends alone would do"


@pytest.mark.parametrize("every", [2, 3, 7])
def test_a_trace_that_looks_less_often_leaves_nothing_out(prepared, every):
    """Hold all steps, and be wider by the way of an object's fastest particle between two looks at most; start anew
    with every step."""
    plan = prepared(SCENE).plan
    with Instance(plan) as instance, Instance(plan) as seldom:
        for one in (instance, seldom):
            one.setup()
        for steps in (200, 1, 150, 63):
            fastest = np.zeros(3)
            for one in (instance, seldom):
                one.trace.start()
            seldom.trace.look_every(every)
            for _ in range(steps):  # speeds of whole steps; those between them are larger by gravity in half of one at most
                instance.run(1)
                fastest = np.maximum(fastest, instance.trace.top_speeds())
            seldom.run(steps)
            boxes, wider = instance.trace.boxes(), seldom.trace.boxes()
            more = (every - 1) * 1.2 * plan.certificate.timestep * fastest[:, None]
            assert (wider[0] <= boxes[0]).all() and (wider[1] >= boxes[1]).all()
            assert (wider[0] >= boxes[0] - more).all() and (wider[1] <= boxes[1] + more).all()
            assert steps == 1 or (wider[0] < boxes[0])[1:].all(), "what moves must make a difference"
            assert np.array_equal(seldom.array("x"), instance.array("x"))
            seldom.trace.start()
            seldom.run(0)
            assert np.array_equal(seldom.trace.boxes(), extremes([instance.array("x")], plan.system))


def test_a_trace_looks_at_least_at_times(prepared):
    """Refuse a number of steps that is none."""
    with (
        Instance(prepared(SCENE).plan) as instance,
        pytest.raises(SetupError, match="after every 1 or more steps, 0 are asked for"),
    ):
        instance.trace.look_every(0)


def test_a_trace_changes_no_bit(prepared):
    """Move particles to the same places with and without."""
    plan = prepared(SCENE).plan
    with Instance(plan) as plain, Instance(plan) as traced:
        traced.trace.start()
        for instance in (plain, traced):
            instance.setup()
            instance.run(300)
        assert np.array_equal(plain.array("x"), traced.array("x")) and np.array_equal(plain.array("v"), traced.array("v"))


def test_a_trace_that_was_not_started_is_refused(prepared):
    """Say so instead of giving an empty box."""
    with Instance(prepared(SCENE).plan) as instance, pytest.raises(SetupError, match="0 objects are traced, 3 are asked for"):
        instance.trace.boxes()


def test_objects_must_be_numbered_from_one(prepared):
    """Refuse a molecule for which there is no box."""
    with Instance(prepared(SCENE).plan) as instance:
        instance.lammps.lmp.command("set atom 1 mol 4")
        with pytest.raises(SetupError, match="molecule IDs go from 1 to 4, they must be within 1 and the 3 objects"):
            instance.trace.start()


RENUMBERED = """
import sys
from pathlib import Path
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.scene.parse import load_scene
with Instance(prepare(load_scene(Path(sys.argv[1]))).plan) as instance:
    instance.setup()
    instance.trace.start()
    instance.lammps.lmp.command(f"set atom 1 mol {sys.argv[2]}")
    try:
        instance.run(10)
    except Exception as error:
        print(error)
"""


@pytest.mark.parametrize("molecule", [0, 4, 4000000])
def test_molecule_ids_that_change_during_a_trace_stop_the_run(tmp_path, molecule):
    """Name the particle and its molecule ID, for which there is no box, instead of writing beyond all boxes."""
    (tmp_path / "small.txt").write_text(SCENE)
    done = plugin_path.python(RENUMBERED, tmp_path / "small.txt", molecule)
    assert done.returncode == 0, done.stderr
    assert f"particle 1 has molecule ID {molecule}, but objects 1 to 3 are traced" in done.stdout
