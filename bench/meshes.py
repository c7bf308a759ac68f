# SPDX-License-Identifier: GPL-2.0-only
"""How many mesh files become bodies that fall and lie: python bench/meshes.py FILE_OR_FOLDER ...

Each STL, OBJ and PLY file is scaled to 20 cm, made a rigid body 2 cm above the ground, and let fall for three seconds: as a
`mesh`, or as what the message names, a `solid` or a `sheet` of rubber. A row has the file, its faces, the word that took it or
what the message says, particles, seconds of processor time and the most memory. Each try is a process of its own, which may take
a minute of processor time and 2 GB; the row of one that takes more says so.
"""

from __future__ import annotations

import multiprocessing
import resource
import signal
import sys
import tempfile
from pathlib import Path

import numpy as np
import one_thread  # noqa: F401
from mdanim_lammps import MdanimError, Scene, SceneError
from mdanim_lammps.model.mesh_formats import Polygons, UnreadableMesh, read
from mdanim_lammps.model.orientation import MeshError
from mdanim_lammps.model.shapes import extent

SIZE, ABOVE = 0.2, 0.02
"""Longest side of the box around each body, and its height above the ground [m]."""
STILL = 5e-3
"""How far the middle of a body that lies rises or sinks in the last half second [m]; it may roll or rock."""
SECONDS, BYTES = 60, 2_000_000_000
"""Most that a try may take: processor time [s], data [bytes]."""
SUFFIXES = (".stl", ".obj", ".ply")
FORMS = {
    "mesh": 'mesh "{path}" scale {scale!r}  elasticity rigid',
    "solid": 'solid "{path}" scale {scale!r}  elasticity rigid',
    "sheet": 'mesh "{path}" scale {scale!r} sheet thickness 2 mm  material rubber  resolution 1 cm',
}
SCENE = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object body {{ shape {shape}  position (0, 0, {height!r}) m {density} }}
control {{ time 3 s  frames 10 fps  friction 0.5 }}
record body.position.z
record body.speed
"""


def main(places: list[str]) -> None:
    found = dict.fromkeys((*FORMS, ""), 0)
    print("| file | faces | taken as | particles | s | MB |\n|---|---|---|---|---|---|")
    for path in sorted(file for place in places for file in _files(Path(place))):
        begin = _spent()
        word, done = _tried(path)
        found[word] += 1
        what = word or done["why"].replace("|", "/")
        print(
            f"| {path.name} | {_faces(path)} | {what} | {done['particles']} | {_spent() - begin:.1f} | {done['MB']} |", flush=True
        )
    bodies, every = sum(found[word] for word in FORMS), sum(found.values())
    kinds = ", ".join(f"{found[word]} as {word}" for word in FORMS)
    print(f"\n{bodies} of {every} fall and lie ({kinds})")


def _files(place: Path) -> list[Path]:
    return [file for file in (place.rglob("*") if place.is_dir() else [place]) if file.suffix.lower() in SUFFIXES]


def _tried(path: Path) -> tuple[str, dict]:
    """The word that takes a file and what came of it, or "" and why it is not taken."""
    left = list(FORMS)
    word: str | None = left[0]
    while word:
        left.remove(word)
        done = _limited(_fallen, path, word)
        if not done["why"]:
            return word, done
        word = next((word for word in left if f"write {word}" in done["hint"]), None)
    return "", done | {"why": f"{done['why']}; {done['hint']}" if done["hint"] else done["why"]}


def _spent() -> float:
    """Processor time of all processes that this one has waited for [s]."""
    return sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


def _polygons(path: Path) -> Polygons | None:
    """Contents of a file; None where it is damaged."""
    try:
        return read(path.read_bytes(), path.suffix.lower())
    except UnreadableMesh:
        return None


def _faces(path: Path) -> int:
    return 0 if (found := _polygons(path)) is None else len(found.count)


def _limited(function, *values) -> dict:
    """The result of a function in a process with limits, or which of them it passed, and the most memory [MB]."""
    near, far = multiprocessing.Pipe(duplex=False)

    def work() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
        resource.setrlimit(resource.RLIMIT_DATA, (BYTES, BYTES))
        done = function(*values)
        far.send(done | {"MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024})

    process = multiprocessing.get_context("fork").Process(target=work)
    process.start()
    far.close()
    try:
        return near.recv()
    except EOFError:
        process.join()
        late = process.exitcode == -signal.SIGXCPU
        return _refused(f"more than {SECONDS} s" if late else f"the process ended: {process.exitcode}") | {"MB": ""}
    finally:
        process.join()


def _refused(why: str, hint: str = "") -> dict:
    return {"why": why, "hint": hint, "particles": ""}


def _fallen(path: Path, word: str) -> dict:
    """Whether a file becomes a body that falls and lies, and its particles."""
    found = _polygons(path)
    size = 0.0 if found is None or not len(found.points) else float(np.ptp(found.points, axis=0).max())
    shape = FORMS[word].format(path=path.resolve(), scale=SIZE / size if 0.0 < size < np.inf else 1.0)
    density = "" if word == "sheet" else "density 1000 kg/m^3"
    try:
        first = Scene.from_text(SCENE.format(shape=shape, height=1.0, density=density)).record.solids[0].shape
        height = ABOVE - float(extent(first)[0][2])
        scene = Scene.from_text(SCENE.format(shape=shape, height=height, density=density))
        with tempfile.TemporaryDirectory() as folder:
            run = scene.run(Path(folder) / "run")
            z, speed = (run.records[f"body.{what}"] for what in ("position.z", "speed"))
        if not (-ABOVE < z[-1] < z[0] - 0.5 * ABOVE and np.ptp(z[-5:]) < STILL):
            return _refused(f"from z = {z[0]:.3g} m to {z[-1]:.3g} m, {speed[-1]:.2g} m/s at the end")
        return {"why": "", "hint": "", "particles": scene.prepared.plan.system.particles}
    except MemoryError:
        return _refused(f"more than {BYTES / 1e9:g} GB")
    except MeshError as error:
        return _refused(str(error), error.hint)
    except SceneError as error:
        return _refused(error.problems[0].message, error.problems[0].hint)
    except MdanimError as error:
        return _refused(str(error).splitlines()[0])


if __name__ == "__main__":
    main(sys.argv[1:])
