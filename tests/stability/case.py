# SPDX-License-Identifier: GPL-2.0-only
"""Hard cases: a scene, what is measured in it, how much of that is allowed, and why. Building blocks for scenes.

Units: spacing 1 m. Solids of density 1 and elasticity 1 unless told, so the wave speed is C and a time of 1 is h sqrt(rho/E).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from trial import Trial

C = 1.2**0.5
"""Wave speed sqrt(1.2 E/rho) at E = rho = 1."""
CONTROL = "control { time 10^6 frames 0.01 fps resolution 1 contact-model paper }\n"
"""Frames so rare that they do not set the time step. The cases are of the paper's contact, those of surfaces.py not."""


@dataclass(frozen=True)
class Case:
    """One hard case. Everything measured is an error, so that small is good and a negative number is better than needed."""

    name: str
    scene: str
    """Text of the scene."""
    play: Callable[[str, bool], dict[str, float]]
    """Runs the text, in the long form or the short one, and measures."""
    most: dict[str, float]
    """The most that is allowed of each thing measured; each has to be measured."""
    why: str
    """Why these limits."""

    def measure(self, long: bool = False) -> dict[str, float]:
        """Play the case; what was measured, in the order of ``most``."""
        found = self.play(self.scene, long)
        if found.keys() != self.most.keys():
            raise KeyError(f"{self.name} measures {list(found)}, its limits are of {list(self.most)}")
        return {what: float(found[what]) for what in self.most}


def broken(case: Case, found: dict[str, float]) -> list[str]:
    """Quantities beyond their limits, in words; a NaN is."""
    return [
        f"{what} is {found[what]:.4g}, the most is {most:g} ({case.why})"
        for what, most in case.most.items()
        if not found[what] <= most
    ]


def block(name: str, size, position, young=1.0, density=1.0, more: str = "") -> str:
    """A cuboid; ``size`` in cells."""
    size, position = (", ".join(repr(float(a)) for a in v) for v in (size, position))
    return f"object {name} {{ shape box ({size}) position ({position}) density {density!r} elasticity {young!r} Pa {more} }}\n"


def velocity(x=0.0, y=0.0, z=0.0) -> str:
    """A setting."""
    return f"velocity ({float(x)!r}, {float(y)!r}, {float(z)!r})"


def refused(text: str, error: type[Exception], words: str, unstable: bool = False) -> dict[str, float]:
    """0 when the scene is refused with these words, 1 when it runs or the message is another one."""
    try:
        with Trial(text, unstable=unstable):
            return {"not refused": 1}
    except error as e:
        return {"not refused": words not in str(e)}
