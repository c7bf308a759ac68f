# SPDX-License-Identifier: GPL-2.0-only
"""From evaluated settings to the frozen records of scene.py, with the checks that look at more than one value."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

from ..errors import Span
from ..features import facets
from . import keywords
from . import scene as records
from .asked import ASKED, asked_for, check_render, check_shown_in_time, shown
from .evaluated import EvaluatedBlock, EvaluatedSetting, around
from .formatting import number, say, whole
from .keywords import BLOCKS, KEYWORDS, Block, did_you_mean, example, examples
from .lammps_lines import commands
from .limits import MOST_FRAMES
from .meshes import beside, refusal_of_mesh
from .naming import bare_name, objects_by_name
from .placement import Placement, beyond_limits
from .render import SMOOTH_RATE, few_pictures
from .scene import GLOBALS, Vector
from .schema import OneOf
from .shapes import mesh_of, with_path
from .source import Problems, SceneFile


def validate(out: EvaluatedBlock, problems: Problems, name: str, source: SceneFile) -> records.SceneRecord | None:
    """The scene, or None where errors make it impossible."""
    validator = Validator(out, problems, Span(source.name, 1, 1))
    for facet in facets("follow"):
        facet.fill(validator)
    return validator.scene(name, source.path)


def validate_render(out: EvaluatedBlock, problems: Problems, names: Sequence[str], source: SceneFile) -> records.Render | None:
    """The render block of a file for a scene with objects of these names; None after an error."""
    return Validator(out, problems, Span(source.name, 1, 1), names).render()


class Validator:
    """Makes the records of one scene; every ``problem`` has a place."""

    def __init__(self, out: EvaluatedBlock, problems: Problems, top: Span, names: Sequence[str] = ()):
        self.out, self.problems = out, problems
        self.has_scene = not names
        """Whether there is a whole scene, not a render block alone."""
        self.top = top
        """The beginning of the scene, for problems of the scene as a whole."""
        self.by_kind: dict[str, list[EvaluatedBlock]] = {}
        for block in out.blocks:
            self.by_kind.setdefault(block.block, []).append(block)
        self.names = dict.fromkeys((*names, *(b.name for b in self.blocks("object"))))
        """Names of all objects, in the order of the scene."""
        self.places: dict[int, Placement | None] = {}
        """Where groups stand in the world, by the id of their block."""
        self.touched = {word: kind for words in facets("words") for word, kind in getattr(words, "TOUCHED", {}).items()}
        """Words for what objects touch, and the kinds of block that bring it; empty for a setting of that name."""
        self.memory: dict[str, Any] = {}
        """Memory of the checks of features from one block to the next."""

    @cached_property
    def named(self) -> dict[str, list[int]]:
        """Numbers of the objects that each name of a contact block may stand for."""
        return objects_by_name(self.names)

    @cached_property
    def own_names(self) -> dict[str, str]:
        """Names of blocks that ``expect`` knows by their word, each with the word."""
        return {b.name: b.block for b in self.out.blocks if b.block in GLOBALS}

    def problem(self, span: Span | None, message: str, hint: str = "", severity: str = "error", key=None) -> None:
        self.problems.add(span, message, hint, severity, key)

    def blocks(self, kind: str) -> list[EvaluatedBlock]:
        return self.by_kind.get(kind, [])

    def scene(self, name: str, path: Path | None) -> records.SceneRecord | None:
        """All records; None after an error."""
        self.one_of_each()
        held = {block.field: self.records(block) for block in BLOCKS.values() if block.field}
        top, control = self.settings(self.out) or {}, held["control"]
        if not self.blocks("control") and not self.out.excused("control"):
            self.problem(self.top, "the scene has no control block: how long is it?", "write control { time 3 s }", key="control")
        self.names_once()
        for words in facets("words"):
            if hasattr(words, "check"):
                words.check(self, top, held)
        for facet in facets("places"):
            facet.check(self, held)
        held["control"] = control = self.frames(control, held["render"])
        check_shown_in_time(self, control, held["render"])
        if held["render"] is None:
            for block in self.blocks("render")[:1]:
                shown(self, block)
        self.cameras()
        top |= asked_for(self, control)
        enough = [block for block in BLOCKS.values() if block.enough]
        if not any(held[b.field] for b in enough) and not self.out.excused("object") and not self.problems.errors:
            cause = f"the scene has neither an {' nor a '.join(b.name for b in enough)}: there is nothing to compute"
            self.problem(self.top, cause, "write object NAME { ... }", key="empty")
        if self.problems.errors or control is None:
            return None
        spans = {w: found[0].span() for w, found in self.out.settings.items() if not isinstance(KEYWORDS[""][w].codec, ASKED)}
        for block in self.blocks("effects"):
            spans |= {f"effects.{w}": found[0].span() for w, found in block.settings.items()}
        held = {field: value for field, value in held.items() if value is not None}
        return keywords.SCENE(name=name, path=path, spans=spans, warnings=tuple(self.problems.ordered()), **held, **top)

    def quantities(self) -> Iterator[tuple[tuple, Span]]:
        """Quantities that the scene asks for, each as subject, word and argument, with its place."""
        for block in (self.out, *self.blocks("render")):
            for s in (s for found in block.settings.values() for s in found):
                places = (n for n, value in enumerate(s.entry.values) if value is not None and value.slot.kind == "check")
                yield from ((s.values[n], s.span(n)) for n in places)

    def render(self) -> records.Render | None:
        """The render block alone; None after an error."""
        self.one_of_each()
        found = self.records(BLOCKS["render"])
        self.cameras()
        return found

    # -- from settings to records

    def records(self, kind: Block) -> Any:
        """The records of one kind of block in the scene: a tuple, one record, a mapping, or None."""
        found = self.blocks(kind.name)
        if kind.raw:
            return tuple(command for block in found for command in commands(block))
        if kind.record is None:
            return self.settings(found[0]) if found else {}
        made = tuple(r for r in (self.record(kind, b) for b in (found if kind.many else found[:1])) if r is not None)
        made = _divided(self, kind, made)
        return made if kind.many else made[0] if made else None

    def record(self, kind: Block, block: EvaluatedBlock) -> Any:
        """One block with the checks of its kind (``check_KIND``); None after an error."""
        if kind.of_objects:
            block.names = tuple(self.meant(block, name) for name in block.names)
            places = (block.group.source.span(name.token, name.last, block.used_at) for name in block.group.names)
            if sum(self.known_body(name, place, kind) for name, place in zip(block.names, places)) < len(block.names):
                return None
        if not self.complete(block):
            return None
        settings = self.settings(block)
        if settings is None:
            return None
        values = {**dict(zip(kind.names, block.names)), **({"kind": block.group.kind} if kind.kinds else {}), **settings}
        if "spans" in kind.record.__dataclass_fields__:
            values["spans"] = self.spans(block)
        record = kind.record(**values)
        for words in facets("words"):
            if kind.name in getattr(words, "CHECKS", {}):
                record = words.CHECKS[kind.name](self, block, record)
        check = getattr(self, f"check_{kind.name}", lambda block, record: record)
        return self.in_world(block, check(block, record))

    def meant(self, block: EvaluatedBlock, name: str) -> str:
        """The full name of what a name in a group means: its own objects first, then those of the groups around."""
        own = (f"{place.name}.{name}" for place in around(block.inside))
        return next((full for full in own if full in self.named), name)

    def in_world(self, block: EvaluatedBlock, record: Any) -> Any:
        """An object, or the place of a group, moved along with the groups that it stands in, and a record of a feature that has
        ``moved(place)``; None after an error."""
        movable = isinstance(record, records.Solid | Placement)
        if block.inside is None or not (movable or hasattr(record, "moved")):
            return record
        if (place := self.place_of(block.inside)) is None:
            return None
        if not movable:
            return record.moved(place)
        try:
            record = place.moved(record)
        except ValueError as e:
            cause, way_out, word = e.args
            self.problem(block.first(word).span(), f"{cause}{block.where}", way_out)
            return None
        if beyond := beyond_limits(record):
            self.problem(block.head, *beyond)
        return record

    def place_of(self, block: EvaluatedBlock) -> Placement | None:
        """Where a group stands in the world; None after an error."""
        if id(block) not in self.places:
            self.places[id(block)] = self.record(BLOCKS["place"], block)
        return self.places[id(block)]

    def settings(self, block: EvaluatedBlock) -> dict[str, Any] | None:
        """Fields of the record, from the settings of a block; None where a value is wrong. Absent ones keep their default."""
        own, good = KEYWORDS[block.block], True
        values = {k.field: k.absent for k in own.values() if k.absent is not None} if block.block != "effects" else {}
        for word, found in block.settings.items():
            k, read = own[word], []
            for s in found if not isinstance(k.codec, ASKED) else ():
                try:
                    read.append(k.read(s.entry.choice, s.values))
                except ValueError as e:
                    message, hint, at = e.args
                    self.problem(s.span(at), message, hint)
                    good = False
            try:
                values |= k.gathered(read) if read else {}
            except ValueError as e:
                message, hint, at = e.args
                self.problem(found[at].span(), message, hint)
                good = False
        for value in [v for v in values.values() if hasattr(v, "brings")]:
            values |= value.brings()
        return values if good else None

    def brought(self, block: EvaluatedBlock) -> dict[str, str]:
        """Settings of a block that follow from others, each with the other's word."""
        rows = ((w, k.codec.kind(s.entry.choice, s.values)) for w, k in KEYWORDS[block.block].items()
                if isinstance(k.codec, OneOf) and (s := block.first(w)) is not None)  # fmt: skip
        return {word: w for w, kind in rows for word in getattr(kind, "BRINGS", ())}

    def perhaps_brought(self, block: EvaluatedBlock) -> dict[str, str]:
        """The same of settings that are broken, whatever they were to be."""
        kinds = ((w, kind) for w in block.broken if w in KEYWORDS[block.block]
                 for kind in getattr(KEYWORDS[block.block][w].codec, "kinds", ()))  # fmt: skip
        return {word: w for w, kind in kinds for word in getattr(kind, "BRINGS", ())}

    # -- several blocks at once

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
        first: dict[tuple[str, str], EvaluatedBlock] = {}
        own = {kind.name for kind in BLOCKS.values() if kind.names and not kind.of_objects}
        for block in (b for b in self.out.blocks if b.block in own):  # as they stand in the scene
            if (key := (block.name, BLOCKS[block.block].of)) in first:
                again = block.group is first[key].group  # by a repeat
                bare = bare_name(block.name)
                way_out = f"; give it the index of each repeat around it, as {bare}[i] or {bare}[i][j]" if again else ""
                self.problem(
                    block.head,
                    f"the name {block.name} is given twice{block.where}",
                    f"first given at {first[key].head}{way_out}",
                    key=("name", id(block.group)),
                )
            elif block.block == "object" and block.name in GLOBALS:
                self.problem(block.head, f"an object cannot be called {block.name}: expect uses this word", "take another name")
            first.setdefault(key, block)

    def frames(self, control: records.Control | None, render: records.Render | None) -> records.Control | None:
        """Control with as many frames as slow motion asks for, unless it says how many: at least one, and not too many."""
        if control is None:
            return None
        slow = render is not None and render.speed < 1.0
        if slow and "frames" not in control.spans:
            control = replace(control, frames=SMOOTH_RATE / render.speed)
        elif slow and (cause := few_pictures(control.frames, render.speed)):
            way_out = f"for smooth motion write frames {number(SMOOTH_RATE / render.speed)} fps in control, or leave frames out"
            self.problem(control.spans["frames"], cause, way_out, severity="warning")
        frames, rate = control.time * control.frames, f"1/{number(control.frames, 6)} s"
        if frames < 1.0:
            cause = f"in {number(control.time, 6)} s there is not one frame of {rate}"
            self.problem(control.spans["time"], cause, "a longer time, or more frames per second")
        if frames > MOST_FRAMES:
            cause = f"{number(control.time, 6)} s have {number(frames)} frames of {rate}; the most is {whole(MOST_FRAMES)}"
            self.problem(control.spans["time"], cause, "a shorter time, or fewer frames per second")
        return control

    # -- helpers for one block

    def complete(self, block: EvaluatedBlock) -> bool:
        """Whether everything needed is there; what is missing, or given twice, is a problem."""
        good = not block.broken
        title = f"{block.block} {block.name}".rstrip()
        brought, perhaps = self.brought(block), self.perhaps_brought(block)
        for word in (w for w in brought if w in block.settings):
            cause = f"{title} has its {word} by its {brought[word]}{block.where}"
            self.problem(block.first(word).span(), cause, f"leave out {word}")
            good = False
        for word, keyword in KEYWORDS[block.block].items():
            key = ("missing", id(block.group), keyword.one_of or word)
            if keyword.needed and word not in block.settings and word not in brought | perhaps and not block.excused(word):
                self.problem(block.head, f"{title} has no {word}{block.where}", examples(keyword), key=key)
                good = False
            if keyword.one_of and keyword.one_of[0] == word:
                given = [w for w in keyword.one_of if w in block.settings]
                if not given and not block.excused(*keyword.one_of):
                    this = " or ".join(keyword.one_of)
                    self.problem(block.head, f"{title} has no {this}{block.where}", example(keyword), key=key)
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

    def spans(self, block: EvaluatedBlock) -> dict[str, Span]:
        """Where each keyword's values stand."""
        spans = {}
        for word, found in block.settings.items():
            s = found[0]
            values = [v for v in s.entry.values if v is not None]
            spans[word] = s.between(values[0].first, values[-1].last) if values else s.span()
        spans[block.block] = block.head
        return spans

    def corners(self, s: EvaluatedSetting, what: str) -> tuple[Vector, Vector]:
        """Two corners of a box, the lower one first."""
        a, b = s.values
        for axis, x, y in zip("xyz", a, b):
            if not x < y:
                self.problem(
                    s.span(1),
                    f"{what} has no extent along {axis}: it goes from {say(x, 'm', 6)} to {say(y, 'm', 6)}",
                    "the lower corner stands first",
                )
        return a, b

    # -- blocks

    def check_object(self, block: EvaluatedBlock, solid: records.Solid) -> records.Solid | None:
        """Shape, place and what is held."""
        for s in block.settings.get("hold", ()):
            if len(s.values) == 2:
                self.corners(s, "the held box")
        s, shape = block.first("shape"), solid.shape
        if (mesh := mesh_of(shape)) is not None:
            path = beside(s.entry.source.folder, mesh.path)
            if refusal := refusal_of_mesh(path, str(mesh.path)):
                self.problem(s.span(0), *refusal)
                return None
            return replace(solid, shape=with_path(shape, path))
        shape = shape.shape if isinstance(shape, records.Shell) else shape
        if isinstance(shape, records.Torus) and shape.minor >= shape.major:
            r, big = say(shape.minor, "m", 6), say(shape.major, "m", 6)
            cause = f"the tube of a torus is thinner than the ring: r < R, found r = {r}, R = {big}"
            self.problem(s.span(1), cause, "write torus R r, the radius of the centre line first")
            return None
        return solid

    def check_render(self, block: EvaluatedBlock, render: records.Render) -> records.Render:
        """Names and quantities of what pictures show."""
        return check_render(self, block, render)

    def cameras(self) -> None:
        """Cameras look at something; several are points of one path, each with a time of its own, in order."""
        settings = [s for block in self.blocks("render")[:1] for s in block.settings.get("camera", ())]
        last = -math.inf
        for s in settings:
            if isinstance(one := s.record(), records.Standpoint):
                if one.name is not None:
                    self.known_object(one.name, s.span(0))
                if len(settings) > 1:
                    cause = f"camera {one.place} is a view for the whole movie, and there is another camera"
                    self.problem(s.span(), cause, "leave one of them out, or write all as camera 2 s from ...")
                continue
            time, eye, look, up = s.values
            if isinstance(look, str):
                self.known_object(look, s.span(2))
            elif math.dist(eye, look) == 0.0:
                self.problem(s.span(2), "the camera stands where it looks", "move one of the two points")
            if time is not None and time < 0.0:
                self.problem(s.span(0), f"the camera's time must be >= 0, found {number(time, 6)} s")
            if up is not None and math.hypot(*up) == 0.0:
                self.problem(s.span(3), "up needs a direction, found (0, 0, 0)", "e.g. up (0, 0, 1)")
            if len(settings) == 1:
                continue
            if time is None:
                self.problem(s.span(), "several cameras make a path, and this one has no time", "write camera 2 s from ...")
            elif time <= last:
                cause = f"the times of the cameras must rise, found {number(time, 6)} s after {number(last, 6)} s"
                self.problem(s.span(0), cause)
            else:
                last = time

    def known_object(self, name: str, span: Span, more: Iterable[str] = ()) -> bool:
        """Whether an object has this name; an unknown one is a problem, whose way out may be one of ``more`` too."""
        if name in self.names or self.out.excused("object"):
            return name in self.names
        if len(several := self.named.get(name, ())) > 1:
            first = next(islice(self.names, several[0], None))
            self.problem(span, f"{name} stands for {len(several)} objects, and one is needed", f"name one of them, e.g. {first}")
            return False
        known = [*islice(self.names, 2000), *more]
        self.problem(span, f"no object is called {name}", did_you_mean(name, known) if known else "the scene has no object")
        return False

    def known_body(self, name: str, span: Span, block: Block) -> bool:
        """Whether a name of a block of objects stands for something there; an unknown one is a problem."""
        if block.instead:
            return _known_in(self, name, span, block)
        kind = self.touched.get(name)
        plane = bool(self.blocks(kind) if kind else name in self.touched and self.out.first(name))
        twice = "a plane of the scene" if plane else "a repeat" if name in self.names and len(self.named[name]) > 1 else ""
        if name in self.named and twice:
            self.problem(span, f"{name} is the name of an object and of {twice}", "give the object another name")
            return False
        if name in self.named or plane or self.out.excused("object", *filter(None, self.touched.values()), name):
            return True
        if kind is not None:
            self.problem(span, f"the scene has no {name}", example(KEYWORDS[kind][name]) + (f" in a {kind}" if kind else ""))
        elif found := [(word, k) for word, k in self.touched.items() if any(name == b.name for b in self.blocks(k))]:
            word, kind = found[0]
            self.problem(span, f"{name} is the {kind}; what objects touch is its {word}", f"write {word}")
        else:
            self.known_object(name, span, (repeat for repeat in islice(self.named, 2000) if repeat not in self.names))
        return False


def _known_in(v: Validator, name: str, span: Span, block: Block) -> bool:
    """As `Validator.known_body`, in a block that takes words of its own in place of planes."""
    if name in v.named:
        if name in block.instead:
            v.problem(span, f"{name} is the name of an object, and a word of {block.name}", "give the object another name")
        return name not in block.instead
    if name in block.instead or v.out.excused("object"):
        return True
    if name in v.touched:
        v.problem(span, f"{name} is not an object", f"write {' or '.join(block.instead)} for what never moves")
    else:
        v.known_object(name, span, (*(n for n in islice(v.named, 2000) if n not in v.names), *block.instead))
    return False


def _divided(v: Validator, kind: Block, made: tuple) -> tuple:
    """The records that those of a kind of block stand for."""
    for divide in (facet.DIVIDES[kind.name] for facet in facets("divide") if kind.name in facet.DIVIDES):
        made = tuple(part for record in made for part in divide(v, record))
    return made
