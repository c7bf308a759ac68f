# SPDX-License-Identifier: GPL-2.0-only
"""A run in formats of other programs (docs/export.md): one file of this folder for each format, one table of all; write.py writes
them."""

from __future__ import annotations

from typing import Any

from ..records import dataclass


@dataclass(frozen=True, slots=True)
class Format:
    """One row of the table."""

    module: str
    """File of this folder whose function ``write(cut, folder, stem, on_frame)`` writes the files; it returns notes for people."""
    suffixes: tuple[str, ...]
    """Suffixes of the files that it writes; the first one belongs to the name that is asked for."""
    about: str
    pieces: str = ""
    """Names of the files in the folder that is written beside the file of the first suffix; empty where there is none."""
    needs: str = ""
    """Module that only ``pip install 'mdanim-lammps[export]'`` brings."""
    liquid: bool = False
    """Whether it has the liquid, so that a run without objects can be written."""


FORMATS = {
    "usd": Format(
        "usd",
        (".usdc",),
        "USD: meshes over time, materials, liquid, camera, lamp; Blender, Houdini, usdview",
        needs="pxr",
        liquid=True,
    ),
    "gltf": Format("gltf", (".glb",), "glTF: meshes with a morph target for each frame; browsers, slides", liquid=True),
    "vtk": Format(
        "vtk",
        (".pvd", ".vtk"),
        "PVD series: surfaces, particles with velocity and strain, liquid; ParaView, PyVista",
        r"(surfaces|particles|liquid|drops)-\d{6,}\.vtp",
        liquid=True,
    ),
    "xyz": Format("xyz", (".xyz",), "extended XYZ in metres: particles with velocity and mass, box, time; OVITO, ASE"),
    "xtc": Format("xtc", (".xtc", ".gro"), "XTC with its GRO: particles, a tenth of the size, lengths scaled; VMD, MDAnalysis"),
    "lammpstrj": Format("lammpstrj", (".lammpstrj",), "the dump that lmp writes for the same scene, to the last digit"),
    "csv": Format("csv", (".csv",), "a row for each object and frame: centre, velocity, spin, energy; pandas, spreadsheets"),
}
"""Formats by the name that ``--to`` takes."""


def __getattr__(name: str) -> Any:
    """The function `export`, loaded when it is first asked for: the table alone needs no other module."""
    if name != "export":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .write import export

    return export
