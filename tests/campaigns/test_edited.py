# SPDX-License-Identifier: GPL-2.0-only
"""Hundreds of texts to a server that may edit: each is answered soon, and the server lives on."""

import json
import random

import pytest
from campaign import rounds
from mdanim_lammps import Scene
from mdanim_lammps.view.edit import Editor
from scene_texts import FALL
from view_lab import page, served
from word_scenes import ODD, mutilated, scene

SECONDS = 60.0
"""In which a text is answered on a busy machine; usually in a tenth of a second."""
LONG = 200_000


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A finished run."""
    place = tmp_path_factory.mktemp("edited")
    (place / "fall.txt").write_text(FALL)
    return Scene.load(place / "fall.txt").run().folder


def text_of(chance: random.Random) -> str:
    """Text of all words, mutilated, word salad, noise, long or empty."""
    match chance.randrange(6):
        case 0 | 1:
            return scene(chance, set())
        case 2:
            return mutilated(FALL, chance)
        case 3:
            return " ".join(chance.choices(ODD, k=chance.randrange(60)))
        case 4:
            return "".join(chr(chance.choice((chance.randrange(32, 127), chance.randrange(0xD800), 0xD800))) for _ in range(200))
        case _:
            return chance.choice(("", "\n" * 1000, "object a {" * 500, FALL * 20, "x" * LONG, f"let a = {'(' * 2000}"))


def campaign(folder, count: int, seed: int) -> None:
    """Send texts one after the other; whatever they are, the next one is answered, and the right text has no problems."""
    chance = random.Random(seed)
    with served(folder, editor=Editor(folder, folder.parent / "fall.txt")) as view, page(view) as link:
        for k in range(count):
            text = text_of(chance)
            link.send(json.dumps({"edit": text}))
            answer = _answer(link)
            assert isinstance(answer.get("problems"), list) and answer["started"] is False, (k, text[:2000], answer)
        link.send(json.dumps({"edit": FALL}))
        assert _answer(link)["problems"] == []
    assert (folder.parent / "fall.txt").read_text() == FALL


def _answer(link) -> dict:
    """The next message that is not news of the run."""
    while True:
        said = link.recv(SECONDS)
        if isinstance(said, str) and "news" not in (found := json.loads(said)):
            return found


def test_ten_texts(folder):
    """For every day."""
    campaign(folder, 10, 1)


@pytest.mark.soak
@pytest.mark.timeout(3600)
def test_three_hundred_texts(folder):
    """None is left without an answer."""
    campaign(folder, rounds(300), 2)
