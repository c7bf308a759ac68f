# SPDX-License-Identifier: GPL-2.0-only
"""A run that plain ``lmp`` has made: its dump becomes a trajectory, and all that reads runs reads it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ..errors import OutputError
from ..results.dump import read_dump
from ..results.files import claimed
from ..results.progress import ProgressLog
from ..results.trajectory_file import part_of
from ..results.trajectory_writer import TrajectoryWriter
from ..scene.scene import SceneRecord
from .prepare import prepare


def adopt_dump(folder: Path, scene: SceneRecord) -> str:
    """Make trajectory.h5 of ``NAME.lammpstrj`` in a folder that ``build`` has made, unless there is a trajectory.

    Args:
        folder: output folder.
        scene: as it is stored there.

    Returns:
        A line that says what was done; empty where there is a trajectory, or no dump.

    Raises:
        OutputError: a dump of another scene, or one without a whole frame; the trajectory cannot be written.
        SceneError, RefusedError: the scene cannot be prepared.
    """
    file = folder / "trajectory.h5"
    if file.exists() or part_of(file).exists() or not any(folder.glob("*.lammpstrj")):
        return ""
    ready = prepare(replace(scene, trusted=True), allow_unstable=True)  # nothing is run
    dump = folder / f"{ready.plan.name}.lammpstrj"
    if not dump.exists():
        return ""
    dt = ready.certificate.timestep
    with claimed(folder):
        try:
            frames = sum(1 for _ in read_dump(dump, ready.system.particles))
            if not frames:
                raise ValueError("it holds no whole frame")
            # A dump holds no liquid: there will be none in the pictures.
            out = TrajectoryWriter(
                file,
                scene,
                ready.models,
                frames=frames,
                dt=dt,
                steps_per_frame=ready.certificate.steps_per_frame,
                scene_text=ready.lock,
            )
            with out, ProgressLog(folder, columns=("time",), energies=0, frames=frames, executors=1) as log:
                for frame, (step, x, v) in enumerate(read_dump(dump, ready.system.particles)):
                    out.write(step, step * dt, x, v)
                    log.frame(frame, {"time": step * dt}, 0.0)
                out.flush()
                out.close()
        except (OSError, ValueError) as error:
            raise OutputError(f"{dump} is not the dump of 'lmp -in in.{ready.plan.name}' in this folder: {error}") from error
    lost = "; the liquid is not in a dump, and is not drawn" if ready.plan.grid else ""
    return f"adopted  {frames} frames of {dump.name}, which lmp has written{lost}"
