# SPDX-License-Identifier: GPL-2.0-only
"""The terminal: closed streams, poor encodings, signals, and how a command ends."""

import errno
import io
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
from mdanim_lammps.errors import ExitCode, OutputError, Problem, SceneError, Span
from mdanim_lammps.terminal import Printable, documented_exit, error_line

PROGRAM = [sys.executable, "-m", "mdanim_lammps"]
BALL = """
title "Kula z {title}"
object ball {{
  shape sphere 10 cm
  position (0, 0, 1) m
  density 1000 kg/m^3
  elasticity 100 kPa
}}
control {{ time 0.1 s  resolution 5 cm }}
"""


@pytest.fixture
def scene(tmp_path):
    """Make a scene file with a title."""

    def make(title="gumy"):
        path = tmp_path / "ball.txt"
        path.write_text(BALL.format(title=title), encoding="utf-8")
        return path

    return make


@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-"])
def test_closed_streams(scene, closed):
    """Run with streams closed by the shell: no traceback, and no file of the run takes the number of a stream."""
    path = scene()
    done = subprocess.run(
        ["sh", "-c", f'"$@" {closed}', "sh", *PROGRAM, path, "--no-movie"], capture_output=True, text=True, timeout=100
    )
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    assert (path.parent / "ball.out" / "summary.json").exists()


def test_output_that_nothing_reads(scene):
    """End quietly with 0 when stdout is a pipe whose reader has gone, as after ``| head -1``."""
    process = subprocess.Popen([*PROGRAM, "check", scene()], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.close()
    assert "Error" not in process.stderr.read()
    assert process.wait() == 0


@pytest.mark.parametrize("first", ["warning", "note", "error"])
@pytest.mark.parametrize("span", [Span("a.txt", 3, 7), None], ids=["at a place", "without a place"])
def test_the_first_of_several_problems_may_be_a_warning(first, span):
    """A problem says itself how grave it is: no name of the program and no second word stands before it."""
    told = error_line(SceneError([Problem(span, "friction has no effect", severity=first), Problem(None, "no time")]))
    assert told.startswith(f"a.txt:3:7: {first}: friction" if span else f"{first}: friction") and "mdanim-lammps" not in told


def test_another_broken_pipe_is_an_error(capsys):
    """A pipe other than stdout that breaks is told, and is not a success."""
    with pytest.raises(SystemExit) as end, documented_exit(debug=False):
        raise BrokenPipeError(32, "Broken pipe")
    assert end.value.code == ExitCode.IO
    assert "broken pipe" in capsys.readouterr().err.lower()


def test_a_name_that_is_too_long_is_cut(capsys):
    """It is told with its begin and its end, in one line."""
    with pytest.raises(SystemExit) as end, documented_exit(debug=False):
        os.stat("/tmp/" + 300 * "x")
    said = capsys.readouterr().err
    assert end.value.code == ExitCode.IO and "/tmp/xxx" in said and "...x" in said and len(said) < 200
    assert said.endswith("file name too long; write a shorter name\n")


@pytest.mark.parametrize(("encoding", "command"), [("ascii", ["check"]), ("latin-1", ["check"]), ("ascii", ["check", "--json"])])
def test_characters_that_the_terminal_lacks(scene, encoding, command):
    """Print a title beyond the encoding of stdout with escapes instead of failing."""
    done = subprocess.run(
        [*PROGRAM, *command, scene("żółć → 東京 é")],
        capture_output=True,
        env=os.environ | {"PYTHONIOENCODING": encoding},
        timeout=100,
    )
    assert done.returncode == 0, done.stderr
    assert b"\\u6771" in done.stdout if command == ["check"] else b"objects" in done.stdout


def test_sigterm_is_told(scene):
    """SIGTERM before the run has begun ends with the code of Ctrl-C and a message."""
    code = (
        "import time\nfrom mdanim_lammps import cli\nfrom mdanim_lammps.cli.options import Reading\n"
        "Reading.load = lambda *a, **k: (print('ready', flush=True), time.sleep(60))\ncli.main(['check', 'x.txt'])"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.1)
    process.send_signal(signal.SIGTERM)
    assert process.wait(20) == ExitCode.INTERRUPTED
    assert process.stderr.read() == "mdanim-lammps: interrupted\n"


SIGNAL_WHILE_LOADING = """
import os, sys
class Sender:
    def find_spec(name, path=None, target=None):
        if name == {module!r}:
            os.kill(os.getpid(), {number})
sys.meta_path.insert(0, Sender)
from mdanim_lammps.__main__ import main
main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("module", ["mdanim_lammps.cli", "numpy", "cyclopts", "scipy.spatial", "mdanim_lammps.scene.parse"])
def test_signals_while_it_is_loaded(scene, module, number):
    """End with 130 and a word, never a traceback nor the signal's own end, whatever module is being loaded."""
    script = SIGNAL_WHILE_LOADING.format(module=module, number=int(number))
    done = subprocess.run([sys.executable, "-c", script, "check", scene()], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (ExitCode.INTERRUPTED, "mdanim-lammps: interrupted\n")


def half_loaded(error):
    """Raise an error in a command, after Ctrl-C."""
    from mdanim_lammps import interrupts

    with documented_exit(debug=False):
        interrupts.heard.append(signal.SIGINT)
        raise error


def test_what_follows_an_interrupt_is_its_consequence(capsys):
    """An error after Ctrl-C, as of a library half loaded, is not another fault."""
    for error in (ImportError("half"), OutputError("half"), OSError("half")):
        with pytest.raises(SystemExit) as ended:
            half_loaded(error)
        assert ended.value.code == ExitCode.INTERRUPTED
    assert set(capsys.readouterr().err.splitlines()) == {"mdanim-lammps: interrupted"}


def test_debug_keeps_the_traceback():
    """Let an error through where ``--debug`` is given."""
    with pytest.raises(OutputError), documented_exit(debug=True):
        raise OutputError("disk full")


def test_signs_that_command_a_terminal_are_escaped(tmp_path):
    """Names of files too; what rich draws is drawn."""
    import pty

    name = "a\x1b]0;title\x07\x1b[31m\u202eb.txt"
    (tmp_path / name).write_text(BALL.format(title="x"))
    for words, told in (
        (["check", "missing" + name], r"missinga_x1b]0;title_x07_x1b[31m_x202eb.txt is not there"),
        (["render", name], r"a\x1b]0;title\x07\x1b[31m\u202eb.txt is a file"),
    ):
        ours, theirs = pty.openpty()
        with subprocess.Popen([*PROGRAM, *words], stdout=theirs, stderr=theirs, cwd=tmp_path):
            os.close(theirs)
            said = b""
            with suppress(OSError):  # the end of a terminal
                while piece := os.read(ours, 4096):
                    said += piece
        os.close(ours)
        assert told in said.decode()
    written = io.StringIO()
    stream = Printable(written)
    assert stream.write("a\x1b[2J→\u3000\n\t\udcff") == 10 and written.getvalue() == "a\\x1b[2J→\u3000\n\t\\udcff"
    assert stream.rich_proxied_file is written


def test_a_name_that_is_not_utf_8(tmp_path):
    """Or that has signs that cannot be printed: the scene is called by escapes, and the run can be drawn and resumed."""
    from command_line import GOOD, call

    for name, shown in ((b"k\xff", "k_xff"), (b"k\x1bb", "k_x1bb")):
        path = Path(os.fsdecode(os.path.join(os.fsencode(tmp_path), name + b".txt")))
        path.write_text(GOOD + "render { size (64, 48) }\n")
        for words in (
            ["check", path],
            [path, "--no-movie"],
            ["render", tmp_path / f"{shown}.out"],
            ["report", tmp_path / f"{shown}.out"],
        ):
            done = call(*words)
            assert done.returncode == 0, done.stderr
        assert shown in call("resume", tmp_path / f"{shown}.out").stderr
        path.write_text(GOOD.replace("kPa", "kg"))
        assert f"{shown}.txt:8:" in call("check", path).stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the device is that of Linux")
def test_a_disk_that_is_full_of_words(scene):
    """Where progress cannot be written the run goes on to its end; where results cannot be printed it says so."""
    path = scene()
    with open("/dev/full", "w") as full:
        done = subprocess.run([*PROGRAM, path, "--no-movie"], stdout=subprocess.PIPE, stderr=full, text=True)
        assert done.returncode == 0 and (path.parent / "ball.out" / "summary.json").exists()
        said = subprocess.run([*PROGRAM, "check", path], stdout=full, stderr=subprocess.PIPE, text=True)
    assert said.returncode == ExitCode.IO and "stdout, or a file, cannot be written: No space left" in said.stderr


@pytest.mark.parametrize(
    "error",
    [
        OSError(errno.EMFILE, "Too many open files", "lammps.py"),
        OutputError("run.out: cannot be read as HDF5 (errno = 24, error message = 'Too many open files')"),
        ImportError("libmpi.so.12: cannot open shared object file: Too many open files"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_too_few_open_files_have_a_way_out(error, capsys):
    """The limit is met by the system, a library or the loader."""
    with pytest.raises(SystemExit) as ended, documented_exit(debug=False):
        raise error
    said = capsys.readouterr().err
    assert ended.value.code == ExitCode.ENVIRONMENT and "ulimit -n 1024" in said and "Too many open files" in said
    with pytest.raises(type(error), match="Too many open files"), documented_exit(debug=True):
        raise error


@pytest.mark.parametrize(
    ("files", "executors"), [(8, 1), (12, 1), (22, 1), *(pytest.param(n, 2, marks=pytest.mark.mpi) for n in (20, 30))]
)
def test_few_open_files(scene, files, executors):
    """A message in place of words of libraries, and of an end by MPI."""
    done = subprocess.run(
        ["sh", "-c", f'ulimit -n {files}; "$@"', "sh", *PROGRAM, scene(), "-n", str(executors), "--no-movie", "-q"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == ExitCode.ENVIRONMENT and "ulimit -n 1024" in done.stderr and "UCX" not in done.stderr, done.stderr
