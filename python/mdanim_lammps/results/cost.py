# SPDX-License-Identifier: GPL-2.0-only
"""Where the wall time of a run went: by effect, tied to the scene line that called for it, and by other work. Also cost.json."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path

from ..records import dataclass
from .files import read_json
from .stored import COST


@dataclass(frozen=True, slots=True)
class CostShare:
    """The cost of one effect."""

    seconds: float
    place: str | None = None
    """Scene line that called for it, ``file:line:column``."""
    clocks: Mapping[str, float] = field(default_factory=dict)
    """Seconds of each piece of it that has a clock of its own; empty where there is one only."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Seconds of a run; effects and other work add up to the wall time, but for what falls between two clocks."""

    wall: float
    """From the first word of the scene to the last frame [s]; pictures are not in it."""
    steps: int
    particles: int
    effects: Mapping[str, CostShare] = field(default_factory=dict)
    other: Mapping[str, float] = field(default_factory=dict)
    """Leap-frog, rest of the step, setup (loading and modelling), output, and what a resumed run had cost before [s]."""
    movie: float | None = None
    """Only in a forecast: time of the movie after the run [s]; None where it is unknown."""

    @property
    def total(self) -> float:
        """Wall seconds of the run, those before a resume included."""
        return self.wall

    @property
    def parts(self) -> dict[str, float]:
        """Seconds by effect and by other work."""
        return {name: part.seconds for name, part in self.effects.items()} | dict(self.other)

    @property
    def covered(self) -> float:
        """Sum of all parts over the wall time [-]."""
        return sum(self.parts.values()) / self.wall

    def to_json(self) -> dict:
        """Plain data for cost.json."""
        return {
            "wall": self.wall,
            "steps": self.steps,
            "particles": self.particles,
            "effects": {
                name: {
                    "seconds": part.seconds,
                    "share": part.seconds / self.wall,
                    "place": part.place,
                    **({"clocks": dict(part.clocks)} if part.clocks else {}),
                }
                for name, part in self.effects.items()
            },
            "other": dict(self.other),
            **({} if self.movie is None else {"movie": self.movie}),
        }

    @classmethod
    def read(cls, path: Path) -> Cost:
        """Read cost.json. Raises OutputError when it is missing or broken."""
        data = read_json(path, COST)
        effects = {
            name: CostShare(part["seconds"], part["place"], part.get("clocks", {})) for name, part in data["effects"].items()
        }
        return cls(data["wall"], data["steps"], data["particles"], effects, data["other"])
