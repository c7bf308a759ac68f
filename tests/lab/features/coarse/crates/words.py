# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to crates."""

from __future__ import annotations

from mdanim_lammps.scene.schema import Rule, setting

SWITCHES: dict[str, str] = {}


class CrateWords:
    """Settings of an object."""

    crate: int = setting("<n>", "Cells across its thinnest part. Absent: it is not a crate.", "1", Rule.COUNT, default=0)


OBJECT = CrateWords
