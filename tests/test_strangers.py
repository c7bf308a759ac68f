# SPDX-License-Identifier: GPL-2.0-only
"""Output folders of which a stranger has changed one file at random: each command ends soon with a documented code."""

from __future__ import annotations

import json
import os
import random
import re
import shutil
from contextlib import suppress

import h5py
import numpy as np
import pytest
import strangers
from mdanim_lammps import Scene, cli
from mdanim_lammps.errors import MdanimError, OutputError
from mdanim_lammps.export import FORMATS
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.progress import PROGRESS
from mdanim_lammps.results.timeline import Timeline
from mdanim_lammps.view.feed import LAYERS
from mdanim_lammps.view.tail import Known, Tail
from scene_texts import POOL

pytestmark = [pytest.mark.timeout(120), pytest.mark.filterwarnings("ignore::RuntimeWarning")]
FILES = ("manifest.json", "cost.json", "summary.json", "certificate.json", "timeline.json", "progress.jsonl")
CODES = (0, 2, 3, 6, 7)
"""Done; a range or size that does not fit; the stored scene is wrong; runs differ, as a NaN does from itself; a file is wrong."""


@pytest.fixture(scope="module")
def pool(tmp_path_factory):
    """A run of a pool with all files that a run can leave."""
    folder = tmp_path_factory.mktemp("pool")
    (folder / "pool.txt").write_text(POOL + "expect cube.position.z at 0.2 s = 0.1 m +- 1 m\n")
    Scene.load(folder / "pool.txt").run(folder / "pool.out")
    timeline = Timeline(2, "central", ("cube",))
    for frame in (0, 1):
        timeline.add(frame, [np.array([0]), np.zeros(0, int)], 0, 0)
    timeline.spans.append((0, "simulating", 1, 0.0, 1.0))
    timeline.write(folder / "pool.out")
    return folder / "pool.out"


@pytest.fixture
def copy(pool, tmp_path):
    """Makes a fresh copy of the run."""

    def make():
        shutil.rmtree(tmp_path / "pool.out", ignore_errors=True)
        return shutil.copytree(pool, tmp_path / "pool.out")

    return make


def code_of(*arguments) -> int:
    """Exit code of a command, run in this process."""
    with pytest.raises(SystemExit) as end:  # noqa: PT012 -- some commands return, others exit
        cli.main([*map(str, arguments)])
        raise SystemExit(0)
    return int(end.value.code)


def viewed(folder) -> int:
    """Ask for all that a page asks for; the exit code that this comes to."""
    try:
        with Tail(folder) as tail:
            json.dumps(tail.news(Known()), allow_nan=False).encode()
            if tail.count:
                feed = tail.feed()
                feed.scene(), feed.springs(), feed.track(0, tail.count)
                told = tail.told()
                for word in json.loads(json.dumps(told.head(), allow_nan=False))["words"]:
                    with suppress(MdanimError):  # a page shows it in place of this curve
                        told.curve([feed.metadata.names[0], word])
                told.vectors("velocity")
                for frame in range(tail.count):
                    feed.frame(frame, LAYERS)
    except MdanimError as error:
        return int(error.exit_code)
    return 0


COMMANDS = {
    "view": viewed,
    "report": lambda folder: code_of("report", folder),
    "timeline": lambda folder: code_of("timeline", folder),
    "compare": lambda folder: code_of("compare", folder, folder),
    "render": lambda folder: code_of("render", folder, "--size", 64, 48, "-q"),
    **{to: lambda folder, to=to: code_of("export", folder, "--to", to, "--force", "-q") for to in FORMATS},
}


def tried(copy, seeds, change, commands) -> None:
    """Change a copy for each seed, and run some commands."""
    for seed in seeds:
        chance, folder = random.Random(seed), copy()
        what = change(folder, chance)
        for name in commands(chance):
            assert COMMANDS[name](folder) in CODES, f"seed {seed}, {name}: {what}"


def json_changed(folder, chance) -> str:
    return strangers.crafted_json(folder / chance.choice(FILES), chance)


def trajectory_changed(folder, chance) -> str:
    if chance.random() < 0.3:
        (folder / PROGRESS).unlink()  # as older versions left it
    return strangers.crafted_trajectory(folder / "trajectory.h5", chance)


def test_crafted_json(copy, capsys):
    """Values of other kinds, huge, missing, or no JSON at all, in any file."""
    tried(copy, range(10), json_changed, lambda chance: ("view",))
    tried(copy, range(100, 102), json_changed, lambda chance: ("report", "timeline"))


def test_crafted_trajectories(copy, capsys):
    """Tables and attributes of other kinds and shapes, with checksums that fit."""
    tried(copy, range(5), trajectory_changed, lambda chance: chance.sample(("view", "csv", "xyz", "vtk", "lammpstrj"), 2))


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("change", [json_changed, trajectory_changed])
@pytest.mark.parametrize("part", range(4))
def test_crafted_folders_at_length(copy, capsys, change, part):
    """Hundreds of each, with all commands."""
    tried(copy, range(1000 * part + 1000, 1000 * part + 1125), change, lambda chance: chance.sample(list(COMMANDS), 4))


@pytest.mark.parametrize("name", ["cost", "summary", "certificate", "manifest"])
@pytest.mark.parametrize("text", ["NaN", "Infinity", "1e999", '{"effects": {"a": 1}, "other": {}}', '{"expect": [1]}', '"x"'])
def test_facts_that_are_none(copy, capsys, name, text):
    """A fact that is not JSON, or not what a run says, is named; a page is never left empty."""
    folder = copy()
    path = folder / f"{name}.json"
    data = json.loads(path.read_text())
    path.write_text(text if text[0] in '{"' else path.read_text().replace(json.dumps(next(iter(data.values()))), text, 1))
    assert viewed(folder) in (7, 0 if name in ("manifest", "summary") else 7)
    assert code_of("report", folder) == viewed(folder)
    assert viewed(folder) == 0 or f"{name}.json" in capsys.readouterr().err


def test_more_frames_told_than_there_are(copy, capsys):
    """The progress that a run writes is not a measure of its trajectory."""
    folder = copy()
    lines = (folder / PROGRESS).read_text().splitlines()
    frames = [n for n, line in enumerate(lines) if '"frame"' in line]
    more = [lines[frames[-1]].replace('"frame": 8', f'"frame": {n}') for n in range(9, 40)]
    lines[0] = lines[0].replace('"frames": 9', '"frames": 40')
    (folder / PROGRESS).write_text("\n".join([*lines[: frames[-1] + 1], *more, *lines[frames[-1] + 1 :]]) + "\n")
    with Tail(folder) as tail:
        assert tail.news(Known())["count"] == 40 and tail.feed() and tail.count == 9
    assert code_of("report", folder) == 0


LARGE = 20 * 10**9


@pytest.mark.parametrize("name", [*FILES, "ledger.csv", "scene.lock.txt"])
def test_large_files(copy, capsys, name):
    """Files of 20 GB, which take no room on the disk, are refused before they are read."""
    folder = copy()
    if name == "ledger.csv":
        (folder / PROGRESS).unlink()  # else it is not read
    os.truncate(folder / name, LARGE)
    codes = {command: COMMANDS[command](folder) for command in ("view", "report")}
    whole = {"ledger.csv": (0, 0), "timeline.json": (0, 0), "scene.lock.txt": (0, 3)}  # of a ledger rows of its frames are read
    assert tuple(codes.values()) == whole.get(name, (7, 7)), codes
    assert code_of("timeline", folder) == {"timeline.json": 7, "manifest.json": 7, "scene.lock.txt": 3}.get(name, 0)
    if name == "ledger.csv":
        with pytest.raises(OutputError, match=r"would take|a line of it has more"):
            Ledger.read(folder / name)
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize(
    "text",
    [
        "repeat i in 1 .. 2000000 { }",
        'include "/etc/hostname"',
        "\n".join(f"object o{n} {{ shape sphere 1 m position (0, 0, {n}) m density 1 elasticity 1 }}" for n in range(6000)),
    ],
    ids=["repeat", "include", "objects"],
)
def test_a_stored_scene_that_no_run_stores(copy, capsys, monkeypatch, text):
    """A scene text in a trajectory that asks for much is not read at all: exports leave out what needs it."""
    folder = copy()
    with h5py.File(folder / "trajectory.h5", "r+") as file:
        del file["parameters/mdanim/scene"]
        file["parameters/mdanim/scene"] = np.array([text.encode()])
    monkeypatch.setattr("mdanim_lammps.scene.parse.parse_scene", lambda *_, **__: pytest.fail("read"))
    for to in ("csv", "usd"):
        assert code_of("export", folder, "--to", to) == 0
    header = (folder / "pool.csv").read_text().splitlines()[0]
    assert "kinetic" in header and "elastic" not in header


def test_a_stored_scene_of_far_more_particles(copy, monkeypatch, capsys):
    """It is not built."""
    folder = copy()
    with h5py.File(folder / "trajectory.h5", "r+") as file:
        text = file["parameters/mdanim/scene"][0].decode()
        del file["parameters/mdanim/scene"]
        finer, times = re.subn(r"resolution +0\.05 m", "resolution 0.001 m", text)
        assert times == 1
        file["parameters/mdanim/scene"] = np.array([finer.encode()])
    monkeypatch.setattr("mdanim_lammps.export.csv.build_models", lambda *_: pytest.fail("built"))
    assert code_of("export", folder, "--to", "csv") == 0
