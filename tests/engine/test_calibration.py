# SPDX-License-Identifier: GPL-2.0-only
"""The calibration of a machine: widths and ranges follow from what was measured, which is stored and measured anew where it does
not hold. No test looks at a clock: what was measured is written into the file."""

import ctypes
import json
import os
import subprocess
import sys

import pytest
from filming import FALL, SOFT, SOLID, ranges
from mdanim_lammps.engine import calibration
from mdanim_lammps.engine.calibration import CALIBRATION, Calibration, calibrate, holds_for, stored, stored_at
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.plugin import open_library
from mdanim_lammps.engine.threads import with_threads
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

TEXT = FALL + "object a {{ shape box (15, 15, 15) cm position (0, 0, 0) {} drag 0.1 }}\ncontrol {{ time 1 s resolution 1 cm }}\n"
"""4096 particles."""
KNOWN = {"avx512": (30.0, 30.0), "avx2": (30.0, 30.0), "common": (30.0, 30.0)}


def numbers(widths, waking, calling):
    """What the file holds besides what it depends on."""
    return {"widths_ns": widths, "waking_ns": waking, "calling_ns": calling}


@pytest.fixture
def measured(tmp_path, monkeypatch):
    """Let the plugin know numbers as if they had been measured here; the tests' own come back afterwards."""
    calibrate.cache_clear()

    def tell(widths, calling=3e3):
        monkeypatch.setenv(CALIBRATION, str(tmp_path / "calibration.json"))
        (tmp_path / "calibration.json").write_text(json.dumps(holds_for() | numbers(widths, 15e3, calling)))
        calibrate.cache_clear()
        return calibrate(open_library())

    yield tell
    monkeypatch.undo()
    calibrate.cache_clear()
    calibrate(open_library())


def used(material: str, threads: int = 1, style: str = "") -> tuple[str, int]:
    """Width and number of ranges of the passes of a block."""
    with with_threads(threads), Instance(prepare(parse_scene(TEXT.format(material))).plan) as instance:
        if style:
            instance._lmp.command(f"run_style verlet/mdanim {style}")
        instance.setup()
        instance.run(3)
        width = instance._library.mdanim_width
        width.restype, width.argtypes = ctypes.c_char_p, [ctypes.c_void_p]
        return width(instance._handle).decode(), ranges(instance)


def test_the_width_follows_the_measurement(measured):
    """Passes take the width that was measured to be the fastest, of springs with dashpots another one; `width` overrides it."""
    here = list(measured(KNOWN).widths)
    for width in here:
        other = here[0] if width != here[0] else here[-1]
        found = measured(KNOWN | {width: (20.0, 40.0)} | ({other: (40.0, 20.0)} if other != width else {}))
        assert (found.fastest(False), found.fastest(True)) == (width, other if other != width else width)
        assert used(SOLID)[0] == width and used(SOFT)[0] == found.fastest(True)
        assert used(SOLID, style=f"width {here[-1]}")[0] == here[-1]


@pytest.mark.parametrize(
    ("ns", "calling", "expected"),
    [
        pytest.param(30.0, 3e3, 4, id="a range of 1000 particles pays"),
        pytest.param(60.0, 3e3, 4, id="one of 500 as well: there are four threads"),
        pytest.param(30.0, 6e3, 2, id="one of 2000 pays"),
        pytest.param(30.0, 6.4e3, 1, id="one of 2134 pays, half of all is less"),
    ],
)
def test_ranges_follow_the_measurement(measured, ns, calling, expected):
    """A range takes at least ten times as long as a call of threads that are awake."""
    measured(dict.fromkeys(KNOWN, (ns, 1.0)), calling)
    assert used(SOLID, threads=4)[1] == expected


def test_a_stored_calibration_is_not_measured_again(measured, monkeypatch):
    """What the file holds is taken as it is."""
    monkeypatch.setattr(calibration, "_measure", lambda *_: pytest.fail("measured"))
    assert measured(KNOWN, 400.0).least_task == 4e3


@pytest.mark.parametrize(
    "text",
    [
        pytest.param("", id="empty"),
        pytest.param("[]", id="no table"),
        pytest.param('{"widths_ns": 3}', id="no widths"),
        pytest.param(json.dumps(holds_for() | numbers(KNOWN | {"common": (0.0, 1.0)}, 1.0, 1.0)), id="nothing takes no time"),
        pytest.param(json.dumps(holds_for() | numbers(KNOWN, None, 1.0)), id="waking unknown"),
        pytest.param(json.dumps(holds_for() | {"widths_ns": KNOWN, "waking_ns": 1.0}), id="calling unknown"),
        pytest.param(json.dumps(holds_for() | numbers(KNOWN, 1.0, 1.0) | {"processor": "Z80"}), id="another processor"),
        pytest.param(json.dumps(holds_for() | numbers(KNOWN, 1.0, 1.0) | {"version": "0"}), id="another version"),
        pytest.param(json.dumps(holds_for() | numbers({"other": (1.0, 1.0)}, 1.0, 1.0)), id="another set of widths"),
    ],
)
def test_what_does_not_hold_here_is_measured_and_stored(tmp_path, monkeypatch, measured, text):
    """The file then has what was measured."""
    new = Calibration(dict.fromkeys(measured(KNOWN).widths, (7.0, 8.0)), 9.0, 1.0)
    monkeypatch.setattr(calibration, "_measure", lambda *_: new)
    monkeypatch.setenv(CALIBRATION, str(tmp_path / "new" / "calibration.json"))
    stored_at().parent.mkdir()
    stored_at().write_text(text)
    calibrate.cache_clear()
    assert calibrate(open_library()) == new == stored()
    assert [p.name for p in stored_at().parent.iterdir()] == ["calibration.json"]


def test_what_was_not_seen_is_not_stored(tmp_path, monkeypatch, measured):
    """Where no thread found a processor in time the next process measures again; so it is where no file can be written."""
    names = list(measured(KNOWN).widths)
    for waking, calling, name in ((None, 1.0, "none.json"), (5.0, None, "none.json"), (5.0, 1.0, "file/calibration.json")):
        (tmp_path / "file").touch()
        monkeypatch.setenv(CALIBRATION, str(tmp_path / name))
        found = Calibration(dict.fromkeys(names, (7.0, 8.0)), waking, calling)
        monkeypatch.setattr(calibration, "_measure", lambda *_, found=found: found)
        calibrate.cache_clear()
        assert calibrate(open_library()) == found and stored() is None


def test_the_measurement_measures_every_width(tmp_path):
    """The plugin's own measurement, in a process that knows of none: all numbers are there, and it is kept."""
    code = "from mdanim_lammps.engine.plugin import open_library\nopen_library()\n"
    path = tmp_path / "cache" / "calibration.json"
    code += "from mdanim_lammps.engine.calibration import calibrate\nfound = calibrate(open_library())\n"
    code += (
        "print(min(ns for pair in found.widths.values() for ns in pair) > 0.1, (found.waking or 1) > 0 < (found.calling or 1))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, CALIBRATION: str(path)}, capture_output=True, text=True
    )
    assert done.stdout.split() == ["True", "True"], done.stderr
