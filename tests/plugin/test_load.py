# SPDX-License-Identifier: GPL-2.0-only
"""Loading the plugin: into its own LAMMPS version, and not into another."""

import ctypes
import os
import re
import shutil
import subprocess
from pathlib import Path

import plugin_path
import pytest
from mdanim_lammps.engine import plugin
from mdanim_lammps.engine.plugin import ABI, VERSION, all_styles
from mdanim_lammps.errors import SetupError

FILE = Path(plugin_path.folder()) / "mdanimplugin.so"


def test_styles_and_numbers_are_those_python_asks_for():
    """LAMMPS has every style; the file tells the interface and version that the driver checks."""
    lmp = plugin_path.lammps()
    assert [lmp.has_style(kind, name) for kind, name in all_styles()] == [True] * len(all_styles())
    lmp.close()
    library = ctypes.CDLL(str(FILE))
    assert library.mdanim_abi() == ABI
    assert ctypes.c_int.in_dll(library, "mdanim_built_for").value == VERSION


@pytest.mark.parametrize("kept", [0, 10, 0.5, 0.999])
def test_a_plugin_that_is_cut_short_is_refused(tmp_path, monkeypatch, kept):
    """To map such a file would end the process with SIGBUS."""
    image = FILE.read_bytes()
    (tmp_path / "mdanimplugin.so").write_bytes(image[: int(kept * len(image)) if kept < 1 else kept])
    assert not plugin.is_cut_short(FILE)
    monkeypatch.setattr(plugin, "_FILE", tmp_path / "mdanimplugin.so")
    with pytest.raises(SetupError, match="is cut short or is not a library; reinstall"):
        plugin.open_lammps()


def test_the_styles_are_all_that_a_scene_asks_for():
    """A plugin that lacks a style of the engine's commands is refused."""
    sources = "".join(path.read_text() for path in Path(plugin.__file__).parents[1].rglob("*.py"))
    named = {*re.findall(r"mdanim/[a-z]+", sources)} - {"mdanim/test"}
    assert named <= {name for _, name in all_styles()}


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
    """Both are loaded by the program that loads the plugin; a second copy of either would be fatal."""
    if shutil.which("readelf") is None:
        pytest.skip("no readelf (binutils)")
    needed = subprocess.run(["readelf", "-d", str(FILE)], capture_output=True, text=True, check=True).stdout
    assert "NEEDED" in needed
    assert "lammps" not in needed.lower().replace("mdanim_lammps", "") and "libmpi" not in needed


# Properties of a host, changed: the plugin asks for them through these functions of the LAMMPS library.
HOSTS = {
    "another tagint": (
        "int lammps_extract_setting(void *, const char *what) { return what[0] == 't' ? 8 : what[0] == 'b' ? 8 : 4; }",
        "was built for tagint of 4 bytes and is not loaded into a LAMMPS that has 8",
    ),
    "no MPI": ("int lammps_config_has_mpi_support() { return 0; }", "needs a LAMMPS with MPI and is not loaded into one without"),
    "another MPI": (
        "int lammps_get_mpi_comm(void *) { return 3; }",
        "was built for MPICH and is not loaded into a LAMMPS with MPICH Version",
    ),
    "another layout": (
        "void *lammps_extract_global(void *, const char *) { return 0; }",
        "was built for another update of LAMMPS version 20250722, whose classes have another layout",
    ),
}


# Parts of run_style verlet, of which the headers tell nothing, as another build of the library may have them. That of the wheel
# has 344 bytes: lists up to 320, flags from 328 on.
VERLET = """
extern "C" {
void integrate(void *, void *, int, char **) __asm__("_ZN9LAMMPS_NS9IntegrateC2EPNS_6LAMMPSEiPPc");
void verlet(void *, void *, int, char **) __asm__("_ZN9LAMMPS_NS6VerletC2EPNS_6LAMMPSEiPPc");
void init(char *) __asm__("_ZN9LAMMPS_NS6Verlet4initEv");
extern const void *const table[12] __asm__("_ZTVN9LAMMPS_NS6VerletE");
"""
TABLE = "".join(
    f'extern const char {name}[] __asm__("{symbol}");\n'
    for name, symbol in {
        "type": "_ZTIN9LAMMPS_NS6VerletE",
        "end": "_ZN9LAMMPS_NS6VerletD1Ev",
        "remove": "_ZN9LAMMPS_NS6VerletD0Ev",
        "start": "_ZN9LAMMPS_NS6Verlet4initEv",
        "setup": "_ZN9LAMMPS_NS6Verlet5setupEi",
        "minimal": "_ZN9LAMMPS_NS6Verlet13setup_minimalEi",
        "run": "_ZN9LAMMPS_NS6Verlet3runEi",
        "clear": "_ZN9LAMMPS_NS6Verlet11force_clearEv",
        "clean": "_ZN9LAMMPS_NS6Verlet7cleanupEv",
        "reset": "_ZN9LAMMPS_NS9Integrate8reset_dtEv",
        "memory": "_ZN9LAMMPS_NS9Integrate12memory_usageEv",
    }.items()
)
VERLETS = {
    "a longer one": "void verlet(void *to, void *l, int n, char **a) { integrate(to, l, n, a); ((char *)to)[344 + 24] = 0; }",
    "no list where one is": "void verlet(void *to, void *l, int n, char **a) { integrate(to, l, n, a); ((char *)to)[312] = 1; }",
    "functions in another order": TABLE
    + "const void *const table[12] = {0, type, end, remove, start, setup, minimal, run, clear, reset, clean, memory};",
}
INITS = {
    "flags elsewhere": "void init(char *) {}",
    "more flags": "void init(char *to) { for (int n = 328; n <= 344; n += 4) *(int *)(to + n) = 0; }",
}


def preloaded(folder: Path, code: str) -> str:
    """LD_PRELOAD with a library of such functions; a sanitizer stays first."""
    (folder / "host.cpp").write_text(code)
    compiler = os.environ.get("CXX", "c++")
    subprocess.run([compiler, "-shared", "-fPIC", "-o", folder / "host.so", folder / "host.cpp"], check=True)
    return ":".join(filter(None, (os.environ.get("LD_PRELOAD"), str(folder / "host.so"))))


@pytest.mark.parametrize("host", [*HOSTS, *VERLETS])
def test_another_binary_interface_of_the_same_version_is_refused(tmp_path, host):
    """Load no style into a build of the right date that differs in what styles rely on, and say in what."""
    another = "was built for another update of LAMMPS version 20250722 or with another standard library: run_style verlet"
    code, message = HOSTS[host] if host in HOSTS else (VERLETS[host], another)
    (tmp_path / "in.info").write_text("info styles fix\nprint 'alive'\n")
    preload = preloaded(tmp_path, f'extern "C" {{ {code} }}\n' if host in HOSTS else f"{VERLET}{code}}}\n")
    done = plugin_path.bare_lmp(tmp_path / "in.info", FILE.parent, LD_PRELOAD=preload)
    assert done.returncode == 0 and "alive" in done.stdout, done.stderr
    assert "mdanim/leapfrog" not in done.stdout
    assert message in done.stderr


@pytest.mark.parametrize("host", INITS)
def test_flags_of_another_verlet_are_an_error_before_the_first_step(tmp_path, host):
    """The library's constructor does not write them, its init() does: where it writes elsewhere, it does so in other members."""
    (tmp_path / "in.run").write_text(
        "region all block 0 1 0 1 0 1\ncreate_box 1 all\nmass 1 1.0\nrun_style verlet/mdanim\nrun 0\nprint 'alive'\n"
    )
    preload = preloaded(tmp_path, f"{VERLET}{INITS[host]}}}\n")
    done = plugin_path.bare_lmp(tmp_path / "in.run", FILE.parent, LD_PRELOAD=preload)
    assert done.returncode != 0 and "alive" not in done.stdout
    assert "run_style verlet of this LAMMPS has another layout" in done.stdout + done.stderr


def test_lammps_hears_what_its_styles_were_built_for(tmp_path):
    """Give LAMMPS the date of the headers, not its own back: it compares the two, and tells where they differ."""
    image = FILE.read_bytes()
    date = b"22 Jul 2025\0"
    assert image.count(date) == 1
    (tmp_path / "mdanimplugin.so").write_bytes(image.replace(date, b"21 Jul 2025\0"))
    (tmp_path / "in.load").write_text(f"plugin load {tmp_path / 'mdanimplugin.so'}\n")
    done = plugin_path.bare_lmp(tmp_path / "in.load", tmp_path / "no plugins")
    assert "compiled for LAMMPS version 21 Jul 2025, loaded into LAMMPS version 22 Jul 2025" in done.stdout
