# SPDX-License-Identifier: GPL-2.0-only
"""Every scene of scenes/ runs to its end and meets its own expectations."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from mdanim_lammps import Scene
from mdanim_lammps.scene.parse import load_scene

SCENES = Path(__file__).parent.parent / "scenes"
FRAGMENTS = {"rubber"}
"""Files that scenes include, no scenes themselves."""


NAMES = sorted({p.stem for p in SCENES.glob("*.txt")} - FRAGMENTS)
LONG = {
    "balls": (0.25, False),
    "barge": (0.3, True),
    "billiard": (0.5, False),
    "biscuit": (0.25, True),
    "blocks": (0.1, False),
    "boat": (0.5, False),
    "bottle": (0.4, False),
    "bowling": (0.25, False),
    "bridge": (0.2, True),
    "buggy": (0.5, False),
    "cards": (0.15, False),
    "chairs": (0.5, False),
    "clay": (0.28, False),
    "cloth": (0.3, True),
    "crowd": (0.25, True),
    "densities": (1.2, False),
    "dominoes": (0.8, False),
    "double": (0.5, True),
    "drawbridge": (0.5, False),
    "flag": (0.5, False),
    "glide": (0.4, False),
    "hammock": (0.2, True),
    "hats": (0.3, False),
    "helter": (1.5, False),
    "henge": (0.3, False),
    "hollow": (0.3, False),
    "jenga": (0.46, False),
    "mattress": (0.05, False),
    "merry": (0.6, False),
    "newton": (0.66, True),
    "paddle": (0.5, True),
    "parachute": (1.1, False),
    "pegs": (1.0, False),
    "pile": (0.25, False),
    "plates": (0.2, True),
    "race": (0.3, False),
    "rack": (0.4, True),
    "ripples": (0.3, False),
    "spiral": (0.8, False),
    "splash": (1.5, False),
    "swing": (0.8, False),
    "tackle": (0.03, False),
    "trampoline": (0.6, False),
    "utube": (1.5, False),
    "vessels": (1.5, False),
    "wake": (0.6, True),
    "wall": (0.3, True),
    "weir": (1.5, False),
    "windmill": (0.2, False),
    "wrecking": (0.4, False),
}
"""Scenes of two seconds of work and more: up to when they are always run [s], and whether what is expected of the end holds
then already; to their end they are run with `make soak`."""


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.soak if name in LONG else ()) for name in NAMES])
def test_scene_meets_its_expectations(name, tmp_path):
    """Run a scene and meet every expect line; there are some. Energies add up to what `accuracy balanced` stands for."""
    meets_its_expectations(Scene.load(SCENES / f"{name}.txt"), tmp_path / f"{name}.out")


def meets_its_expectations(scene: Scene, folder: Path) -> None:
    """Run it and look at what it expects; no scene that is shown begins with a warning."""
    assert not scene.prepared.warnings
    result = scene.run(folder)
    assert result.outcomes, "no expect lines"
    assert not result.missed, "\n".join(map(str, result.missed))
    assert result.ledger.residual <= 1e-3


@pytest.mark.parametrize("name", LONG)
def test_a_long_scene_begins_as_expected(name, tmp_path):
    """Meet what is expected until then, and what holds then of what is expected of the end: of energies and of the liquid's
    volume it always does."""
    whole, (seconds, holds) = load_scene(SCENES / f"{name}.txt"), LONG[name]
    early = tuple(e for e in whole.expects if e.quantity == "residual" or (holds if e.time is None else e.time < seconds))
    scene = replace(whole, expects=early, control=replace(whole.control, time=seconds))
    meets_its_expectations(Scene(scene), tmp_path / f"{name}.out")


def test_demo_scene_checks_from_the_command_line():
    """Check the scene of `make demo` as a user would."""
    done = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", "check", str(SCENES / "beam.txt")], capture_output=True, text=True
    )
    assert done.returncode == 0 and "set by: cube" in done.stdout
