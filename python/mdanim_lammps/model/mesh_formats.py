# SPDX-License-Identifier: GPL-2.0-only
"""STL, OBJ and PLY as polygons with the names of parts. Normals, texture and materials are passed over, right or wrong."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import field
from itertools import islice

import numpy as np

from ..records import dataclass

PLAIN = re.compile(rb"[^\x20-\x7e]+")


class UnreadableMesh(Exception):
    """A file that is not a mesh; the message says where and why."""


@dataclass(frozen=True, eq=False)
class Polygons:
    """V points and F polygons of any number of corners."""

    points: np.ndarray
    """In units of the file, float32, shape (V, 3): a surface is not known better, and STL holds no more."""
    count: np.ndarray
    """Corners of each polygon, int64, shape (F,)."""
    index: np.ndarray
    """Points at the corners, one polygon after the other, int64; each is one that is there."""
    color: np.ndarray
    """RGB of the points, uint8, shape (V, 3), or (0, 3) where the file has none."""
    names: tuple[str, ...] = ()
    """Names of the parts: objects of an OBJ file, or its groups where it has one object at most; solids of an STL file. None of a
    file with one part."""
    part: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    """The part of each polygon, its number in ``names``, int64, shape (F,); (0,) without names."""


def read(data: bytes, kind: str) -> Polygons:
    """The polygons of a file of this kind: ``.stl``, ``.obj`` or ``.ply``. Raises UnreadableMesh."""
    return {".stl": _stl, ".obj": _obj, ".ply": _ply}[kind](data)


def _polygons(points: np.ndarray, count, index, places=None, color: np.ndarray | None = None, of: Sequence[str] = ()) -> Polygons:
    """Checked polygons; ``places`` tell where each one stands in the file, ``of`` the name of its part."""
    count, index = np.asarray(count, np.int64), np.asarray(index, np.int64)
    wrong = np.flatnonzero((index < 0) | (index >= len(points)))
    if len(wrong):
        face = int(np.searchsorted(np.cumsum(count), wrong[0], side="right"))
        place = f"line {places[face]}" if places is not None else f"face {face + 1}"
        raise UnreadableMesh(f"{place}: names point {index[wrong[0]] + (places is not None)}, there are {len(points)}")
    number: dict[str, int] = {}
    part = np.array([number.setdefault(name, len(number)) for name in of], np.int64)
    named = (tuple(number), part) if len(number) > 1 else ()
    return Polygons(points.astype(np.float32), count, index, np.zeros((0, 3), np.uint8) if color is None else color, *named)


def _numbers(words: list[bytes], places: list[int]) -> np.ndarray:
    """Rows of three numbers, shape (V, 3), the rows from these lines."""
    try:
        return np.array(words, "S").astype(float).reshape(-1, 3)
    except ValueError:
        return np.array([_number(word, places[k // 3]) for k, word in enumerate(words)]).reshape(-1, 3)


def _number(word: bytes, line: int) -> float:
    try:
        return float(word.upper().replace(b"D", b"E"))  # as Fortran writes exponents
    except ValueError:
        raise UnreadableMesh(f"line {line}: {_shown(word)} is not a number") from None


def _name(line: bytes) -> str:
    """The name of a part behind the first word of a line, without what a text of a scene cannot hold."""
    return " ".join(b" ".join(line.split()[1:]).decode(errors="replace").replace('"', "'").split())


def _shown(word: bytes) -> str:
    return f"'{PLAIN.sub(b'?', word[:40]).decode()}'"


# --- STL --------------------------------------------------------------------------------------------------------------


def _stl(data: bytes) -> Polygons:
    told = int.from_bytes(data[80:84], "little") if len(data) >= 84 else -1
    if 84 + 50 * told != len(data) and data.lstrip()[:5].lower() == b"solid" and b"\0" not in data[:1024]:
        return _stl_text(data)
    if told < 0:
        raise UnreadableMesh("is too short for an STL file")
    if (room := (len(data) - 84) // 50) < told:
        raise UnreadableMesh(f"is cut short, or no STL file: it declares {told} triangles and has bytes for {room}")
    triangle = np.frombuffer(data, [("normal", "<f4", 3), ("corner", "<f4", (3, 3)), ("more", "<u2")], told, 84)
    return _polygons(triangle["corner"].reshape(-1, 3), np.full(told, 3), np.arange(3 * told))


def _stl_text(data: bytes) -> Polygons:
    words, places, count, first, of = [], [], [], None, []
    solids, name = 0, ""
    for line, text in enumerate(data.splitlines(), 1):
        word, *rest = text.split() or [b""]
        word = word.lower()
        if word == b"vertex":
            if first is None or len(rest) != 3:
                raise UnreadableMesh(f"line {line}: a vertex has three numbers and stands between 'outer loop' and 'endloop'")
            words += rest
            places.append(line)
        elif word == b"outer":
            first = len(places)
        elif word == b"endloop" and first is not None:
            count.append(len(places) - first)
            of.append(name)
            first = None
        elif word == b"solid":
            solids += 1
            name = _name(text) or str(solids)
        elif word not in (b"", b"facet", b"endloop", b"endfacet", b"endsolid", b"color"):
            raise UnreadableMesh(f"line {line}: {_shown(word)} is not a word of an STL file")
    if first is not None:
        raise UnreadableMesh("is cut short: it ends inside of a triangle")
    return _polygons(_numbers(words, places), count, np.arange(len(places)), of=of)


# --- OBJ --------------------------------------------------------------------------------------------------------------


def _obj(data: bytes) -> Polygons:
    words, places, count, index, faces = [], [], [], [], []
    named: dict[bytes, str] = {b"o": "", b"g": ""}
    of: dict[bytes, list[str]] = {word: [] for word in named}
    for line, (word, rest) in _obj_lines(data):
        if word == b"v":
            if len(rest) < 3:
                raise UnreadableMesh(f"line {line}: a point has three numbers, found {len(rest)}")
            words += rest[:3]
            places.append(line)
        elif word in (b"f", b"fo"):
            corners = [_corner(text, line, len(places)) for text in rest]
            if len(corners) >= 3:
                count.append(len(corners))
                index += corners
                faces.append(line)
                for kind, name in named.items():
                    of[kind].append(name)
        elif word in named:
            named[word] = _name(b" ".join((word, *rest)))
    if not places:
        raise UnreadableMesh("has no point, which is a line 'v x y z'")
    return _polygons(_numbers(words, places), count, index, faces, of=of[b"o" if len(set(of[b"o"])) > 1 else b"g"])


def _obj_lines(data: bytes):
    """Lines with their numbers as a first word and the rest, without remarks; a line goes on after a backslash at its end."""
    before, began = b"", 0
    for line, text in enumerate(data.removeprefix(b"\xef\xbb\xbf").splitlines(), 1):
        text, began = before + text.split(b"#", 1)[0].rstrip(), began or line
        if text.endswith(b"\\"):
            before = text[:-1] + b" "
            continue
        if words := text.split():
            yield began, (words[0].lower(), words[1:])
        before, began = b"", 0


def _corner(text: bytes, line: int, points: int) -> int:
    """The point of a corner such as ``3``, ``3/1``, ``3//2``, ``3/`` or ``-1``, from 0; the rest is texture and light."""
    try:
        number = int(text.split(b"/", 1)[0])
    except ValueError:
        raise UnreadableMesh(f"line {line}: {_shown(text)} is not a corner of a face, such as 3 or 3/1/2") from None
    return number - 1 if number >= 0 else points + number


# --- PLY --------------------------------------------------------------------------------------------------------------

TYPES = {
    **dict(char="i1", uchar="u1", short="i2", ushort="u2", int="i4", uint="u4", float="f4", double="f8"),
    **dict(int8="i1", uint8="u1", int16="i2", uint16="u2", int32="i4", uint32="u4", float32="f4", float64="f8"),
}
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass
class _Element:
    """A table of a PLY file: its name, number of rows, and columns as (name, type of numbers, type of counts of a list or "")."""

    name: str
    rows: int
    columns: list[tuple[str, str, str]]

    def least(self) -> int:
        """Bytes of a row whose lists are empty."""
        return sum(np.dtype(many or kind).itemsize for _, kind, many in self.columns)

    def cut(self, rows: int) -> UnreadableMesh:
        return UnreadableMesh(f"is cut short: it declares {self.rows} rows of '{self.name}' and has {rows}")


def _ply(data: bytes) -> Polygons:
    order, elements, begin = _ply_header(data)
    tables = _ply_text(data, begin, elements) if order == "" else _ply_binary(data, begin, elements, order)
    vertex = tables.get("vertex", {})
    if not {"x", "y", "z"} <= vertex.keys():
        raise UnreadableMesh("has no element 'vertex' with x, y and z")
    face = tables.get("face", {})
    count, index = face.get("vertex_indices") or face.get("vertex_index") or (np.zeros(0, np.int64), np.zeros(0, np.int64))
    names = next(
        (n for n in (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue")) if vertex.keys() >= {*n}), ()
    )
    colors = [vertex[name] for name in names]
    color = np.stack(colors, axis=1) if colors and all(c.dtype == np.uint8 for c in colors) else None
    return _polygons(np.stack([vertex[axis] for axis in "xyz"], axis=1), count, index, None, color)


def _ply_header(data: bytes) -> tuple[str, list[_Element], int]:
    """Order of bytes ("" of a text), the elements, and where the first row begins."""
    end = re.search(rb"(?m)^\s*end_header[ \t]*(\r\n|\n|\r)", data[: 1 << 20])
    if not re.match(rb"ply\s", data) or not end:
        raise UnreadableMesh("does not begin with the header of a PLY file, 'ply' to 'end_header'")
    order, elements = None, []
    for line, text in enumerate(data[: end.start()].decode("latin-1").splitlines(), 1):
        words = text.split()
        try:
            match words:
                case ["format", name, _]:
                    order = ORDERS[name]
                case ["element", name, rows] if int(rows) >= 0:
                    elements.append(_Element(name, int(rows), []))
                case ["property", "list", many, kind, name]:
                    elements[-1].columns.append((name, TYPES[kind], TYPES[many]))
                case ["property", kind, name]:
                    elements[-1].columns.append((name, TYPES[kind], ""))
                case [] | ["ply"] | ["comment" | "obj_info", *_]:
                    pass
                case _:
                    raise ValueError
        except (KeyError, ValueError, IndexError):
            raise UnreadableMesh(f"line {line}: {_shown(text.strip().encode())} is not a line of a PLY header") from None
    if order is None:
        raise UnreadableMesh("does not name its format")
    return order, elements, end.end()


def _ply_text(data: bytes, begin: int, elements: list[_Element]) -> dict[str, dict]:
    first = data.count(b"\n", 0, begin) + 1
    lines = ((n, words) for n, text in enumerate(data[begin:].splitlines(), first) if (words := text.split()))
    tables = {}
    for element in elements:
        rows = list(islice(lines, element.rows))
        if len(rows) < element.rows:
            raise element.cut(len(rows))
        columns: list[list] = [[] for _ in element.columns]
        for line, words in rows:
            at = 0
            for column, (_, _, many) in zip(columns, element.columns):
                size = int(_number(words[at], line)) if many and at < len(words) else 1
                begin, at = at + bool(many), at + bool(many) + size
                if at > len(words) or size < 0:
                    raise UnreadableMesh(f"line {line}: is too short for a row of '{element.name}'")
                column.append([_number(word, line) for word in words[begin:at]] if many else _number(words[begin], line))
        tables[element.name] = {
            name: (np.array([len(v) for v in values], np.int64), np.array([x for v in values for x in v], kind))
            if many
            else np.array(values).astype(kind)
            for values, (name, kind, many) in zip(columns, element.columns)
        }
    return tables


def _ply_binary(data: bytes, at: int, elements: list[_Element], order: str) -> dict[str, dict]:
    tables = {}
    for element in elements:
        if element.rows * element.least() > len(data) - at:
            raise element.cut((len(data) - at) // max(1, element.least()))
        found = _even_rows(data, at, element, order)
        tables[element.name], at = found or _uneven_rows(data, at, element, order)
    return tables


def _even_rows(data: bytes, at: int, element: _Element, order: str) -> tuple[dict, int] | None:
    """Columns of an element whose lists are all as long as those of its first row, and where it ends; None where some are not."""
    fields, first = [], at
    for k, (_, kind, many) in enumerate(element.columns):
        size = 0
        if many:
            fields.append((f"n{k}", order + many))
            size = int(np.frombuffer(data, order + many, 1, first)[0]) if first + 8 <= len(data) else 0
            first += np.dtype(many).itemsize
        fields.append((f"v{k}", order + kind, (size,) if many else ()))
        first += np.dtype(kind).itemsize * (size if many else 1)
        if first > len(data) or size < 0:
            return None
    row = np.dtype(fields)
    if element.rows * row.itemsize > len(data) - at:
        return None
    rows = np.frombuffer(data, row, element.rows, at)
    lists = [k for k, (_, _, many) in enumerate(element.columns) if many]
    if any((rows[f"n{k}"] != row[f"v{k}"].shape[0]).any() for k in lists):
        return None
    columns = {
        name: (rows[f"n{k}"].astype(np.int64), rows[f"v{k}"].ravel()) if many else rows[f"v{k}"]
        for k, (name, _, many) in enumerate(element.columns)
    }
    return columns, at + element.rows * row.itemsize


def _uneven_rows(data: bytes, at: int, element: _Element, order: str) -> tuple[dict, int]:
    """The same row by row."""
    columns: list[list] = [[] for _ in element.columns]
    kinds = [(np.dtype(order + kind), np.dtype(order + many) if many else None) for _, kind, many in element.columns]
    for row in range(element.rows):
        for column, (kind, many) in zip(columns, kinds):
            size = 1
            if many is not None:
                if at + many.itemsize > len(data):
                    raise element.cut(row)
                size = int(np.frombuffer(data, many, 1, at)[0])
                at += many.itemsize
            if size < 0 or at + size * kind.itemsize > len(data):
                raise element.cut(row)
            column.append(np.frombuffer(data, kind, size, at))
            at += size * kind.itemsize
    return {
        name: (np.array([len(v) for v in values], np.int64), found) if many else found
        for values, (name, kind, many) in zip(columns, element.columns)
        for found in [np.concatenate(values) if values else np.zeros(0, kind)]
    }, at
