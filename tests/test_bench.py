# SPDX-License-Identifier: GPL-2.0-only
"""Commands of bench/ that tests would not notice to be broken."""

import re
import subprocess
import sys

import pytest
from paths import REPOSITORY

BENCH = REPOSITORY / "bench"


def said(code: str) -> str:
    """What a line of Python prints in bench/, in a process of its own."""
    return subprocess.run([sys.executable, "-c", code], cwd=BENCH, check=True, capture_output=True, text=True).stdout


def test_the_start_of_a_run_can_be_measured():
    """What bench/around.py runs in a process of its own goes through."""
    assert float(said("import around; print(around.start_up('float', None))")) > 0.0


@pytest.mark.parametrize(
    ("parts", "page"),
    [
        pytest.param("import liquid_tables; print(*liquid_tables.PARTS)", "physics-liquid.md", id="liquid"),
        pytest.param("print('threads')", "decisions/threads.md", id="threads"),
    ],
)
def test_tables_have_their_place(parts, page):
    """A page has the two markers of each table that a command writes into it, and what is between them is not empty."""
    text = (REPOSITORY / "docs" / page).read_text(encoding="utf-8")
    for part in said(parts).split():
        assert re.search(rf"^<!-- {part}: written by bench/.* -->\n(?!<!--)[^\0]+?^<!-- end of {part} -->$", text, re.M), part


def test_the_share_of_the_liquid_can_be_measured():
    """A body that lies still wakes no liquid; one that plunges in does."""
    scene = "edge=6, basin=16, top=16, level=8, model='waves'"
    found = said(f"import liquid; print([liquid.measure(w, 40, **dict({scene}))['updates'] for w in liquid.CASES])")
    plunging, afloat, rest, above = (float(n) for n in found.strip("[]\n").split(","))
    assert plunging > 0.0
    assert afloat > 0.0
    assert rest == above == 0.0


def test_threads_can_be_measured():
    """By bench/threads.py: from a state that one process finds for all, and a scene by its name and size."""
    done = subprocess.run(
        [sys.executable, "threads.py", "1", "2", "float 400", "hail 4"], cwd=BENCH, check=True, capture_output=True, text=True
    )
    rows = [line.split(" | ") for line in done.stdout.splitlines()[4:]]
    assert [row[0] for row in rows] == ["| float 400", "| hail 4"]
    assert all(float(cell) > 0.0 for row in rows for cell in row[1:10])
