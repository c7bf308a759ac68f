# SPDX-License-Identifier: GPL-2.0-only
"""Other words with which a scene would look the same, which features propose in their modules ``proposal``."""

from __future__ import annotations

from ..records import dataclass
from ..scene.scene import SceneRecord


@dataclass(frozen=True)
class Proposal:
    """Words for some objects of a scene."""

    words: str
    """Words to write into these objects."""
    groups: tuple[tuple[str, str], ...]
    """Groups of like objects: their name, and the figure by which that was decided."""
    how: str
    """How it was decided, for all groups."""
    scene: SceneRecord
    """The scene with these words."""
    ladder: str
    """Ladder of a study that tells how far motions differ."""
