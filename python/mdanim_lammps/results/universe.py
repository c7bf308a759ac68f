# SPDX-License-Identifier: GPL-2.0-only
"""A trajectory, or what ``build`` has written, for MDAnalysis."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from ..errors import OutputError
from .dump import read_dump
from .trajectory import Trajectory

with warnings.catch_warnings():
    # In a notebook without ipywidgets tqdm, which MDAnalysis imports, shows its own path.
    warnings.filterwarnings("ignore", "IProgress not found")
    import MDAnalysis
    from MDAnalysis.coordinates.base import ReaderBase


class _Reader(ReaderBase):
    """Gives frames to MDAnalysis, each after its checksums were compared."""

    # MDAnalysis registers readers by their format: this one is for `universe_of` alone.
    format = "MDANIM"

    def __init__(self, filename: str, **options):
        super().__init__(filename, **options)
        self._source = Trajectory(filename)
        self.n_atoms = len(self._source.metadata.id)
        self._reopen()
        self._read_next_timestep()

    @property
    def n_frames(self) -> int:
        return len(self._source)

    def _read_frame(self, frame: int):
        source, ts = self._source, self.ts
        if frame >= len(source):
            raise OSError  # the end, for MDAnalysis
        found = {name: source.frames.value(name, frame) for name in source.frames.tables}
        ts.frame, ts.time = frame, float(source.times[frame])
        ts.positions, ts.velocities = found.pop("position"), found.pop("velocity")
        ts.data.update(found, step=int(source.steps[frame]))
        return ts

    def _read_next_timestep(self, ts=None):
        return self._read_frame(self.ts.frame + 1)

    def _reopen(self) -> None:
        self.ts = self._Timestep(self.n_atoms, positions=True, velocities=True, **self._ts_kwargs)
        self.ts.frame = -1

    def close(self) -> None:
        self._source.close()


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


def open_universe(data: str | Path, dump: str | Path | None = None) -> MDAnalysis.Universe:
    """The output of ``mdanim-lammps build``, for MDAnalysis; masses and springs included, metres and m/s.

    Args:
        data: ``data.NAME``. MDAnalysis alone does not read it: masses are those of particles, not of atom types.
        dump: ``NAME.lammpstrj`` that ``lmp -in in.NAME`` has left, for frames; None has one frame, the start.

    Raises:
        OutputError: a file is missing, or is not one that ``build`` and ``lmp`` write.
    """
    data = Path(data)
    try:
        lines = data.read_text(encoding="ascii").splitlines()
        count = int(lines[2].split()[0])
        names = {int(number): name for number, name in (line.split()[2:] for line in lines if line.startswith("# molecule "))}
        starts = {line.split(" #")[0]: n + 2 for n, line in enumerate(lines) if line[:1].isalpha() and n}
        springs = int(lines[3].split()[0])
        table = lambda name, rows: np.array(" ".join(lines[starts[name] : starts[name] + rows]).split(), float).reshape(rows, -1)
        atoms, mass = table("Atoms", count), table("Model", count)[:, 1]
        velocity = table("Velocities", count)[:, 1:4]
        bonds = table("Bonds", springs)[:, 2:4].astype(int) if springs else np.zeros((0, 2), int)
    except (OSError, ValueError, KeyError, IndexError) as error:
        raise OutputError(f"{data} is not a data file that 'mdanim-lammps build' has written: {error}") from error
    residues = np.unique(atoms[:, 1].astype(int))
    universe = MDAnalysis.Universe.empty(
        count, n_residues=len(residues), atom_resindex=np.searchsorted(residues, atoms[:, 1]), trajectory=True, velocities=True
    )
    universe.add_TopologyAttr("masses", mass)
    universe.add_TopologyAttr("ids", atoms[:, 0].astype(int))
    universe.add_TopologyAttr("types", atoms[:, 2].astype(int).astype(str).astype(object))
    universe.add_TopologyAttr("resids", residues)
    if names:  # older versions did not write them
        resnames = np.array([names.get(number, "") for number in residues.tolist()], dtype=object)
        universe.add_TopologyAttr("resnames", resnames)
        universe.add_TopologyAttr("names", resnames[universe.atoms.resindices])
    if springs:
        universe.add_TopologyAttr("bonds", bonds - 1)
    universe.atoms.positions, universe.atoms.velocities = atoms[:, 3:6], velocity
    if dump is not None:
        try:
            # MDAnalysis's own reader of dumps moves the lower corner of the box to the origin.
            frames = [(x.astype(np.float32), v.astype(np.float32)) for _, x, v in read_dump(Path(dump), count)]
            x, v = (np.stack(values) for values in zip(*frames))
        except (OSError, ValueError) as error:
            raise OutputError(f"{dump} is not a dump of {data}: {error}") from error
        universe.load_new(x, velocities=v)
    return universe
