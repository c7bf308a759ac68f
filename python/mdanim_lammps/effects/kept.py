# SPDX-License-Identifier: GPL-2.0-only
"""Records of features in a trajectory: what does not change during a run, and the tables that its frames have because of it."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..features import facets
from ..model.grid import Grid
from ..scene.scene import SceneRecord
from .fields import Field

if TYPE_CHECKING:
    from typing import Self


class KeptRecord:
    """A record of a feature; a subclass is a frozen dataclass, and stands in `KEPT` of the feature's module ``kept``."""

    GROUP: ClassVar = "parameters/mdanim"
    """Group of the file whose attributes hold it."""
    TABLES: ClassVar[tuple[Field, ...]] = ()
    """Fields that frames may have because of it, in the order of their checksums."""
    UNLIKE: ClassVar = ""
    """Word for two records that differ, where runs with them cannot be compared frame by frame."""

    @classmethod
    def of(cls, scene: SceneRecord, grid: Grid | None) -> Self | None:
        """The record of a scene whose effects use these cells; None where there is nothing to keep."""
        raise NotImplementedError

    @classmethod
    def read(cls, attributes: Mapping[str, Any], shapes: Mapping[str, tuple[int, ...]]) -> Self | None:
        """The record of a file, from the attributes of its group and the shapes in one frame of those of TABLES that there are;
        None where there are no attributes of these names. Raises KeyError, ValueError, TypeError."""
        found = {f.name: attributes[f.name] for f in dataclasses.fields(cls) if f.name in attributes}
        return cls(**found) if found else None

    def write(self) -> dict[str, Any]:
        """Attributes from which it is read."""
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}

    def fields(self) -> tuple[Field, ...]:
        """Fields of TABLES that frames have, each with its ``counts``."""
        return ()

    def fault(self) -> str:
        """Fault of a record that was read, in words; empty where all is well."""
        return ""

    @classmethod
    def parted(cls, old: Self | None, new: Self | None) -> str:
        """Reason why a run with one record cannot go on with the other; empty where it can."""
        return ""

    def apart(self, first: Mapping[str, np.ndarray], second: Mapping[str, np.ndarray]) -> tuple[str, float] | None:
        """Name and distance [m] of what differs between two runs, by these `fields` of a frame of each; None for nothing."""
        return None


def kinds() -> dict[str, type[KeptRecord]]:
    """The kinds of records of all features, by name."""
    return {name: kind for facet in facets("kept") for name, kind in facet.KEPT.items()}


def records_of(scene: SceneRecord, grid: Grid | None) -> dict[str, KeptRecord]:
    """The records of a scene whose effects use these cells, by name."""
    found = {name: kind.of(scene, grid) for name, kind in kinds().items()}
    return {name: record for name, record in found.items() if record is not None}
