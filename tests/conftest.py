# SPDX-License-Identifier: GPL-2.0-only
"""Fixtures that every test may use: small scenes from text, prepared and run."""

import os
import signal
import sys
from pathlib import Path

import pytest

# A shell that starts tests in the background has them ignore Ctrl-C, and all processes that they start: tests send it to some.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Tests start some hundred Pythons: modules are compiled by the first of them, not by each.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# Ranks poll while they wait for each other. With more of them than cores that takes three times the work itself: let them sleep.
os.environ.setdefault("MPIR_CVAR_CH4_PROGRESS_THROTTLE", "1")
os.environ.setdefault("MPIR_CVAR_CH4_PROGRESS_THROTTLE_NO_PROGRESS_COUNT", "50")
os.environ.setdefault("MPIR_CVAR_ENABLE_HEAVY_YIELD", "1")  # also in collectives

SCENES = Path(__file__).parent.parent / "scenes"


LEAST_TASK = 30e3
"""Least task of the tests [ns]: a range has 1000 particles or more."""


@pytest.fixture(scope="session", autouse=True)
def threads_of_tests():
    """In all processes of the tests: one thread unless they ask for more, and the same share of the work on any machine."""
    from mdanim_lammps.engine import threads

    os.environ[threads.LEAST] = str(LEAST_TASK)
    os.environ[threads.THREADS] = "1"


@pytest.fixture(scope="session", autouse=True)
def meshes_read_here():
    """Mesh files are read by this process: the start of one of their own takes longer than most tests that have a mesh."""
    from mdanim_lammps.model import mesh_contents, mesh_reader

    apart = mesh_reader._read_apart
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mesh_reader, "_read_apart", lambda paths: list(map(mesh_contents.contents, paths)))
        yield apart


@pytest.fixture
def meshes_read_apart(monkeypatch, meshes_read_here):
    """Mesh files are read as they are for users, by a process of its own for each."""
    from mdanim_lammps.model import mesh_reader

    monkeypatch.setattr(mesh_reader, "_read_apart", meshes_read_here)


@pytest.fixture(scope="session")
def scenes() -> Path:
    """The folder of scenes."""
    return SCENES


@pytest.fixture
def prepared(tmp_path):
    """Make a prepared scene from text."""

    def make(text: str, name: str = "small", *, insist: bool = False):
        from mdanim_lammps.run.prepare import prepare
        from mdanim_lammps.scene.parse import load_scene

        path = tmp_path / f"{name}.txt"
        path.write_text(text, encoding="utf-8")
        return prepare(load_scene(path), allow_unstable=insist)

    return make
