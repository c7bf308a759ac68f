# SPDX-License-Identifier: GPL-2.0-only
"""Thousands of scenes made of every word of the language: each is refused with its problems, or read, written and prepared."""

import random
import signal
import time
from contextlib import contextmanager

import pytest
from campaign import rounds
from mdanim_lammps.errors import MdanimError, SceneError
from mdanim_lammps.model.spacing import plan_spacing
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.keywords import KEYWORDS
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene
from word_scenes import scene

READ, PREPARED = 5.0, 30.0
"""Processor seconds that reading and preparing of such a scene may take; a hundredth of that is usual."""
PARTICLES = 20_000
"""Larger scenes are read only."""


@contextmanager
def no_longer_than(seconds: float, text: str):
    """Fail with the text of a scene that hangs."""

    def end(*_):
        raise TimeoutError(f"still at work after {seconds} s with\n{text}")

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, 10.0 * seconds)  # of the wall's clock: others may have the processor
    start = time.process_time()
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert time.process_time() - start < seconds, text


def fate(text: str) -> str:
    """How a scene ends: ``bad text``, ``refused`` or ``prepared``; all else is an error with its text."""
    try:
        with no_longer_than(READ, text):
            read = parse_scene(text, "odd")
            assert parse_scene(lock_text(read), read.name) == read, text
    except SceneError as error:
        assert str(error), text
        assert any(p.severity == "error" and p.message for p in error.problems), text
        return "bad text"
    try:
        with no_longer_than(PREPARED, text):
            if plan_spacing(read).total > PARTICLES:
                return "large"
            ready = prepare(read)
            assert ready.certificate.timestep > 0.0, text
    except MdanimError as error:
        assert str(error), text
        return "refused"
    return "prepared"


def campaign(count: int, seed: int) -> tuple[dict[str, int], set[str]]:
    """How many scenes ended how, and all words that were in them."""
    chance, used, found = random.Random(seed), set(), {}
    for _ in range(count):
        text = scene(chance, used)
        try:
            end = fate(text)
        except Exception as error:
            raise AssertionError(f"{type(error).__name__}: {error}\n{text}") from error
        found[end] = found.get(end, 0) + 1
    return found, used


def test_forty_scenes_of_all_words():
    """Some of each kind."""
    found, used = campaign(40, 1)
    assert found["bad text"] and len(used) > 60


@pytest.mark.soak
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("part", range(10))
def test_ten_thousand_scenes_of_all_words(part):
    """Every word of every block is in them; a good part can be prepared."""
    count = rounds(1000)
    found, used = campaign(count, 100 + part)
    print(found)
    assert count < 300 or used == {f"{block}.{name}" for block, words in KEYWORDS.items() for name in words}
    assert count < 300 or found["prepared"] + found.get("large", 0) > 0.05 * count
