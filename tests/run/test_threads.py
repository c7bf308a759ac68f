# SPDX-License-Identifier: GPL-2.0-only
"""Threads of a run: whatever their number, the frames and the ledger are the same; where the number comes from."""

import ctypes
import math
import os
import re
import warnings
from pathlib import Path

import numpy as np
import plugin_path
import pytest
from filming import WIDTHS, ranges, supported
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.cli.options import Executing
from mdanim_lammps.cli.steps import announce
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.threads import (
    LEAST,
    THREADS,
    asked_threads,
    check_threads,
    choose_threads,
    share_of_cores,
    with_threads,
)
from mdanim_lammps.errors import UsageError
from mdanim_lammps.features import effects
from mdanim_lammps.processes import cores, quota
from mdanim_lammps.report import threads_line
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene

TEXT = """
gravity (0, 0, -9.81)
ground z 0
object a { shape box (20, 20, 20) cm position (0, 0, 11) cm density 1000 elasticity 0.2 MPa drag 0.3 damping 0.05 spin (1, 2, 0) }
object b { shape box (16, 16, 16) cm position (0.05, 0, 0.4) density 1000 elasticity 0.2 MPa friction 0.5 }
control { time 0.2 s frames 20 fps resolution 1.4 cm }
"""


@pytest.mark.parametrize("executors", [1, 2])
def test_a_run_does_not_depend_on_threads(tmp_path, executors):
    """Frames and ledger of three threads are those of one, in one process and on executors."""
    (tmp_path / "two.txt").write_text(TEXT)
    scene = Scene.load(tmp_path / "two.txt")
    one = scene.run(tmp_path / "one")
    more = scene.run(tmp_path / "more", executors=executors, threads=3)
    with Trajectory(tmp_path / "one") as a, Trajectory(tmp_path / "more") as b:
        assert len(a) == len(b) == 5
        for frame in range(5):
            assert np.array_equal(a.position(frame), b.position(frame)) and np.array_equal(a.velocity(frame), b.velocity(frame))
    if executors == 1:  # sums over objects of several instances have another order
        columns = {c for row in one.ledger.rows for c in row if "second" not in c}
        assert [{c: row[c] for c in columns} for row in one.ledger.rows] == [
            {c: row[c] for c in columns} for row in more.ledger.rows
        ]


def test_the_environment_tells_the_number(monkeypatch):
    """Nothing where it says nothing; inside of with_threads what that says, and after it what was there before."""
    monkeypatch.delenv(THREADS, raising=False)
    assert asked_threads() is None
    with with_threads(3):
        assert asked_threads() == 3
        with with_threads(None):
            assert asked_threads() == 3
    assert THREADS not in os.environ
    monkeypatch.setenv(THREADS, "2")
    with with_threads(5):
        assert os.environ[THREADS] == "5"
    assert asked_threads() == 2


BLOCK = "object a {{ shape box ({0}, {0}, {0}) cm position (0, 0, 0) density 1000 elasticity 0.2 MPa {1} }}\n"
BLOCK += "control {{ time 0.1 s resolution 1 cm }}\n"


@pytest.mark.parametrize(
    ("edge", "damping", "cores", "asked", "threads", "line"),
    [
        pytest.param(15, "", 2, None, 2, "2 of 2 cores: a pass over 4 096 particles takes 123 us, a thread", id="all cores"),
        pytest.param(15, "", 16, None, 4, "4 of 16 cores", id="no more than pay"),
        pytest.param(9, "", 4, None, 1, "1 of 4 cores: .* 30 us, a thread pays from 1 000 particles on", id="too small"),
        pytest.param(11, "damping 0.1", 4, None, 2, "pays from 750 particles on", id="dashpots take longer"),
        pytest.param(15, "", 1, None, 1, "1: there is one core", id="one core"),
        pytest.param(5, "", 1, "7", 7, "7, as asked for", id="asked for"),
    ],
)
def test_threads_are_taken_where_they_pay(monkeypatch, edge, damping, cores, asked, threads, line):
    """One for each core, but each has as many particles as pay; what is asked for stands. `check` tells which and why."""
    monkeypatch.delenv(THREADS, raising=False)
    if asked:
        monkeypatch.setenv(THREADS, asked)
    choice = choose_threads(prepare(parse_scene(BLOCK.format(edge, damping))).plan, cores)
    assert choice.threads == threads
    assert re.match(f"threads  .*{line}", threads_line(choice))


def test_check_names_the_effects_of_standard_steps(monkeypatch):
    """Whether threads are asked for or not; on one core there is nothing to tell."""
    monkeypatch.delenv(THREADS, raising=False)
    plan = prepare(parse_scene("gravity at 0 s (0, 0, -9.81) gravity at 1 s (0, 0, 0)\nair { }\n" + BLOCK.format(15, ""))).plan
    takes = "with gravity and air on LAMMPS takes its standard steps, of which threads share springs, contact and liquid alone"
    assert threads_line(choose_threads(plan, 2)) == f"threads  2 of 2 cores: {takes}"
    assert "there is one core" in threads_line(choose_threads(plan, 1))
    with with_threads(3):
        assert threads_line(choose_threads(plan, 2)) == f"threads  3, as asked for: {takes}"


def test_a_run_of_which_threads_do_not_share_all_tells_it(monkeypatch, tmp_path, capsys):
    """Asked for by a word of the command line, the environment or an argument."""
    scene = "air {}\n" + BLOCK.format(2, "").replace("time 0.1 s", "time 1 ms frames 1000 fps")
    (tmp_path / "a.txt").write_text(scene)
    line = "threads  2, as asked for: with air on LAMMPS takes its standard steps, of which"
    monkeypatch.delenv(THREADS, raising=False)
    with pytest.warns(UserWarning, match=line):
        Scene.load(tmp_path / "a.txt").run(tmp_path / "b.out", threads=2)
    ready = prepare(parse_scene(scene))
    for asked, environment in ((2, ""), (None, "2"), (None, "")):
        monkeypatch.setenv(THREADS, environment)
        announce(ready, False, False, Executing(threads=asked))
        assert (line in capsys.readouterr().out) == bool(asked or environment)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Scene.load(tmp_path / "a.txt").run(tmp_path / "c.out", threads=1)  # shares nothing


def test_fixes_that_have_no_part_in_passes_are_known():
    """As the plugin's classes have it: those of passes derive from a class of passes/pass_participant.h."""
    standard = {style for e in effects() for form in e.forms if not form.in_passes for _, style in form.styles}
    headers = (Path(__file__).parents[2] / "plugin" / "lammps").glob("fix_mdanim_*.h")
    bases = {path.stem: re.search(r"^class FixMdanim\w+ :([^{]*)", path.read_text(), re.MULTILINE) for path in headers}
    others = {name for name, found in bases.items() if found and "::Pass" not in found[1]}
    assert others == {f"fix_{style.replace('/', '_')}" for style in standard}


def test_the_environment_tells_what_a_thread_is_asked_for(monkeypatch):
    """134 particles where it says nothing; what is not a time is refused."""
    monkeypatch.delenv(THREADS, raising=False)
    plan = prepare(parse_scene(BLOCK.format(15, ""))).plan
    monkeypatch.delenv(LEAST)
    assert choose_threads(plan, 40).pays_from == 134 and choose_threads(plan, 40).threads == 30
    for told in ("0", "-3", "soon", "inf", "nan"):
        monkeypatch.setenv(LEAST, told)
        with pytest.raises(UsageError, match=f"{LEAST} is a time in nanoseconds"):
            choose_threads(plan, 40)


def used(threads: int, style: str = "") -> tuple[str, int]:
    """Width and number of ranges of the passes over a block of 4096 particles."""
    with with_threads(threads), Instance(prepare(parse_scene(BLOCK.format(15, ""))).plan) as instance:
        if style:
            instance.lammps.lmp.command(f"run_style verlet/mdanim {style}")
        instance.setup()
        instance.run(3)
        width = instance.lammps.library.mdanim_width
        width.restype, width.argtypes = ctypes.c_char_p, [ctypes.c_void_p]
        return width(instance.lammps.handle).decode(), ranges(instance)


@pytest.mark.parametrize(("least", "expected"), [(30e3, 4), (60e3, 2), (64e3, 1)])
def test_ranges_follow_what_a_thread_is_asked_for(monkeypatch, least, expected):
    """A range has 1000, 2000 or 2134 particles at least: with the last ones half of all is less."""
    monkeypatch.setenv(LEAST, str(least))
    assert used(4)[1] == expected


def test_passes_take_the_widest_vectors_unless_told(monkeypatch):
    """By the environment, or by the command, which goes before it. One that this processor does not have is refused."""
    here = [width for width in reversed(WIDTHS) if supported(width)]
    assert used(1)[0] == here[0]
    for width in here:
        monkeypatch.setenv("MDANIM_WIDTH", width)
        assert used(1)[0] == width
        assert used(1, f"width {here[0]}")[0] == here[0]
    monkeypatch.setenv("MDANIM_WIDTH", "sse9")
    with pytest.raises(Exception, match="width sse9 is unknown"):
        used(1)


@pytest.mark.parametrize(("edge", "cores", "expected"), [(15, 3, 3), (15, 1, 1), (9, 3, 1)])
def test_an_instance_takes_the_cores_that_pay(monkeypatch, edge, cores, expected):
    """Unless a number is asked for."""
    monkeypatch.delenv(THREADS, raising=False)
    monkeypatch.setattr("mdanim_lammps.engine.threads.cores", lambda: cores)
    with Instance(prepare(parse_scene(BLOCK.format(edge, ""))).plan) as instance:
        instance.setup()
        instance.run(2)
        assert ranges(instance) == expected


class Node:
    """Ranks on one host, as mpi4py tells of them."""

    def __init__(self, *masks):
        self.masks = masks

    def Split_type(self, _):
        return self

    def allgather(self, _):
        return self.masks

    def Free(self):
        pass


@pytest.mark.parametrize(
    ("masks", "quota", "expected"),
    [
        ([{0, 1, 2, 3}], math.inf, 4),
        ([{0, 1, 2, 3}] * 2, math.inf, 2),
        ([{0, 1, 2, 3}] * 3, math.inf, 1),
        ([{0, 1}] * 5, math.inf, 1),
        ([{0, 1}, {2, 3}], math.inf, 2),
        ([{0, 1, 2, 3}, {2, 3}], math.inf, 3),
        ([{0, 1, 2, 3}] * 2, 3.0, 1),
        ([{0, 1, 2, 3}] * 2, 0.5, 1),
    ],
)
def test_ranks_of_a_host_share_its_cores(monkeypatch, masks, quota, expected):
    """Ranks that a launcher has bound to cores have them; a limit of time is for all of them together."""
    monkeypatch.setattr("mdanim_lammps.engine.threads.affinity", lambda: masks[0])
    monkeypatch.setattr("mdanim_lammps.engine.threads.quota", lambda: quota)
    assert share_of_cores(Node(*masks)) == expected


def test_executors_share_the_cores(monkeypatch):
    """Each of two has half, the supervisor none; a number that was asked for stands."""
    monkeypatch.delenv(THREADS, raising=False)
    code = (
        "import os\nfrom mpi4py import MPI\nfrom mdanim_lammps.engine import threads\n"
        "from mdanim_lammps.parallel.runtime.ranks import share_out_cores\n"
        "threads.affinity, threads.quota = (lambda: set(range(6))), (lambda: float('inf'))\n"
        "share_out_cores(MPI.COMM_WORLD)\nos.write(1, f'{MPI.COMM_WORLD.rank} {os.environ.get(threads.THREADS)}\\n'.encode())"
    )
    done = plugin_path.python(code, ranks=3)
    assert sorted(done.stdout.splitlines()) == ["0 None", "1 3", "2 3"], done.stderr
    monkeypatch.setenv(THREADS, "5")
    assert sorted(plugin_path.python(code, ranks=2).stdout.splitlines()) == ["0 5", "1 5"]


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        pytest.param({}, math.inf, id="no groups"),
        pytest.param({"proc/self/cgroup": "0::/\n"}, math.inf, id="no limit"),
        pytest.param({"proc/self/cgroup": "0::/\n", "sys/fs/cgroup/cpu.max": "max 100000\n"}, math.inf, id="max"),
        pytest.param({"proc/self/cgroup": "0::/\n", "sys/fs/cgroup/cpu.max": "150000 100000\n"}, 1.5, id="one and a half"),
        pytest.param(
            {
                "proc/self/cgroup": "0::/a/b\n",
                "sys/fs/cgroup/a/cpu.max": "200000 100000\n",
                "sys/fs/cgroup/a/b/cpu.max": "900000 100000\n",
            },
            2.0,
            id="of the group above",
        ),
        pytest.param(
            {
                "proc/self/cgroup": "5:memory:/x\n4:cpu,cpuacct:/c\n",
                "sys/fs/cgroup/cpu/c/cpu.cfs_quota_us": "300000\n",
                "sys/fs/cgroup/cpu/c/cpu.cfs_period_us": "100000\n",
                "sys/fs/cgroup/cpu/cpu.cfs_quota_us": "-1\n",
                "sys/fs/cgroup/cpu/cpu.cfs_period_us": "100000\n",
            },
            3.0,
            id="the old form",
        ),
        pytest.param({"proc/self/cgroup": "nonsense\n0::/\n", "sys/fs/cgroup/cpu.max": "many\n"}, math.inf, id="nonsense"),
    ],
)
def test_the_limit_of_a_container_counts(tmp_path, files, expected):
    """As the kernel tells it."""
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert quota(tmp_path) == expected


def test_cores_are_those_of_the_mask_within_the_limit(monkeypatch):
    """At least one."""
    monkeypatch.setattr("mdanim_lammps.processes.affinity", lambda: {1, 5, 6})
    for limit, expected in ((math.inf, 3), (2.7, 2), (0.2, 1)):
        monkeypatch.setattr("mdanim_lammps.processes.quota", lambda limit=limit: limit)
        assert cores() == expected


@pytest.mark.parametrize("number", [0, -1, 33, "many", "1.5"])
def test_a_number_that_cannot_be_is_refused(number):
    """Tell what can be."""
    with pytest.raises(UsageError, match=f"a whole number from 1 to 32, not {number}"):
        check_threads(number)
