# SPDX-License-Identifier: GPL-2.0-only
"""The distributed program against the sequential one: the same film to the last bit, however objects are dealt out."""

import itertools
import json
import re
from pathlib import Path

import numpy as np
import plugin_path
import pytest
from distribution_lab import MEASURED, SEQUENTIAL, WINDOWS, matrix, same_file, ways
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.timeline import KINDS, Timeline
from mpi import scenes as films

BY_RANKS_AND_BY_THREADS = pytest.mark.parametrize("by_threads", [False, True], ids=["by ranks", "by threads"])

pytestmark = pytest.mark.mpi


def same(alone: Path, together: Path) -> None:
    """The file of the frames to the byte; energies and all that is measured but for rounding."""
    assert compare(alone, together).equal  # tells where they differ
    same_file(alone, together)
    one, two = (Ledger.read(f / "ledger.csv") for f in (alone, together))
    assert (one.terms, one.extras) == (two.terms, two.extras)
    scale = max(np.abs(one.array(t)).max() for t in one.terms)
    # Loss by dashpots is of second order only where a bundle begins anew: 4.4e-6 of all energy for 16 balls.
    timeline = Timeline.read(together)
    begun = np.count_nonzero(timeline.moves) + sum(timeline.retries)
    for column in one.columns:
        rough = column in ("damping_loss", "residual")
        np.testing.assert_allclose(
            two.array(column),
            one.array(column),
            rtol=2e-3 if rough else 1e-9,
            err_msg=column,
            atol=(max(1e-4, 5e-6 * begun) if column == "residual" else 1e-5 * scale if rough else 1e-12 * scale),
        )
    first, second = (json.loads((f / "summary.json").read_text()) for f in (alone, together))
    for summary in (first, second):
        del summary["seconds"], summary["energy_residual"]
    found = [[e.pop("found") for e in summary["expect"]] for summary in (first, second)]
    np.testing.assert_allclose(*found, rtol=1e-9, atol=1e-4)
    assert first.pop("penetration") == pytest.approx(second.pop("penetration"), rel=1e-12)
    assert first == second


def checked(folder: Path, executors: int) -> Timeline:
    """The timeline of a finished run, found whole; nothing else is left over."""
    timeline = Timeline.read(folder)
    frames = json.loads((folder / "summary.json").read_text())["frames"]
    assert timeline.executors == executors and timeline.frames == list(range(frames))
    assert {kind for _, kind, *_ in timeline.spans} <= set(KINDS)
    assert {e for e, *_ in timeline.spans} == set(range(executors))
    assert all(begin <= end for *_, begin, end in timeline.spans)
    assert not [p for p in folder.iterdir() if p.name.startswith(".") or p.name == "stop"]
    return timeline


FILMS = {
    "mixed": (films.MIXED, matrix()),
    "rafts": (films.RAFTS, matrix()),
    "passing": (films.PASSING, matrix((3,), ["central"])),
    "dam": (films.DAM, matrix((2,))),
    "waves": (films.WAVES, matrix((4,)) | matrix((3,), ["peers"], "windows ", settings=WINDOWS)),
    "alone": (films.ALONE, matrix((1, 4), ["peers"]) | matrix((3,), ["central"])),
    "resting": (films.RESTING, matrix((2,))),
    "hasty": (films.HASTY, matrix((3,))),
    "uneven": (films.UNEVEN, matrix((2,), ["peers"]) | matrix((3,), ["central"], "windows ", settings=WINDOWS)),
}


@pytest.mark.parametrize("name", FILMS)
def test_every_frame_is_that_of_the_sequential_program(scene, name):
    """One to four executors under either control give the film of the sequential program, and all that is told of it."""
    text, cases = FILMS[name]
    all_the_same(ways(scene(text), cases), cases)


def all_the_same(found: dict[str, Path], cases: dict[str, dict]) -> dict[str, Timeline]:
    """Every way against the sequential program; returns their timelines."""
    timelines = {}
    for way, case in cases.items():
        same(found["sequential"], found[way])
        timelines[way] = checked(found[way], case["executors"])
        assert timelines[way].control == case["control"]
    return timelines


def windows(timeline: Timeline) -> int:
    """Most windows on the way to a frame: an executor waits once at the end of each, or has begun it again."""
    waits = [frame for e, kind, frame, *_ in timeline.spans if e == 0 and kind == "waiting" and frame > 1]
    return int(np.bincount(waits).max())


def test_objects_that_fly_about_change_their_executors(scene):
    """At least 30 migrations; also where reserved boxes are too small at first, and where windows are shorter than a frame."""
    again, finer = {"safety": 0.3}, WINDOWS | {"finest": 4}
    cases = (
        matrix((2,), name="plain ")
        | matrix((3,), ["central"], "again ", settings=again)
        | matrix((3,), ["central"], "windows ", settings=finer)
        | matrix((3,), ["peers"], "both ", settings=again | finer)
    )
    timelines = all_the_same(ways(scene(films.FLYING), cases), cases)
    moves = {way: sum(t.moves) for way, t in timelines.items()}
    assert moves["both peers3"] >= 30 and moves["again central3"] >= 30, moves
    assert sum(timelines["again central3"].retries) >= 10 and sum(timelines["both peers3"].retries) >= 10
    assert sum(timelines["plain peers2"].retries) == 0
    assert windows(timelines["windows central3"]) > 1 == windows(timelines["plain central2"])
    for timeline in timelines.values():
        # An object that came to an executor left another one, and in no frame is a movable object without an owner.
        table = timeline.owner()
        assert (table >= 0).all() and (table < timeline.executors).all()
        assert (table[1:] != table[:-1]).sum() <= sum(timeline.moves)
    kinds = [kind for _, kind, *_ in timelines["again central3"].spans]
    assert kinds.count("frozen") >= 10, "what is done is frozen while others begin a window again"


def test_only_what_meets_others_begins_again(scene):
    """Boxes are too small in every frame, but a window is simulated again only where a wider one meets another executor's."""
    cases = matrix((3,), settings={"safety": 0.0})
    timelines = all_the_same(ways(scene(films.APART), cases), cases)
    for timeline in timelines.values():
        times = np.array(
            [
                [
                    sum(e == executor and kind == "simulating" and f == frame for e, kind, f, *_ in timeline.spans)
                    for frame in timeline.frames[1:]
                ]
                for executor in range(3)
            ]
        )
        assert min(timeline.retries[1:]) > 0
        one, other, third = timeline.owner()[1:, [timeline.names.index(name) for name in ("falling", "below", "hanging")]].T
        meet = int((one == other).argmax())
        assert (times[:, :meet] == 1).all() and times[one[meet], meet] == 2 and meet > 0
        assert (times[third[0]] == 1).all() and (third == third[0]).all() and times.max() == 2


HEAVY = {
    "solid": (films.HEAVY, "central", 3),
    "liquid": (films.POOL + MEASURED, "peers", 2),
    "waves": (films.WAVES, "peers", 2),
    "liquid of three": (films.POOL, "central", 3),
    "islands": (films.FLYING, "central", 3),
}
LONG = {("liquid of three", False), ("liquid of three", True), ("islands", False)}


def team(name: str, by_threads: bool):
    """A case of the next test."""
    shared = "threads" if by_threads else "ranks"
    return pytest.param(name, by_threads, id=f"by {shared}-{name}", marks=[pytest.mark.soak] * ((name, by_threads) in LONG))


@pytest.mark.parametrize(("name", "by_threads"), [*itertools.starmap(team, itertools.product(HEAVY, (False, True)))])
def test_a_team_runs_what_is_too_heavy_for_one(scene, name, by_threads):
    """Several executors run one island together, or one has threads for all of them, also where its box is too small at first."""
    text, control, more = HEAVY[name]
    team = {"least": 50, "by_threads": by_threads}
    cases = matrix((2,), [control], settings=team) | matrix(
        (more,), [control], "windows ", settings=WINDOWS | team | {"safety": 0.5}
    )
    timelines = all_the_same(ways(scene(text), cases), cases)
    assert {members for _, members in timelines[f"{control}2"].teams} <= {(0, 1), (1, 0)} and timelines[f"{control}2"].teams
    assert max(len(members) for _, members in timelines[f"windows {control}{more}"].teams) >= 2
    assert sum(timelines[f"windows {control}{more}"].retries) > 0


@BY_RANKS_AND_BY_THREADS
def test_a_team_ends_when_it_has_no_more_to_do(scene, by_threads):
    """Two objects meet and part: what each member of the team has of them goes to the one that runs them next, also when a window
    begins again."""
    team = {"least": 50, "by_threads": by_threads}
    cases = matrix((2,), settings=team) | matrix((2,), ["central"], "windows ", settings=WINDOWS | team | {"safety": 0.3})
    timelines = all_the_same(ways(scene(films.BOUNCE), cases), cases)
    for timeline in timelines.values():
        together = [frame for frame, _ in timeline.teams]
        assert together and min(together) > 1 and max(together) < timeline.frames[-1] - 2
    assert sum(timelines["windows central2"].retries) > 0


def test_a_run_goes_on_with_other_executors(scene):
    """Stop in the middle of a collision; go on with more executors, with none, under the other control; stop again."""
    first, after = ({"executors": k, "control": control} for k, control in ((3, "central"), (2, "peers")))
    cases = {
        "a": first | {"stop": 4},
        "a more": first | {"executors": 4, "resume": True, "in": "a"},
        "b": SEQUENTIAL | {"stop": 4},
        "b spread": after | {"resume": True, "in": "b", "stop": 7},
        "b alone": SEQUENTIAL | {"resume": True, "in": "b"},
        "c": after | {"stop": 5},
        "c alone": SEQUENTIAL | {"resume": True, "in": "c"},
    }
    found = ways(scene(films.MIXED), cases)
    contact = Ledger.read(found["sequential"] / "ledger.csv").array("contact")
    assert contact[4:8].min() > 0.0, "it was to be stopped while objects touch"
    for way in ("a", "b", "c"):
        same(found["sequential"], found[way])
    timeline = checked(found["a"], 4)  # of all frames, those before the resume too
    assert (timeline.owner() >= 0).any(axis=1).all() and min(timeline.cpu) > 0.0
    assert timeline.owner().max() == 3 and timeline.owner()[0].max() == 2
    spread = Timeline.read(found["b"]).frames  # the frames before and after had no team's owner
    assert spread[0] == 5 and 7 <= spread[-1] < len(timeline.frames) - 1


def test_covered_sides_are_the_same_for_every_executor(scene):
    """Whatever neighbours it has of a slab, and after a resume on a seam."""
    peers = {"executors": 2, "control": "peers"}
    cases = {
        "spread": peers,
        "a": SEQUENTIAL | {"stop": 4},
        "a spread": peers | {"resume": True, "in": "a"},
        "b": peers | {"stop": 4},
        "b alone": SEQUENTIAL | {"resume": True, "in": "b"},
    }
    found = ways(scene(films.SEAMS), cases)
    for way in ("spread", "a", "b"):
        same(found["sequential"], found[way])


@pytest.mark.parametrize("text", [pytest.param(films.POOL, id="surface"), pytest.param(films.WAVES, id="waves")])
def test_a_liquid_goes_on_with_other_executors(scene, text):
    """Stop while bodies splash; the state of the liquid goes to the executor that has it next."""
    cases = {
        "a": {"executors": 2, "control": "central", "stop": 5},
        "a more": {"executors": 3, "control": "peers", "resume": True, "in": "a"},
        "b": SEQUENTIAL | {"stop": 5},
        "b spread": {"executors": 2, "control": "peers", "resume": True, "in": "b"},
        "team": {"executors": 2, "control": "peers", "stop": 5, "settings": {"least": 50}},
        "team alone": SEQUENTIAL | {"resume": True, "in": "team"},
    }
    found = ways(scene(text), cases)
    if text == films.WAVES:
        momentum = Ledger.read(found["sequential"] / "ledger.csv").array("liquid_momentum.x")
        assert np.ptp(momentum[4:8]) > 0.01, "it was to be stopped while the liquid moves"
    for way in ("a", "b", "team"):
        same(found["sequential"], found[way])


def test_lammps_alone_runs_the_same_film(scene):
    """The written input under ``lmp`` ends with the bits of the distributed run."""
    path = scene(films.MIXED.replace("frames 100 fps", "frames 25 fps"))
    found = ways(path, matrix((2,), ["central"]))
    from mdanim_lammps.results.trajectory import Trajectory
    from mdanim_lammps.run.loop import write_inputs
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    ready = prepare(load_scene(path))
    write_inputs(ready, path.parent)
    script = path.parent / f"in.{ready.plan.name}"
    script.write_text(
        script.read_text() + "\nwrite_dump all custom end.dump id x y z vx vy vz modify sort id format float %.17g\n"
    )
    done = plugin_path.lmp(script)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = np.loadtxt(path.parent / "end.dump", skiprows=9)
    with Trajectory(found["central2"]) as film:
        last = len(film) - 1
        assert np.array_equal(rows[:, 1:4], film.position(last)) and np.array_equal(rows[:, 4:], film.velocity(last))


@pytest.mark.soak
@pytest.mark.parametrize("name", [*FILMS, "flying"])
def test_all_films_on_any_number_of_executors(scene, name):
    """The long form: everything under everything."""
    cases = (
        matrix()
        | matrix((2, 4), name="windows ", settings=WINDOWS)
        | matrix((3,), name="again ", settings={"safety": 0.2})
        | matrix((2, 3), name="teams ", settings={"least": 50})
    )
    text = films.FLYING if name == "flying" else FILMS[name][0]
    all_the_same(ways(scene(text), cases, timeout=250.0), cases)


@pytest.mark.soak
@pytest.mark.parametrize(("name", "seconds"), [("crowd", 0.6), ("float", 2.0)])
def test_scenes_of_the_paper(tmp_path, scenes, name, seconds):
    """The crowd and the float, from the files as they are but shorter."""
    text = (scenes / f"{name}.txt").read_text().replace('include "rubber.txt"', "let rubber = 150 kPa")
    text = re.sub(r"time +\d s", f"time {seconds} s", text.split("expect")[0])
    (tmp_path / "scene.txt").write_text(text)
    cases = matrix((2, 3))
    all_the_same(ways(tmp_path / "scene.txt", cases, timeout=250.0), cases)
