# SPDX-License-Identifier: GPL-2.0-only
"""A liquid in a trajectory: its basin, the surface in every frame, and the drops that fly."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...effects.fields import Field
from ...effects.kept import KeptRecord
from ...errors import OutputError
from ...model.grid import Grid
from ...records import dataclass
from ...scene.scene import Vector

MOST_DROPS = 2048
"""Drops of a liquid that fly at once, as in plugin/liquid/drops.h: where there are more, they merge."""
HEIGHT = Field("liquid_height", "m", per="column", dtype="float32", table="liquid/height")
"""Height of each column, shape (ny, nx): the surface that solids feel."""
RAW = Field("liquid_raw", "m", per="column", dtype="float32", table="liquid/raw")
"""Top of the topmost liquid cell of each column: NaN where a solid hides it, minus infinity where one keeps the column dry."""
DROPS = Field("liquid_drops", "m", per="row", dtype="float32", shape=(4,), table="liquid/drops")
"""Middle and radius of each drop; a radius of 0 is none."""
WAY = Field("liquid_way", "m", per="row", shape=(3,), table="liquid/way")
"""Displacement of a basin that moves from where it is at the start, one row."""


@dataclass(frozen=True, slots=True)
class Pool(KeptRecord):
    """The liquid, and the cells of the basin that holds it."""

    GROUP = "observables/liquid"
    TABLES = (HEIGHT, RAW, DROPS, WAY)
    UNLIKE = "liquids or basins"

    name: str
    low: Vector
    """Lower corner of the basin [m]."""
    high: Vector
    """Upper corner [m]."""
    shape: tuple[int, int, int]
    """Cells along x, y, z."""
    density: float
    """[kg/m^3]"""
    color: str = ""
    """``#rrggbb``, or empty where the renderer chooses."""
    most_drops: int = 0
    """Drops that a frame has room for."""
    moves: bool = False
    """Whether frames have the displacement of the basin."""

    @property
    def grid(self) -> Grid:
        """The cells alone."""
        return Grid(self.low, self.high, self.shape)

    @classmethod
    def of(cls, scene, grid):
        if grid is None or scene.liquid is None:
            return None
        liquid, drops = scene.liquid, MOST_DROPS if scene.liquid.drops else 0
        return cls(liquid.name, grid.low, grid.high, grid.shape, liquid.density, liquid.color or "", drops, liquid.moves)

    @classmethod
    def read(cls, attributes, shapes):
        own = [attributes[word] for word in ("name", "low", "high", "shape", "density", "color")]
        return cls(*own, shapes.get(DROPS.table, (0,))[0], WAY.table in shapes)

    def write(self):
        return {word: getattr(self, word) for word in ("name", "low", "high", "shape", "density", "color")}

    def fields(self):
        columns = [replace(field, counts=self.shape[1::-1]) for field in (HEIGHT, RAW)]
        drops = [replace(DROPS, counts=(self.most_drops,))] if self.most_drops else []
        return (*columns, *drops, *([replace(WAY, counts=(1,))] if self.moves else []))

    def fault(self):
        low, high, shape = (np.array(corner) for corner in (self.low, self.high, self.shape))
        if not re.fullmatch("(#[0-9a-fA-F]{6})?", self.color):
            return "a colour is not written as #rrggbb"
        box = low.shape == high.shape == shape.shape == (3,) and np.isfinite([low, high]).all()
        return "" if box and (low < high).all() and (shape > 0).all() else "the basin is not a box"

    @classmethod
    def parted(cls, old, new):
        if (old and old.grid) == (new and new.grid):
            return ""
        return f"holds {_described(old)}, this scene {_described(new)}"

    def apart(self, first, second):
        """The largest difference of heights."""
        if all(np.array_equal(first[f.name], second[f.name], equal_nan=True) for f in self.fields()):
            return None
        # A raw height that only one of them has (NaN, minus infinity) is not a height.
        heights = [(first[f.name], second[f.name]) for f in (HEIGHT, RAW)]
        both = [np.isfinite(x) & np.isfinite(y) for x, y in heights]
        return self.name, float(max(np.abs(x[b] - y[b]).max(initial=0.0) for (x, y), b in zip(heights, both)))


def _described(pool: Pool | None) -> str:
    return f"a liquid in {' x '.join(map(str, pool.shape))} cells" if pool else "no liquid"


class Track:
    """Further quantities of a trajectory with a liquid."""

    @property
    def liquid(self) -> Pool | None:
        """The liquid and its basin; None in a scene without."""
        return self.metadata.kept.get("liquid")

    def liquid_height(self, frame: int) -> np.ndarray:
        """Smooth height z of the liquid over each column of cells [m], float32, shape (ny, nx)."""
        return self._of_liquid(HEIGHT, frame)

    def liquid_raw(self, frame: int) -> np.ndarray:
        """Top of the topmost liquid cell of each column, z [m], float32, shape (ny, nx); NaN where a solid
        hides it, minus infinity where one keeps the column dry, as a hull does."""
        return self._of_liquid(RAW, frame)

    def liquid_drops(self, frame: int) -> np.ndarray:
        """Middle and radius of each drop of the liquid that flies [m], float32, shape (D, 4)."""
        if self.liquid is None or not self.liquid.most_drops:
            return np.zeros((0, 4), np.float32)
        rows = self._of_liquid(DROPS, frame)
        return rows[rows[:, 3] > 0.0]

    def liquid_way(self, frame: int) -> np.ndarray:
        """Displacement of the basin from where it is at the start [m], shape (3,): the grid of the liquid is there."""
        return self._of_liquid(WAY, frame)[0] if self.liquid is not None and self.liquid.moves else np.zeros(3)

    @cached_property
    def liquid_levels(self) -> np.ndarray:
        """Mean height z of the liquid over the basin [m], shape (F,)."""
        return np.array([self.liquid_height(i).mean(dtype=np.float64) for i in range(len(self))])

    def _of_liquid(self, field: Field, frame: int) -> np.ndarray:
        if self.liquid is None:
            raise OutputError(f"{self.path}: there is no liquid in this run")
        return self.field(field.name, frame)


KEPT = {"liquid": Pool}
