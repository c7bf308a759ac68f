# SPDX-License-Identifier: GPL-2.0-only
"""The terminal: closed streams, poor encodings, signals, and how a command ends."""

import os
import signal
import subprocess
import sys
import time

import pytest
from mdanim_lammps.errors import ExitCode, OutputError
from mdanim_lammps.terminal import documented_exit

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


def test_another_broken_pipe_is_an_error(capsys):
    """A pipe other than stdout that breaks is told, and is no success."""
    with pytest.raises(SystemExit) as end, documented_exit(debug=False):
        raise BrokenPipeError(32, "Broken pipe")
    assert end.value.code == ExitCode.IO
    assert "Broken pipe" in capsys.readouterr().err


@pytest.mark.parametrize("encoding", ["latin-1", "ascii"])
@pytest.mark.parametrize("command", [["check"], ["check", "--format", "json"]])
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
        "import time\nfrom mdanim_lammps import cli\n"
        "cli.load = lambda *a, **k: (print('ready', flush=True), time.sleep(60))\ncli.main(['check', 'x.txt'])"
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
    """An error after Ctrl-C, as of a library half loaded, is no other fault."""
    for error in (ImportError("half"), OutputError("half"), OSError("half")):
        with pytest.raises(SystemExit) as ended:
            half_loaded(error)
        assert ended.value.code == ExitCode.INTERRUPTED
    assert set(capsys.readouterr().err.splitlines()) == {"mdanim-lammps: interrupted"}


def test_debug_keeps_the_traceback():
    """Let an error through where ``--debug`` is given."""
    with pytest.raises(OutputError), documented_exit(debug=True):
        raise OutputError("disk full")
