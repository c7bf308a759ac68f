# SPDX-License-Identifier: GPL-2.0-only
"""How many mesh files become bodies: python bench/meshes.py FILE_OR_FOLDER ...

Each STL, OBJ and PLY file is scaled to 20 cm and made a rigid body over the ground: as a `mesh`, or else as a `solid` of what its
surface encloses. A row has the file, its faces, the word that took it or what the message says, and seconds of processor time.
Each try is a process of its own, which may take 20 s of processor time and 2 GB; the row of one that takes more says so.
"""

from __future__ import annotations

import multiprocessing
import resource
import signal
import sys
import tempfile
from pathlib import Path

import one_thread  # noqa: F401
import pyvista
from mdanim_lammps.errors import MdanimError, SceneError
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene

SIZE = 0.2
"""Longest side of the box around each body [m]."""
SECONDS, BYTES = 20, 2_000_000_000
"""Most that a try may take: processor time [s], data [bytes]."""
SUFFIXES = (".stl", ".obj", ".ply")


def main(places: list[str]) -> None:
    found = {"mesh": 0, "solid": 0, "": 0}
    print("| file | faces | taken as | s |\n|---|---|---|---|")
    for path in sorted(file for place in places for file in _files(Path(place))):
        begin, why = _spent(), ""
        faces, scale = _limited(_size, path) or (0, 1.0)
        for word in ("mesh", "solid", ""):
            if not word or not (why := _limited(_refused, path, word, scale)):
                break
        found[word] += 1
        print(f"| {path.name} | {faces} | {word or why} | {_spent() - begin:.1f} |", flush=True)
    bodies, every = found["mesh"] + found["solid"], sum(found.values())
    print(f"\n{bodies} of {every} are bodies, {found['mesh']} of them as they are, {found['solid']} as solids")


def _files(place: Path) -> list[Path]:
    return [file for file in (place.rglob("*") if place.is_dir() else [place]) if file.suffix.lower() in SUFFIXES]


def _spent() -> float:
    """Processor time of this process and of those that it has waited for [s]."""
    return sum(time for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN) for time in resource.getrusage(who)[:2])


def _limited(function, *values):
    """The result of a function in a process with limits, or which of them it passed."""
    near, far = multiprocessing.Pipe(duplex=False)

    def work() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
        resource.setrlimit(resource.RLIMIT_DATA, (BYTES, BYTES))
        far.send(function(*values))

    process = multiprocessing.get_context("fork").Process(target=work)
    process.start()
    far.close()
    try:
        return near.recv()
    except EOFError:
        process.join()
        return f"more than {SECONDS} s" if process.exitcode == -signal.SIGXCPU else f"the process ended: {process.exitcode}"
    finally:
        process.join()


def _size(path: Path) -> tuple[int, float] | None:
    """Faces of a file, and the scale that makes it SIZE long; None of what another program's reader does not read."""
    try:
        surface = pyvista.read(path)
        long = float((surface.points.max(axis=0) - surface.points.min(axis=0)).max())
        return surface.n_cells, SIZE / long
    except Exception:
        return None


def _refused(path: Path, word: str, scale: float) -> str:
    """The message where a file is not taken; empty where it is."""
    with tempfile.TemporaryDirectory() as name:
        scene = Path(name) / "body.txt"
        body = f'shape {word} "{path.resolve()}" scale {scale!r}  position (0, 0, 1) m  density 1000 kg/m^3  elasticity rigid'
        scene.write_text(f"gravity (0, 0, -9.81) m/s^2\nground z 0 m\nobject body {{ {body} }}\ncontrol {{ time 1 s }}\n")
        try:
            prepare(load_scene(scene))
        except MemoryError:
            return f"more than {BYTES / 1e9:g} GB"
        except SceneError as error:
            return error.problems[0].message
        except MdanimError as error:
            return str(error).splitlines()[0]
    return ""


if __name__ == "__main__":
    main(sys.argv[1:])
