# SPDX-License-Identifier: GPL-2.0-only
"""Where joints let things be."""

from __future__ import annotations

from ...reach import Motion
from .hung import hung
from .links import NOTHING, links_of


class JointMotion(Motion):
    """Objects that joints hold, unite and let pass; without joints there are none."""

    def joins(self, scene):
        return links_of(scene).pairs if scene.joints else ()

    def unites(self, scene):
        groups = links_of(scene).whole_of.values() if scene.joints else ()
        return {group[0]: group for group in groups}.values()

    def hangs(self, scene):
        return hung(links_of(scene)) if scene.joints else ()

    def holds(self, scene):
        return links_of(scene).leashes if scene.joints else {}

    def passes(self, scene):
        return links_of(scene).passing if scene.joints else ()

    def untold(self, scene):
        ends = (m for link in links_of(scene).all for m in (link.first, link.named)) if scene.joints else ()
        return {m: "its joint pulls at it, and frames do not tell that from contact" for m in ends if m != NOTHING}
