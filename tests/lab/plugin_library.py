# SPDX-License-Identifier: GPL-2.0-only
"""Build the test library: C functions over the automaton and the level rule, and LAMMPS styles, that only tests use.

``python tests/lab/plugin_library.py`` builds it ahead; else the first test that needs it does.
"""

from __future__ import annotations

import ctypes
import fcntl
import hashlib
import os
import platform
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLUGIN, TESTS = ROOT / "plugin", ROOT / "tests" / "lab" / "plugin"
FOLDER = ROOT / "build" / "mdanimtest"
"""Folder of the library alone: as LAMMPS_PLUGIN_PATH it makes LAMMPS load the styles of the tests."""
FILE = FOLDER / "mdanimtestplugin.so"
FLOORS = (
    "simd/kernels",
    "threads/team",
    "records/state_records",
    "geometry/aligned_array",
    "lammps/stateful",
    "lammps/fix_base",
    "lammps/named_group",
    "lammps/particle_value",
)
PASSES = ("passes/cutter", "passes/displacement_budget", "passes/range_cut", "passes/strips", "passes/tag_order")
SOURCES = (
    *sorted(TESTS.glob("*.cpp")),
    *sorted(path for path in (PLUGIN / "liquid").rglob("*.cpp") if not path.stem.endswith("_of_set")),
    *(PLUGIN / f"{name}.cpp" for name in (*FLOORS, *PASSES)),
)
OF_SET = (PLUGIN / "simd" / "kernels_of_set.cpp", PLUGIN / "liquid" / "waves" / "waves_kernels_of_set.cpp")
"""Tables and loops of waves, for each set of instructions; unused_kernels.cpp has the other names."""
SETS = [
    (name, [f"-DMDANIM_SET={name}", f"-DMDANIM_LANES={lanes}", "-Wno-psabi", *flags])
    for name, lanes, *flags in map(str.split, (PLUGIN / "simd" / "sets.txt").read_text().splitlines())
    if name == "common" or platform.machine() in ("x86_64", "AMD64")
]
"""Sets of instructions, and what the compiler is told for each."""


def build() -> Path:
    """The built library, compiled anew where its sources, flags or LAMMPS have changed; one process builds, others wait."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    stamp = FOLDER / "stamp"
    with (FOLDER / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not FILE.exists() or not stamp.exists() or stamp.read_text() != _digest():
            _compile()
            stamp.write_text(_digest())
    return FILE


def _compile() -> None:
    """Sources side by side on all cores, then the link. Raises RuntimeError with what the compiler says."""
    part = FOLDER / "part"
    names = "".join(f"MDANIM_A_SET({name})" for name, _ in SETS)
    objects = {FOLDER / f"{source.parent.name}-{source.stem}.o": (source, [f"-DMDANIM_SETS={names}"]) for source in SOURCES}
    for name, flags in SETS:
        for source in OF_SET:
            objects[FOLDER / f"{name}-{source.stem}.o"] = source, flags
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        commands = ([*_command(), *flags, "-c", str(source), "-o", str(o)] for o, (source, flags) in objects.items())
        list(pool.map(_run, commands))
    _run([*_command(), "-shared", *map(str, objects), "-o", str(part)])
    part.replace(FILE)


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"the test library does not compile:\n{done.stderr}")


@cache
def library() -> ctypes.CDLL:
    """The built library with liblammps below it."""
    from mdanim_lammps.engine.plugin import open_library

    open_library()  # maps liblammps
    return ctypes.CDLL(str(build()))


@cache
def _command() -> list[str]:
    """The compiler's command but for what it reads and writes; the flags are those of the plugin."""
    headers = subprocess.run([sys.executable, str(PLUGIN / "headers.py")], capture_output=True, text=True, check=True).stdout
    lammps, mpi, *_ = headers.split(";")
    flags = (PLUGIN / "compile_flags.txt").read_text().split()
    folders = [f"-I{PLUGIN}", "-isystem", lammps, "-isystem", mpi]
    kind = ["-std=c++17", "-fPIC", "-fvisibility=hidden", "-fvisibility-inlines-hidden"]
    more = os.environ.get("CXXFLAGS", "").split()
    return [os.environ.get("CXX", "c++"), *kind, *flags, *more, *folders]


def _digest() -> str:
    """Digest of all files that the library is made from."""
    found = hashlib.sha256(f"{_command()} {SETS}".encode())
    for path in sorted(p for folder in (PLUGIN, TESTS) for p in folder.rglob("*") if p.suffix in (".h", ".cpp")):
        if path in SOURCES or path in OF_SET or path.suffix == ".h":
            found.update(path.read_bytes())
    return found.hexdigest()


if __name__ == "__main__":
    print(build())
