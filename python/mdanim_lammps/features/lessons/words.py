# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from ...scene.schema import setting

SWITCHES: dict[str, str] = {}


class LessonWords:
    """Settings outside of all blocks."""

    question: str = setting(
        '<"text">', "What a lesson asks; the page that `mdanim-lammps lesson` makes shows it above the film.",
        '"Which ball lands first?"', default="")  # fmt: skip
    answer: str = setting(
        '<"text">', "What it answers, which that page shows when it is asked for.",
        '"Both land at once."', default="")  # fmt: skip


SCENE = LessonWords
