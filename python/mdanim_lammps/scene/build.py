# SPDX-License-Identifier: GPL-2.0-only
"""From settings to the frozen records of scene.py, with the checks that look at more than one setting."""

from __future__ import annotations

import math
import os
import re
from decimal import Decimal, InvalidOperation
from pathlib import Path

from ..errors import Span
from . import scene as records
from . import units
from .expand import Filled, Setting
from .keywords import BLOCKS, GLOBALS, IMMERSION, KEYWORDS, QUANTITIES, did_you_mean, example
from .limits import FARTHEST, MOST_BYTES_OF_MESH, MOST_FRAMES
from .rotation import IDENTITY, departure, rotation_about, rotation_euler
from .scene import Vector
from .source import Problems, Source, ordinary
from .wording import number, say, whole


def build(out: Filled, problems: Problems, name: str, source: Source) -> records.Scene | None:
    """The scene, or None where errors make it impossible."""
    return Builder(out, problems, Span(source.name, 1, 1)).scene(name, source.path)


class Builder:
    """Reads one Filled scene; every ``problem`` has a place."""

    def __init__(self, out: Filled, problems: Problems, top: Span):
        self.out, self.problems = out, problems
        self.top = top
        """The beginning of the scene, for problems of the scene as a whole."""
        self.by_kind: dict[str, list[Filled]] = {}
        for block in out.blocks:
            self.by_kind.setdefault(block.block, []).append(block)
        self.names = dict.fromkeys(b.name for b in self.blocks("object"))
        """Names of all objects, in the order of the scene."""

    def problem(self, span: Span | None, message: str, hint: str = "", severity: str = "error", key=None) -> None:
        self.problems.add(span, message, hint, severity, key)

    def blocks(self, kind: str) -> list[Filled]:
        return self.by_kind.get(kind, [])

    def scene(self, name: str, path: Path | None) -> records.Scene | None:
        """All records; None after an error."""
        self.one_of_each()
        solids = [s for s in map(self.solid, self.blocks("object")) if s is not None]
        liquids = self.blocks("liquid")
        liquid = self.liquid(liquids[0]) if liquids else None
        control = self.control()
        walls = self.walls()
        self.names_once()
        self.gravity_fits(liquids)
        self.ground_below(liquid)
        self.inside_walls(solids, walls)
        effects = self.effects()
        render = self.render(control)
        expects = self.expects(control)
        if not solids and not liquids and not self.out.excused("object") and not self.problems.errors:
            self.problem(
                self.top,
                "the scene has neither an object nor a liquid: there is nothing to compute",
                "write object NAME { ... }",
                key="empty",
            )
        if self.problems.errors or control is None:
            return None
        spans = {w: found[0].span() for w, found in self.out.settings.items() if w != "expect"}
        for block in self.blocks("effects"):
            spans |= {f"effects.{w}": found[0].span() for w, found in block.settings.items()}
        return records.Scene(
            name=name, control=control, title=self.out.value("title", ""),
            gravity=self.out.value("gravity", (0.0, 0.0, 0.0)), solids=tuple(solids), liquid=liquid,
            ground=self.out.value("ground"), walls=walls, effects=effects, render=render, expects=expects,
            path=path, spans=spans, warnings=tuple(self.problems.ordered()),
        )  # fmt: skip

    # -- several blocks at once

    def head(self, block: Filled) -> Span:
        """Place of a block's name, or of its word."""
        g = block.group
        return g.source.span(g.name.token, g.name.last) if g.name else g.source.span(g.token)

    def one_of_each(self) -> None:
        """Blocks that may stand only once."""
        for kind, rule in BLOCKS.items():
            found = self.blocks(kind)
            if not rule.many and len(found) > 1:
                for extra in found[1:]:
                    g = extra.group
                    self.problem(
                        g.source.span(g.token),
                        f"a second {kind} block; a scene has at most one",
                        f"the first is at {found[0].group.source.span(found[0].group.token)}",
                    )

    def names_once(self) -> None:
        """No two blocks of one name, and no name that expect uses for something else."""
        first: dict[str, Filled] = {}
        for block in (b for b in self.out.blocks if b.block in ("object", "liquid")):  # as they stand in the scene
            if block.name in first:
                self.problem(
                    self.head(block),
                    f"the name {block.name} is given twice{block.where}",
                    f"first given at {self.head(first[block.name])}",
                    key=("name", id(block.group)),
                )
            elif block.block == "object" and block.name in GLOBALS:
                self.problem(
                    self.head(block), f"an object cannot be called {block.name}: expect uses this word", "take another name"
                )
            first.setdefault(block.name, block)

    def ground_below(self, liquid: records.Liquid | None) -> None:
        """Ground above the floor of the basin holds solids up within the liquid."""
        ground = self.out.value("ground")
        if liquid is None or ground is None or not liquid.low[2] < ground < liquid.high[2]:
            return
        self.problem(
            self.out.first("ground").span(0),
            f"the ground at z = {say(ground, 'm', 6)} is above the floor of the basin, {say(liquid.low[2], 'm', 6)}: "
            "nothing sinks below it, liquid does",
            f"the basin has a floor of its own: leave the ground out, or write ground z {say(liquid.low[2], 'm', 6)}",
            severity="warning",
        )

    def gravity_fits(self, liquids: list[Filled]) -> None:
        """A liquid lies flat only under gravity along -z."""
        if not liquids or self.out.excused("gravity"):
            return
        given = self.out.first("gravity")
        g = given.values[0] if given else (0.0, 0.0, 0.0)
        if g[0] != 0.0 or g[1] != 0.0 or g[2] >= 0.0:
            span = given.span(0) if given else self.head(liquids[0])
            found = f"found {units.show(g)} m/s^2" if given else "the scene has no gravity"
            self.problem(span, f"a liquid needs gravity along -z, {found}", "e.g. gravity (0, 0, -9.81) m/s^2", key="gravity")

    def inside_walls(self, solids: list[records.Solid], walls: records.Walls | None) -> None:
        """An object's centre must lie between the walls; how far it reaches is checked with its model."""
        if walls is None:
            return
        for s in solids:
            if not all(a < x < b for a, x, b in zip(walls.low, s.position, walls.high)):
                self.problem(
                    s.spans["position"],
                    f"{s.name} stands outside the walls: its centre is {units.show(s.position)} m",
                    f"the walls go from {units.show(walls.low)} to {units.show(walls.high)} m",
                )

    # -- helpers for one block

    def complete(self, block: Filled) -> bool:
        """Whether everything needed is there; tells what is missing, and what is given twice over."""
        good = not block.broken
        title = f"{block.block} {block.name}".rstrip()
        for word, keyword in KEYWORDS[block.block].items():
            key = ("missing", id(block.group), keyword.one_of or word)
            if keyword.needed and word not in block.settings and not block.excused(word):
                self.problem(self.head(block), f"{title} has no {word}{block.where}", example(keyword), key=key)
                good = False
            if keyword.one_of and keyword.one_of[0] == word:
                given = [w for w in keyword.one_of if w in block.settings]
                if not given and not block.excused(*keyword.one_of):
                    this = " or ".join(keyword.one_of)
                    self.problem(self.head(block), f"{title} has no {this}{block.where}", example(keyword), key=key)
                    good = False
                elif len(given) > 1:
                    second = max((block.first(w) for w in given), key=lambda s: (s.entry.token.line, s.entry.token.column))
                    first = next(block.first(w) for w in given if block.first(w) is not second)
                    self.problem(
                        second.span(),
                        f"{title} has both {' and '.join(given)}; exactly one is needed",
                        f"remove one; the other stands at {first.span()}",
                        key=key,
                    )
                    good = False
        return good

    def spans(self, block: Filled) -> dict[str, Span]:
        """Where each keyword's values stand."""
        spans = {}
        for word, found in block.settings.items():
            s = found[0]
            values = [v for v in s.entry.values if v is not None]
            spans[word] = s.entry.source.span(values[0].first, values[-1].last) if values else s.span()
        spans[block.block] = self.head(block)
        return spans

    def corners(self, s: Setting, low: int, high: int, what: str) -> tuple[Vector, Vector]:
        """Two corners of a box, the lower one first."""
        a, b = s.values[low], s.values[high]
        for axis, x, y in zip("xyz", a, b):
            if not x < y:
                self.problem(
                    s.span(high),
                    f"{what} has no extent along {axis}: it goes from {say(x, 'm', 6)} to {say(y, 'm', 6)}",
                    "the lower corner stands first",
                )
        return a, b

    # -- blocks

    def solid(self, block: Filled) -> records.Solid | None:
        """One object."""
        if not self.complete(block):
            return None
        rotation = self.rotation(block)
        shape = self.shape(block)
        holds = tuple(self.hold(s) for s in block.settings.get("hold", ()))
        if rotation is None or shape is None:
            return None
        words, value = block.first("elasticity").entry.words, block.value
        self.near_enough(block, shape)
        elastic = records.SpringConstant(value("elasticity")) if words else records.Young(value("elasticity"))
        still = (0.0, 0.0, 0.0)
        return records.Solid(
            name=block.name, shape=shape, position=value("position"), rotation=rotation, elasticity=elastic,
            mass=value("mass"), density=value("density"), damping=value("damping", 0.0),
            velocity=value("velocity", still), spin=value("spin", still), drag=value("drag", 0.0),
            hold=holds, color=value("color"), spans=self.spans(block),
        )  # fmt: skip

    def shape(self, block: Filled) -> records.Shape | None:
        s = block.first("shape")
        kind, v = s.entry.words[0], s.values
        if kind == "torus" and v[1] >= v[0]:
            self.problem(
                s.span(1),
                f"the tube of a torus is thinner than the ring: r < R, found r = {say(v[1], 'm', 6)}, R = {say(v[0], 'm', 6)}",
                "write torus R r, the radius of the centre line first",
            )
            return None
        if kind == "mesh":
            path = Path(os.path.abspath(s.entry.source.folder / v[0]))
            if path.suffix.lower() not in (".stl", ".obj", ".ply"):
                self.problem(s.span(0), f"a mesh is an STL, OBJ or PLY file, found '{v[0]}'")
                return None
            if not os.path.exists(path):
                self.problem(s.span(0), f"the mesh file '{v[0]}' is not there: {path}", "its name is relative to this scene file")
                return None
            if not ordinary(path):
                self.problem(s.span(0), f"the mesh file '{v[0]}' is not an ordinary file", "copy the mesh beside the scene")
                return None
            if path.stat().st_size > MOST_BYTES_OF_MESH:
                self.problem(s.span(0), f"the mesh file '{v[0]}' is larger than {MOST_BYTES_OF_MESH >> 20} MB", "fewer triangles")
                return None
            return records.Mesh(path, 1.0 if v[1] is None else v[1])
        make = {
            "box": records.Box,
            "sphere": records.Sphere,
            "ellipsoid": records.Ellipsoid,
            "cylinder": records.Cylinder,
            "cone": records.Cone,
            "torus": records.Torus,
        }[kind]
        return make(*v)

    def near_enough(self, block: Filled, shape: records.Shape) -> None:
        """An object so far out that its particles differ by rounding alone is refused; a mesh is not known here."""
        if isinstance(shape, records.Mesh):
            return
        lengths = [x for v in block.first("shape").values for x in (v if isinstance(v, tuple) else (v,))]
        position = block.value("position")
        if max(map(abs, position)) > FARTHEST * min(lengths):
            self.problem(
                block.first("position").span(0),
                f"{block.name} is too far from the origin for its size: {units.show(position)} m with a length of "
                f"{say(min(lengths), 'm', 6)}",
                f"at most {number(FARTHEST)} times its smallest length",
            )

    def rotation(self, block: Filled) -> tuple[Vector, Vector, Vector] | None:
        s = block.first("orientation")
        if s is None:
            return IDENTITY
        kind = s.entry.words[0]
        if kind == "euler":
            return rotation_euler(s.values[0])
        if kind == "axis":
            axis, angle = s.values
            length = math.hypot(*axis)
            if not 1e-150 < length < 1e150:
                self.problem(
                    s.span(0), f"the axis of a rotation needs a direction, found {units.show(axis)}", "e.g. axis (0, 0, 1)"
                )
                return None
            return rotation_about(tuple(c / length for c in axis), angle)
        if departure(s.values) > 1e-9:
            self.problem(
                s.span(),
                "this matrix is not a rotation: its rows are not orthonormal and right-handed",
                "write orientation axis (x, y, z) angle a",
            )
            return None
        return s.values

    def hold(self, s: Setting) -> records.Hold:
        kind = s.entry.words[0]
        if kind == "all":
            return records.HoldAll()
        if kind == "within":
            return records.HoldWithin(*self.corners(s, 0, 1, "the held box"))
        sides = (s.values[0],) if kind == "face" else (f"-{s.values[0]}", f"+{s.values[0]}")
        return records.HoldFaces(tuple(map(records.Side, sides)))

    def liquid(self, block: Filled) -> records.Liquid | None:
        """The liquid, with its volume or level checked against what it starts in: the basin, or part of it."""
        if not self.complete(block):
            return None
        low, high = self.corners(block.first("basin"), 0, 1, "the basin")
        fill = self.fill(block, low, high)
        where = "the basin" if fill is None else "the fill region"
        bottom, top = (low, high) if fill is None else fill
        room = math.prod(b - a for a, b in zip(bottom, top))
        volume, level = block.value("volume"), block.value("level")
        if volume is not None and volume > room > 0.0:
            self.problem(
                block.first("volume").span(0),
                f"{say(volume, 'm^3', 6)} of liquid do not fit into {where} of {say(room, 'm^3', 6)}",
                "less liquid, or a larger basin" if fill is None else "less liquid, or a larger fill region",
            )
        if level is not None and not bottom[2] < level <= top[2]:
            self.problem(
                block.first("level").span(0),
                f"the level {say(level, 'm', 6)} is outside {where}, which goes from "
                f"{say(bottom[2], 'm', 6)} to {say(top[2], 'm', 6)}",
                "the level is a height, not a depth",
            )
        sweeps = block.value("sweeps")
        model = records.LiquidModel(block.value("model", "surface"))
        if model is records.LiquidModel.PAPER:
            self.problem(
                block.first("model").span(0),
                "model paper takes the rules literally: not Archimedes, objects denser than about 0.4 of the liquid sink",
                "leave the line out for drafts after Archimedes",
                severity="warning",
            )
        return records.Liquid(
            name=block.name, low=low, high=high, density=block.value("density"), volume=volume, level=level,
            drag=block.value("drag"), model=model, sweeps=None if sweeps is None else int(sweeps), fill=fill,
            color=block.value("color"), spans=self.spans(block),
        )  # fmt: skip

    def fill(self, block: Filled, low: Vector, high: Vector) -> tuple[Vector, Vector] | None:
        """The part of the basin that the liquid starts in; it must lie within the basin."""
        s = block.first("fill")
        if s is None:
            return None
        fill = self.corners(s, 0, 1, "the part that is filled")
        for which, (corner, name) in enumerate(zip(fill, ("lower", "upper"))):
            if not all(a <= x <= b for a, x, b in zip(low, corner, high)):
                self.problem(
                    s.span(which),
                    f"the {name} corner of fill lies outside the basin: {units.show(corner)} m",
                    f"the basin goes from {units.show(low)} to {units.show(high)} m",
                )
        return fill

    def walls(self) -> records.Walls | None:
        s = self.out.first("walls")
        return records.Walls(*self.corners(s, 0, 1, "the space between the walls")) if s else None

    def control(self) -> records.Control | None:
        found = self.blocks("control")
        if not found:
            if not self.out.excused("control"):
                self.problem(
                    self.top, "the scene has no control block: how long is it?", "write control { time 3 s }", key="control"
                )
            return None
        block = found[0]
        if not self.complete(block):
            return None
        value = block.value
        save = block.first("save")
        contact = value("contact-stiffness", 1.0)
        if value("frames", 30.0) * value("time") < 1.0:
            self.problem(
                block.first("time").span(0),
                f"in {number(value('time'), 6)} s there is not one frame of 1/{number(value('frames', 30.0), 6)} s",
                "a longer time, or more frames per second",
            )
        if value("frames", 30.0) * value("time") > MOST_FRAMES:
            self.problem(
                block.first("time").span(0),
                f"{number(value('time'), 6)} s have {number(value('frames', 30.0) * value('time'))} frames of "
                f"1/{number(value('frames', 30.0), 6)} s; the most is {whole(MOST_FRAMES)}",
                "a shorter time, or fewer frames per second",
            )
        return records.Control(
            time=value("time"), frames=value("frames", 30.0),
            timestep=value("timestep"), resolution=value("resolution"),
            accuracy=self.accuracy(block.first("accuracy")), contact_stiffness=contact,
            seed=int(value("seed", 1.0)),
            save=records.Save(value("save", "all")), single=bool(save) and save.values[1] == "single",
            spans=self.spans(block),
        )  # fmt: skip

    def accuracy(self, s: Setting | None) -> records.Accuracy | float:
        """A class, or the error aimed at as a fraction."""
        if s is None:
            return records.Accuracy.BALANCED
        if s.entry.words:
            return records.Accuracy(s.entry.words[0])
        match = re.fullmatch(r"\s*error\s+([0-9.eE+-]+)\s*%\s*", s.values[0])
        try:
            percent = Decimal(match[1]) if match else None
        except InvalidOperation:
            percent = None
        if percent is None or not 0 < percent < 100 or float(percent / 100) == 0.0:
            classes = ", ".join(a.value for a in records.Accuracy)
            self.problem(
                s.span(0),
                f'accuracy is {classes} or an error between 0 and 100 %, found "{s.values[0]}"',
                'write accuracy "error 2 %"',
            )
            return records.Accuracy.BALANCED
        return float(percent / 100)

    def effects(self) -> dict[str, records.Switch]:
        found = self.blocks("effects")
        return {w: records.Switch(s[0].values[0]) for w, s in found[0].settings.items()} if found else {}

    def render(self, control: records.Control | None) -> records.Render:
        found = self.blocks("render")
        if not found:
            return records.Render()
        block = found[0]
        size = block.first("size")
        cameras = tuple(self.camera(s, control) for s in block.settings.get("camera", ()))
        if len(cameras) > 1:
            self.camera_path(block, cameras)
        return records.Render(
            size=tuple(map(int, size.values[0])) if size else (1280, 720), movie=self.movie(block.first("movie")),
            background=block.value("background"), camera=cameras, liquid=block.value("liquid", "smooth"),
            spans=self.spans(block),
        )  # fmt: skip

    def movie(self, s: Setting | None) -> str | None:
        """The name of the movie: a file below the output folder, and none of the run's own."""
        if s is None:
            return None
        name = s.values[0]
        cause = ""
        if not name.isprintable():
            cause = "the name of a movie holds no characters that cannot be printed"
        elif Path(name).is_absolute() or ".." in Path(name).parts:
            cause = "the movie lies outside of the output folder"
        elif Path(name).suffix.lower() != ".mp4" or max(map(len, map(os.fsencode, Path(name).parts))) > 255:
            cause = "a movie is written as .mp4"
        if cause:
            shown = "".join(c if c.isprintable() else "?" for c in name)
            self.problem(s.span(0), f"{cause}: '{shown}'", 'write a name inside it, e.g. movie "ball.mp4"')
        return name

    def camera(self, s: Setting, control: records.Control | None) -> records.Camera:
        time, eye, look, up = s.values
        if isinstance(look, str):
            self.known_object(look, s.span(2))
        elif math.dist(eye, look) == 0.0:
            self.problem(s.span(2), "the camera stands where it looks", "move one of the two points")
        if time is not None and time < 0.0:
            self.problem(s.span(0), f"the camera's time must be >= 0, found {number(time, 6)} s")
        if up is not None and math.hypot(*up) == 0.0:
            self.problem(s.span(3), "up needs a direction, found (0, 0, 0)", "e.g. up (0, 0, 1)")
        return records.Camera(eye, look, time, (0.0, 0.0, 1.0) if up is None else up)

    def camera_path(self, block: Filled, cameras: tuple[records.Camera, ...]) -> None:
        """Several cameras are points of one path: each with a time of its own, in order."""
        last = -math.inf
        for s, camera in zip(block.settings["camera"], cameras):
            if camera.time is None:
                self.problem(s.span(), "several cameras make a path, and this one has no time", "write camera 2 s from ...")
            elif camera.time <= last:
                self.problem(
                    s.span(0), f"the times of the cameras must rise, found {number(camera.time, 6)} s after {number(last, 6)} s"
                )
            else:
                last = camera.time

    def known_object(self, name: str, span: Span) -> bool:
        """Whether an object has this name; tells it if not."""
        if name in self.names or self.out.excused("object"):
            return name in self.names
        hint = did_you_mean(name, list(self.names)[:2000])
        self.problem(span, f"no object is called {name}", hint if self.names else "the scene has no object")
        return False

    def expects(self, control: records.Control | None) -> tuple[records.Expect, ...]:
        return tuple(e for s in self.out.settings.get("expect", ()) if (e := self.expect(s, control)) is not None)

    def expect(self, s: Setting, control: records.Control | None) -> records.Expect | None:
        """One self-check, with the unit of its quantity."""
        (subject, quantity), time, value, tolerance = s.values
        kind = subject if subject in GLOBALS else "NAME"
        known = [q for k, q in QUANTITIES if k == kind]
        if kind == "NAME" and not self.known_subject(subject, quantity, s.span(0)):
            return None
        if (kind, quantity) not in QUANTITIES:
            self.problem(
                s.span(0), f"{quantity} is no quantity of {subject} that expect can check", did_you_mean(quantity, known)
            )
            return None
        if (kind == "liquid" or quantity in IMMERSION) and not self.blocks("liquid") and not self.out.excused("liquid"):
            self.problem(s.span(0), f"{subject}.{quantity} needs a liquid, and the scene has none")
        if time is not None and (time < 0.0 or (control is not None and time > control.time * (1.0 + 1e-9))):
            end = f", which ends at {number(control.time, 6)} s" if control else ""
            self.problem(s.span(1), f"{number(time, 6)} s lies outside the run{end}", "an earlier time, or a longer control time")
        dim = units.unit(QUANTITIES[kind, quantity][0]).dim
        numbers = []
        for n, (x, what) in enumerate(((value, "the value"), (tolerance, "the tolerance")), 2):
            if x is None:
                numbers.append(0.0)
                continue
            if units.dimension(x) not in (dim, units.NONE):
                self.problem(
                    s.span(n),
                    f"{subject}.{quantity} is {units.describe(dim)}, found {units.show(x)}, {units.describe(units.dimension(x))}",
                    f"units that fit: {' '.join(units.units_of(dim))}" if dim != units.NONE else "leave out the unit",
                )
                return None
            if not math.isfinite(units.magnitude(x)):
                self.problem(s.span(n), f"{what} is not a finite number")
            numbers.append(units.magnitude(x))
        if numbers[1] < 0.0:
            self.problem(s.span(3), f"the tolerance must be >= 0, found {units.show(tolerance)}")
        return records.Expect(subject, quantity, numbers[0], numbers[1], time, s.span())

    def known_subject(self, subject: str, quantity: str, span: Span) -> bool:
        """An object; or a word for the whole scene, mistyped."""
        if any(subject == b.name for b in self.blocks("liquid")):
            self.problem(span, f"the liquid is called liquid in expect, found {subject}", f"write liquid.{quantity}")
            return False
        if subject in self.names:
            return True
        if not self.out.excused("object"):
            hint = did_you_mean(subject, [*list(self.names)[:2000], *GLOBALS])
            self.problem(span, f"no object is called {subject}", hint)
        return False
