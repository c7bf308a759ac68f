# SPDX-License-Identifier: GPL-2.0-only
"""``scene.lock.txt``: a scene written out in full, defaults and repeats, and read back the same."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from .keywords import BLOCKS, KEYWORDS, Block
from .scene import Mesh, Scene

LOCK = "scene.lock.txt"


def lock_text(scene: Scene, meshes: Mapping[Path, str] | None = None) -> str:
    """The scene as a text in SI units whose floats are exact: ``parse_scene(lock_text(s), s.name) == s``.

    ``meshes`` are the names of mesh files in the output folder; without it their paths are absolute.
    Raises ValueError for a text that the language cannot hold (one with a quote or a line break in it).
    """
    settings = {name: k.lines(scene) for name, k in KEYWORDS[""].items()}
    lines = [
        f"# {scene.name}: the whole scene as it was run, in SI units, with every default written out.",
        "# Written by mdanim-lammps; it can be run again as it stands.",
        "",
        *(f"{name} {text}" for name, texts in settings.items() if not KEYWORDS[""][name].many for text in texts),
    ]
    for block in reversed(BLOCKS.values()):
        held = getattr(scene, block.field)
        for record in held if block.many else (held,):
            lines += _block(block, _with_mesh(record, meshes or {}))
    checks = [f"{name} {text}" for name, texts in settings.items() if KEYWORDS[""][name].many for text in texts]
    return "\n".join([*lines, *(["", *checks] if checks else [])]) + "\n"


def _with_mesh(record: Any, meshes: Mapping[Path, str]) -> Any:
    """The object with the name that its mesh has in the output folder."""
    shape = getattr(record, "shape", None)
    return replace(record, shape=replace(shape, path=meshes[shape.path])) if isinstance(shape, Mesh) and meshes else record


def _block(block: Block, record: Any) -> list[str]:
    """Lines of a block, values in one column; none for what the scene does not have."""
    if block.record is None:
        settings = [(word, member.value) for word, member in record.items()]
    else:
<<<<<<< HEAD
        blocks.append(["# effects: all auto"])
    if scene.liquid is not None:
        blocks.append(_liquid(scene.liquid))
    blocks += (_solid(s, meshes or {}) for s in scene.solids)
    if scene.expects:
        blocks.append(list(map(_expect, scene.expects)))
    for block in blocks:
        lines += ["", *block]
    return "\n".join(lines) + "\n"


def _text(text: str) -> str:
    if '"' in text or "\n" in text or "\r" in text:
        raise ValueError(f"a text of the scene language holds no quote and no line break: {text!r}")
    return f'"{text}"'


def _vector(v: Vector) -> str:
    return f"({', '.join(map(repr, v))})"


def _box(box) -> str:
    return f"from {_vector(box.low)} m to {_vector(box.high)} m"


def _auto(x: float | None, unit: str) -> str:
    return "auto" if x is None else f"{x!r} {unit}".rstrip()


def _block(head: str, settings: list[tuple[str, str]]) -> list[str]:
    """Lines of a block, values in one column."""
    width = max((len(word) for word, _ in settings), default=0)
    return [head + " {", *(f"  {word:<{width}} {value}" for word, value in settings), "}"]


def _control(c: records.Control) -> list[str]:
    accuracy = c.accuracy.value if isinstance(c.accuracy, records.Accuracy) else f'"error {Decimal(repr(c.accuracy)) * 100} %"'
    return _block("control", [
        ("time", f"{c.time!r} s"),
        ("frames", f"{c.frames!r} fps"),
        ("timestep", _auto(c.timestep, "s")),
        ("resolution", _auto(c.resolution, "m")),
        ("accuracy", accuracy),
        ("contact-stiffness", repr(c.contact_stiffness)),
        ("seed", str(c.seed)),
        ("save", f"{c.save.value} {'single' if c.single else 'double'}"),
    ])  # fmt: skip


def _render(r: records.Render) -> list[str]:
    settings = [("size", f"({r.size[0]}, {r.size[1]})")]
    if r.movie is not None:
        settings.append(("movie", _text(r.movie)))
    if r.background is not None:
        settings.append(("background", _text(r.background)))
    for c in r.camera:
        time = "" if c.time is None else f"{c.time!r} s "
        look = c.look if isinstance(c.look, str) else f"{_vector(c.look)} m"
        settings.append(("camera", f"{time}from {_vector(c.eye)} m look {look} up {_vector(c.up)}"))
    settings.append(("liquid", r.liquid))
    return _block("render", settings)


def _liquid(q: records.Liquid) -> list[str]:
    amount = ("volume", f"{q.volume!r} m^3") if q.volume is not None else ("level", f"{q.level!r} m")
    settings = [
        ("basin", _box(q)),
        ("density", f"{q.density!r} kg/m^3"),
        amount,
        ("drag", _auto(q.drag, "1/s")),
        ("model", q.model.value),
        ("sweeps", _auto(q.sweeps, "")),
    ]
    if q.fill is not None:
        settings.append(("fill", _box(records.Walls(*q.fill))))
    if q.color is not None:
        settings.append(("color", _text(q.color)))
    return _block(f"liquid {q.name}", settings)


def _shape(s: records.Shape, meshes: Mapping[Path, str]) -> str:
    match s:
        case records.Box():
            return f"box {_vector(s.size)} m"
        case records.Sphere():
            return f"sphere {s.radius!r} m"
        case records.Ellipsoid():
            return f"ellipsoid {_vector(s.radii)} m"
        case records.Cylinder():
            return f"cylinder {s.radius!r} m {s.height!r} m"
        case records.Cone():
            return f"cone {s.radius!r} m {s.height!r} m"
        case records.Torus():
            return f"torus {s.major!r} m {s.minor!r} m"
        case records.Mesh():
            return f"mesh {_text(meshes.get(s.path, str(s.path)))} scale {s.scale!r}"


def _hold(h: records.Hold) -> list[str]:
    if isinstance(h, records.HoldAll):
        return ["all"]
    if isinstance(h, records.HoldWithin):
        return [f"within box {_box(h).removeprefix('from ')}"]
    low, *other = [side.value for side in h.sides]
    return [f"faces {low[1]}" if other else f"face {low}"]


def _solid(s: Solid, meshes: Mapping[Path, str]) -> list[str]:
    turned = s.rotation != IDENTITY
    young = isinstance(s.elasticity, records.Young)
    settings = [
        ("shape", _shape(s.shape, meshes)),
        ("position", f"{_vector(s.position)} m"),
        ("orientation", f"matrix {' '.join(map(_vector, s.rotation))}" if turned else KEYWORDS["object"]["orientation"].default),
        ("mass", f"{s.mass!r} kg") if s.mass is not None else ("density", f"{s.density!r} kg/m^3"),
        ("elasticity", f"{s.elasticity.modulus!r} Pa" if young else f"spring {s.elasticity.k!r} N/m"),
        ("damping", repr(s.damping)),
        ("velocity", f"{_vector(s.velocity)} m/s"),
        ("spin", f"{_vector(s.spin)} rad/s"),
        ("drag", f"{s.drag!r} N*s/m"),
    ]
    settings += [("hold", text) for h in s.hold for text in _hold(h)]
    if s.color is not None:
        settings.append(("color", _text(s.color)))
    return _block(f"object {s.name}", settings)


def _expect(e: records.Expect) -> str:
    unit = expect_unit(e)
    time = "" if e.time is None else f" at {e.time!r} s"
    value, tolerance = (f"{x!r} {unit}".rstrip() for x in (e.value, e.tolerance))
    return f"expect {e.subject}.{e.quantity}{time} = {value} +- {tolerance}"


def expect_unit(e: records.Expect) -> str:
    """SI unit of what an expect checks; empty for plain numbers."""
    unit, _ = QUANTITIES[e.subject if e.subject in GLOBALS else "NAME", e.quantity]
    return "" if unit == "1" else unit
=======
        settings = (
            [] if record is None else [(word, text) for word, k in KEYWORDS[block.name].items() for text in k.lines(record)]
        )
    if not settings:
        return []
    head = " ".join((block.name, *(getattr(record, name) for name in block.names)))
    width = max(len(word) for word, _ in settings)
    return ["", head + " {", *(f"  {word:<{width}} {text}" for word, text in settings), "}"]
>>>>>>> 5805a37 (A keyword is one field of a record: parser, range checks, messages, docs and scene.lock.txt follow from it)
