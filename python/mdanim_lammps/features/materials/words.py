# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from typing import Any

from ...scene.schema import Block, Codec, Keyword, setting

SWITCHES: dict[str, str] = {}


class Told(Codec):
    """A name that is not written out: what follows from it is."""

    def write(self, k: Keyword, value: Any) -> None:
        return None


class MaterialWords:
    """Settings of an object."""

    material: str | None = setting(
        "<MATERIAL>",
        "What it is made of: density, elasticity, friction, restitution or damping, and colour, as far as the object does not "
        "say them itself. [Materials](materials.md) are `steel`, `oak`, `rubber`, `ice` and others, and those of `material` "
        "blocks. What would not be seen to bend is `rigid`.",
        "oak", default=None, after="shape", shared=True, codec=Told(), compare=False)  # fmt: skip
    """Its name."""


OBJECT = MaterialWords

BLOCKS = (
    Block("material", None, "", "A material of one's own: settings for all objects that say `material NAME`. With a `material` "
          "in it, it has what that one has, as far as it does not say it itself; it may have the name of a known one, of which "
          "it then is another form. An object of it is rigid under the [same rule](materials.md#when-an-object-is-rigid).",
          names=("name",), many=True, of="object", order=5),
)  # fmt: skip
