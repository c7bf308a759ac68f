# SPDX-License-Identifier: GPL-2.0-only
"""Joints, ropes, drives and air against closed forms, in one table: ``python bench/links.py [--write] [WORD ...]``.

Cases are those of joint_scenes.py and forces.py, and of rope_cases.py, drive_cases.py and air_cases.py in tests/lab. With words
only rows whose name has one of them; ``--write`` puts the whole table into docs/physics-joints.md. The exit code is 1 where a row
is off by more than it may be.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import forces
import joint_scenes
from timing import markdown, replace_between

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import air_cases
import drive_cases
import rope_cases

PAGE = Path(__file__).parents[1] / "docs" / "physics-joints.md"


@dataclass(frozen=True)
class Row:
    """A case, and how far it may be off."""

    case: str
    form: str
    measure: Callable[[], tuple[float, float]]
    """The figure that is found, and the closed form."""
    within: float
    unit: str = ""
    scale: float = 0.0
    """By what the error is divided; 0: the closed form."""

    def cells(self) -> tuple[list[str], bool]:
        """Cells of the table, and whether the row is within."""
        found, wanted = self.measure()
        off = (found - wanted) / (self.scale or wanted)
        close = abs(off) <= self.within
        shown = [f"{wanted:.5g} {self.unit}", f"{found:.5g} {self.unit}", f"{off:+.1e}", f"{self.within:g}"]
        return [self.case, self.form, *(s.strip() for s in shown[:2]), shown[2] if close else f"**{shown[2]}**", shown[3]], close


def of_joints(case: str, form: str, within: float) -> Row:
    measure, unit = joint_scenes.CASES[case]
    return Row(case, form, measure, within, unit)


def of_ropes(case: str, form: str, unit: str = "") -> Row:
    measure, within = rope_cases.CASES[case]
    return Row(case, form, measure, within, unit)


def of_air(case: str, form: str) -> Row:
    measure, within = air_cases.CASES[case]
    return Row(case, form, measure, within, "m/s")


def slips() -> tuple[float, float]:
    wanted, found = forces.slip()
    return found, wanted


def rows() -> Iterator[Row]:
    """All rows, in the order of the table."""
    for angle, form in ((5, "4 K(sin α/2) √(I/(m g l/2))"), (120, "the same")):
        for kind in ("rigid", "20 MPa"):
            yield of_joints(f"period of a rod on a hinge, {angle}°, {kind}", form, 0.005)
    yield of_joints("period of a ball on a spring", "2π √(m/k)", 0.005)
    yield of_joints("force in the first joint of 20 links", "weight", 1e-4)
    yield Row("double pendulum, 10 s", "energy residual 0", lambda: (joint_scenes.double_pendulum(), 0.0), 1e-4, scale=1.0)
    yield of_ropes("sag of a chain of 40 particles, slack 1.1", "catenary", "m")
    for wrap in (90, 180):
        for kind in ("chain", "rope"):
            yield of_ropes(f"capstan, {kind}, {wrap} degrees", "e^(μα), μ = 0.3")
    for kind in ("chain", "rope"):
        yield of_ropes(f"whirls a ball on a joint, {kind}", "m v²/r", "N")
    yield of_joints("speed of a wheel after 1.5 s of 2 N m, M t/I", "M t/I", 0.01)
    yield of_joints("its speed at last, that of the motor", "60 rpm", 0.01)
    ball = "sphere 4 cm"
    for shape, kind, frequency in (("box (6, 6, 6) cm", "300 kPa", 5.0), (ball, "rigid", 3.0), (ball, "1 MPa", 2.0)):
        name = f"{shape.split()[0]} leaves a plate that shakes, {kind}, {frequency:g} Hz"
        yield Row(name, "a (2πf)² = g", partial(drive_cases.leaves, shape, kind, frequency), 0.02, "m/s²")
    yield Row("a block slips on a belt", "v/(μ g)", slips, 0.01, "s")
    for turns in (4, 100):
        name = f"slider-crank, {turns} turns, place of the piston"
        yield Row(name, "r cos ωt + √(l² − r² sin² ωt)", partial(joint_scenes.crank, turns), 1e-3, "m", joint_scenes.STROKE)
    yield of_air("plate face on, rigid, 40 cm, 1 cm of 40 kg/m^3", "√(2mg/ρCA) tanh 3")
    yield of_air("sheet face on, 40 cm, 1 mm of 300 kg/m^3", "√(2mg/ρCA) tanh 2")
    yield of_air("ball in wind, rigid, 5 m/s", "w t/(t + l/w), l = 4 m/ρCA")
    yield of_joints("force at which a joint breaks", "F", 0.02)


def main(words: list[str]) -> int:
    """Measure, print, and write if asked to; the exit code."""
    write = "--write" in words
    words = [word for word in words if word != "--write"]
    chosen = [row for row in rows() if not words or any(word in row.case for word in words)]
    if write and words:
        sys.exit("--write needs the whole table: leave the words out")
    table, close = [], True
    for row in chosen:
        cells, good = row.cells()
        print(*cells, sep="  ", file=sys.stderr, flush=True)
        table.append(cells)
        close &= good
    text = markdown(["case", "closed form", "it gives", "found", "off", "within"], table)
    print(text)
    if write:
        replace_between(PAGE, "links", text)
    return 0 if close else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
