# SPDX-License-Identifier: GPL-2.0-only
"""How a problem is printed: place, message, source line, caret, way out, include chain."""

import pytest
from command_line import GOOD, call
from mdanim_lammps import Scene
from mdanim_lammps.errors import ExitCode, MdanimError, OutputError, Problem, SceneError, Span, for_a_shell, in_python

LINE = "      mass       1.5 kgg"


def test_problem_prints_as_the_interface_says():
    """Print the example of the interface page letter by letter."""
    problem = Problem(Span("crowd.txt", 12, 22, 3, LINE), "'kgg' is not a unit of mass", "did you mean 'kg'?")
    assert str(problem) == (
        "crowd.txt:12:22: error: 'kgg' is not a unit of mass\n"
        "   12 |       mass       1.5 kgg\n"
        "      |                      ^~~  did you mean 'kg'?"
    )


@pytest.mark.parametrize(("line", "column", "width", "below"), [
    pytest.param("ab cd", 4, 2, "    ^~".replace("    ", "   ", 1), id="two letters"),
    pytest.param("\tab", 2, 2, "\t^~", id="a tab stays a tab"),
    pytest.param("ab", 3, 1, "  ^", id="the end of the line"),
    pytest.param("ab", 1, 99, "^~", id="no wider than the line"),
    pytest.param("ab", 1, 0, "^", id="at least one sign"),
])  # fmt: skip
def test_caret_stands_below_its_word(line, column, width, below):
    """Put the caret under the word whatever stands before it."""
    caret = str(Problem(Span("s", 1, column, width, line), "m")).split("\n")[2]
    assert caret == "      | " + below


def test_long_line_is_cut_around_the_caret():
    """Show 100 signs of a long line, the bad word among them."""
    text = "a" * 400 + "BAD" + "b" * 400
    _, line, caret = str(Problem(Span("s", 1, 401, 3, text), "m")).split("\n")
    assert len(line) < 120
    assert line[caret.index("^") : caret.index("^") + 3] == "BAD"


def test_a_word_without_end_is_cut():
    """A file of 1 MB without a space is not printed back."""
    message = str(Problem(None, f"unknown word '{'x' * 10**6}'; a file of scenes begins with object", "the way out"))
    assert message.startswith("error: unknown word 'xxx") and "xxx... (1000003 characters) a file" in message
    assert len(message) < 200


def test_control_signs_are_not_printed():
    """Keep escape sequences of a hostile file out of the terminal."""
    assert "\x1b" not in str(Problem(Span("s", 1, 1, 1, "\x1b[2Jmass"), "m"))


def test_include_chain_is_shown_inside_out():
    """Name the including lines, the nearest first."""
    chain = (Span("main.txt", 3, 1), Span("a.txt", 7, 1))
    text = str(Problem(Span("b.txt", 1, 1, 1, "x", chain), "m"))
    assert text.endswith("included from a.txt:7:1\n        included from main.txt:3:1")


def test_problem_without_place_keeps_its_hint():
    """A problem of the command line has a message and a way out, and no picture."""
    problem = Problem(None, "the scene has no 'let x'", "did you mean 'y'?")
    assert str(problem) == "error: the scene has no 'let x'\n  did you mean 'y'?"
    assert (problem.file, problem.line, problem.column) == ("", 0, 0)


def test_scene_error_prints_every_problem():
    """Join all problems in one message and leave with the code for scenes."""
    error = SceneError([Problem(None, "one"), Problem(None, "two", severity="warning")])
    assert str(error) == "error: one\nwarning: two"
    assert error.exit_code is ExitCode.SCENE
    assert isinstance(error, MdanimError)


@pytest.mark.parametrize(
    ("shell", "python"),
    [
        (
            "a.out exists; overwrite it with --force, or write elsewhere with -o DIR",
            "a.out exists; overwrite it with force=True, or write elsewhere",
        ),
        ("-o x.mp4: there is no folder y; make it first", "x.mp4: there is no folder y; make it first"),
        ("--force does not delete them: name another with -o", "force=True does not delete them: name another"),
        ("start afresh with --force or another -o folder", "start afresh with force=True or another folder"),
        ("name NAME.out beside NAME.txt or what -o said", "name NAME.out beside NAME.txt or what `run` was given"),
        ("-n 70: this machine has 2 cores; write -n 2", "executors=70: this machine has 2 cores; write executors=2"),
        ("--frames 5:None: the run has frames 0 to 4", "frames=slice(5, None): the run has frames 0 to 4"),
        (
            "take fewer frames (--every 4) or objects (--objects), or --to usd",
            "take fewer frames (every=4) or objects (objects=...), or 'usd'",
        ),
        ("--set h: the scene has no 'let h'", "h: the scene has no 'let h'"),
        ("with 'mdanim-lammps study S --budget 9', or --no-movie", "with 'mdanim-lammps study S --budget 9', or movie=False"),
        (
            "s.txt:1:3: error: what\n    1 | let a = b -n 2\n      |         ^  --force",
            "s.txt:1:3: error: what\n    1 | let a = b -n 2\n      |         ^  force=True",
        ),
    ],
)
def test_messages_name_options_as_they_are_written(shell, python):
    """In Python as Python has them; what is for a shell, and lines of a scene, stay."""
    assert in_python(shell) == python
    assert str(OutputError(shell)) == python and OutputError(shell).told() == shell
    before = for_a_shell()
    try:
        assert str(OutputError(shell)) == shell
    finally:
        for_a_shell(before)


def test_a_command_speaks_as_a_shell_and_python_as_python(tmp_path):
    """Both use the same folder, one after the other in one process."""
    (tmp_path / "good.txt").write_text(GOOD)
    scene = Scene.load(tmp_path / "good.txt")
    scene.run()
    said = call(tmp_path / "good.txt").stderr
    with pytest.raises(OutputError) as caught:
        scene.run()
    assert "overwrite it with --force" in said and "overwrite it with force=True, or write elsewhere" in str(caught.value)
