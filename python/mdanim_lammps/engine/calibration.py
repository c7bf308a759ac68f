# SPDX-License-Identifier: GPL-2.0-only
"""What this processor takes for a pass with vectors of each width, and for threads to come: measured in 0.1 s when LAMMPS
is loaded first on a machine, and kept in a file. It decides how fast a run is, never a bit of it."""

from __future__ import annotations

import ctypes
import json
import math
import os
import platform
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from .. import __version__
from ..errors import SetupError

CALIBRATION = "MDANIM_CALIBRATION"
"""Environment variable with the file, if it is not to be the one in the user's cache."""
TYPICAL_CALLING = 400.0
"""Nanoseconds, as plugin/passes/calibration.cpp has it."""
CALLS_OF_TASK = 10.0
"""The least that a thread is asked for, in calls, as plugin/passes/calibration.cpp has it."""


@dataclass(frozen=True)
class Calibration:
    """Nanoseconds, all of them measured."""

    widths: Mapping[str, tuple[float, float]]
    """For each width that runs here, the widest first: a particle's step in a pass over springs without and with dashpots."""
    waking: float | None
    """What a call takes longer than its tasks when the other threads sleep; None where no thread found a processor in time."""
    calling: float | None
    """The same when they are awake."""

    def fastest(self, damped: bool) -> str:
        """The width that is chosen for springs where some have dashpots, or none."""
        return min(self.widths, key=lambda width: self.widths[width][damped])

    @property
    def least_task(self) -> float:
        """The least that a thread is asked for [ns]."""
        return CALLS_OF_TASK * (self.calling or TYPICAL_CALLING)


def stored_at() -> Path:
    """The file that holds the calibration of this machine: home folders may be shared by machines with other processors."""
    if named := os.environ.get(CALIBRATION):
        return Path(named)
    cache = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(cache) / "mdanim-lammps" / f"calibration-{re.sub('[^a-z0-9]+', '-', processor().lower())}.json"


def stored() -> Calibration | None:
    """What the file holds; None where it is missing, broken, or of another processor or version."""
    try:
        data = json.loads(stored_at().read_text(encoding="utf-8"))
        widths = {str(name): (float(plain), float(damped)) for name, (plain, damped) in data["widths_ns"].items()}
        waking, calling = float(data["waking_ns"]), float(data["calling_ns"])
        good = all(0.0 < ns < math.inf for ns in (waking, calling, *(ns for pair in widths.values() for ns in pair)))
        return Calibration(widths, waking, calling) if good and {k: data[k] for k in holds_for()} == holds_for() else None
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, AttributeError):  # RuntimeError: there is no home folder
        return None


def holds_for() -> dict[str, str]:
    """What a calibration depends on: it holds where all of it is the same."""
    return {"processor": processor(), "version": __version__}


@lru_cache(maxsize=1)
def processor() -> str:
    """Name of this machine's processor."""
    with suppress(OSError, StopIteration):
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return platform.processor() or platform.machine()


@lru_cache(maxsize=1)
def calibrate(library: ctypes.CDLL) -> Calibration:
    """Let the plugin of this process know the calibration: the stored one, or what is measured now. Raises SetupError."""
    names, found = _widths(library), stored()
    if found is None or not set(names) <= set(found.widths):
        found = _measure(library, names)
        if found.waking and found.calling:
            with suppress(OSError, RuntimeError):  # where no file can be written each process measures for itself
                _store(found)
    numbers = [*(ns for name in names for ns in found.widths[name]), found.waking or 0.0, found.calling or 0.0]
    _call(library.mdanim_give_calibration, numbers)
    return Calibration({name: found.widths[name] for name in names}, found.waking, found.calling)


def _store(found: Calibration) -> None:
    path = stored_at()
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}")  # processes that begin together each write a whole file
    numbers = {"widths_ns": dict(found.widths), "waking_ns": found.waking, "calling_ns": found.calling}
    part.write_text(json.dumps(holds_for() | numbers, indent=1) + "\n", encoding="utf-8")
    part.replace(path)


def _widths(library: ctypes.CDLL) -> list[str]:
    library.mdanim_width_name.restype = ctypes.c_char_p
    names: list[str] = []
    while name := library.mdanim_width_name(ctypes.c_int(len(names))):
        names.append(name.decode())
    return names


def _measure(library: ctypes.CDLL, names: list[str]) -> Calibration:
    *pairs, waking, calling = _call(library.mdanim_calibrate, [0.0] * (2 * len(names) + 2))
    return Calibration(dict(zip(names, zip(pairs[::2], pairs[1::2]))), waking or None, calling or None)


def _call(function, numbers: Sequence[float]) -> list[float]:
    """The numbers as the function leaves them."""
    array = (ctypes.c_double * len(numbers))(*numbers)
    error = ctypes.create_string_buffer(1024)
    if function(array, error, ctypes.c_int(len(error))):
        raise SetupError(f"the plugin cannot be calibrated: {error.value.decode(errors='replace')}")
    return list(array)
