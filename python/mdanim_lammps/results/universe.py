# SPDX-License-Identifier: GPL-2.0-only
"""A trajectory for MDAnalysis."""

from __future__ import annotations

import MDAnalysis
import numpy as np
from MDAnalysis.coordinates.H5MD import H5MDReader

from .trajectory import Trajectory


class _Reader(H5MDReader):
    """Gives frames that are written, each after its checksums were compared."""

    # MDAnalysis registers readers by their format: this one is for `universe_of` alone.
    format = "MDANIM"

    def __init__(self, filename: str, **options):
        self._source = Trajectory(filename)
        super().__init__(filename, **options)

    @property
    def n_frames(self) -> int:
        return len(self._source)

    def _read_frame(self, frame: int):
        if frame >= len(self._source):
            raise OSError  # the end, for MDAnalysis
        self._source.check(frame)
        return super()._read_frame(frame)

    def close(self) -> None:
        self._source.close()
        super().close()

    def _reopen(self) -> None:
        super().close()
        self.open_trajectory()


def universe_of(trajectory: Trajectory) -> MDAnalysis.Universe:
    """See `Trajectory.universe`."""
    metadata = trajectory.metadata
    universe = MDAnalysis.Universe.empty(
        len(metadata.id), n_residues=len(metadata.names), atom_resindex=metadata.object_of, trajectory=False
    )
    universe.add_TopologyAttr("masses", metadata.mass)
    universe.add_TopologyAttr("ids", metadata.id)
    universe.add_TopologyAttr("types", metadata.layer.astype(str).astype(object))
    universe.add_TopologyAttr("names", np.array(metadata.names, dtype=object)[metadata.object_of])
    universe.add_TopologyAttr("resids", np.arange(1, len(metadata.names) + 1))
    universe.add_TopologyAttr("resnames", np.array(metadata.names, dtype=object))
    if len(metadata.bond):
        rank = np.full(metadata.total + 1, -1)
        rank[metadata.id] = np.arange(len(metadata.id))
        universe.add_TopologyAttr("bonds", rank[metadata.bond])
    universe.trajectory = _Reader(str(trajectory.path), convert_units=False, dt=trajectory.dt * trajectory.steps_per_frame)
    return universe
