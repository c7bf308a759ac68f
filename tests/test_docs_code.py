# SPDX-License-Identifier: GPL-2.0-only
"""Every block of code in tutorial and how-to pages is run, as a newcomer does who reads them from top to bottom."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import call, inside
from mdanim_lammps import Scene
from mdanim_lammps.cli import app
from paths import REPOSITORY, SCENES

DOCS = REPOSITORY / "docs"
PAGES = [
    name
    for part in (DOCS / "toc.yml").read_text(encoding="utf-8").split("- caption: ")
    if part.startswith(("Tutorial", "How to"))
    for name in re.findall(r"file: (\S+)", part)
    if not name.startswith("notebooks/")  # tests/test_notebooks.py runs them
]
BIN = Path(sys.executable).parent
SCENE = """
let h = 0.3
gravity (0, 0, -9.81) m/s^2
object NAME { shape sphere 10 cm position (0, 0, 50) cm mass 1 kg elasticity 300 kPa }
object cube { shape box (10, 10, 10) cm position (h, 0, 1) m mass 1 kg elasticity 300 kPa }
liquid water { basin from (-1, -1, 0) m to (2, 1, 2) m density 1000 kg/m^3 level 30 cm }
record NAME.speed
control { time 0.4 s  frames 30 fps  resolution 10 cm }
"""
ELSEWHERE = ("git ", "python3 -m venv ", "source ", "make ", "pip ", "cmake ", "LAMMPS_PLUGIN_PATH=", "MDANIM_MPIEXEC=")
"""Lines that need the network, a compiler or other hosts begin so; of the program's own the words are looked at."""
BROWSER = ("view", "--view", "--edit", "--hands")
"""A command with one of these waits for a browser: tests/view runs it."""
LESSON = ("lesson", "--lesson")
"""A command with one of these is of a scene of the repository: tests/test_lessons.py runs it."""


def pieces(page: str) -> list[tuple[str, str, str]]:
    """A page as (text before, language, code) for each of its blocks; the last piece has the text after them."""
    parts = re.split(r"^```(\w*)\n(.*?)^```$", (DOCS / f"{page}.md").read_text(encoding="utf-8") + "```\n```", flags=re.S | re.M)
    return list(zip(*(parts[k::3] for k in range(3))))


def is_scene(code: str) -> bool:
    """Whether a block is written in the scene language."""
    return bool(re.match(r"(#.*\n|title .*\n|let .*\n)*(gravity|object|render|liquid|repeat|joint|expect|record|hands) ", code))


def command(line: str) -> list[str]:
    """Words of a line that calls the program; none of another line."""
    words = shlex.split(line, comments=True)
    while words and re.match(r"\w+=", words[0]):
        words = words[1:]
    return words[1:] if words and Path(words[0]).name == "mdanim-lammps" else []


class Newcomer:
    """Does what a page says, in a folder; pictures are small, and a study is short."""

    def __init__(self, page: str, place: Path):
        self.page, self.place, self.names = page, place, {"text": SCENE.replace("NAME", "ball")}
        self.done, self.runs = [], 0

    def read(self) -> None:
        scene = ""
        for before, language, code in pieces(self.page):
            for name, line in re.findall(r"(?:[Ss]ave it as `(\w+\.txt)`)|(?:run\s+`([^`\n]*mdanim-lammps [^`]*)`)", before):
                if name:
                    small = re.sub(r"^render \{", "render { size (64, 48)", scene, flags=re.M)
                    (self.place / name).write_text(small if small != scene else f"{scene}render {{ size (64, 48) }}\n")
                else:
                    self.shell(line)
            if code:
                scene = code if is_scene(code) else scene
                self.block(language, code)

    def block(self, language: str, code: str) -> None:
        if language == "python":
            small = re.sub(r"size=\(\d+, \d+\)", "size=(64, 48)", code)
            with inside(self.place):
                exec(compile(small, f"docs/{self.page}.md", "exec"), self.names)
        elif language == "json":
            assert json.loads(code)
        elif is_scene(code):
            Scene.from_text(code if "control {" in code else SCENE.replace("NAME", "ball") + code)
        elif code.startswith("compute "):
            self.input_script(code)
        elif code.startswith("import bpy"):
            compile(code, self.page, "exec")  # Blender's own Python is not here
        elif code.startswith("#!/bin/bash"):
            self.job(code)
        elif code.startswith("executor 0 "):
            assert "-->" in code or "==>" in code  # a drawing
        else:
            self.shell(code)

    def shell(self, code: str) -> None:
        """Lines one after the other; the program's commands in this process."""
        place = self.place
        for line in code.splitlines():
            for step in line.split(" && "):
                words = command(step)
                self.done += [words] if words else []
                if step.startswith(ELSEWHERE) or any(word in (*BROWSER, *LESSON) for word in words):
                    if words:
                        app.parse_args(words, exit_on_error=False, print_error=False)
                    break
                if step.startswith("cd "):
                    place = place / step.split()[1]
                elif words:
                    self.program(words, place)
                else:
                    step = re.sub(r"(\.\./)*\.venv/bin/", "", step)
                    home = {"HOME": str(self.place), "PATH": f"{BIN}:{os.environ['PATH']}"}
                    subprocess.run(["bash", "-ec", step], cwd=place, check=True, capture_output=True, env={**os.environ, **home})

    def program(self, words: list[str], place: Path) -> None:
        """A command of the program. A page's first run draws its movie; one after it is drawn by other tests."""
        for option, *values in (("--size", "64", "48"), ("--budget", "9 s")):
            if option in words:
                at = words.index(option) + 1
                words[at : at + len(values)] = values
        if words[0].endswith(".txt"):
            self.runs += 1
            words = [*words, "--no-movie"] if self.runs > 1 and "--force" not in words else words
        ended = call(*words, cwd=place)
        assert ended.returncode == 0, f"{words}: {ended.stdout}{ended.stderr}"

    def job(self, code: str) -> None:
        """A job of a batch system, from its beginning and once more, in a folder with a scene; nothing is submitted."""
        place = self.place / "job"
        (place / "mdanim" / "bin").mkdir(parents=True)
        (place / "mdanim" / "bin" / "activate").write_text("sbatch() { false; }\n")
        (place / "ball.txt").write_text(SCENE.replace("NAME", "ball"))
        (place / "job.sh").write_text(code)
        env = {**os.environ, "HOME": str(place), "PATH": f"{BIN}:{os.environ['PATH']}", "SLURM_NTASKS": "2"}
        ends = [subprocess.run(["bash", "job.sh"], cwd=place, env=env, capture_output=True, text=True) for _ in range(2)]
        assert ends[0].returncode == 0, ends[0].stderr
        assert ends[1].returncode == 4 and "is complete" in ends[1].stderr

    def input_script(self, code: str) -> None:
        """Between the settings and the run of a script that the program has built."""
        head = (self.place / "ball.out" / "in.ball").read_text().split("\nrun ")[0]
        script = f"{head}\ngroup mobile union all\n{code}run 0\n"
        subprocess.run([BIN / "lmp"], input=script, text=True, cwd=self.place / "ball.out", check=True, capture_output=True)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A folder with the scenes and runs that pages name."""
    place = tmp_path_factory.mktemp("pages")
    for name, ball in (("beam", "beam"), ("drop", "ball"), ("ball", "ball")):
        (place / f"{name}.txt").write_text(SCENE.replace("NAME", ball))
        if name != "drop":  # which the page runs itself
            Scene.load(place / f"{name}.txt").run(place / f"{name}.out")
    for name in ("soft", "stiff"):
        shutil.copytree(place / "ball.out", place / f"{name}.out")
    (place / "bad.txt").write_text(SCENE.replace("300 kPa", "300 kg").replace("NAME", "ball"))
    (place / "other-camera.txt").write_text("render { size (64, 48) camera from (3, -4, 2) m look (0, 0, 0) m }\n")
    shutil.copytree(SCENES / "lammps", place, dirs_exist_ok=True)
    (place / ".vscode" / "extensions").mkdir(parents=True)
    lmp = [BIN / "lmp", "-in", "in.ball"]
    subprocess.run(lmp, cwd=place / "ball.out", check=True, capture_output=True)
    return place


@pytest.mark.mpi
@pytest.mark.parametrize("page", PAGES)
def test_page(page, runs, tmp_path):
    """Code of a page, in its order: a tutorial in an empty folder, a how-to beside the runs that it names."""
    newcomer = Newcomer(page, tmp_path if "Save it as" in (DOCS / f"{page}.md").read_text(encoding="utf-8") else runs)
    newcomer.read()
    if page == "quickstart":
        assert len(newcomer.done) >= 6 and (tmp_path / "ball.out" / "movie.mp4").exists()
        assert (tmp_path / "pool.out" / "trajectory.h5").exists() and (tmp_path / "ball3.out" / "ball.lammpstrj").exists()
    if page == "forces":
        assert newcomer.names["momentum"][0] == pytest.approx(newcomer.names["blow"], rel=1e-9)  # sums of other orders
    if page == "export":
        assert ["export", "beam.out", "--to", "usd"] in newcomer.done


def test_python_of_the_trajectory_page(runs, monkeypatch):
    """How the file is read with this package, and without."""
    names = {"n_particles": Scene.load(runs / "beam.txt").prepared.system.particles}
    names["MDAnalysis"] = __import__("MDAnalysis")
    first, second = (code for _, language, code in pieces("trajectory") if language == "python")
    monkeypatch.chdir(runs)
    exec(compile(first, "docs/trajectory.md", "exec"), names)
    monkeypatch.chdir(runs / "beam.out")
    exec(compile(second, "docs/trajectory.md", "exec"), names)


def test_the_readme():
    """Its scene is beam.txt, and its commands are understood."""
    text = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    code = re.findall(r"^```\n(.*?)^```", text, flags=re.S | re.M)
    commands = [words for block in code for line in block.splitlines() if (words := command(line))]
    assert len(commands) > 6
    for words in commands:
        app.parse_args(words, exit_on_error=False, print_error=False)
    assert any(Scene.from_text(block).record.solids for block in code if is_scene(block))


def test_pages_are_looked_at():
    """All of the tutorial and the how-to, and the blocks of each."""
    assert {"quickstart", "export", "pictures", "beyond-one-host"} <= set(PAGES)
    assert sum(bool(code) for page in PAGES for _, _, code in pieces(page)) > 25
