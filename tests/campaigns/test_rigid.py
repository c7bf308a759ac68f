# SPDX-License-Identifier: GPL-2.0-only
"""Random scenes of rigid, held and elastic objects at the certified time step: none diverges, and the books close."""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rigid_scenes
from campaign import rounds
from mdanim_lammps import DivergedError, Scene, Trajectory
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.scene.scene import SceneRecord

STEPS = 100_000
"""Most steps of a scene: what needs shorter ones is run for a shorter time."""
RESIDUAL, WORST, RARE = 1e-3, 1e-2, 0.1
"""Error of energy that `accuracy balanced` stands for, and the largest one, in a tenth of all scenes at most: blows of edges and
rims without dashpots, whose normals turn with the depth (test_random_blows of tests/plugin/rigid/test_known_motions.py)."""
FEW = (2, 4, 6, 12, 151, 270)
"""Seeds of scenes that are run every day. In the last one a corner comes below a side of a mesh and beyond a blunt edge of it at
once, which took 6 % of all energy."""


def lowest(surface, of: np.ndarray) -> float:
    """Height of the lowest corner that is drawn of some objects [m]."""
    corners = surface.regular_faces[of[surface.cell_data["object"]]]
    return float(surface.points[corners, 2].min(initial=np.inf))


def check(seed: int, folder: Path) -> str:
    """Run a scene; its kind, or ``off`` where its energy is off by more than RESIDUAL, ``warned`` where it has failed and the
    program has told before that it may, or ``refused``."""
    folder.mkdir()
    kind, text = rigid_scenes.scene(seed, folder)
    (folder / "odd.txt").write_text(text)
    try:
        scene = Scene(shortened(load_scene(folder / "odd.txt")))
        ready = scene.prepared
    except SceneError as error:
        assert "not in one piece" in str(error), f"{error}\n{text}"  # of a thin hull
        return "refused"
    try:
        run = scene.run(folder / "out")
    except DivergedError as error:
        assert ready.warnings, f"{error}\n{text}"
        return "warned"
    with Trajectory(folder / "out") as trajectory:
        centers, speeds = np.array(trajectory.centers), np.array(trajectory.center_velocities)
        low = min(lowest(trajectory.surface(frame), ready.system.rigid) for frame in range(len(trajectory)))
    assert np.isfinite(centers).all() and np.isfinite(speeds).all(), text
    off = np.abs(run.ledger.array("residual"))
    assert (off < WORST).all(), f"residual {run.ledger.residual}\n{text}"
    if kind == "space":  # no one takes momentum
        part = ready.system.mass_of[:, None] * speeds
        moved = np.abs(part.sum(axis=1) - part[0].sum(axis=0)).max()
        assert moved < 1e-12 * np.abs(part).sum(axis=(1, 2)).max(), f"momentum {moved}\n{text}"
    told = {m.name: m.value for m in ready.certificate.margins}
    if "blow depth" in told and scene.record.ground is not None:
        free = ready.system.mass_of[~ready.system.still]
        deep = math.sqrt(free.max() / free.min()) * max(told["blow depth"], told["rest depth"])  # a heavy one strikes a light one
        assert low > -deep, f"{-low} m in the ground\n{text}"
    return kind if (off < RESIDUAL).all() else "off"


def shortened(scene: SceneRecord) -> SceneRecord:
    """A scene for a shorter time where it takes more than STEPS steps."""
    sure = Scene(scene).prepared.certificate
    if sure.steps <= STEPS:
        return scene
    frames = max(2, STEPS // sure.steps_per_frame)
    return replace(scene, control=replace(scene.control, time=frames / scene.control.frames))


def campaign(seeds: Iterable[int], folder: Path) -> dict[str, int]:
    """How many scenes of each kind there were."""
    return Counter(check(seed, folder / str(seed)) for seed in seeds)


def test_six_random_scenes(tmp_path):
    """One that falls, two stacks that are struck, two without gravity, one with a liquid."""
    assert campaign(FEW, tmp_path) == {"fall": 1, "stack": 2, "space": 2, "pool": 1}


@pytest.mark.soak
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("part", range(10))
def test_three_hundred_random_scenes(tmp_path, part):
    """Each kind in each part."""
    count = rounds(30)
    found = campaign(range(part * count, (part + 1) * count), tmp_path)
    print(found)
    assert found["off"] <= RARE * count + 1
