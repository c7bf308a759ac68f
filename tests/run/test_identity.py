# SPDX-License-Identifier: GPL-2.0-only
"""Every scene of scenes/, with a coarse lattice and its whole time: whatever the number of threads and of executors and the
width of vectors, all frames have the same bits, and on one process the ledger, too."""

from contextlib import suppress
from dataclasses import replace

import pytest
from filming import WIDTHS, supported
from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.engine.threads import LEAST
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene.parse import load_scene
from paths import SCENES
from splash_lab import EAGER

COARSER = 1.5
"""Times the spacing of a scene: a fifth of the time, and the same things happen."""
WAYS = ((2, 1, None), (3, 1, None), (4, 2, "central"), (8, 1, None), (1, 3, "peers"), (2, 2, "peers"))
"""Threads, executors and their control; widths take turns."""
pytestmark = [pytest.mark.mpi, pytest.mark.soak, pytest.mark.timeout(0)]


def coarse(name: str) -> Scene:
    """A scene with larger spacing, or as it is where it tells none or something in it would be too thin."""
    scene = replace(load_scene(SCENES / name), expects=())
    if scene.control.resolution is None:
        return Scene(scene)
    coarser = Scene(replace(scene, control=replace(scene.control, resolution=COARSER * scene.control.resolution)))
    with suppress(SceneError):
        if coarser.prepared:
            return coarser
    return Scene(scene)


def film_of(folder) -> list[bytes]:
    """All that each frame has."""
    with Trajectory(folder) as film:
        liquid = film.liquid is not None
        return [
            film.position(n).tobytes() + film.velocity(n).tobytes() + (film.liquid_raw(n).tobytes() if liquid else b"")
            for n in range(len(film))
        ]


@pytest.mark.parametrize("name", sorted(path.name for path in SCENES.glob("*.txt") if "control {" in path.read_text()))
def test_a_scene_has_the_same_bits_in_every_way(tmp_path, monkeypatch, name):
    """All that threads can share they share, however little it is worth."""
    scene, widths = coarse(name), [width for width in WIDTHS if supported(width)]
    monkeypatch.setenv(LEAST, EAGER)

    def run(threads, executors, control, width):
        """The film of the scene, and its ledger but for the clocks."""
        monkeypatch.setenv("MDANIM_WIDTH", width)
        folder = tmp_path / f"{threads} {executors} {width}"
        result = scene.run(folder, threads=threads, executors=executors, control=control, progress=False)
        return film_of(folder), [{c: value for c, value in row.items() if "second" not in c} for row in result.ledger.rows]

    film, ledger = run(1, 1, None, widths[0])
    for number, (threads, executors, control) in enumerate(WAYS):
        width = widths[(number + 1) % len(widths)]
        found, rows = run(threads, executors, control, width)
        assert len(found) == len(film)
        assert [n for n, frame in enumerate(film) if found[n] != frame] == [], (threads, executors, width)
        if executors == 1:  # sums over objects of several instances have another order
            assert rows == ledger, (threads, width)
