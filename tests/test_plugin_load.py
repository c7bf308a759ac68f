# SPDX-License-Identifier: GPL-2.0-only
"""Loading the plugin: into its own LAMMPS version, and not into another."""

import ctypes
import shutil
from pathlib import Path

import plugin_path
import pytest
from mdanim_lammps.engine.plugin import ABI, STYLES, VERSION

FILE = Path(plugin_path.folder()) / "mdanimplugin.so"


def test_styles_and_numbers_are_those_python_asks_for():
    """LAMMPS has every style; the file tells the interface and version that the driver checks."""
    lmp = plugin_path.lammps()
    assert [lmp.has_style(kind, name) for kind, name in STYLES] == [True] * len(STYLES)
    lmp.close()
    library = ctypes.CDLL(str(FILE))
    assert library.mdanim_abi() == ABI
    assert ctypes.c_int.in_dll(library, "mdanim_built_for").value == VERSION


def test_another_lammps_version_is_refused_and_lmp_lives_on(tmp_path):
    """Make the file believe it was built for 29 Aug 2024: no style, one line that says why, exit code 0."""
    image = FILE.read_bytes()
    old = VERSION.to_bytes(4, "little")
    assert old in image
    (tmp_path / "mdanimplugin.so").write_bytes(image.replace(old, (20240829).to_bytes(4, "little")))
    (tmp_path / "in.info").write_text("info styles fix\nprint 'alive'\n")
    done = plugin_path.bare_lmp(tmp_path / "in.info", tmp_path)
    assert done.returncode == 0 and "alive" in done.stdout
    assert "mdanim/leapfrog" not in done.stdout
    assert "built for LAMMPS version 20240829 and is not loaded into version 20250722" in done.stderr


def test_loading_twice_is_harmless(tmp_path):
    """plugin load after LAMMPS_PLUGIN_PATH, and a second instance beside the first."""
    first, second = plugin_path.lammps(), plugin_path.lammps()
    first.command(f"plugin load {FILE}")
    second.close()
    assert first.has_style("fix", "mdanim/barrier")
    first.close()


def test_the_shared_object_needs_neither_liblammps_nor_libmpi():
    """Both are loaded by whoever loads the plugin; a second copy of either would be fatal."""
    import subprocess

    if shutil.which("readelf") is None:
        pytest.skip("no readelf (binutils)")
    needed = subprocess.run(["readelf", "-d", str(FILE)], capture_output=True, text=True, check=True).stdout
    assert "NEEDED" in needed
    assert "lammps" not in needed.lower().replace("mdanim_lammps", "") and "libmpi" not in needed
