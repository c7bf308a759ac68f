# SPDX-License-Identifier: GPL-2.0-only
"""Memory that runs out, in containers and below limits of a shell, is told as such."""

import resource
import subprocess
import sys

import pytest
from mdanim_lammps.errors import ExitCode, OutputError, SceneError, SetupError, out_of_memory
from mdanim_lammps.processes import available_memory
from mdanim_lammps.run import prepare as preparing
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.terminal import documented_exit

GB = 10**9
V2, V1 = "sys/fs/cgroup/", "sys/fs/cgroup/memory/"


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        pytest.param({}, None, id="no groups"),
        pytest.param(
            {"proc/self/cgroup": "0::/\n", V2 + "memory.max": "max\n", V2 + "memory.current": "5\n"}, None, id="no limit"
        ),
        pytest.param(
            {"proc/self/cgroup": "0::/\n", V2 + "memory.max": "3000000\n", V2 + "memory.current": "1000000\n"}, 2e6, id="its own"
        ),
        pytest.param(
            {
                "proc/self/cgroup": "0::/user.slice/job\n",
                V2 + "user.slice/memory.max": "9000000\n",
                V2 + "user.slice/memory.current": "8000000\n",
                V2 + "user.slice/job/memory.max": "7000000\n",
                V2 + "user.slice/job/memory.current": "1000000\n",
            },
            1e6,
            id="of the group above",
        ),
        pytest.param(
            {
                "proc/self/cgroup": "0::/job\n",
                V2 + "job/memory.max": "7000000\n",
                V2 + "job/memory.current": "6000000\n",
                V2 + "job/memory.stat": "anon 1\ninactive_file 2000000\n",
            },
            3e6,
            id="files that are kept give way",
        ),
        pytest.param(
            {
                "proc/self/cgroup": "7:cpu,cpuacct:/c\n4:memory:/docker/x\n0::/\n",
                V1 + "docker/x/memory.limit_in_bytes": "4000000\n",
                V1 + "docker/x/memory.usage_in_bytes": "500000\n",
                V1 + "memory.limit_in_bytes": "9223372036854771712\n",
                V1 + "memory.usage_in_bytes": "500000\n",
            },
            3.5e6,
            id="the old form",
        ),
        pytest.param(
            {"proc/self/cgroup": "nonsense\n0::/\n", V2 + "memory.max": "much\n", V2 + "memory.current": "1\n"},
            None,
            id="nonsense",
        ),
        pytest.param({"proc/self/cgroup": "0::/\n", V2 + "memory.max": "5\n", V2 + "memory.current": "9\n"}, 0.0, id="over it"),
    ],
)
def test_the_least_limit_counts(tmp_path, files, expected):
    """As the kernel tells it, on the way from the own group to the root."""
    (tmp_path / "proc").mkdir()
    (tmp_path / "proc/meminfo").write_text("MemTotal: 99 kB\nMemAvailable: 10000000 kB\n")
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    found = available_memory(tmp_path)
    assert found == expected if expected is not None else found > 1e8


def test_a_limit_of_the_shell_counts():
    """With a limit of 2 GB, between 1 and 2 GB are free."""
    code = "import mdanim_lammps.processes as p; print(p.limited(), p.available_memory())"
    run = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (2 * GB, 2 * GB)),
    )
    limited, free = run.stdout.split()
    assert limited == "True" and 1e9 < float(free) < 2e9


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        SetupError(
            "the plugin could not insert 9 particles: ERROR on proc 0: Failed to reallocate 5111808 bytes for array atom:f"
        ),
        SetupError("LAMMPS, MPI or the plugin cannot be loaded: liblammps.so: failed to map segment from shared object"),
        ImportError("vtkRenderingFreeType.so: failed to map segment from shared object"),
        OSError(12, "Cannot allocate memory"),
        RuntimeError("std::bad_alloc"),
    ],
    ids=lambda e: type(e).__name__,
)
def test_it_is_one_message(capsys, error):
    """Whichever library has met it; with its own words and a way out."""
    assert out_of_memory(error)
    with pytest.raises(SystemExit) as ended, documented_exit(debug=False):
        raise error
    assert ended.value.code == ExitCode.ENVIRONMENT
    said = capsys.readouterr().err
    assert "would not fit in memory" in said and "resolution" in said and "GB are free" in said and "Traceback" not in said


def test_other_errors_are_not_taken_for_it():
    assert not out_of_memory(OutputError("disk full")) and not out_of_memory(ValueError("shape"))


def test_models_that_do_not_fit_are_a_problem_of_the_scene(monkeypatch):
    """With its place and a coarser resolution."""
    text = "object a { shape sphere 1 m  position (0, 0, 2) m  density 500  elasticity 1 MPa } control { time 1 s }"

    def full(*_, **__):
        raise MemoryError

    monkeypatch.setattr(preparing, "build_models", full)
    with pytest.raises(SceneError, match=r"particles at a spacing of .* memory has run out") as caught:
        preparing.prepare(parse_scene(text))
    assert caught.value.problems[0].line == 1 and "try resolution" in caught.value.problems[0].hint


def test_a_run_below_a_limit_of_the_shell_is_refused_or_runs(tmp_path):
    """At 0.6 GB: what the scene takes and what libraries take do not fit, which is said before anything is made."""
    (tmp_path / "s.txt").write_text(
        "object a { shape box (1, 1, 1) m  position (0, 0, 2) m  density 500  elasticity 1 MPa }\n"
        "control { time 0.1 s  resolution 1.6 cm }"
    )
    run = subprocess.run(
        [sys.executable, "-m", "mdanim_lammps", "s.txt"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (6 * GB // 10,) * 2),
    )
    assert run.returncode == ExitCode.SCENE and "GB are free" in run.stderr and "Traceback" not in run.stderr, run.stderr
