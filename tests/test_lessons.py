# SPDX-License-Identifier: GPL-2.0-only
"""Lessons: scenes with a question and an answer, and the page that a run of one becomes."""

import base64
import io
import re
from pathlib import Path

import numpy as np
import pytest
from command_line import call
from mdanim_lammps import Scene
from mdanim_lammps.errors import ExitCode
from mdanim_lammps.picture.plot import span_of
from PIL import Image

SCENES = Path(__file__).parent.parent / "scenes"
LESSONS = sorted((SCENES / "lessons").glob("*.txt"))


@pytest.mark.parametrize("path", LESSONS, ids=lambda path: path.stem)
def test_lesson_meets_its_expectations(path, tmp_path):
    """It asks and answers, shows curves, records, and finds what it expects; nothing warns."""
    scene = Scene.load(path)
    record = scene.record
    assert record.question and record.answer and record.records and record.render.plot
    assert not scene.prepared.warnings
    result = scene.run(tmp_path / "r.out")
    assert result.outcomes and not result.missed, "\n".join(map(str, result.missed))


def test_what_is_as_good_as_constant_is_a_straight_line():
    """On the lesson's page and in movies: rounding of a force of 18.6 N, and of a place 2 m up, is not drawn as a wild curve."""
    assert span_of([np.array([18.56469, 18.56471, np.nan])], "N") == pytest.approx((-0.08 * 18.56471, 1.08 * 18.56471))
    assert span_of([np.array([2.0, 2.0 + 1e-9])], "m") == pytest.approx((2.0 - 0.0116, 2.0 + 0.0116))
    assert span_of([np.array([1.0]), np.array([2.0])], "m") == pytest.approx((0.92, 2.08))
    assert span_of([np.full(2, np.nan)], "J") == pytest.approx((-0.08, 1.08))


TEXT = """
title "A <lesson>"
question "Which one, <script>alert(1)</script>?"
answer "Both & none"
gravity (0, 0, -9.81) m/s^2
object ball { shape sphere 5 cm  position (0, 0, 1) m  mass 1 kg  elasticity rigid  color "#8000c0" }
control { time 0.1 s  frames 20 fps }
record ball.speed
record ball.kinetic
record ball.weight
expect ball.speed at 0.1 s = 0.981 m/s +- 1 %
render { size (64, 48) }
"""


def test_page_of_a_lesson(tmp_path):
    """Question, movie, curves, answer, what was found, also what was missed, and the scene, in one file without a script that
    asks no host."""
    (tmp_path / "fall.txt").write_text(TEXT + "expect ball.speed at 0.1 s > 2 m/s\n")
    said = call("fall.txt", "--lesson", "-q", cwd=tmp_path)
    assert said.returncode == ExitCode.DIVERGED and "MISSED" in said.stderr, said.stderr
    page = (tmp_path / "fall.out" / "lesson.html").read_text()
    assert ">missed<" in page and "A &lt;lesson&gt;" in page and "Both &amp; none" in page and "ball.speed at 0.1 s" in page
    assert "= 0.981 +- 0.00981 m/s<" in page
    assert "<script" not in page and "default-src 'none'" in page and not re.search(r'(src|href)="(?!data:)', page)
    movie, curves = (base64.b64decode(found) for found in re.findall(r'src="data:[a-z/0-9]+;base64,([^"]+)"', page))
    assert movie == (tmp_path / "fall.out" / "movie.mp4").read_bytes() and curves.startswith(b"\x89PNG")
    colors = np.asarray(Image.open(io.BytesIO(curves)).convert("RGB"))
    own = (colors == (0x80, 0x00, 0xC0)).all(axis=2)
    assert own.sum() > 100  # a curve has the colour of its object
    long = np.flatnonzero(own.sum(axis=1) > 500) / len(own)
    assert len(long) and long.min() > 0.67 and long.max() < 0.78  # the weight, constant, is high above 0
    (tmp_path / "silent.txt").write_text(TEXT.replace("question", "# question"))
    refused = call("silent.txt", "--lesson", "-o", "never.out", cwd=tmp_path)  # before it takes any time
    assert refused.returncode == 2 and "silent asks nothing; write question" in refused.stderr
    assert not (tmp_path / "never.out").exists()
    refused = call("lesson", "fall.txt", cwd=tmp_path)
    assert refused.returncode == 2 and "fall.txt --lesson" in refused.stderr
    (tmp_path / "fall.out" / "movie.mp4").unlink()
    said = call("lesson", "fall.out", "--force", cwd=tmp_path)
    assert said.returncode == 0 and "without a movie" in said.stdout, said.stderr
    page = (tmp_path / "fall.out" / "lesson.html").read_text()
    assert "<video" not in page and page.count("data:image/png") == 1
