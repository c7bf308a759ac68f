# SPDX-License-Identifier: GPL-2.0-only
"""Instances on several ranks: what one rank sees, to the last bit; and many instances one after the other."""

from pathlib import Path

import numpy as np
import pytest
from filming import BETWEEN, EFFECTS, LATER, SHAPES, SOLID, film
from mpi.changed import CASES, STEPS
from mpi.changed import film as film_changed
from mpi.follow import follow
from paths import MESHES, MPI
from ranks_lab import on_ranks
from scene_texts import MEETING, SPLASH

FILM = MPI / "film.py"
RENUMBERED = MPI / "renumbered.py"
FOLLOW = MPI / "follow.py"
CUT = MPI / "cut.py"
CHANGED = MPI / "changed.py"
CORNER = MPI / "corner.py"
WIDTHS = MPI / "widths.py"
CYCLES = MPI / "cycles.py"
NEARER = MEETING.replace("44) cm", "42.6) cm").replace("-4, 5) cm", "-4, 3.5) cm")
SCENES = {
    "solids": NEARER.replace("drag 0.8", "drag 0.8\n  damping 0.05"),
    "liquid": SPLASH,
    "waves": SPLASH.replace("model surface", "model waves manning 0.03 drops 1 wave -x amplitude 2 cm period 0.5 s"),
}
MOVING = {
    **{name: SHAPES[name] for name in ("sphere", "held", "damped", "damped beside others", "damped and held")},
    **EFFECTS,
    "mesh": f'object a {{ shape mesh "{MESHES / "dumbbell.obj"}" scale 1/30 position (0, 0, 0) spin (3, 2, 15) rad/s {SOLID} }}',
}
"""Scenes whose steps are taken by passes."""
ACCOUNTS = np.s_[16:48]
"""Bytes of a liquid's state that only tell energies, in the heads of plugin/liquid/automaton/automaton_basin_state.cpp and of
wave_basin_state.cpp."""


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("name", "ranks"),
    [("solids", 2), ("solids", 3), ("solids", 4), ("liquid", 2), ("liquid", 3), ("liquid", 4), ("waves", 2), ("waves", 3)],
)
def test_ranks_see_what_one_sees(tmp_path, name, ranks):
    """Follow contact, dashpots, drag, held particles and liquid, take back steps, move all particles: the same bits on
    all ranks."""
    path = tmp_path / "small.txt"
    path.write_text(SCENES[name])
    alone = follow(path)
    on_ranks(FOLLOW, ranks, "together", path, tmp_path / "film.npz")
    film = np.load(tmp_path / "film.npz")
    same(film, alone)
    for what in ("x", "v", "f"):
        assert np.array_equal(film[f"again {what}"], film[f"end {what}"]) and np.array_equal(
            film[f"new {what}"], film[f"end {what}"]
        )
    assert (film["end x"] != film["start x"]).any()
    assert np.abs(film["end energies"]).min() > 0.0 if name == "solids" else (film["end cells"] != film["start cells"]).any()


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("name", "ranks"),
    [(name, 2) for name in MOVING]
    + [
        ("held", 3),
        ("walls and contact", 3),
        ("liquid", 4),
        ("contact", 4),
        ("mesh", 4),
        ("air", 3),
        ("damped", 4),
        ("damped beside others", 3),
        ("damped walls", 4),
        ("damped contact", 3),
        ("damped in liquid", 4),
        ("damped, all at once", 3),
    ],
)
def test_passes_with_ghosts_give_the_bits_of_one_rank(tmp_path, name, ranks):
    """Film bodies that are split among ranks: the bits of run_style verlet on one, and all ranks took most steps by passes."""
    path = tmp_path / "scene.txt"
    path.write_text(MOVING[name])
    frames, energies, trace, _ = film(MOVING[name], "verlet")
    on_ranks(FILM, ranks, path, tmp_path / "film.npz")
    found = np.load(tmp_path / "film.npz")
    assert len(set(found["taken"])) == 1 and found["taken"][0] > 200
    assert np.array_equal(found["frames"], frames)
    assert np.array_equal(found["trace"], trace)
    # Loss by dashpots is estimated in steps in which particles change ranks (loss.h); on two ranks the plain step is 2 % off.
    np.testing.assert_allclose(found["energies"], energies, rtol=3e-3 if "damped" in name else 1e-12, atol=1e-12)


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("size", "turned", "across"),
    [
        ((22.5, 22.5, 22.5), "", False),
        ((22.5, 22.5, 22.5), "orientation axis (0, 0, 1) angle 90 deg", False),
        ((47.5, 10, 10), "", True),
    ],
)
def test_space_is_cut_along_rows_where_that_is_as_good(tmp_path, size, turned, across):
    """Share a cube of 10 particles along each edge, as it is and turned, between two ranks, and a rod of 20 x 5 x 5:
    only that is cut across."""
    path, row = tmp_path / "scene.txt", round(size[0] / 2.5) + 1
    path.write_text(
        f"object a {{ shape box {size} cm position (0, 0, 0) m {turned} density 900 elasticity 1 MPa }}\n"
        "control { time 0.1 s  frames 100 fps  resolution 2.5 cm }"
    )
    rows, particles = np.array([line.split() for line in on_ranks(CUT, 2, path, row).splitlines()], int).T
    assert particles[0] == particles[1]
    assert (rows == (particles.sum() if across else particles) // row).all()


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 3])
def test_forces_are_added_in_the_order_of_fixes_on_all_ranks(tmp_path, ranks):
    """Put fixes that ask for places alone before and after one whose particles are held back."""
    path = tmp_path / "scene.txt"
    path.write_text(BETWEEN)
    frames, _, trace, _ = film(BETWEEN, "verlet", more=LATER)
    on_ranks(FILM, ranks, path, tmp_path / "film.npz", *LATER)
    found = np.load(tmp_path / "film.npz")
    assert len(set(found["taken"])) == 1 and found["taken"][0] > 200
    assert np.array_equal(found["frames"], frames) and np.array_equal(found["trace"], trace)


@pytest.mark.mpi
def test_lists_of_two_steps_of_one_number_are_not_taken_for_each_other(tmp_path):
    """Give steps other numbers so that lists are made in the step whose number the last ones have: particles change
    ranks there."""
    assert int(on_ranks(RENUMBERED, 3, tmp_path)) > 20


@pytest.mark.mpi
@pytest.mark.parametrize(("name", "ranks"), [(name, 2) for name in CASES] + [("delete_bonds", 3), ("second springs", 3)])
def test_what_changes_between_runs_is_seen(tmp_path, name, ranks):
    """Take out, add and alter springs, objects and masses between runs: the bits of run_style verlet on one rank after each run.

    Passes keep blocks of objects whose particles are the same, tag_order.h; most steps of each run are taken by them.
    """
    case = CASES[name]
    alone, _ = film_changed(case, "verlet", tmp_path)
    assert (alone[-1] != film_changed(case.unchanged(), "verlet", tmp_path)[0][-1]).any()
    on_ranks(CHANGED, ranks, name, tmp_path, tmp_path / "found.npz")
    found = np.load(tmp_path / "found.npz")
    for states, passes in (film_changed(case, case.style, tmp_path), (found["ours"], found["passes"])):
        assert (np.asarray(passes) > 0.9 * STEPS).all()
        assert [np.array_equal(*pair) for pair in zip(states, alone, strict=True)] == [True] * len(alone)
    assert np.array_equal(found["plain"], alone)


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 3])
def test_a_rank_without_particles_does_not_end_passes(tmp_path, ranks):
    """Put all objects in a corner of a box that is shared evenly: all steps but the last by passes, and the bits of verlet."""
    on_ranks(CORNER, ranks, tmp_path, tmp_path / "found.npz")
    found = np.load(tmp_path / "found.npz")
    assert found["own"].min() == 0
    assert (found["passes"] == 99).all()
    assert np.array_equal(found["ours"], found["plain"])


@pytest.mark.mpi
def test_a_width_that_one_rank_does_not_have_is_refused_on_all():
    """Refuse together: a rank that went on would wait for the others for ever."""
    raised = on_ranks(WIDTHS, 2, timeout=60.0).splitlines()
    assert len(raised) == 2
    assert all("the processor of some rank does not have it" in line for line in raised)


@pytest.mark.mpi
def test_instances_on_parts_of_the_ranks(tmp_path):
    """Run one instance on rank 0 and another on ranks 1 and 2 at the same time."""
    path = tmp_path / "small.txt"
    path.write_text(SCENES["solids"])
    on_ranks(FOLLOW, 3, "apart", path, tmp_path / "film")
    alone = follow(path)
    for k in (0, 1):
        same(np.load(tmp_path / f"film{k}.npz"), alone)


def same(film, alone) -> None:
    """Compare every bit of what moves, and energies but for rounding."""
    assert set(film) == set(alone)
    for key, value in alone.items():
        if key.endswith(("energies", "depths")):
            np.testing.assert_allclose(film[key], value, rtol=1e-3, atol=1e-9, err_msg=key)  # dashpots, loss.h
        elif key.endswith("liquid"):
            assert np.array_equal(np.delete(film[key], ACCOUNTS), np.delete(value, ACCOUNTS)), key
        else:
            assert np.array_equal(film[key], value, equal_nan=True), key


def left_behind(folder: Path, count: int) -> tuple[float, int]:
    """Memory that an instance leaves [bytes], and files that all of them do."""
    path = folder / "small.txt"
    path.write_text(MEETING)
    memory, files = on_ranks(CYCLES, 1, path, count, own=True).split()
    return float(memory), int(files)


@pytest.mark.parametrize(
    ("count", "most"),
    [
        pytest.param(300, 4e3, id="some"),
        # More than MPI has context identifiers, if they were not given back.
        pytest.param(6000, 4e2, id="thousands", marks=[pytest.mark.soak, pytest.mark.timeout(0)]),
    ],
)
def test_instances_leave_nothing_behind(tmp_path, count, most):
    """Make and close, one after the other: no file stays open, and no memory is lost beyond what an
    allocator keeps."""
    memory, files = left_behind(tmp_path, count)
    assert files == 0
    assert memory < most, f"{memory:.0f} bytes an instance"
