# SPDX-License-Identifier: GPL-2.0-only
"""Input scripts with mistakes: plain ``lmp`` ends with an error or runs on, and never with a signal or a hang."""

import random
import re
import shutil
import subprocess

import pytest
from campaign import rounds
from paths import SCENES
from plugin_path import BIN, environment

ODD = (
    *("0", "-1", "1e308", "nan", "inf", "x", "99999999999", "0.5", "v_none", "NULL", "all", "none", ""),
    *("plane", "objects", "bodies", "pair", "stiffness 0", "friction -1", "damping 1e9", "every 0", "energy"),
)
SECONDS = 60.0
"""Limit for a script of 50 steps [s]."""
SIGNALS = "(Segmentation|Aborted|terminate called|Floating point exception|Bus error|double free|corrupted)"


def misused(text: str, chance: random.Random) -> str:
    """A script with one to three lines changed, those of this package's styles first."""
    lines = text.splitlines()
    ours = ("fix_modify", "set ", "bond_coeff", "run_style")
    own = [n for n, line in enumerate(lines) if "mdanim" in line or line.startswith(ours)]
    for _ in range(chance.choice((1, 1, 2, 3))):
        n = chance.choice(own if chance.random() < 0.8 else range(len(lines)))
        words = lines[n].split("#")[0].split()
        if not words:
            continue
        i = chance.randrange(len(words))
        match chance.randrange(6):
            case 0:
                words[i] = chance.choice(ODD)
            case 1:
                del words[i]
            case 2:
                words.insert(i, chance.choice(ODD))
            case 3:
                words = words[:i]
            case 4:  # before what it needs, or after what needs it
                lines.insert(chance.randrange(len(lines)), lines[n])
                continue
            case 5:
                words += [chance.choice(ODD), chance.choice(ODD)]
        lines[n] = " ".join(words)
    return "\n".join(lines) + "\n"


def check(name: str, place, seed: int) -> int:
    """Run a misused script; its exit code."""
    place.mkdir()
    text = misused((SCENES / "lammps" / f"in.{name}").read_text(), random.Random(seed))
    (place / "in.odd").write_text(text)
    for body in (SCENES / "lammps").glob("contact.*"):
        shutil.copy(body, place)
    command = [BIN / "lmp", "-in", "in.odd", "-log", "none", "-nocite", "-var", "steps", "50"]
    options = {"capture_output": True, "text": True, "errors": "replace", "timeout": SECONDS}
    ended = subprocess.run(command, cwd=place, env=environment(), **options)
    said = ended.stdout + ended.stderr
    told = f"seed {seed}: {ended.returncode}\n{said[-1500:]}"
    assert ended.returncode >= 0 and not re.search(SIGNALS, said), told
    assert ended.returncode == 0 or "ERROR" in said, told
    return ended.returncode


SCRIPTS = ("two_cubes", "pool", "bowl", "cantilever", "two_blocks")


def test_a_misused_script(tmp_path):
    """One, for every day."""
    check("two_cubes", tmp_path / "one", 4)


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("name", SCRIPTS)
def test_a_hundred_misused_scripts(tmp_path, name):
    """Twenty of each of five; a good part is refused."""
    count = rounds(20)
    codes = [check(name, tmp_path / f"{seed}", 1000 + seed) for seed in range(count)]
    assert count < 10 or sum(code != 0 for code in codes) > count // 4
