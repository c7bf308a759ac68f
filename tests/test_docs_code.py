# SPDX-License-Identifier: GPL-2.0-only
"""Code in tutorial and how-to pages does what the pages say: Python is run, scenes are read, commands are understood."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import run
from mdanim_lammps import Scene
from mdanim_lammps.cli import app
from paths import REPOSITORY

DOCS = REPOSITORY / "docs"
PAGES = [
    DOCS / f"{name}.md"
    for name in (
        "quickstart",
        "install",
        "python",
        "export",
        "pictures",
        "view",
        "accuracy",
        "editors",
        "input-scripts",
        "beyond-one-host",
    )
]
PAGES.append(REPOSITORY / "README.md")
SCENE = """
let h = 0.3
gravity (0, 0, -9.81) m/s^2
object NAME { shape sphere 10 cm position (0, 0, 50) cm mass 1 kg elasticity 300 kPa }
object cube { shape box (10, 10, 10) cm position (h, 0, 1) m mass 1 kg elasticity 300 kPa }
liquid water { basin from (-1, -1, 0) m to (2, 1, 2) m density 1000 kg/m^3 level 30 cm }
control { time 1.1 s  frames 30 fps  resolution 10 cm }
"""


def blocks(page: Path) -> list[tuple[str, str]]:
    """Language and text of each block of code."""
    return re.findall(r"^```(\w*)\n(.*?)^```", page.read_text(encoding="utf-8"), flags=re.S | re.M)


def commands(page: Path) -> list[list[str]]:
    """Words of every line that calls the program, without what a shell does before and after it."""
    found = []
    for line in (
        line for language, text in blocks(page) if not language for line in text.splitlines() if "mdanim-lammps" in line
    ):
        words = shlex.split(line, comments=True)
        while words and "=" in words[0]:
            words = words[1:]
        if words and Path(words[0]).name == "mdanim-lammps":
            end = next((n for n, word in enumerate(words) if word in ("&&", "|", ";")), len(words))
            found.append(words[1:end])
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_commands_are_understood(page):
    """Each command and option of the pages is one that the program has."""
    for words in commands(page):
        if words and "[" not in " ".join(words):
            app.parse_args(words, exit_on_error=False, print_error=False)


def test_there_are_commands():
    """The pages are looked at."""
    assert sum(len(commands(page)) for page in PAGES) > 25
    assert ["export", "beam.out", "--to", "usd"] in commands(DOCS / "export.md")


@pytest.fixture(scope="module")
def workplace(tmp_path_factory):
    """A folder with the scenes and runs that the pages name."""
    place = tmp_path_factory.mktemp("pages")
    for name, ball in (("beam", "beam"), ("drop", "ball"), ("ball", "ball")):
        (place / f"{name}.txt").write_text(SCENE.replace("NAME", ball))
        folder = place / f"{name}.out"
        Scene.load(place / f"{name}.txt").run(folder, executors=2 if name == "drop" else 1)
    (place / "bad.txt").write_text(SCENE.replace("300 kPa", "300 kg").replace("NAME", "ball"))
    subprocess.run(
        [Path(sys.executable).parent / "lmp", "-in", "in.ball"], cwd=place / "ball.out", check=True, capture_output=True
    )
    return place


@pytest.mark.mpi
@pytest.mark.parametrize("page", ["python", "export", "pictures", "trajectory"])
def test_python_runs(page, workplace, monkeypatch):
    """Blocks of a page one after the other; what needs another program is no Python block."""
    monkeypatch.chdir(workplace)
    names = {"text": SCENE.replace("NAME", "ball")}
    found = [text for language, text in blocks(DOCS / f"{page}.md") if language == "python"]
    assert found
    for text in found:
        if "n_particles" in text:  # a note on how to open the file without this package
            names["n_particles"] = Scene.load("beam.txt").prepared.system.particles
            names["MDAnalysis"] = pytest.importorskip("MDAnalysis")
            monkeypatch.chdir(workplace / "beam.out")
        exec(compile(text, f"docs/{page}.md", "exec"), names)
    monkeypatch.chdir(workplace)


def test_the_quickstart(tmp_path):
    """Its scenes are saved under their names and its commands are run, as a newcomer does."""
    page, place = DOCS / "quickstart.md", tmp_path
    scenes = [text for language, text in blocks(page) if not language and "control {" in text]
    for name, text in zip(("ball", "pool"), scenes):
        (place / f"{name}.txt").write_text(text)
    ran = [words for words in commands(page) if words[-1:] != ["--force"]]
    assert len(scenes) == 2 and len(ran) >= 4
    for words in ran:
        done = run(*words, cwd=place)
        assert done.returncode == 0, f"{words}: {done.stdout}{done.stderr}"
    assert (place / "ball.out" / "movie.mp4").exists() and (place / "ball3.out" / "in.ball").exists()
    done = run("pool.txt", "--no-movie", cwd=place)  # "Save it as pool.txt and run"
    assert done.returncode == 0, done.stdout + done.stderr
    script = next(text for language, text in blocks(page) if language == "python")
    subprocess.run([sys.executable, "-c", script], cwd=place, check=True, env={**os.environ})
    lmp = Path(sys.executable).parent / "lmp"
    subprocess.run([lmp, "-in", "in.ball"], cwd=place / "ball3.out", check=True, capture_output=True)


@pytest.mark.parametrize("page", [DOCS / "pictures.md", DOCS / "python.md"], ids=lambda p: p.stem)
def test_scenes_are_read(page):
    """Blocks of the language are valid beside a scene that has what they name."""
    for language, text in blocks(page):
        if not language and text.startswith("render {"):
            Scene.from_text(SCENE.replace("NAME", "ball") + text)


def test_the_site_is_built_without_a_warning(tmp_path):
    """Links to pages and headings, the order of pages, docstrings. Notebooks are run by a test of their own."""
    command = [sys.executable, "-m", "sphinx", "-b", "html", "-q", "-W", "--keep-going", "-D", "nb_execution_mode=off"]
    done = subprocess.run([*command, "-d", tmp_path / "doctrees", DOCS, tmp_path / "html"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    page = (tmp_path / "html" / "api.html").read_text()
    assert "center_of_mass" in page and "sweep" in page
    assert (tmp_path / "html" / "notebooks" / "first-scene.html").exists()
