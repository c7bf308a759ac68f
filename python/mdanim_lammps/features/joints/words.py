# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to joints."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from enum import Enum
from typing import Any

from ...errors import Span
from ...records import dataclass
from ...scene.formatting import number, say, whole
from ...scene.holding import all_held
from ...scene.limits import Limit
from ...scene.naming import objects_by_name
from ...scene.schema import Block, Codec, Observable, Rule, Vector, Words, setting
from ...scene.units import NONE, Scalar, dimension, fitting, magnitude, show, unit

WORLD = "world"
"""Word for what never moves."""
RETURNS = Limit("restitution of stops", 1.0, way_out="1 is a stop that takes nothing")
MOST_JOINTS = 10**5
"""Joints of a scene."""

SWITCHES = {"joint": "a `joint` block"}

KINDS = {
    "weld": "it holds both objects as they are",
    "ball": "it holds one point, about which they turn in every direction",
    "hinge": "it turns about an axis",
    "slider": "it slides along an axis",
    "spring": "it pulls and pushes along the line of its two ends",
}
"""Kinds of joints, with the motions that they leave."""

HAVING = {
    "angle": ("hinge",),
    "way": ("slider", "spring"),
    "force": tuple(KINDS),
    "torque": ("weld", "hinge", "slider"),
    "gap": tuple(KINDS),
    "drive": ("hinge",),
    "power": ("hinge", "slider"),
}
"""Kinds of joints that have each quantity."""


def _quantities() -> Iterator[tuple[tuple[str, str], Observable]]:
    """Quantities of the joint of two objects, and of its kind where several kinds have it."""
    for what, of, about in (
        ("angle", "rad", "angle of the hinge that joins it to another object or to the world, 0 at the start"),
        ("way", "m", "way of its slider from the start, or the length of its spring"),
        ("force", "N", "size of the force in its joint"),
        ("torque", "N*m", "size of the torque in its joint"),
        ("gap", "m", "distance of the two points that its joint holds together"),
        ("drive", "N*m", "torque of motor, friction and stops of its hinge"),
        ("power", "J/s", "power of these, or of those of its slider"),
    ):
        kinds = HAVING[what] if len(HAVING[what]) > 1 else ()
        more = f"; of one kind of several `door.joint.{kinds[-1]}.{what}(frame)`" if kinds else ""
        yield ("NAME", f"joint.{what}"), Observable(of, f"{about}, `door.joint.{what}(frame)`{more}", "joint", takes="joined")
        for kind in kinds:
            told = f"{about}, of its joint {kind}, `door.joint.{kind}.{what}(frame)`"
            yield ("NAME", f"joint.{kind}.{what}"), Observable(of, told, "joint", takes="joined", narrows=True)


QUANTITIES = dict(_quantities())

MARGINS = {"joint gap": "how far a joint opens under its load; above 1/200 of the thinnest part of what it joins it shows"}

LEDGER = {
    "joints": "the energy of joints: that of their springs, and of what they are opened by [J]",
    "joint_heat": "what friction and dashpots of joints have taken so far, and what broke [J]",
    "work": "what motors have brought in so far [J]",
}
"""Columns of the ledger."""


class Joined(Enum):
    """Whether joined objects touch each other."""

    ON = "on"
    OFF = "off"


class Flag(Codec):
    """A word that is there or not."""

    def read(self, k: Any, choice: int, values: tuple) -> bool:
        return True

    def write(self, k: Any, value: bool) -> tuple[int, tuple] | None:
        return (0, ()) if value else None


class Several(Codec):
    """Several values, some of which may be left out."""

    def read(self, k: Any, choice: int, values: tuple) -> tuple:
        return values

    def write(self, k: Any, value: tuple | None) -> tuple[int, tuple] | None:
        return None if value is None else (0, value)


@dataclass(frozen=True, slots=True)
class Motor:
    """A motor of a hinge or slider: it drives the first object against the second towards a speed."""

    speed: Scalar
    """[rad/s] of a hinge, [m/s] of a slider."""
    torque: float | None = None
    """The most that it does [N*m]; None for no limit."""
    force: float | None = None
    """The same of a slider [N]."""

    @property
    def most(self) -> float | None:
        """Largest torque [N*m] or force [N]."""
        return self.force if self.torque is None else self.torque


class MotorCodec(Codec):
    """A `Motor`."""

    def read(self, k: Any, choice: int, values: tuple) -> Motor:
        for at, (what, value) in enumerate((("torque", values[1]), ("force", values[2])), 1):
            if value is not None and value <= 0.0:
                raise ValueError(f"the {what} of a motor must be > 0, found {number(value)}", f"leave {what} out: no limit", at)
        return Motor(*values)

    def write(self, k: Any, value: Motor | None) -> tuple[int, tuple] | None:
        return None if value is None else (0, (value.speed, value.torque, value.force))


@dataclass(frozen=True, slots=True)
class Joint:
    """Joints of one kind between some objects and another one, or the world."""

    kind: str
    """One of KINDS."""
    first: str
    """An object, all objects of a repeat or of a group."""
    second: str
    """The same, or ``world``."""
    at: Vector | None = setting(
        "<(x, y, z):m>", "Where it is at the start. Absent: the centre of the first one, unless that is a rope. Not of a spring.",
        "(0, 0, 1) m", default=None)  # fmt: skip
    """[m]"""
    axis: Vector | None = setting(
        "<(x, y, z)>", "Axis of a hinge, along which a slider slides. It goes with the second object.", "(0, 1, 0)",
        default=None)  # fmt: skip
    begin: Vector | None = setting(
        "<(x, y, z):m>", "End of a spring in the first object. Absent: its centre.", "(0, 0, 1) m", name="from",
        default=None)  # fmt: skip
    """[m]"""
    end: Vector | None = setting(
        "<(x, y, z):m>", "End of a spring in the second object, or in the world. Absent: the centre of the second object.",
        "(0, 0, 1) m", name="to", default=None)  # fmt: skip
    """[m]"""
    motor: Motor | None = setting(
        "speed <w:rad/s or m/s> [torque <M:N*m>] [force <F:N>]",
        "Drives the first object of a hinge or slider against the second towards this speed, about or along the axis, with the "
        "torque or force at most. Without these it is as hard as the joint, and gets there as fast as the joint bears.",
        "speed 60 rpm torque 2 N*m", default=None, codec=MotorCodec())  # fmt: skip
    limits: tuple[Scalar, Scalar] | None = setting(
        "<a:rad or m> to <b:rad or m>",
        "Range of the angle of a hinge or the way of a slider: those of the first object seen from the second, 0 at the start.",
        "-30 deg to 90 deg", default=None)  # fmt: skip
    restitution: float | None = setting(
        "<e>", "Part of its speed with which what meets a limit comes back. Absent: that of critical damping, 0.14, the least.",
        "0.5", Rule.NOT_NEGATIVE, default=None, limit=RETURNS)  # fmt: skip
    friction: Scalar | None = setting(
        "<M:N*m or N>", "Dry friction of a hinge, a torque, or of a slider, a force.", "0.1 N*m", Rule.NOT_NEGATIVE,
        default=None)  # fmt: skip
    breaks: tuple[float, float | None] | None = setting(
        "<F:N> [torque <M:N*m>]", "Force, and torque, above which it parts for good. Absent: it bears all.", "50 N",
        Rule.POSITIVE, codec=Several(), default=None)  # fmt: skip
    stiffness: float | None = setting(
        "<k:N/m>",
        "Of a spring; of all others, how hard it holds both points together. Absent: so hard that its gap does not show.",
        "2000 N/m", Rule.POSITIVE, default=None)  # fmt: skip
    """[N/m]"""
    length: float | None = setting(
        "<L:m>", "Length of a spring that neither pulls nor pushes. Absent: as long as it is at the start.", "20 cm",
        Rule.POSITIVE, default=None)  # fmt: skip
    """[m]"""
    damping: float | None = setting(
        "<c:N*s/m>", "Dashpot beside a spring.", "3 N*s/m", Rule.NOT_NEGATIVE, default=None)  # fmt: skip
    """[N*s/m]"""
    pulls: bool = setting(
        "only", "A spring that does not push, as a cable.", "only", default=False, codec=Flag())  # fmt: skip
    contact: Joined | None = setting(
        None, "Whether the objects that it joins touch each other. Absent: `off`, they may be inside each other, as links of a "
        "chain are; of a spring `on`.",
        "on", default=None, codec=Words(Joined))  # fmt: skip
    spans: Mapping[str, Span] = field(default_factory=dict, compare=False, repr=False)
    """Where each keyword's value stands; ``spans["joint"]`` is that of the names."""

    @property
    def words(self) -> str:
        """``hinge door frame``"""
        return f"{self.kind} {self.first} {self.second}"

    @property
    def touches(self) -> bool:
        """Whether contact acts between the objects that it joins."""
        return self.kind == "spring" if self.contact is None else self.contact is Joined.ON

    def moved(self, place: Any) -> Joint:
        """The joint of a group that is placed somewhere (scene/placement.py)."""
        moved = {name: place.point(at) for name in ("at", "begin", "end") if (at := getattr(self, name)) is not None}
        return replace(self, **moved, axis=None if self.axis is None else place.turn(self.axis))


class JointWords:
    """Joints of a scene."""

    joints: tuple[Joint, ...] = ()


SCENE = JointWords

BLOCKS = (
    Block(
        "joint",
        Joint,
        "joints",
        "Connects two objects, or an object and the `world`: `joint hinge door frame { at (0, 0, 1) m axis (0, 0, 1) }`. A "
        "`weld` holds them as they are, a `ball` holds a point, a `hinge` lets them turn about an axis, a `slider` slide along "
        "it, a `spring` pulls and pushes along the line of two points. The name of a repeat without its index, or of a group, "
        "stands for all of its objects: each of them has such a joint.",
        names=("first", "second"),
        kinds=KINDS,
        indexed=True,
        of_objects=True,
        instead=(WORLD,),
        many=True,
        in_group=True,
        order=30,
    ),
)

TAKES = {
    "at": ("weld", "ball", "hinge", "slider"),
    **dict.fromkeys(("axis", "motor", "limits", "restitution", "friction"), ("hinge", "slider")),
    **dict.fromkeys(("from", "to", "length", "damping", "pulls"), ("spring",)),
}
"""Kinds of joints that have a setting; all have the others."""
INSTEAD = {
    ("at", "spring"): "write from and to, its two ends",
    ("from", "slider"): "write at, the point, and limits for how far it slides",
    ("to", "slider"): "write at, the point, and limits for how far it slides",
    ("damping", "hinge"): "write friction 0.1 N*m",
    ("damping", "slider"): "write friction 1 N",
}
"""Ways out where a kind of joint has no such setting; else one is named that has."""


# --- checks: v is the scene/validate.Validator ----------------------------------------------------------------------


def check_joint(v: Any, block: Any, joint: Joint) -> Joint | None:
    """Settings that belong to the kind, in its units; two different things. All problems of a joint in one pass."""
    found = v.problems.errors
    _check_objects(v, block, joint)
    for word in joint.spans:
        if joint.kind not in (kinds := TAKES.get(word, tuple(KINDS))):
            cause = f"a {joint.kind} has no {word}: {KINDS[joint.kind]}"
            way_out = INSTEAD.get((word, joint.kind)) or f"leave it out, or write joint {' or '.join(kinds)}"
            v.problem(joint.spans[word], f"{cause}{block.where}", way_out)
    if joint.kind in TAKES["axis"]:
        if joint.axis is None and not block.excused("axis"):
            v.problem(block.head, f"joint {joint.words} has no axis{block.where}", f"e.g. axis (0, 1, 0): {KINDS[joint.kind]}")
        elif joint.axis is not None and not 1e-150 < math.hypot(*joint.axis) < 1e150:
            v.problem(joint.spans["axis"], "the axis of a joint needs a direction, found (0, 0, 0)", "e.g. axis (0, 1, 0)")
        _check_units(v, joint)
    elif joint.kind != "weld" and joint.breaks is not None and joint.breaks[1] is not None:
        cause = f"a {joint.kind} bears no torque: {KINDS[joint.kind]}"
        v.problem(joint.spans["breaks"], f"{cause}{block.where}", f"write breaks {number(joint.breaks[0])} N")
    if joint.kind == "spring" and joint.second == WORLD and joint.end is None and not block.excused("to"):
        cause = f"joint {joint.words} does not say where it ends in the world{block.where}"
        v.problem(block.head, cause, "e.g. to (0, 0, 2) m")
    return joint if v.problems.errors == found else None


def _check_objects(v: Any, block: Any, joint: Joint) -> None:
    """Two different things, the world behind the object, and not too many of them."""
    first, second = (v.named.get(name, ()) for name in block.names)
    if joint.first == WORLD:
        other = joint.second if joint.second != WORLD else "rod"
        v.problem(
            block.head, "the world stands behind the object that it is joined to", f"write joint {joint.kind} {other} world"
        )
    elif len(first) > 1 and len(second) > 1:
        cause = f"both {joint.first} and {joint.second} are several objects: which is joined to which?"
        v.problem(block.head, cause, f"write joint {joint.kind} {joint.first}[i] {joint.second}[i] in a repeat")
    elif first and list(first) == list(second):
        cause = f"{joint.first} cannot be joined to itself{block.where}"
        v.problem(block.head, cause, "write the name of another object, or world")
    made = v.memory["joints"] = v.memory.get("joints", 0) + max(1, len(first)) * max(1, len(second))
    if made > MOST_JOINTS:
        cause = f"this scene has more than {whole(MOST_JOINTS)} joints"
        v.problem(block.head, cause, "join fewer objects", key="joints")


def _check_units(v: Any, joint: Joint) -> None:
    """A hinge turns, a slider slides: units of its settings."""
    turns = joint.kind == "hinge"
    wanted = {"motor": "rad/s" if turns else "m/s", "limits": "rad" if turns else "m", "friction": "N*m" if turns else "N"}
    given = {
        "motor": [joint.motor.speed] if joint.motor else [],
        "limits": joint.limits or [],
        "friction": [] if joint.friction is None else [joint.friction],
    }
    for word, values in given.items():
        text, dim = wanted[word], unit(wanted[word]).dim
        if (other := next((value for value in values if dimension(value) not in (NONE, dim)), None)) is not None:
            cause = f"a {joint.kind} has its {word} in {text}, found {show(other)}: {KINDS[joint.kind]}"
            v.problem(joint.spans[word], cause, f"units that fit: {' '.join(fitting(text))}")
    if joint.motor and (joint.motor.force if turns else joint.motor.torque) is not None:
        wrong, right = ("force", "torque 2 N*m") if turns else ("torque", "force 20 N")
        v.problem(joint.spans["motor"], f"the motor of a {joint.kind} has no {wrong}: {KINDS[joint.kind]}", f"write {right}")
    if joint.restitution is not None and not joint.limits:
        cause = f"joint {joint.words} has a restitution and no limits: it is that of what meets a limit"
        v.problem(joint.spans["restitution"], cause, f"write limits {'-30 deg to 60 deg' if turns else '-10 cm to 20 cm'}")
    if joint.limits:
        low, high = map(magnitude, joint.limits)
        if not low <= 0.0 <= high or low == high:
            cause = f"limits from {say(low, wanted['limits'])} to {say(high, wanted['limits'])} do not hold the start, which is 0"
            order = "the lower one stands first" if low >= high else "it counts from the start, which lies between both"
            v.problem(joint.spans["limits"], cause, f"{order}: limits {'-30 deg to 60 deg' if turns else '-10 cm to 20 cm'}")


def check(v: Any, top: Mapping, held: Mapping) -> None:
    """Something that a joint joins can move."""
    solids = held["solids"]
    by_name = objects_by_name(s.name for s in solids)
    moves = [not all_held(s) for s in solids]
    for joint in held["joints"]:
        ends = [by_name.get(name, ()) for name in (joint.first, joint.second)]
        if not any(moves[m] for of in ends for m in of) and all(ends[: 1 if joint.second == WORLD else 2]):
            both = f"{joint.first} is held" if joint.second == WORLD else f"{joint.first} and {joint.second} are both held"
            v.problem(
                joint.spans["joint"], f"{both}: nothing of joint {joint.words} can move", "take hold all out of one of them"
            )


CHECKS = {"joint": check_joint}
