# SPDX-License-Identifier: GPL-2.0-only
"""Child processes: they run this program and nothing that lies in the current folder, and speak UTF-8."""

import ast
import os
import signal
import subprocess
import sys
import time
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path

import mdanim_lammps
import pytest
from mdanim_lammps import children
from mdanim_lammps.children import ChildLost, Workers

ROOT = Path(mdanim_lammps.__file__).parent
PROGRAM = "import sys\nfrom mdanim_lammps.__main__ import main\nsys.exit(main())\n"
"""As pip writes the command `mdanim-lammps`."""
SPY = "import os\nwith open(os.environ['SPIES'], 'a') as file:\n    file.write(__name__ + '\\n')\n"
"""A module that tells when it is run."""
SHORT = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object block { shape mesh "cube.stl" scale 0.01  position (0, 0, 0.5) m  density 1000 kg/m^3  elasticity 100 kPa }
object ball { shape sphere 10 cm  position (1, 0, 1) m  density 1000 kg/m^3  elasticity 100 kPa }
let h = 5
control { time 0.1 s  resolution h * 1 cm  frames 30 fps }
render { size (160, 90) }
"""
CUBE = """solid cube
{}endsolid cube
"""


def cube(side: float) -> str:
    """An STL file of a cube."""
    corners = [tuple(side * (n >> k & 1) for k in range(3)) for n in range(8)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    loops = ("".join("vertex {} {} {}\n".format(*corners[n]) for n in t) for t in triangles)
    return CUBE.format("".join(f"facet normal 0 0 0\nouter loop\n{loop}endloop\nendfacet\n" for loop in loops))


@cache
def names() -> set[str]:
    """Modules of Python and of all that is installed."""
    return {*sys.stdlib_module_names, *packages_distributions(), "usercustomize"} - set(sys.builtin_module_names)


class Theirs:
    """A folder with a scene, where a stranger has left a module of every name that Python or this program imports."""

    def __init__(self, folder: Path):
        self.folder, self.log = folder / "theirs", folder / "spies"
        self.folder.mkdir()
        for name in names():
            (self.folder / f"{name}.py").write_text(SPY)
        (self.folder / "scene.txt").write_text(SHORT)
        (self.folder / "cube.stl").write_text(cube(10.0))
        (self.folder / "matplotlibrc").write_text("text.usetex: True\n")
        self.script = folder / "bin" / "mdanim-lammps"
        self.script.parent.mkdir()

    def python(self, text: str, *arguments: object, **more: str) -> str:
        """Run a script that lies elsewhere in the folder; returns what it prints."""
        self.script.write_text(text)
        env = {k: v for k, v in os.environ.items() if k != "PYTHONSAFEPATH"}
        env |= {"SPIES": str(self.log), "PYTHONPATH": str(ROOT.parent), **more}
        done = subprocess.run(
            [sys.executable, str(self.script), *map(str, arguments)],
            cwd=self.folder,
            env=env,
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert not self.log.exists(), self.log.read_text()
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def program(self, *arguments: object, **more: str) -> str:
        """Run the program in the folder."""
        return self.python(PROGRAM, *arguments, **more)


@pytest.fixture
def theirs(tmp_path):
    """The folder."""
    return Theirs(tmp_path)


@pytest.fixture
def theirs_run(theirs):
    """The folder, in which the scene has been run."""
    theirs.program("scene.txt", "--no-movie", "-q")
    return theirs


def test_the_reader_of_meshes_runs_nothing_of_the_folder(theirs):
    """Nor does `check`, which forks for the first steps."""
    assert "0 errors" not in theirs.program("check", "scene.txt")


@pytest.mark.mpi
def test_ranks_run_nothing_of_the_folder(theirs):
    """The supervisor and executors, and the picture of what they did."""
    theirs.program("scene.txt", "-n", "2", "--no-movie", "-q")
    theirs.program("timeline", "scene.out")
    assert (theirs.folder / "scene.out" / "trace.json").exists()


def test_doctor_runs_nothing_of_the_folder(theirs):
    """It starts mpiexec and a process that draws."""
    assert "opengl" in theirs.program("doctor")


def test_the_view_of_a_run_runs_nothing_of_the_folder(theirs_run):
    """The server that `--view` starts beside a run."""
    script = (
        "import sys, threading\nfrom pathlib import Path\nfrom mdanim_lammps.view import beside\n"
        "told = threading.Event()\nbeside.show_address = lambda *words: (print(words[0]), told.set())\n"
        "viewer = beside.Viewer(True)\nviewer.start(Path('scene.out'))\n"
        "told.wait(60)\nviewer._process.terminate()\nviewer._process.wait()\n"
    )
    assert "http://127.0.0.1" in theirs_run.python(script)


def test_a_run_of_the_edited_text_runs_nothing_of_the_folder(theirs_run):
    """The run that a page starts."""
    script = (
        "from pathlib import Path\nfrom mdanim_lammps.view.edit import Editor\nfrom mdanim_lammps.view.tail import Tail\n"
        "editor = Editor(Path('scene.out'), Path('scene.txt'))\n"
        "with Tail(Path('scene.out')) as tail:\n    editor.run(editor.text, tail)\n    print(editor._process.wait())\n"
    )
    assert theirs_run.python(script).split() == ["0"]


def test_processes_that_draw_run_nothing_of_the_folder(theirs_run):
    """Processes that draw a movie run nothing of the folder."""
    script = (
        "from mdanim_lammps.picture.movie import render_movie\nfrom mdanim_lammps.scene.render import Render\n"
        "render_movie('scene.out', Render(size=(160, 90)), 'movie.mp4', processes=2)\n"
    )
    theirs_run.python(script)
    assert (theirs_run.folder / "movie.mp4").exists()


def test_processes_of_a_sweep_run_nothing_of_the_folder(theirs):
    """Each loads LAMMPS and reads the mesh."""
    script = "from mdanim_lammps import Scene\nprint(len(list(Scene.load('scene.txt').sweep({'h': [5, 6]}, processes=2))))\n"
    assert theirs.python(script).split() == ["2"]


def test_a_study_runs_nothing_of_the_folder(theirs):
    """It runs in this process, and draws a plot."""
    theirs.program("study", "scene.txt", "--budget", "8 s", "--ladders", "time step", "-q")
    assert list(theirs.folder.rglob("*.png")), "no plot was drawn"


@pytest.mark.parametrize("named", ["{}:", ":{}", "{}::/nowhere"])
def test_an_empty_part_of_the_path_is_not_the_current_folder(theirs, named):
    """As of ``PYTHONPATH=$UNSET:/opt/lib``. What Python itself loads before a program begins is Python's affair."""
    for name in names():
        if name not in ("argparse", "cyclopts", "multiprocessing", "numpy", "queue", "resource", "scipy", "signal", "subprocess"):
            (theirs.folder / f"{name}.py").unlink()
    theirs.program("check", "scene.txt", PYTHONPATH=named.format(ROOT.parent))


def test_as_a_module_it_leaves_the_current_folder(tmp_path):
    """``python -m`` puts the current folder first on the path, where modules may have names that this program imports late."""
    for name in ("cyclopts", "numpy", "resource", "argparse", "scipy"):
        (tmp_path / f"{name}.py").write_text(SPY)
    log = tmp_path / "spies"
    env = {k: v for k, v in os.environ.items() if k != "PYTHONSAFEPATH"} | {"SPIES": str(log), "PYTHONPATH": str(ROOT.parent)}
    command = [sys.executable, "-m", "mdanim_lammps", "explain", "ground"]
    subprocess.run(command, cwd=tmp_path, env=env, check=True, capture_output=True)
    assert not log.exists(), log.read_text()


# --- the one place ----------------------------------------------------------------------------------------------------

STARTS = {
    *("subprocess", "multiprocessing", "pty", "asyncio", "ProcessPoolExecutor", "runpy", "posix_spawn", "posix_spawnp"),
    *("system", "popen", "fork", "forkpty", "startfile"),
    *(f"{kind}{how}" for kind in ("exec", "spawn") for how in ("l", "le", "lp", "lpe", "v", "ve", "vp", "vpe")),
}
ALLOWED = {
    "children.py": {"subprocess"},
    "cost/forecast.py": {"multiprocessing"},  # forks: no new Python is started
}


def test_processes_are_started_in_one_place():
    """A process of Python started elsewhere would begin in the current folder."""
    found = {str(path.relative_to(ROOT)): started(path) for path in sorted(ROOT.rglob("*.py"))}
    assert {"subprocess", "multiprocessing"} <= set().union(*found.values())
    assert {path: names for path, names in found.items() if not names <= ALLOWED.get(path, set())} == {}


def started(path: Path) -> set[str]:
    """Names of a file that start processes."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {part for a in node.names for part in a.name.split(".")}
        elif isinstance(node, ast.ImportFrom):
            found |= {*(node.module or "").split("."), *(a.name for a in node.names)} if not node.level else set()
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "os":
            found.add(node.attr)
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "sys":
            found |= {"subprocess"} if node.attr == "executable" and path.name not in EXECUTABLE else set()
    return found & STARTS


EXECUTABLE = {"children.py", "doctor.py", "steps.py", "launch.py"}
"""Files that name this Python: to start it, or what lies beside it."""


# --- what they say ------------------------------------------------------------------------------------------------------


def test_children_speak_utf_8(monkeypatch):
    """Whatever the locale."""
    monkeypatch.setenv("LC_ALL", "C")
    monkeypatch.setenv("PYTHONUTF8", "0")
    monkeypatch.setenv("PYTHONCOERCECLOCALE", "0")
    echo = "import sys; text = sys.stdin.read(); print(text); print(text, file=sys.stderr)"
    with children.start([sys.executable, "-c", echo], stdin=children.PIPE, stdout=children.PIPE, stderr=children.PIPE) as child:
        assert child.communicate("→ 10 \N{MICRO SIGN}m") == ("→ 10 µm\n", "→ 10 µm\n")


def test_the_environment_of_children(monkeypatch):
    """Without parts of the path that name the current folder."""
    monkeypatch.setenv("PYTHONPATH", ":/opt/lib::/usr/lib")
    assert children.environment()["PYTHONPATH"] == "/opt/lib:/usr/lib"
    assert children.environment({"A": "1"})["A"] == "1"


# --- processes that share work --------------------------------------------------------------------------------------------


def test_workers_do_their_tasks_in_order():
    """Several processes, results by their futures; what is printed does not get in the way."""
    with Workers(2, begin=(os.putenv, "A", "1")) as workers:
        futures = [workers.submit(pow, 2, n) for n in range(10)]
        assert [f.result() for f in futures] == [2**n for n in range(10)]
        workers.submit(print, "to stderr").result()
        assert len({workers.submit(os.getpid).result() for _ in range(50)} - {os.getpid()}) in (1, 2)


def test_what_workers_fail_of_is_raised():
    """With its type, and where it happened."""
    with Workers(1) as workers:
        with pytest.raises(ZeroDivisionError) as caught:
            workers.submit(divmod, 1, 0).result()
        assert "Traceback" in str(caught.value.__cause__)
        assert workers.submit(divmod, 7, 2).result() == (3, 1)


HALF = """
import os, pickle
for number in range(3, 20):
    try:
        os.write(number, pickle.dumps(9 * ['the beginning'])[:40])
    except OSError:
        pass
"""


def test_a_worker_that_is_killed_is_noticed():
    """Also while it sends, where the rest of its answer does not come; what is asked of it later fails too."""
    for code in ("", HALF):
        with Workers(1) as workers, pytest.raises(ChildLost):
            workers.submit(exec, f"{code}\nimport os\nos._exit(9)").result()
    with Workers(1) as workers:
        with pytest.raises(ChildLost):
            workers.submit(os._exit, 9).result()
        with pytest.raises(ChildLost):
            workers.submit(pow, 2, 2).result()


def test_workers_end_at_once():
    """Begun work is broken off, other work is cancelled, and no process stays."""
    with Workers(2) as workers:
        futures = [workers.submit(time.sleep, 100) for _ in range(5)]
        time.sleep(0.5)
    assert all(child.poll() is not None for child in workers.children)
    assert all(f.cancelled() for f in futures[2:])


def test_ctrl_c_is_for_the_parent_alone():
    """A terminal sends it to all processes of its group; workers go on until their parent ends them."""
    with Workers(1) as workers:
        child = workers.submit(os.getpid).result()
        assert os.getpgid(child) != os.getpgid(0)
        os.kill(child, signal.SIGINT)
        assert workers.submit(pow, 2, 5).result() == 32


def test_a_worker_that_does_not_end_is_killed(monkeypatch):
    """One that ignores SIGTERM has some seconds, and no more."""
    monkeypatch.setattr(children, "ENDING", 0.3)
    with Workers(1) as workers:
        workers.submit(signal.signal, signal.SIGTERM, signal.SIG_IGN).exception()
        workers.submit(exec, "import signal, time\nsignal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])\ntime.sleep(100)")
        time.sleep(0.3)
        child = workers.children[0]
    assert child.wait(10) == -signal.SIGKILL


def test_workers_end_with_their_parent(tmp_path):
    """Which may be killed while they work."""
    script = tmp_path / "parent.py"
    script.write_text(
        "import os, signal, time\nfrom mdanim_lammps.children import Workers\n"
        "workers = Workers(1)\nfuture = workers.submit(os.getpid)\nprint(future.result(), flush=True)\n"
        "workers.submit(time.sleep, 100)\ntime.sleep(0.3)\nos.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=60)
    child = int(done.stdout)
    for _ in range(100):
        if not Path(f"/proc/{child}").exists() or "Z" in Path(f"/proc/{child}/stat").read_text().rsplit(")", 1)[1].split()[0]:
            break
        time.sleep(0.05)
    else:
        pytest.fail("the worker goes on")
