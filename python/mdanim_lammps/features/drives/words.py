# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

from ...records import dataclass
from ...scene.formatting import number, vector
from ...scene.schema import OneOf, Rule, Vector, setting
from ...scene.shapes import holds_all
from ..contact.words import ContactModel

SWITCHES = {"drives": "an object's `drive ...`, `key ...` or `release ...`"}

LEDGER = {"work": "what drives have brought in so far [J]"}
"""Columns of the ledger."""

RELEASE = "release"
"""Setting of an object whose hold ends."""
NEAR = 1e-9
"""Distance of two points that are one, over their distance from the origin."""
LEAST = 1e-6
"""Time between two keys, and from the start to the first one that is behind it [s]: a step is a part of it."""


@dataclass(frozen=True, slots=True)
class DriveVelocity:
    """Straight on."""

    FORMS: ClassVar = ("velocity <(vx, vy, vz):m/s>",)
    velocity: Vector
    """[m/s]"""

    def moved(self, place: Any) -> DriveVelocity:
        """The same of an object in a group that is placed."""
        return replace(self, velocity=place.turn(self.velocity))


@dataclass(frozen=True, slots=True)
class DriveTurn:
    """A rotation about an axis through a point."""

    FORMS: ClassVar = ("turn <(wx, wy, wz):rad/s> [about <(x, y, z):m>]",)
    rate: Vector
    """[rad/s]"""
    about: Vector | None = None
    """[m]; None is the position of the object."""

    def moved(self, place: Any) -> DriveTurn:
        """The same of an object in a group that is placed."""
        return replace(self, rate=place.turn(self.rate), about=None if self.about is None else place.point(self.about))


@dataclass(frozen=True, slots=True)
class DriveOscillation:
    """To and fro by d sin(2 pi f t)."""

    FORMS: ClassVar = ("oscillation <(dx, dy, dz):m> frequency <f:Hz> [phase <a:rad>]",)
    way: Vector
    """[m]"""
    frequency: float
    """[1/s]"""
    phase: float = 0.0
    """[rad]"""

    def moved(self, place: Any) -> DriveOscillation:
        """The same of an object in a group that is placed."""
        return replace(self, way=place.turn(self.way))


@dataclass(frozen=True, slots=True)
class DriveSurface:
    """The surface runs over an object that stands: a belt."""

    FORMS: ClassVar = ("surface <(vx, vy, vz):m/s>",)
    velocity: Vector
    """[m/s]"""

    def moved(self, place: Any) -> DriveSurface:
        """The same of an object in a group that is placed."""
        return replace(self, velocity=place.turn(self.velocity))


@dataclass(frozen=True, slots=True)
class ShiftKey:
    """A point of the path of walls or of a basin, which are not turned."""

    FORMS: ClassVar = ("<T:s> by <(x, y, z):m>",)
    time: float
    """[s]"""
    by: Vector
    """Displacement from the start [m]."""


@dataclass(frozen=True, slots=True)
class DriveKey:
    """A point of a path."""

    FORMS: ClassVar = ("<T:s> at <(x, y, z):m> [axis <(x, y, z)> angle <a:rad>]",)
    time: float
    """[s]"""
    at: Vector
    """Place of the object's centre [m]."""
    axis: Vector = (0.0, 0.0, 1.0)
    angle: float = 0.0
    """Turned by this about the axis from how it is at the start [rad]."""

    def moved(self, place: Any) -> DriveKey:
        """The same of an object in a group that is placed."""
        return replace(self, at=place.point(self.at), axis=place.turn(self.axis))

    @property
    def rotation(self) -> Vector:
        """Rotation vector [rad]."""
        length = math.hypot(*self.axis)
        return tuple(self.angle / length * a if self.angle else 0.0 for a in self.axis)


class DriveWords:
    """Settings of an object."""

    drive: tuple[DriveVelocity | DriveTurn | DriveOscillation | DriveSurface, ...] = setting(
        None,
        "How what is held of it moves: at a velocity, by turning about a point (absent: its `position`), which is moved along by "
        "the others, or to and fro by d sin(2 π f t + phase) from where it is at the start. Several add up; turns are about one "
        "point. `surface` has its surface run along at this velocity while it stands, as that of a belt does: friction feels it.",
        "velocity (0.5, 0, 0) m/s", default=(), many=True,
        codec=OneOf(DriveVelocity, DriveTurn, DriveOscillation, DriveSurface),
        after="hold")  # fmt: skip
    key_points: tuple[DriveKey, ...] = setting(
        None,
        "What is held of it follows a smooth path: its centre is there at time T, turned by the angle from how it is at the "
        "start. Before the first key it goes there from its `position`, behind the last one and between two that are equal it "
        "stays. `drive` adds to it.",
        "1 s at (0, 0, 0.5) m", default=(), name="key", many=True, codec=OneOf(DriveKey), after="drive")  # fmt: skip
    release: float | None = setting(
        "<T:s>",
        "From this time on what is held of it is free, and goes on with the velocity that it has. Until then it stands, or goes "
        "as `drive` and `key` say.",
        "1 s", Rule.NOT_NEGATIVE, default=None, after="key")  # fmt: skip
    """[s]; None is never."""


OBJECT = DriveWords


def lets_go(solid: Any) -> bool:
    """Whether what is held of an object moves by forces later on."""
    return solid.release is not None and bool(solid.hold)


# --- checks: v is the scene/validate.Validator ----------------------------------------------------------------------


def check_object(v: Any, block: Any, solid: Any) -> Any:
    """Turns are about one point, oscillations have a frequency, keys ascend, from where the object is."""
    drives, keys = block.settings.get("drive", ()), block.settings.get("key", ())
    turns = [(s, one) for s, one in zip(drives, solid.drive) if isinstance(one, DriveTurn)]
    points = [solid.position if one.about is None else one.about for _, one in turns]
    for (s, _), point in zip(turns[1:], points[1:]):
        if math.dist(point, points[0]) > NEAR * (1.0 + math.hypot(*point)):
            both = f"{vector(points[0])} m and about {vector(point)} m"
            cause = f"{solid.name} turns about {both}{block.where}; turns are about one point"
            v.problem(s.span(), cause, "write the same point behind about, or add a drive velocity or oscillation")
    _check_surface(v, block, solid)
    said = next((s for word in ("drive", "key", RELEASE) if (s := block.first(word)) is not None), None)
    if said is not None and not solid.hold and not block.excused("hold"):
        cause = f"nothing of {solid.name} is held, so nothing of it can be driven or released{block.where}"
        v.problem(said.span(), cause, "write hold all, or hold face -x for a part of it")
    for s, one in zip(drives, solid.drive):
        if isinstance(one, DriveOscillation) and not one.frequency > 0.0:
            _no_frequency(v, s, one)
    _check_keys(v, keys, solid)
    if holds_all(solid.hold):
        how, end = "as a whole", f", or leave out the hold or the {{}}{block.where}"
        if lets_go(solid):
            how, end = f"until {number(solid.release, 6)} s", ", which it keeps when it is let go"
        for word, drive in (("velocity", "velocity (1, 0, 0) m/s"), ("spin", "turn (0, 0, 3) rad/s")):
            if (s := block.first(word)) is not None and any(getattr(solid, word)):
                cause = f"{solid.name} is held {how}, and its {word} is not used"
                v.problem(s.span(), cause, f"write drive {drive}{end.format(word)}", "warning", ("held", word, id(block.group)))
    return solid


def _check_surface(v: Any, block: Any, solid: Any) -> None:
    """A surface runs over what is held as a whole, is not turned, and is not let go."""
    drives = block.settings.get("drive", ())
    at = next((s for s, one in zip(drives, solid.drive) if isinstance(one, DriveSurface)), None)
    if at is None:
        return
    if solid.hold and not holds_all(solid.hold):
        cause = f"the surface of {solid.name} runs, and it is held in a part: a surface runs over what does not deform"
        v.problem(at.span(), cause, f"write hold all in {solid.name}")
    if any(isinstance(one, DriveTurn) for one in solid.drive) or any(key.angle for key in solid.key_points):
        cause = f"the surface of {solid.name} runs along one direction of the world, and {solid.name} is turned"
        v.problem(at.span(), cause, "leave the turn out, or the drive surface: a drum that turns moves its surface by itself")
    if solid.release is not None:
        cause = f"the surface of {solid.name} runs while it is held, and it is let go"
        v.problem(at.span(), cause, "leave the release out, or drive the object itself by drive velocity")


def check_shift(v: Any, what: str, said: Sequence[tuple[Any, Any]]) -> None:
    """Motions of walls or of a basin (``what``): oscillations have a frequency, keys ascend from where it is. Settings, each with
    what it says."""
    for s, one in said:
        if isinstance(one, DriveOscillation) and not one.frequency > 0.0:
            _no_frequency(v, s, one)
    keys = [(s, one) for s, one in said if isinstance(one, ShiftKey)]
    check_times(v, [s for s, _ in keys], [key for _, key in keys])
    for s, key in keys:
        if key.time == 0.0 and any(key.by):
            cause = f"at 0 s {what} is where the scene has it, and this key has it {vector(key.by)} m from there"
            v.problem(s.span(), cause, "leave the key at 0 s out")


def _no_frequency(v: Any, s: Any, one: DriveOscillation) -> None:
    v.problem(s.span(1), f"the frequency of a drive must be > 0, found {number(one.frequency, 6)} Hz", "e.g. frequency 5 Hz")


def _check_keys(v: Any, settings: Any, solid: Any) -> None:
    check_times(v, settings, solid.key_points)
    for s, key in zip(settings, solid.key_points):
        if key.angle and not 1e-150 < math.hypot(*key.axis) < 1e150:
            v.problem(s.span(2), f"the axis of a key needs a direction, found {vector(key.axis)}", "e.g. axis (0, 0, 1)")
        away = math.dist(key.at, solid.position)
        if key.time == 0.0 and (away > NEAR * (1.0 + math.hypot(*key.at)) or key.angle):
            cause = (
                f"at 0 s {solid.name} is at its position {vector(solid.position)} m, and this key has it at {vector(key.at)} m"
            )
            if key.angle:
                cause = f"at 0 s {solid.name} is turned as its orientation says, and this key turns it"
            v.problem(s.span(1), cause, "leave the key at 0 s out, or change position and orientation")


def check_times(v: Any, settings: Sequence[Any], points: Sequence[Any]) -> None:
    """Keys whose times rise, from the start on and not too near to each other: settings, each with what it says."""
    last = -math.inf
    for s, key in zip(settings, points):
        if key.time < 0.0:
            v.problem(s.span(0), f"the time of a key must be >= 0, found {number(key.time, 6)} s", "the run begins at 0 s")
        elif key.time <= last:
            cause = f"the times of keys must rise, found {number(key.time, 6)} s after {number(last, 6)} s"
            v.problem(s.span(0), cause, "write the keys in the order of their times, one for each")
        elif key.time and (after := key.time - max(last, 0.0)) < LEAST:
            found = f"{number(after, 6)} s after {number(max(last, 0.0), 6)} s"
            cause = f"a key must be at least {number(LEAST)} s after the start and after the one before, found {found}"
            v.problem(s.span(0), cause, "write the key later, or leave it out")
        last = max(last, key.time)


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """Objects that are let go when the run has ended; surfaces that run without friction."""
    if (control := held["control"]) is None:
        return
    belts = [solid for solid in held["solids"] if any(isinstance(one, DriveSurface) for one in solid.drive)]
    if belts and control.contact_model is ContactModel.PAPER:
        cause = f"the surface of {belts[0].name} runs, and contact-model paper has no friction that would feel it"
        v.problem(belts[0].spans["drive"], cause, "take contact-model paper out of control")
    for solid in held["solids"]:
        if lets_go(solid) and solid.release >= control.time:
            cause = f"{solid.name} is let go at {number(solid.release, 6)} s, and the run ends at {number(control.time, 6)} s"
            v.problem(solid.spans[RELEASE], cause, "write an earlier time behind release", severity="warning")


CHECKS = {"object": check_object}
