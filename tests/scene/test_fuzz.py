# SPDX-License-Identifier: GPL-2.0-only
"""Mutilated scenes: whatever is done to a text, it soon gives a Scene or a SceneError, never a traceback."""

import re
import time
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import load_scene, parse_scene
from paths import SCENES

BAD = Path(__file__).parent / "scenes_bad"
FILES = (SCENES / "beam.txt", SCENES / "float.txt", SCENES / "crowd.txt", BAD / "many.txt")
TEXTS = [p.read_text(encoding="utf-8") for p in FILES]
TEXTS.append(lock_text(load_scene(SCENES / "float.txt")))
TOKENS = [re.findall(r"\s+|\w+|.", text) for text in TEXTS]
SPICE = [*'{}()[],=-^*/"# \n\t\0é\u2028', "..", "+-", "1e308", "1e-320", "0", "nan", "inf", "9^9^9", "rand(0, 1)", "mod"]
SPICE += ["m", "kg", "1/s", "let", "let a = 1\n", "repeat", "i in 1 .. 3 {", "include", "object", "control", "expect"]
SPICE += ["auto", "all", "title", "camera", "matrix"]

# A scene takes milliseconds of processor time; a hundred times that is a hang.
LONGEST = 5.0

steady = settings(max_examples=75, derandomize=True, deadline=None)


def survives(text: str) -> None:
    """Read a text; every problem prints, points into its file, and the list is not empty."""
    begin = time.process_time()
    try:
        scene = parse_scene(text, folder=SCENES)
    except SceneError as error:
        assert error.problems
        assert any(p.severity == "error" for p in error.problems)
        assert str(error)
        for p in error.problems:
            assert p.message
            if p.span is not None and p.span.text:
                assert 1 <= p.column <= len(p.span.text) + 1
    else:
        assert parse_scene(lock_text(scene), scene.name) == scene
    assert time.process_time() - begin < LONGEST


@st.composite
def mutilated(draw, pieces):
    """Some pieces of a text deleted, doubled, swapped, or replaced."""
    parts = list(draw(st.sampled_from(pieces)))
    for _ in range(draw(st.integers(1, 6))):
        i = draw(st.integers(0, len(parts) - 1))
        match draw(st.integers(0, 4)):
            case 0:
                parts[i] = ""
            case 1:
                parts[i] *= 2
            case 2:
                j = draw(st.integers(0, len(parts) - 1))
                parts[i], parts[j] = parts[j], parts[i]
            case 3:
                parts[i] = draw(st.sampled_from(SPICE))
            case 4:
                parts[i] += draw(st.sampled_from(SPICE))
    return "".join(parts)


@steady
@given(mutilated(TOKENS))
def test_mutilated_words(text):
    """Words deleted, doubled, swapped, replaced."""
    survives(text)


@steady
@given(mutilated([t.splitlines(keepends=True) for t in TEXTS]))
def test_mutilated_lines(text):
    """Lines deleted, doubled, swapped, replaced."""
    survives(text)


@steady
@given(mutilated([list(t) for t in TEXTS]))
def test_mutilated_characters(text):
    """Characters deleted, doubled, swapped, replaced."""
    survives(text)


@steady
@given(st.sampled_from(TEXTS), st.data())
def test_scene_that_breaks_off(text, data):
    """A text cut at any place."""
    survives(text[: data.draw(st.integers(0, len(text)))])


@steady
@given(st.lists(st.sampled_from(SPICE), max_size=40).map(" ".join))
def test_word_salad(text):
    """Words of the language in no order."""
    survives(text)


@settings(max_examples=150, derandomize=True, deadline=None)
@given(st.binary(max_size=200))
def test_random_bytes(tmp_path_factory, data):
    """A file of random bytes."""
    path = tmp_path_factory.getbasetemp() / "noise.txt"
    path.write_bytes(data)
    try:
        load_scene(path)
    except SceneError as error:
        assert error.problems
    else:
        raise AssertionError("noise was read as a scene")
