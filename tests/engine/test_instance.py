# SPDX-License-Identifier: GPL-2.0-only
"""The engine: plans, commands, data files and live instances say the same, to the last bit."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import plugin_path
import pytest
from mdanim_lammps.engine.commands import harmonic_coeff, input_script
from mdanim_lammps.engine.data_file import data_text, write_data
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.plan import both_ends
from mdanim_lammps.errors import SetupError
from mdanim_lammps.features.liquid import frames as liquid
from mdanim_lammps.run.loop import write_inputs
from mdanim_lammps.run.prepare import Prepared
from scene_texts import MEETING, SPLASH
from twin import world

WAVES = SPLASH.replace("model surface", "model waves manning 0.03 drops 1 wave -x amplitude 2 cm period 0.5 s")
SCENES = [pytest.param(MEETING, id="solids"), pytest.param(SPLASH, id="liquid"), pytest.param(WAVES, id="waves")]


def state(instance):
    """Positions and velocities of an instance, copied."""
    return instance.array("x").copy(), instance.array("v").copy()


def run_frames(ready: Prepared, frames: int):
    """Positions and velocities of every frame from a live instance, shape (F + 1, 2, N, 3)."""
    with Instance(ready.plan) as instance:
        instance.setup()
        film = [state(instance)]
        for _ in range(frames):
            instance.run(ready.certificate.steps_per_frame)
            film.append(state(instance))
    return np.array(film)


def read_dump(path: Path, particles: int):
    """Frames of a sorted dump: positions and velocities, shape (F, 2, N, 3), and atom ids of the first frame."""
    lines = path.read_text().split("ITEM: TIMESTEP\n")[1:]
    film = []
    for block in lines:
        rows = np.array([row.split() for row in block.split("ITEM: ATOMS")[1].splitlines()[1:]], float)
        assert len(rows) == particles
        film.append([rows[:, 3:6], rows[:, 6:9]])
    return np.array(film)


def run_lmp(directory: Path, script: str, ranks: int = 1):
    """Run LAMMPS by hand, as a user would."""
    done = plugin_path.lmp(directory / script, ranks, "-screen", "none", timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr


def test_harmonic_coeff_is_half_of_k():
    """Halve the paper's k for LAMMPS's K."""
    assert harmonic_coeff(3.0) == 1.5


def test_positions_are_kept_once(prepared):
    """Let the models of several objects see their particles in the arrays of the whole, not in copies."""
    ready = prepared(MEETING)
    for m, model in enumerate(ready.models):
        rows = slice(*ready.system.first[m : m + 2])
        for name in ("position", "velocity", "held"):
            own, whole = getattr(model, name), getattr(ready.system, name)
            assert np.shares_memory(own, whole) and np.array_equal(own, whole[rows])


def test_both_ends_are_ascending():
    """Store every spring at both ends with partners in ascending order."""
    bonds = np.array([[0, 1], [0, 3], [1, 2], [2, 3]], np.int32)
    first, partner, kind = both_ends(bonds, np.array([1, 2, 3, 4], np.int32), 4)
    assert [partner[a:b].tolist() for a, b in itertools.pairwise(first)] == [[2, 4], [1, 3], [2, 4], [1, 3]]
    assert [kind[a:b].tolist() for a, b in itertools.pairwise(first)] == [[1, 2], [1, 3], [3, 4], [2, 4]]


@pytest.mark.parametrize("text", SCENES)
def test_lammps_reads_back_our_data_file(prepared, tmp_path, text):
    """Find in LAMMPS every particle, property and spring of the data file, bit for bit."""
    from mdanim_lammps.engine.columns import property_of
    from mdanim_lammps.engine.commands import prelude
    from mdanim_lammps.engine.plugin import open_lammps

    plan = prepared(text).plan
    path = tmp_path / "data.small"
    write_data(plan, path)
    lmp, _ = open_lammps()
    lmp.commands_list([*prelude(plan), f"read_data {path} fix model NULL Model", "mass * 1.0", "run 0 post no"])
    order = np.argsort(lmp.numpy.extract_atom("id")[: plan.system.particles])
    assert np.array_equal(lmp.numpy.extract_atom("x")[: plan.system.particles][order], plan.system.position)
    assert np.array_equal(lmp.numpy.extract_atom("v")[: plan.system.particles][order], plan.system.velocity)
    assert np.array_equal(lmp.numpy.extract_atom("rmass")[: plan.system.particles][order], plan.system.mass)
    assert np.array_equal(lmp.numpy.extract_atom("molecule")[: plan.system.particles][order], plan.system.object + 1)
    for name, field in plan.fields.items():
        found = lmp.numpy.extract_atom(property_of(field, plan.slots).name)[: plan.system.particles]
        assert np.array_equal(found[order], plan.columns[name]), name
    bonds = lmp.numpy.gather_bonds()
    found = {(min(i, j) - 1, max(i, j) - 1): t for t, i, j in bonds.tolist()}
    assert found == {(i, j): t for (i, j), t in zip(plan.bonds.tolist(), plan.bond_kind.tolist())}
    lmp.close()


@pytest.mark.parametrize("factor", [1.0, 3.0])
def test_a_scene_agrees_with_its_naive_twin(prepared, factor):
    """Follow slab, cube and plate through contact, ground and drag up to the moment of impact
    beside a NumPy twin of every law, the contact of the paper among them."""
    paper = MEETING.replace("control {", "control { contact-model paper ")
    ready = prepared(paper.replace("control {", f"control {{ contact-stiffness {factor}"))
    system, c = ready.system, ready.certificate
    bulk = (system.young * np.cbrt(system.cell_volume))[system.object]
    s, reach = factor * bulk * np.minimum(1.0, 2.0 * system.share), 1.6 * system.spacing[system.object]
    thin = system.layer == 4
    g = np.array(ready.scene.gravity)
    drag = np.zeros(system.particles) if ready.context.drag is None else ready.context.drag

    def force(x):
        return (
            world.spring_forces(x, system.spring, system.stiffness, system.rest)[0]
            + system.mass[:, None] * g
            + world.barrier_forces(x, system.object, system.boundary, thin, s, reach)[0]
            + world.ground_forces(x, 0.0, s)[0]
        )

    steps = round(48 * prepared(paper).certificate.timestep / c.timestep)  # cube on slab and plate on ground, pressed in
    x, v = world.leapfrog(system.position, system.velocity, force, system.mass, drag, c.timestep, steps, ~system.held)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(steps)
        # Rounding of 48 steps of sums in another order; the motion itself is of the order of centimetres.
        np.testing.assert_allclose(instance.array("x"), x, atol=1e-12)
        np.testing.assert_allclose(instance.array("v"), v, atol=1e-10)
        contact = world.barrier_forces(x, system.object, system.boundary, thin, s, reach)[1]
        assert contact > 0.0, "the scene must have objects in touch, otherwise this test shows nothing"
        assert instance.fix_scalar("contact") == pytest.approx(contact, rel=1e-9)
        assert instance.fix_scalar("ground") == pytest.approx(world.ground_forces(x, 0.0, s)[1], rel=1e-9)
        assert instance.elastic_energy() == pytest.approx(
            world.spring_forces(x, system.spring, system.stiffness, system.rest)[1], rel=1e-9
        )


@pytest.mark.parametrize("text", SCENES)
def test_pieces_of_a_run_give_the_bits_of_one(prepared, text):
    """Advance in pieces of any length and get the same bits."""
    ready = prepared(text)
    with Instance(ready.plan) as whole, Instance(ready.plan) as pieces:
        whole.setup()
        whole.run(60)
        pieces.setup()
        for n in (1, 2, 7, 20, 30):
            pieces.run(n)
        assert np.array_equal(state(whole), state(pieces))


@pytest.mark.parametrize("text", [pytest.param(MEETING.replace("drag 0.8", "drag 0.8\n  damping 0.1"), id="solids"), *SCENES[1:]])
def test_restore_goes_on_bit_for_bit(prepared, text):
    """Go on from a stored state, dashpots and liquid included, as if nothing had happened."""
    ready = prepared(text)
    with Instance(ready.plan) as first:
        first.setup()
        first.run(151)
        kept, step = first.state(), first.step
        first.run(151)
        with Instance(ready.plan) as second:
            second.put(step, kept)
            second.run(151)
            assert second.step == first.step
            assert np.array_equal(state(first), state(second))
            if ready.plan.grid:
                assert np.array_equal(liquid.cells(first), liquid.cells(second))
                assert np.array_equal(liquid.heights(first), liquid.heights(second), equal_nan=True)
                assert np.array_equal(liquid.drops(first), liquid.drops(second))
                assert (len(liquid.drops(first)) > 0) == (ready.scene.liquid.drops > 0.0)
                assert second.fix_scalar("liquid") == pytest.approx(first.fix_scalar("liquid"), rel=1e-12)


def test_what_waves_do_to_particles_must_be_numbers(prepared):
    """Refuse a state with NaN in a row of an object, and change nothing. The objects are those that the liquid acts on."""
    with Instance(prepared(WAVES).plan) as instance:
        instance.setup()
        instance.run(151)
        kept, step = instance.state(), instance.step
        found = kept.records["liquid"]
        assert found.keys.tolist() == [[0, 0], [2, 0], [3, 0]]
        size, row = found.first[2] - found.first[1] - 8, 4 + 10 * 8
        assert size > 0 and size % row == 0
        data = found.data.copy()
        data[found.first[1] + 8 + 4 :][: 8 * 10] = np.frombuffer(np.full(10, np.nan).tobytes(), np.uint8)
        damaged = {**kept.records, "liquid": replace(found, data=data)}
        with pytest.raises(SetupError, match="not a number"):
            instance.put(step, replace(kept, records=damaged))
        assert instance.records()["liquid"] == found


def test_a_liquid_state_of_another_grid_is_refused(prepared):
    """Say so instead of going on with other cells."""
    with Instance(prepared(SPLASH).plan) as other:
        other.setup()
        records = other.state().records
    ready = prepared(SPLASH.replace("40) cm\n  density", "45) cm\n  density"))
    with Instance(ready.plan) as instance:
        still = instance.state()
        with pytest.raises(SetupError, match="grid of 24 x 20 x 16 cells, this one has 24 x 20 x 18"):
            instance.put(0, replace(still, records=records))


def test_a_liquid_is_read_back(prepared):
    """Pour the volume asked for into the fill region, beside what stands there, and give its surface as arrays."""
    ready = prepared(SPLASH)
    grid = ready.plan.grid
    with Instance(ready.plan) as instance:
        instance.setup()
        cells, (smooth, raw) = liquid.cells(instance), liquid.heights(instance)
    assert cells.shape == grid.shape[::-1] and smooth.shape == raw.shape == (20, 24)
    wet = (cells > 0) & (cells < 255)
    assert cells[wet].sum() == grid.units(0.045) == 2880
    assert not wet[:, :, 20:].any(), "the liquid starts behind its dam"
    assert np.count_nonzero(cells == 255) == pytest.approx(192 + 144 + 27, abs=20), "wall, raft and stone"
    assert (raw[:, 20:] == 0.0).all() and np.nanmax(raw) == pytest.approx(0.2, abs=1e-12)
    assert not np.isnan(smooth).any() and np.isnan(raw).any()


def test_a_scene_without_liquid_has_none(prepared):
    """Refuse to read a liquid that is not there, or off."""
    for text in (MEETING, SPLASH + "effects { liquid off }"):
        with Instance(prepared(text).plan) as instance, pytest.raises(SetupError, match="no liquid"):
            liquid.heights(instance)


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [1, 2, 4])
@pytest.mark.parametrize("text", SCENES)
def test_lmp_gives_the_bits_of_the_driver(prepared, tmp_path, text, ranks):
    """Run the built input by hand on 1, 2 and 4 ranks and get the driver's frames bit for bit."""
    ready = prepared(text)
    film = run_frames(ready, ready.certificate.frames)
    write_inputs(ready, tmp_path)
    run_lmp(tmp_path, "in.small", ranks)
    assert np.array_equal(read_dump(tmp_path / "small.lammpstrj", ready.system.particles), film)


@pytest.mark.mpi
def test_the_paper_s_model_of_the_liquid_gives_the_same_bits(prepared, tmp_path):
    """Two ranks share the cells around particles; frames stay the driver's."""
    ready = prepared(SPLASH.replace("model surface", "model paper"))
    film = run_frames(ready, ready.certificate.frames)
    write_inputs(ready, tmp_path)
    run_lmp(tmp_path, "in.small", 2)
    assert np.array_equal(read_dump(tmp_path / "small.lammpstrj", ready.system.particles), film)


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("text", SCENES)
def test_shuffled_atoms_give_the_same_bits(prepared, tmp_path, text, ranks):
    """Shuffle atoms and bonds of the data file and get the driver's frames bit for bit."""
    ready = prepared(text)
    film = run_frames(ready, ready.certificate.frames)
    write_inputs(ready, tmp_path)
    path = tmp_path / "data.small"
    path.write_text(shuffle_sections(path.read_text(), seed=3))
    run_lmp(tmp_path, "in.small", ranks)
    assert np.array_equal(read_dump(tmp_path / "small.lammpstrj", ready.system.particles), film)


def shuffle_sections(text: str, seed: int) -> str:
    """Shuffle the rows of every long section of a data file; also swap the two ends of every other bond."""
    import random

    order = random.Random(seed)
    pieces = text.split("\n\n")
    for k, piece in enumerate(pieces):
        title = pieces[k - 1].split("\n")[-1] if k else ""
        if title.split(" ")[0] in ("Atoms", "Velocities", "Model", "Bonds"):
            lines = piece.strip("\n").split("\n")
            tail = []
            if not lines[-1][0].isdigit():
                tail = [lines.pop()]
            order.shuffle(lines)
            if title == "Bonds":
                lines = [" ".join([a, t, j, i]) if n % 2 else row for n, row in enumerate(lines) for a, t, i, j in [row.split()]]
            pieces[k] = "\n".join(lines + tail)
    return "\n\n".join(pieces)


def test_last_short_frame_is_dumped(prepared, tmp_path):
    """Dump the last frame at the very end also when the run is not a whole number of frames."""
    ready = prepared(MEETING.replace("time 40 ms", "time 25 ms"))
    c = ready.certificate
    assert c.last_steps and c.steps * c.timestep == pytest.approx(0.025, rel=1e-12)
    write_inputs(ready, tmp_path)
    run_lmp(tmp_path, "in.small")
    text = (tmp_path / "small.lammpstrj").read_text().split("ITEM: TIMESTEP\n")[1:]
    assert [int(block.split("\n")[0]) for block in text] == [0, c.steps_per_frame, 2 * c.steps_per_frame, c.steps]


def test_an_effect_that_is_off_leaves_no_trace(prepared):
    """Write no command, column or fix for what a scene does not call for."""
    ready = prepared(
        "object a { shape box (2, 2, 2) cm\n position (0, 0, 0)\n mass 1 g\n elasticity 1 kPa\n }\ncontrol { time 1 s }"
    )
    script = input_script(ready.plan)
    for word in ("gravity", "barrier", "mdanim/wall", "mdanim/liquid", "lambda", " d_", " i2_", "region", "boundary type"):
        assert word not in script, word
    assert "Model # mass\n" in "".join(data_text(ready.plan))
