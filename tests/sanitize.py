# SPDX-License-Identifier: GPL-2.0-only
"""The plugin under the address and the undefined-behaviour sanitizer: its tests, and scenes on one and two ranks. What threads
share of passes, contact, cells and waves, under the thread sanitizer, without LAMMPS and Python, which do not run under it.

``make sanitize`` runs it. Exit code 0 means that both sanitizers report a planted error, that all tests and scenes pass, and that
no process has reported anything else. Reports lie in build/sanitize/reports.

Leaks are not looked for: LAMMPS, MPI and Python keep memory until their processes end, and reports about them would hide ours.
LAMMPS itself is not instrumented: accesses of its code are not checked, accesses of ours to its arrays are.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WORK = ROOT / "build" / "sanitize"
REPORTS, PACKAGE, SCENES = WORK / "reports", WORK / "package", WORK / "scenes"
BIN = Path(sys.executable).parent
PLUGIN = ROOT / "plugin"
FLAGS = " ".join((PLUGIN / "sanitize_flags.txt").read_text().split())
TESTS = ("plugin/**/test_*.py", "engine/test_trace.py")
PLANTED = {
    "mdanim_plant_heap_overflow": "AddressSanitizer: heap-buffer-overflow",
    "mdanim_plant_signed_overflow": "AddressSanitizer: ABRT",
}
SOLID = "density 1000 elasticity 0.2 MPa"
TEXT = {
    "touching": f"""
gravity (0, 0, -9.81)
ground z 0 m
object a {{ shape sphere 4 cm position (0, 0, 4) cm {SOLID} }}
object b {{ shape box (5, 5, 5) cm position (1, 0, 12) cm {SOLID} velocity (0, 0, -1) }}
object c {{ shape box (6, 6, 1) cm position (-9, 0, 3) cm {SOLID} velocity (1, 0, 0) }}
""",
    # Friction, the planes, sharp points on a cuboid and round ones on a mesh of cells; all with dashpots.
    "friction": f"""
gravity (0.5, 0, -9.81)
ground z 0 m
object a {{ shape box (6, 6, 3) cm position (0, 0, 1.5) cm {SOLID} }}
object b {{ shape box (4, 4, 4) cm position (1, 0.5, 5.02) cm {SOLID} velocity (0.3, 0, -0.5) spin (0, 0, 3) }}
object c {{ shape sphere 3 cm position (-7, 0, 3) cm {SOLID} velocity (1, 0, 0) spin (0, 20, 0) }}
object d {{ shape cylinder 3 cm 2 cm position (-7.5, 0.5, 7.1) cm {SOLID} velocity (1, 0, -0.5) }}
""",
    "surface": f"""
walls from (-8, -8, -8) cm to (14, 8, 12) cm
object a {{ shape box (5, 5, 5) cm position (0, 0, 0) {SOLID} velocity (1, 0, -1) }}
object b {{ shape box (5, 5, 1) cm position (6.5, 0, 2) cm orientation euler (20, 40, 0) deg {SOLID} velocity (-1, 0, 0) }}
object c {{ shape torus 3 cm 1.2 cm position (1, 0, 7) cm {SOLID} velocity (0, 0.5, -1) }}
""",
    **{
        name: f"""
gravity (0, 0, -9.81)
liquid w {{ basin from (-10, -10, 0) cm to (10, 10, 20) cm density 1000 level 8 cm drag 4 {words} }}
object a {{ shape box (5, 5, 5) cm position (-4, 0, 12) cm density 400 elasticity 0.2 MPa velocity (0, 0, -1) }}
object b {{ shape sphere 3 cm position (4, 0, 12) cm density 1500 elasticity 0.2 MPa }}
"""
        for name, words in {"liquid": "model surface", "waves": "drops 1 wave -x amplitude 1 cm period 0.3 s"}.items()
    },
    "damped": f"""
gravity (0, 0, -9.81)
ground z 0 m
object a {{ shape sphere 4 cm position (0, 0, 4.5) cm {SOLID} damping 0.1 spin (3, 0, 20) }}
object b {{ shape box (5, 5, 5) cm position (1, 0, 12) cm {SOLID} damping 0.2 drag 0.3 velocity (0, 0, -1) }}
""",
    "walls": f"""
walls from (-8, -8, -8) cm to (14, 8, 12) cm
object a {{ shape box (5, 5, 5) cm position (0, 0, 0) {SOLID} velocity (2, 0, -2) }}
object b {{ shape box (5, 5, 5) cm position (6.5, 0, 2) cm {SOLID} velocity (-1, 0, 1) }}
""",
    "connected": f"""
gravity (0, 0, -9.81)
ground z 0 m
object a {{ shape box (8, 2, 2) cm position (0, 0, 3) cm density 600 elasticity rigid force (0.2, 0, 0) N from 0.02 s to 0.1 s }}
object b {{ shape cylinder 2 cm 2 cm position (0, 0, 8) cm density 600 elasticity rigid pieces 6 strength 1 kPa spin (0, 30, 0) }}
object c {{ shape box (2, 2, 6) cm position (6, 0, 4) cm {SOLID} hold face -z key 0.05 s at (6.5, 0, 4) cm release 0.1 s }}
object d {{ shape rope from (-8, 0, 4) cm to (-2, 0, 12) cm thickness 5 mm density 900 elasticity 1 MPa tear-strain 0.05 }}
joint hinge a world {{ axis (0, 1, 0) motor speed 60 rpm torque 0.1 N*m }}
joint ball d b {{ at (-2, 0, 12) cm breaks 1 N }}
hand c {{ at (6, 0, 6) cm key 0.02 s at (6, 0, 6) cm key 0.06 s at (6, 0.5, 6) cm }}
""",
    "layers": f"""
gravity (0, 0, -9.81)
ground z 0 m
air {{ density 1.2 kg/m^3 wind (2, 0, 0) m/s }}
let cloth = {{ density 300 elasticity 0.1 MPa tear-strain 0.05 touches-itself yes }}
object a {{ use cloth shape sheet (16, 16) cm thickness 1 mm position (0, 0, 5.2) cm }}
object b {{ shape sphere 3 cm position (0, 0, 9) cm density 1500 elasticity rigid velocity (0, 0, -1) }}
object c {{ shape sphere 4 cm sheet thickness 1 mm position (0, 12, 5) cm density 900 elasticity 1 MPa inflate 1 kPa }}
object d {{ shape box (6, 6, 4) cm position (0, 0, 2) cm {SOLID} yield-strain 0.1 touches-itself yes }}
""",
}
END = "control {{ time 0.2 s frames 50 fps resolution 1 cm  {} }}\n"
THREADS = {
    "threads_of_passes": ("passes/*.cpp", "barrier/*.cpp"),
    "threads_of_contact": ("contact/*.cpp", "barrier/contact_search.cpp"),
    "threads_of_rigid": ("rigid/*.cpp",),
    "threads_of_cells": ("liquid/automaton/automaton.cpp", "liquid/occupancy.cpp"),
    "threads_of_waves": ("liquid/waves/*.cpp", "liquid/occupancy.cpp"),
}
"""Programs of tests/lab, and what of plugin/ they need besides `FLOORS`."""
FLOORS = ("simd/*.cpp", "threads/*.cpp", "geometry/*.cpp", "**/*_of_set.cpp")
SET = ("-DMDANIM_SET=common", "-DMDANIM_LANES=4", "-DMDANIM_SETS=MDANIM_A_SET(common)")
"""The instructions that they are compiled for."""
LEFT_OUT = ("bodies_file.cpp",)
"""Files that read files."""
WORDS = {"friction": "friction 0.4", "surface": "contact-model surface"} | dict.fromkeys(("connected", "layers"), "friction 0.4")
"""Control words for those of TEXT that need more; the other texts use the paper's contact."""


def library(name: str) -> str:
    """Path of a library of the compiler; exits where the compiler does not have it."""
    path = Path(subprocess.check_output([compiler(), f"-print-file-name={name}"], text=True).strip())
    if not path.is_absolute():
        sys.exit(f"{compiler()} has no {name}; use GCC with its sanitizers (Debian: apt install g++)")
    return str(path.resolve())


def compiler() -> str:
    """The C++ compiler."""
    return os.environ.get("CXX", "c++")


def build() -> None:
    """The plugin with both sanitizers, in a copy of the package."""
    folder = WORK / "plugin"
    options = [f"-DPython_EXECUTABLE={sys.executable}", f"-DCMAKE_CXX_COMPILER={compiler()}", "-DMDANIM_SANITIZE=ON"]
    subprocess.run(["cmake", "-S", ROOT, "-B", folder, *options], check=True)
    subprocess.run(["cmake", "--build", folder, "-j", str(os.cpu_count())], check=True)
    for old in (REPORTS, PACKAGE, SCENES):
        shutil.rmtree(old, ignore_errors=True)
        old.mkdir(parents=True)
    no_builds = shutil.ignore_patterns("*.so", "__pycache__")
    shutil.copytree(ROOT / "python" / "mdanim_lammps", PACKAGE / "mdanim_lammps", ignore=no_builds)
    (PACKAGE / "mdanim_lammps" / "plugin").mkdir(exist_ok=True)
    shutil.copy(folder / "mdanimplugin.so", PACKAGE / "mdanim_lammps" / "plugin")


def environment() -> dict[str, str]:
    """The environment of all processes: sanitizers first in each of them, and every report in a file."""
    return {
        **os.environ,
        "PYTHONPATH": str(PACKAGE),
        # The second gives the first what C++ throws exceptions with, which Python alone does not load.
        "LD_PRELOAD": f"{library('libasan.so')}:{library('libstdc++.so')}",
        # GCC's UBSan prints its finding to stderr, then aborts, and ASan writes a report of that.
        "ASAN_OPTIONS": f"detect_leaks=0:handle_abort=1:log_path={REPORTS}/report",
        "UBSAN_OPTIONS": f"print_stacktrace=1:abort_on_error=1:log_path={REPORTS}/report",
        "CXXFLAGS": FLAGS,  # of the test library
        "MPIEXEC_TIMEOUT": "900",
    }


def reports() -> dict[str, str]:
    """Reports of the sanitizers so far, by file."""
    return {path.name: path.read_text(errors="replace") for path in sorted(REPORTS.iterdir())}


def find_planted() -> None:
    """Exit where a sanitizer does not report the error that was planted for it."""
    for function, expected in PLANTED.items():
        code = f"from mdanim_lammps.engine.plugin import open_library; print(open_library().{function}(7))"
        done = subprocess.run([sys.executable, "-c", code], env=environment(), capture_output=True, text=True)
        found = reports()
        if done.returncode == 0 or not any(expected in text for text in found.values()):
            sys.exit(f"{function} was not reported, so no other error would be:\n{done.stdout}{done.stderr}{found}")
        for name in found:
            (REPORTS / name).unlink()
    print(f"both planted errors were reported: {', '.join(PLANTED)}")


def run(*command: object, folder: Path = SCENES) -> bool:
    """Run a command under the sanitizers in a folder; whether it succeeded."""
    words = [str(word) for word in command]
    print("+", *words, flush=True)
    return subprocess.run(words, env=environment(), cwd=folder).returncode == 0


def run_tests() -> bool:
    """The plugin's own tests."""
    options = ("-q", "-x", "-p", "no:cacheprovider", "--timeout", 900, "-c", ROOT / "pyproject.toml")
    options += ("-m", "not soak and not no_memory")
    return run(sys.executable, "-m", "pytest", *options, *sorted(path for name in TESTS for path in (ROOT / "tests").glob(name)))


def run_scenes() -> bool:
    """All scenes: in one process, on two executors, and by LAMMPS alone on two ranks."""
    done = True
    lmp = (BIN / "mpiexec", "-n", 2, BIN / "lmp", "-log", "none", "-screen", "none", "-in")
    for name, text in TEXT.items():
        (SCENES / f"{name}.txt").write_text(text + END.format(WORDS.get(name, "contact-model paper")))
        scene = (sys.executable, "-m", "mdanim_lammps", f"{name}.txt", "--no-movie", "--force", "-q")
        done = done and run(*scene, "-n", 1) and run(*scene, "-n", 2)
        done = done and run(*lmp, f"in.{name}", folder=SCENES / f"{name}.out")
    return done


def run_threads(name: str) -> bool:
    """A program of several threads under the thread sanitizer; a data race or another bit makes it fail."""
    program = WORK / name
    parts = sorted({path for pattern in (*FLOORS, *THREADS[name]) for path in PLUGIN.glob(pattern) if path.name not in LEFT_OUT})
    options = ["-std=c++17", "-g", "-O1", "-fsanitize=thread", "-ffp-contract=off", "-Wno-psabi"]
    options += [*SET, f"-I{ROOT / 'plugin'}", "-pthread"]
    source = ROOT / "tests" / "lab" / f"{name}.cpp"
    subprocess.run([compiler(), *options, source, *parts, "-o", program], check=True)
    print("+", program, flush=True)
    return subprocess.run([program], env={**os.environ, "TSAN_OPTIONS": f"log_path={REPORTS}/report"}).returncode == 0


def main() -> None:
    """Build, prove that errors are seen, run all, and fail on anything that was reported."""
    build()
    find_planted()
    done = all([*map(run_threads, THREADS), run_tests(), run_scenes()])
    found = reports()
    for name, text in found.items():
        print(f"=== {REPORTS / name}", text[:8000], sep="\n")
    if found or not done:
        sys.exit(f"sanitizers reported {len(found)} errors" + ("" if done else "; a command above failed"))
    print("no error was reported")


if __name__ == "__main__":
    main()
