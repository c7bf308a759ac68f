# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from typing import Any

from ...scene.schema import Codec, Keyword, setting

SWITCHES: dict[str, str] = {}


class Origin(Codec):
    """A choice that is not written out: the position follows from it."""

    def write(self, k: Keyword, value: Any) -> None:
        return None


class OriginWords:
    """Settings of an object."""

    origin: str = setting(
        "<centre|file>",
        "`file`: a mesh stays where its file has it, times `scale`; a `position` is then where the origin of the file goes, and "
        "`orientation` turns about it. Absent: `position` is the centre of mass.",
        "file", default="centre", after="position", codec=Origin(), compare=False)  # fmt: skip


OBJECT = OriginWords
