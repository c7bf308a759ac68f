# SPDX-License-Identifier: GPL-2.0-only
"""Settings of features that a study varies (study/), besides the number of cells and the time step."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import lru_cache
from typing import Any, ClassVar

from ..features import facets
from ..scene.scene import SceneRecord
from .context import Context


class Varied:
    """A setting; a subclass stands in `VARIED` of its feature's module ``vary``, as an instance."""

    name: ClassVar[str]
    """Name of its ladder, of its field of a study's Setting, and of its column in tables."""
    letter: ClassVar[str]
    """In names of files."""
    order: ClassVar[int]
    """Place among all, ascending."""
    color: ClassVar[str]
    """Colour of its line in the plot."""
    usual: ClassVar[Any]
    """The value that goes without saying; None where that is ``auto``."""
    word: ClassVar[str]
    """Keyword in a scene."""
    finer_is: ClassVar = ""
    """Name of finer values where a finer setting has finer values of it too, and where it shortens the time step; or empty."""
    converges: ClassVar = True
    """Whether values of its ladder approach a limit; else each is a model of its own, and an error tells what the model costs."""
    by_depth: ClassVar = False
    """Whether it shows in how deep objects sink in."""

    def of(self, scene: SceneRecord) -> Any:
        """Its value in a scene."""
        raise NotImplementedError

    def put(self, scene: SceneRecord, value: Any) -> SceneRecord:
        """A scene with this value."""
        raise NotImplementedError

    def said(self, scene: SceneRecord) -> bool:
        """Whether the scene says a value."""
        raise NotImplementedError

    def why_not(self, context: Context) -> str:
        """Reason why it makes no difference in a scene; empty where it does."""
        raise NotImplementedError

    def ladder(self, value: Any) -> Iterable[Any]:
        """Values around the scene's own, coarsest first."""
        raise NotImplementedError

    def size(self, value: Any) -> float:
        """The quantity that goes to zero along its ladder, up to a factor."""
        raise NotImplementedError

    def finer(self, value: Any, times: float) -> Any:
        """The value that goes with so many times as many cells across."""
        return value

    def stiffness(self, value: Any) -> float:
        """About the square of how many steps there are [-], up to a factor."""
        return 1.0

    def shown(self, value: Any) -> str:
        """The value in a column of a table."""
        return "auto" if value is None else f"{value:g}"

    def told(self, value: Any, number: Callable[[Any], str] = "{:g}".format) -> str:
        """The value behind others in a sentence: ``, contact-stiffness 4``; empty for the usual one."""
        return "" if value == self.usual else f", {self.word} {number(value)}"


@lru_cache(maxsize=1)
def varied() -> tuple[Varied, ...]:
    """The settings of all features."""
    return tuple(sorted((v for facet in facets("vary") for v in facet.VARIED), key=lambda v: v.order))
