# SPDX-License-Identifier: GPL-2.0-only
"""Help for a newcomer: init, explain, doctor, completion, problems as JSON, colours in editors."""

import json
import re
import subprocess
from dataclasses import replace

import pytest
from command_line import GOOD, call, run
from mdanim_lammps import Scene
from mdanim_lammps.cli import doctor
from mdanim_lammps.scene.explain import MARGINS, explain, words
from mdanim_lammps.scene.grammar import grammar
from mdanim_lammps.scene.keywords import BLOCKS, KEYWORDS, did_you_mean, edits
from paths import REPOSITORY, SCENES


def test_init_writes_a_scene_that_runs(tmp_path):
    """As it is and with its remarks taken out; a second time it is refused."""
    said = call("init", "first", cwd=tmp_path)
    assert said.returncode == 0 and "mdanim-lammps check first.txt" in said.stdout
    text = (tmp_path / "first.txt").read_text()
    (tmp_path / "wet.txt").write_text(re.sub(r"^# (?=liquid|  |\})", "", text, flags=re.M).replace("ground z 0 m", "#"))
    for name in ("first.txt", "wet.txt"):
        checked = call("check", name, "--json", cwd=tmp_path)
        assert checked.returncode == 0, checked.stdout
        assert json.loads(checked.stdout)["problems"] == []
    assert json.loads(checked.stdout)["liquid"]["name"] == "water"
    again = call("init", "first", cwd=tmp_path)
    assert again.returncode == 7 and "first.txt exists; overwrite it with --force" in again.stderr
    assert call("init", "first", "--force", cwd=tmp_path).returncode == 0
    assert call("init", "no/first", cwd=tmp_path).returncode == 7


def test_the_cube_of_init_comes_to_rest(tmp_path):
    """Flat on the ground, near where it fell: the last picture shows it as large as the first."""
    from mdanim_lammps import Trajectory

    assert call("init", "first", cwd=tmp_path).returncode == 0
    assert call("first.txt", "--no-movie", cwd=tmp_path).returncode == 0
    cube = Trajectory(tmp_path / "first.out").objects["cube"]
    x, y, z = cube.center_of_mass[-1]
    assert abs(x) < 0.2 and abs(y) < 0.2 and abs(z - 0.1) < 0.01
    assert abs(cube.velocity[-5:]).max() < 0.05


def test_every_word_is_explained():
    """All blocks, settings and limits; what is said has the form, the unit, the meaning."""
    for name in (
        *BLOCKS,
        *(k for block in KEYWORDS.values() for k in block),
        *MARGINS,
        "kPa",
        "sphere",
        "ball",
        "rigid",
        "draft",
    ):
        assert explain(name)
    said = explain("elasticity")
    assert "elasticity E | spring k | rigid   a setting in object { }" in said and "in Pa, N/m; must be > 0; needed" in said
    assert len(explain("friction").split("\n\n")) == 4  # of objects, of two objects, of joints, of the scene
    assert explain("time_step") == explain("Time Step")
    assert "`" not in "".join(map(explain, words()))
    with pytest.raises(KeyError, match="did you mean 'friction'"):
        explain("frction")


@pytest.mark.parametrize(
    ("word", "told"),
    [
        *((word, "rope from") for word in ("rope", "chain")),
        ("string", "explain rope"),
        ("cloth", "explain sheet"),
        ("rope", "rope from (x0, y0, z0) to"),
        *((word, "write force") for word in ("push", "thrust", "impulse", "addforce")),
        *((word, f"{word} (") for word in ("force", "torque")),
        *((word, "joint hinge") for word in ("wheel", "axle", "engine", "pendulum", "door", "pulley")),
        *((word, "drive velocity") for word in ("belt", "conveyor")),
        *((word, "drive oscillation") for word in ("shake", "vibrate", "wiggle")),
    ],
)
def test_words_of_things_lead_to_what_makes_them(word, told):
    assert told in explain(word)
    assert "not in the language" not in explain(word) or word not in ("rope", "chain", "force", "torque")


def typos(word):
    """A word with one letter missing, doubled, swapped with the next, or wrong."""
    for k in range(len(word)):
        yield word[:k] + word[k + 1 :]
        yield word[:k] + word[k] + word[k:]
        yield word[:k] + word[k + 1 : k + 2] + word[k] + word[k + 2 :]
        yield from (word[:k] + wrong + word[k + 1 :] for wrong in "aeqx")


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.soak)])
def test_typos_are_guessed(every):
    """One wrong letter in a word of three letters or more, each fourth every day: that word, or one that is as near."""
    known = words()
    assert {*BLOCKS, *(k for block in KEYWORDS.values() for k in block)} <= {*known}
    for word in [w for w in known if len(w) > 2][::every]:
        for typo in {*typos(word)} - {*known}:
            hint = did_you_mean(typo, known)
            guess = hint.removeprefix("did you mean '").removesuffix("'?")
            assert guess in known and (guess == word or edits(typo.lower(), guess.lower()) <= 1), f"{typo}: {hint}"
            assert edits(typo, word) <= 1


@pytest.mark.parametrize("word", ["domino", "unicorn", "kettle", "water", "marmalade", "butter"])
def test_no_guess_that_is_far_off(word):
    """A word that the language does not have, and of which no word is a typo."""
    assert did_you_mean(word, words()) == ""
    with pytest.raises(KeyError, match="explain without a word lists all of them"):
        explain(word)


def test_the_beginning_of_a_word_is_guessed():
    """Three letters or more."""
    assert did_you_mean("resol", words()) == "did you mean 'resolution'?"


def test_every_margin_of_the_shipped_scenes_is_explained():
    """No limit that check prints is without a meaning."""

    for name in ("beam", "float", "crowd", "plates"):
        scene = Scene.load(SCENES / f"{name}.txt")
        assert {margin.name for margin in scene.certificate.margins} <= {*MARGINS, *scene.effects}


def test_explain_on_the_command_line():
    """A near word is suggested; without a word all are listed."""
    assert "a unit of pressure" in call("explain", "kPa").stdout
    assert "the bound of each object" in call("explain", "time", "step").stdout
    unknown = call("explain", "elastisity")
    assert unknown.returncode == 2 and "did you mean 'elasticity'" in unknown.stderr
    assert "torus" in call("explain").stdout


def test_completion():
    """The script is one that the shell can read, and knows the commands."""
    script = call("completion", "bash").stdout
    assert "export" in script and "--accuracy" in script
    assert subprocess.run(["bash", "-n"], input=script, text=True).returncode == 0


def test_what_was_a_command_says_where_it_is():
    """A user who types it as before is told what to type."""
    told = call("gallery", "scenes", "-o", "g", "--force")
    assert told.returncode == 2 and "python docs/gallery.py DIR" in told.stderr
    assert "gallery" not in call("--help").stdout


def test_doctor_finds_nothing_wrong_here():
    """Each need is met by what runs these tests."""
    said = run("doctor")
    assert said.returncode == 0, said.stdout
    for words_ in ("plugin     loaded by LAMMPS 20250722, interface", "mpich 5", "opengl", "ffmpeg", "cores", "GB free in"):
        assert words_ in said.stdout


def test_doctor_names_a_cure(monkeypatch, tmp_path):
    """For a plugin that is missing, an mpiexec that is not there, an lmp that does not know the styles."""
    monkeypatch.setattr(doctor.plugin, "_FILE", tmp_path / "mdanimplugin.so")
    monkeypatch.setenv("MDANIM_MPIEXEC", str(tmp_path / "mpiexec"))
    (tmp_path / "lmp").write_text("#!/bin/sh\n")
    (tmp_path / "lmp").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    found = {finding.what: finding for finding in doctor.examine()}
    assert found["plugin"].severity == doctor.FAIL and "is missing" in found["plugin"].found
    assert "pip install" in found["plugin"].cure
    assert found["mpi"].severity == doctor.FAIL and "MDANIM_MPIEXEC" in found["mpi"].cure
    assert found["lmp"].severity == doctor.NOTE and "does not know the styles" in found["lmp"].found
    assert all(f.cure for f in found.values() if f.severity) and not replace(found["python"], severity=0).cure


def test_problems_as_json(tmp_path):
    """Each with its place, for editors; exit codes are those of check."""
    (tmp_path / "bad.txt").write_text(GOOD.replace("100 kPa", "100 kg"))
    bad = call("check", "bad.txt", "--json", cwd=tmp_path)
    (problem,) = json.loads(bad.stdout)["problems"]
    assert bad.returncode == 3 and (problem["file"], problem["line"], problem["severity"]) == ("bad.txt", 8, "error")
    assert problem["column"] > 1 and problem["width"] > 1 and problem["message"] and problem["hint"]
    (tmp_path / "fast.txt").write_text(GOOD.replace("time 0.1 s", "time 0.1 s\n timestep 1 s"))
    fast = call("check", "fast.txt", "--format", "json", cwd=tmp_path)
    assert "note: --format json is an old spelling; write --json" in fast.stderr
    assert fast.returncode == 4 and "certified bound" in json.loads(fast.stdout)["problems"][0]["message"]


def test_the_grammar_for_editors_is_that_of_the_schema():
    """The file in the repository is what the schema makes now."""
    stored = json.loads((REPOSITORY / "editors" / "vscode" / "syntaxes" / "mdanim.tmLanguage.json").read_text())
    assert stored == grammar(), "python -m mdanim_lammps.scene.grammar > editors/vscode/syntaxes/mdanim.tmLanguage.json"


def scopes(line: str) -> dict[str, str]:
    """Pieces of a line with their scopes, found as an editor finds them: the nearest match, of equally near ones the first."""
    patterns, found, at = [(re.compile(p["match"]), p) for p in grammar()["patterns"]], {}, 0
    while hits := [(m.start(), n, m, p) for n, (regex, p) in enumerate(patterns) if (m := regex.search(line, at)) and m.group()]:
        _, _, match, pattern = min(hits, key=lambda hit: hit[:2])
        for group, capture in pattern.get("captures", {"0": {"name": pattern.get("name")}}).items():
            if match[int(group)]:
                found[match[int(group)]] = capture["name"].split(".")[0]
        at = match.end()
    return found


def test_the_grammar_tells_words_apart():
    """Blocks, names, settings, units, shapes, quantities, remarks."""
    assert scopes("  shape sphere 10 cm  # round") == {
        "shape": "keyword",
        "sphere": "constant",
        "10": "constant",
        "cm": "storage",
        "# round": "comment",
    }
    assert scopes("object ball[2] {")["ball[2]"] == "entity"
    assert scopes("let h = 2 kg/m^3")["h"] == "variable"
    assert scopes("expect ball.position.z = 1 +- 0.1")[".position.z"] == "support"
    assert scopes("  contact-stiffness 4")["contact-stiffness"] == "keyword"
    for block in KEYWORDS.values():
        for name in block:
            assert scopes(f" {name} 1").get(name) == "keyword", name


def test_the_problem_matcher_reads_what_check_prints(tmp_path):
    """File, line, column, severity and message of a problem."""
    package = json.loads((REPOSITORY / "editors" / "vscode" / "package.json").read_text())
    pattern = package["contributes"]["problemMatchers"][0]["pattern"]
    (tmp_path / "bad.txt").write_text(GOOD.replace("100 kPa", "100 kg"))
    first = call("check", "bad.txt", cwd=tmp_path).stderr.splitlines()[0]
    file, line, column, severity, message = re.match(pattern["regexp"], first).groups()
    assert (file, line, severity) == ("bad.txt", "8", "error") and int(column) > 1 and "elasticity" in message


@pytest.mark.parametrize(("word", "meant"), [("weight", "mass"), ("rotation", "orientation"), ("duration", "time")])
def test_words_of_other_programs_are_known(word, meant):
    """Where the word that is meant may stand, it is named."""
    assert did_you_mean(word, words()) == f"did you mean '{meant}'?"
    assert meant not in did_you_mean(word, ["density", "radius"])
