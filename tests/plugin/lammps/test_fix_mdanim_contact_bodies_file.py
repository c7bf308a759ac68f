# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/contact: bodies from a table of text, and what is refused in it, with file and line."""

import re
from dataclasses import replace
from types import SimpleNamespace

import contact_lab
import plugin_path
import pytest
from contact_lab import Cuboid, State, load
from mdanim_lammps.engine.data_file import bodies_text

PAIR = (Cuboid((1, 2, 2), friction=0.4, velocity=(0, 0, 0.05)), Cuboid((2, 1, 1), (0.2, 0.1, 1.52), 1.0, friction=0.4))
TEXT = "".join(bodies_text({n: SimpleNamespace(**one.arrays) for n, one in enumerate(PAIR)}))
LINES = TEXT.splitlines()


def with_file(folder, text):
    """An instance whose fix reads this text."""
    (folder / "bodies").write_text(text)
    return load(PAIR, folder, f"objects bodies {folder}/bodies", 0.15, give=False)


def test_bodies_of_a_file_give_the_bits_of_those_handed_over(tmp_path):
    """Also with comments, and with all words in one line."""
    lmp = load(PAIR, tmp_path, "objects", 0.15)
    lmp.command("run 20 pre no post no")
    expected = State.of(lmp)
    assert contact_lab.contacts(expected.contacts)
    lmp.close()
    for text in (TEXT, TEXT.replace("\n", "  # comment 1 2\n"), " ".join(line.partition("#")[0] for line in LINES)):
        lmp = with_file(tmp_path, text)
        lmp.command("run 20 pre no post no")
        assert State.of(lmp).same(expected)
        lmp.close()


def test_a_rigid_body_of_a_file_has_the_bits_of_one_handed_over(tmp_path):
    """Its frame in place of places of particles."""
    pair = replace(PAIR[0], velocity=(0, 0, 0), held=True, rigid=True), replace(PAIR[1], velocity=(0, 0, -0.05))
    states = []
    (tmp_path / "bodies").write_text("".join(bodies_text({n: SimpleNamespace(**one.arrays) for n, one in enumerate(pair)})))
    for give in (True, False):
        lmp = load(pair, tmp_path, f"objects bodies {tmp_path}/bodies" if not give else "objects", 0.15, give=give)
        lmp.command("run 20 pre no post no")
        states.append(State.of(lmp))
        lmp.close()
    assert contact_lab.contacts(states[0].contacts) and states[1].same(states[0])


def at(pattern: str, nth: int = 0) -> int:
    """The index of a line."""
    return [n for n, line in enumerate(LINES) if re.match(pattern, line)][nth]


BAD = {
    "other word": (at("edge"), "edges 1 1 1", "'edge' is needed here, got 'edges'"),
    "no number": (at("edge"), "edge 1 x 1", "an edge of the cells must be a number, got 'x'"),
    "no whole number": (at("cells"), "cells 1 2.5 2", "a count of cells must be a whole number, got '2.5'"),
    "far too many particles": (at("particles"), "particles 2000000000", "the rest of the file cannot hold 2000000000 particles"),
    "less than none": (at("points"), "points -1", "the rest of the file cannot hold -1 points"),
    "far too many points": (at("points"), "points 100000", "the rest of the file cannot hold 100000 points"),
    "other cells": (at("filled"), "filled 5", "a body of these counts has another number of cells"),
    "other depths": (at("depth"), "depth 3", "a body of these counts has another number of depths"),
    "other open parts": (at("open"), "open -1", "the rest of the file cannot hold -1 open parts of sides"),
    "unknown kind": (
        at("points") + 1,
        re.sub(r"^(\d+) \d", r"\1 7", LINES[at("points") + 1]),
        "the kind of a point is 0, 1, 2 or 3",
    ),
    "not a body": (at("body", 1), "boby 1", "'body' and its number are needed here, got 'boby'"),
    "twice": (at("body", 1), "body 0", "the number of a body is at least 0 and comes once"),
    "no length": (at("edge"), "edge 1 0 1", "an edge of the cells is not a length"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_mistake_is_told_with_its_line(tmp_path, name):
    """One line is another one."""
    n, line, why = BAD[name]
    # A mistake of a body as a whole is reported at its beginning.
    told = at("body") + 1 if name == "no length" else n + 1
    text = "\n".join([*LINES[:n], line, *LINES[n + 1 :]])
    with pytest.raises(Exception, match=re.escape(f"bodies:{told}: ") + ".*" + re.escape(why)):
        with_file(tmp_path, text)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.2, 0.45, 0.7, 0.9])
def test_a_file_that_is_cut_off_is_refused(tmp_path, share):
    """The message names the file and the last line."""
    with pytest.raises(Exception, match=r"bodies:\d+: "):
        with_file(tmp_path, TEXT[: int(share * len(TEXT))])


def test_no_file_is_refused(tmp_path):
    """One that is not there, and a folder."""
    for name in ("none", "."):
        with pytest.raises(Exception, match="cannot read the bodies in"):
            load(PAIR, tmp_path, f"objects bodies {tmp_path}/{name}", give=False)


@pytest.mark.mpi
def test_a_mistake_ends_all_ranks(tmp_path):
    """No rank waits for the others."""
    (tmp_path / "in.bad").write_text(
        "units lj\natom_style bond\natom_modify map array\nnewton off\nboundary s s s\nregion r block 0 1 0 1 0 1\n"
        "create_box 1 r\nfix a all mdanim/contact 0 1 0 objects bodies bad\n"
    )
    (tmp_path / "bad").write_text("body 0\ncells 1 1\n")
    done = plugin_path.lmp(tmp_path / "in.bad", 2, timeout=60)
    assert done.returncode != 0 and "bad:3: a count of cells must be a whole number, the file ends" in done.stdout + done.stderr
