# SPDX-License-Identifier: GPL-2.0-only
"""Commands of bench/ that tests would not notice to be broken."""

import re
import subprocess
import sys

import pytest
from paths import REPOSITORY

BENCH = REPOSITORY / "bench"


def said(code: str) -> str:
    """Output of a line of Python in bench/, in a process of its own."""
    return subprocess.run([sys.executable, "-c", code], cwd=BENCH, check=True, capture_output=True, text=True).stdout


def test_the_start_of_a_run_can_be_measured(tmp_path):
    """The part of bench/around.py that runs in a process of its own succeeds."""
    arguments = f"Path({str(tmp_path)!r}), around.PLAN, around.SCENES / 'float.txt'"
    assert float(said(f"import around; from pathlib import Path; print(around.python({arguments}))")) > 0.0


@pytest.mark.parametrize(
    ("parts", "page"),
    [
        pytest.param("import liquid_tables; print(*liquid_tables.PARTS)", "physics-liquid.md", id="liquid"),
        pytest.param("print('links')", "physics-joints.md", id="links"),
        pytest.param("print('threads')", "decisions/threads.md", id="threads"),
        pytest.param("print('bench processors peers')", "performance.md", id="performance"),
        pytest.param("print('executors threads goals supervisor model')", "beyond-one-host.md", id="scaling"),
    ],
)
def test_tables_have_their_place(parts, page):
    """A page has the two markers of each table that a command writes into it, and what is between them is not empty."""
    text = (REPOSITORY / "docs" / page).read_text(encoding="utf-8")
    for part in said(parts).split():
        assert re.search(rf"^<!-- {part}: written by bench/.* -->\n(?!<!--)[^\0]+?^<!-- end of {part} -->$", text, re.M), part


def test_a_scene_is_compared_with_its_rigid_form():
    """By bench/as_rigid.py: one step a frame of what nothing touches, and the same parabola."""
    row = said("import as_rigid; print(*as_rigid.compared('spin'), sep='|')").split("|")
    assert row[0] == "`spin.txt`" and int(row[1]) > 5000 and int(row[2]) == 60
    assert float(row[6]) < 1e-9 and int(row[7]) == 0


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


def test_the_model_of_threads_has_what_was_measured():
    """Amdahl's law with the two parts that one and two threads show gives back the two; no part is below 0."""
    code = (
        "import scaling_threads as s\n"
        "for two in (0.625, 0.4, 1.2):\n"
        "    split = s.parts({'1': [1.0] * 3, '2': [two] * 3})\n"
        "    print(*split, s.model(split, 1), s.model(split, 2), s.model(split, 1e9))"
    )
    measured, better, worse = ([float(n) for n in line.split()] for line in said(code).splitlines())
    assert measured == pytest.approx([0.25, 0.75, 1.0, 1.6, 4.0], rel=1e-6)
    assert better == pytest.approx([0.0, 1.0, 1.0, 2.0, 1e9], rel=1e-6)
    assert worse == pytest.approx([1.0, 0.0, 1.0, 1.0, 1.0], rel=1e-6)
