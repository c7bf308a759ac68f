# SPDX-License-Identifier: GPL-2.0-only
"""Every scene of scenes/ runs to its end and meets its own expectations."""

import subprocess
import sys
from pathlib import Path

import pytest
from mdanim_lammps import Scene

SCENES = Path(__file__).parent.parent / "scenes"
FRAGMENTS = {"rubber"}
"""Files that scenes include, no scenes themselves."""


@pytest.mark.parametrize("name", sorted({p.stem for p in SCENES.glob("*.txt")} - FRAGMENTS))
def test_scene_meets_its_expectations(name, tmp_path):
    """Run a scene and meet every expect line; there are some. Energies add up to what `accuracy balanced` stands for."""
    result = Scene.load(SCENES / f"{name}.txt").run(tmp_path / f"{name}.out")
    assert result.outcomes, f"{name}.txt has no expect lines"
    assert not result.missed, "\n".join(map(str, result.missed))
    assert result.ledger.residual <= 1e-3


@pytest.mark.parametrize("name", sorted({p.stem for p in SCENES.glob("*.txt")} - FRAGMENTS))
def test_scene_is_within_all_limits(name):
    """No scene that is shown begins with a warning."""
    assert not Scene.load(SCENES / f"{name}.txt").prepared.warnings


def test_demo_scene_checks_from_the_command_line():
    """Check the scene of `make demo` as a user would."""
    done = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", "check", str(SCENES / "beam.txt")], capture_output=True, text=True
    )
    assert done.returncode == 0 and "set by: cube" in done.stdout
