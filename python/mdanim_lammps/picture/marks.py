# SPDX-License-Identifier: GPL-2.0-only
"""Marks that a picture shows beside the surfaces on request: names, springs and bounding boxes of objects."""

from __future__ import annotations

import numpy as np

from ..errors import UsageError
from ..records import dataclass
from ..results.trajectory_metadata import TrajectoryMetadata
from .pieces import MovingLines

MOST_NAMES = 200
"""More would cover the picture."""
CLEAR_SPRINGS = 600
"""More are drawn the fainter: a fine lattice would be one black patch."""
BOX_EDGES = np.array([(0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (0, 4), (1, 5), (2, 6), (3, 7)])
"""Corners are counted with x fastest, z slowest."""


@dataclass(frozen=True)
class Marks:
    """The marks that are asked for."""

    names: bool = False
    springs: bool = False
    """Instead of the surfaces, which would hide them."""
    boxes: bool = False


class MarkActors:
    """The actors of some marks.

    Args:
        marks: what is asked for.
        metadata: of the trajectory.
        dark: whether the background is.
        height: of the picture in pixels.

    Raises:
        UsageError: names of too many objects, or springs of a trajectory without inner particles.
    """

    def __init__(self, marks: Marks, metadata: TrajectoryMetadata, dark: bool, height: int):
        self.actors = []
        self._skin = metadata.skin
        grey = 0.95 if dark else 0.15
        self._springs = self._boxes = None
        if marks.springs:
            if len(metadata.bond) == 0:
                raise UsageError("--springs: this scene stores no inner particles; write 'save all' in its control block")
            ends = np.searchsorted(metadata.id, metadata.bond)
            self._springs = MovingLines(len(metadata.id), ends, (grey,) * 3, 1.0)
            self._springs.actor.GetProperty().SetOpacity(min(1.0, (CLEAR_SPRINGS / len(ends)) ** 0.5))
            self.actors.append(self._springs.actor)
        if marks.boxes:
            objects = len(metadata.names)
            edges = (BOX_EDGES + 8 * np.arange(objects)[:, None, None]).reshape(-1, 2)
            self._boxes = MovingLines(8 * objects, edges, (grey,) * 3, 1.5)
            self.actors.append(self._boxes.actor)
        self._names = self._name_actors(metadata, grey, height) if marks.names else []
        self.actors += self._names
        self.words = bool(self._names)
        """Whether some of them are words, which may reach anywhere."""

    def show(self, position: np.ndarray) -> None:
        """Go to a frame: positions of the particles [m], shape (N, 3)."""
        if self._springs:
            self._springs.move(position)
        if not (self._boxes or self._names):
            return
        low, high = self._skin.boxes(self._skin.vertices(position))
        if self._boxes:
            corner = np.stack([low, high], axis=1)  # (O, 2, 3)
            z, y, x = np.unravel_index(np.arange(8), (2, 2, 2))
            self._boxes.move(np.stack([corner[:, x, 0], corner[:, y, 1], corner[:, z, 2]], axis=-1).reshape(-1, 3))
        for actor, below, above in zip(self._names, low, high):
            actor.GetPositionCoordinate().SetValue(*((below[:2] + above[:2]) / 2), above[2])

    @staticmethod
    def _name_actors(metadata: TrajectoryMetadata, grey: float, height: int) -> list:
        from vtkmodules.vtkRenderingCore import vtkTextActor

        if len(metadata.names) > MOST_NAMES:
            raise UsageError(
                f"--names: names of {len(metadata.names)} objects would cover the picture; {MOST_NAMES} are the most"
            )
        actors = []
        for name in metadata.names:
            actor = vtkTextActor()
            actor.SetInput(name)
            actor.GetPositionCoordinate().SetCoordinateSystemToWorld()
            look = actor.GetTextProperty()
            look.SetFontFamilyToArial()
            look.SetFontSize(max(9, round(0.02 * height)))
            look.SetColor(grey, grey, grey)
            look.SetJustificationToCentered()
            actors.append(actor)
        return actors
