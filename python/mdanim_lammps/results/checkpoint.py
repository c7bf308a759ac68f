# SPDX-License-Identifier: GPL-2.0-only
"""The checkpoint: everything that is needed to go on bit for bit."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..engine.state import Records, State, StateRecords
from ..errors import OutputError
from .files import write_whole

VERSION = 4
"""Of the file: 4 has the records of all fixes that keep any."""


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
    """What had been summed up by then: energies lost, deepest penetration, seconds."""
    run: str = ""
    """Which run this is a state of: another scene or time step cannot go on from it."""
    ledger: int = 0
    """Checksum of the ledger's rows up to this frame (`Ledger.checksum`)."""
    records: Records = field(default_factory=dict)
    """What fixes keep besides, by the ID of the fix."""

    @property
    def state(self) -> State:
        """What an instance takes up."""
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
            with np.load(path) as data:
                if int(data["version"]) != VERSION:
                    raise OutputError(
                        f"{path} is of version {int(data['version'])}, this program reads {VERSION}: "
                        "go on with the program that wrote it, or run the scene again with --force"
                    )
                records = {
                    fix: StateRecords(
                        data[f"keys{n}"], data[f"first{n}"], np.frombuffer(zlib.decompress(data[f"data{n}"]), np.uint8)
                    )
                    for n, fix in enumerate(data["fixes"].tolist())
                }
                return cls(
                    int(data["step"]),
                    int(data["frame"]),
                    data["x"],
                    data["v"],
                    data["f"],
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
