# SPDX-License-Identifier: GPL-2.0-only
"""The checkpoint: everything that is needed to go on bit for bit."""

from __future__ import annotations

import zlib
from dataclasses import field
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from ..engine.state import Records, State, StateRecords
from ..errors import OutputError
from ..processes import available_memory
from ..records import dataclass
from .files import write_whole
from .untrusted import check_room

VERSION = 4
"""Version of the file: 4 has the records of all fixes that keep any."""


@dataclass(frozen=True)
class Checkpoint:
    """The state at a frame."""

    step: int
    frame: int
    x: np.ndarray
    """[m], shape (N, 3)."""
    v: np.ndarray
    """[m/s], shape (N, 3)."""
    f: np.ndarray
    """Forces [N], shape (N, 3): dashpots see half-step velocities that x and v do not hold."""
    carried: dict[str, float]
    """Sums up to this frame: energies lost, deepest penetration, seconds."""
    run: str = ""
    """Which run this is a state of: another scene or time step cannot go on from it."""
    ledger: int = 0
    """Checksum of the ledger's rows up to this frame (`Ledger.checksum`)."""
    records: Records = field(default_factory=dict)
    """Further values that fixes keep, by the ID of the fix."""

    @property
    def state(self) -> State:
        """The state that an instance takes up."""
        return State(self.x, self.v, self.f, self.records)

    def write(self, path: Path) -> None:
        """Write atomically: the last good checkpoint is never lost. Raises OutputError."""
        records = {}
        for n, of_fix in enumerate(self.records.values()):
            # A liquid's are mostly equal cells: a hundredth is left of them; positions and forces would not shrink.
            packed = np.frombuffer(zlib.compress(of_fix.data.tobytes(), 1), np.uint8)
            records |= {f"keys{n}": of_fix.keys, f"first{n}": of_fix.first, f"data{n}": packed}

        def save(part: Path) -> None:
            with open(part, "wb") as file:
                np.savez(
                    file,
                    version=VERSION,
                    run=self.run,
                    step=self.step,
                    frame=self.frame,
                    ledger=self.ledger,
                    x=self.x,
                    v=self.v,
                    f=self.f,
                    keys=np.array(list(self.carried)),
                    values=np.array(list(self.carried.values()), float),
                    fixes=np.array(list(self.records), str),
                    **records,
                )

        write_whole(path, save)

    @classmethod
    def read(cls, path: Path) -> Checkpoint:
        """Read a checkpoint. Raises OutputError when it is missing, broken or of another version."""
        try:
            with ZipFile(path) as archive:
                check_room(3.0 * sum(member.file_size for member in archive.infolist()), path)
            with np.load(path, allow_pickle=False) as data:
                if int(data["version"]) != VERSION:
                    raise OutputError(
                        f"{path} is of version {int(data['version'])}, this program reads {VERSION}: "
                        "go on with the program that wrote it, or run the scene again with --force"
                    )
                state = [data[name] for name in "xvf"]
                if any(array.dtype != np.float64 or array.shape != (len(state[0]), 3) for array in state):
                    raise ValueError("its arrays are not those of particles")
                if data["values"].dtype != np.float64 or not np.isfinite(data["values"]).all():
                    raise ValueError("its sums are not finite numbers")
                records = {
                    fix: _records(data[f"keys{n}"], data[f"first{n}"], _unpacked(data[f"data{n}"], path))
                    for n, fix in enumerate(data["fixes"].tolist())
                }
                return cls(
                    int(data["step"]),
                    int(data["frame"]),
                    *state,
                    dict(zip(data["keys"].tolist(), data["values"].tolist())),
                    str(data["run"]),
                    int(data["ledger"]),
                    records,
                )
        except OutputError:
            raise
        # A zip file has checksums, but what is read before they are compared may be anything: sizes, methods, headers.
        except Exception as error:
            raise OutputError(
                f"{path} cannot be read, it is missing or damaged ({error}): nothing to resume from; "
                "run the scene again with --force"
            ) from error


def _records(keys: np.ndarray, first: np.ndarray, data: np.ndarray) -> StateRecords:
    """Records whose parts fit together: the plugin reads them as they are. Raises ValueError."""
    count = len(keys)
    if keys.shape != (count, 2) or keys.dtype != np.int32 or first.shape != (count + 1,) or first.dtype != np.int64:
        raise ValueError("its records of fixes have other shapes")
    if first[0] != 0 or first[-1] != len(data) or (np.diff(first) < 0).any():
        raise ValueError("its records of fixes do not share out their bytes")
    return StateRecords(keys, first, data)


def _unpacked(packed: np.ndarray, path: Path) -> np.ndarray:
    """Decompress at most what fits in memory; uint8 bytes, shape (B,)."""
    stream = zlib.decompressobj()
    most = int(0.25 * available_memory())
    data = stream.decompress(packed.tobytes(), most)
    if not stream.eof:
        raise OutputError(f"{path}: the state of a fix is cut off, or larger than the free memory")
    return np.frombuffer(data, np.uint8)
