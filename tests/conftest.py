# SPDX-License-Identifier: GPL-2.0-only
"""Fixtures that every test may use: small scenes from text, prepared and run."""

import signal
from pathlib import Path

import pytest

# A shell that starts tests in the background has them ignore Ctrl-C, and all processes that they start: tests send it to some.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

SCENES = Path(__file__).parent.parent / "scenes"


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
