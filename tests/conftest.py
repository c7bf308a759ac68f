# SPDX-License-Identifier: GPL-2.0-only
"""Fixtures that every test may use: small scenes from text, prepared and run."""

import json
import os
import signal
from pathlib import Path

import pytest

# A shell that starts tests in the background has them ignore Ctrl-C, and all processes that they start: tests send it to some.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

SCENES = Path(__file__).parent.parent / "scenes"


WIDTHS = {"avx512": (31.0, 40.0), "avx2": (30.0, 50.0), "common": (50.0, 90.0)}
CALIBRATION = {"widths_ns": WIDTHS, "waking_ns": 1.0, "calling_ns": 3e3}
"""Of the tests: no clock decides which vectors they take nor how many threads. A range has 1000 particles or more, and threads
that sleep are woken at once."""


@pytest.fixture(scope="session", autouse=True)
def calibration(tmp_path_factory):
    """The calibration of all processes of the tests; and they have one thread unless they ask for more."""
    from mdanim_lammps.engine import calibration, threads

    path = tmp_path_factory.mktemp("calibration") / "calibration.json"
    path.write_text(json.dumps(calibration.holds_for() | CALIBRATION))
    os.environ[calibration.CALIBRATION] = str(path)
    os.environ[threads.THREADS] = "1"


@pytest.fixture(scope="session")
def scenes() -> Path:
    """The folder of scenes."""
    return SCENES


@pytest.fixture
def prepared(tmp_path):
    """Make a prepared scene from text."""

    def make(text: str, name: str = "small"):
        from mdanim_lammps.run.prepare import prepare
        from mdanim_lammps.scene.parse import load_scene

        path = tmp_path / f"{name}.txt"
        path.write_text(text, encoding="utf-8")
        return prepare(load_scene(path))

    return make
