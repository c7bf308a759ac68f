# SPDX-License-Identifier: GPL-2.0-only
"""A run as one HTML file that needs nothing else: the page of the view with its data inside, and what the folder tells.

The file opens from disk and asks no host for anything. Positions are whole numbers within one box per object, which goes with the
object's centre of mass; of them the differences between frames, which are small, are packed.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import html
import json
import os
import re
import struct
import zlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryFile

import numpy as np

from .. import features
from ..effects import resolve
from ..errors import MdanimError, OutputError, RefusedError
from ..results.files import disk_errors, read_json, write_whole
from ..results.html import plain_table
from ..results.stored import STUDY as STUDY_FILE
from ..results.stored import read_manifest
from ..results.untrusted import check_places, check_plain
from ..run.folder import STUDY, stored_scene
from .feed import BY_FRAME, Feed, packed
from .server import packaged_files
from .tail import Known, Tail
from .told import ShownQuantities

STEPS, STEPS_EXACT = 4095, 65535
"""Steps across the box of an object: 0.3 mm of the beam of 1.2 m, and 0.02 mm."""
MOST_BYTES = 20_000_000
"""Largest size of the packed frames: beyond it only every n-th frame is kept."""
LEVEL = 6
"""Level of compression: 9 makes a report smaller by 0.3 to 1.2 %, in twice the time, and in twenty times where frames repeat."""
MOST_ARROWS = 50_000
"""Arrows of a vector that a report takes in: objects times frames."""
MOST_PICTURE = 2_000_000
"""Bytes of a picture of a study that the file takes in."""

START = """
(async () => {
  const packed = Uint8Array.from(atob(document.getElementById("modules").textContent), (sign) => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const address = {};
  for (const [name, code] of JSON.parse(await new Response(stream).text())) {
    const linked = code.replace(/from "\\.\\/([\\w.]+)"/g, (_, other) => `from "${address[other]}"`);
    address[name] = URL.createObjectURL(new Blob([linked], { type: "text/javascript" }));
  }
  await import(address["main.js"]);
})();
"""
"""Makes modules of the packed ones, each of which comes after those that it imports."""


def write_report(
    folder: Path, path: Path, *, exact: bool = False, on_progress: Callable[[int, int], None] = lambda *_: None
) -> int:
    """Write the report of a run that has ended; returns of how many frames one is kept, 1 for all.

    Args:
        folder: output folder.
        path: the file.
        exact: 16 bits a coordinate instead of 12.
        on_progress: called with (frames done, frames in all).

    Raises:
        OutputError: no run there, or a damaged one; the file cannot be written.
        RefusedError: the run goes on.
    """
    with Tail(folder) as tail:
        if tail.live:
            raise RefusedError(
                f"{folder}: the run goes on; wait for its end, stop it, or look at it: mdanim-lammps view {folder}"
            )
        feed, news, told = tail.feed(), _cleaned(tail.news(Known())), tail.told()
        if not (count := tail.count):
            raise OutputError(f"{folder}: there is no frame to report on; run the scene again with --force")
        with disk_errors(path), _Frames(feed, count, STEPS_EXACT if exact else STEPS, path.parent, on_progress) as frames:
            every = 1
            while (block := compressed(frames.pieces(news, every, told), MOST_BYTES if every < count else None)) is None:
                every *= 2
        page = _page(feed.title, block, [*_sections(folder, news), _kept(every)])
    write_whole(path, page)
    return every


def compressed(pieces: Iterable[bytes], most: int | None) -> bytes | None:
    """Pieces end to end, as gzip; None where that has more bytes than ``most``."""
    packer = zlib.compressobj(LEVEL, wbits=31)
    packed = bytearray()
    for piece in pieces:
        packed += packer.compress(piece)
        if most is not None and len(packed) > most:
            return None
    packed += packer.flush()
    return None if most is not None and len(packed) > most else bytes(packed)


class _Rows:
    """Arrays of all frames on the disk, in a file without a name that is gone with this object."""

    def __init__(self, folder: Path):
        self._file = TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115 -- `close` closes it
        self.ends = [0]

    def append(self, row: np.ndarray) -> None:
        """Add the array of one more frame. Raises OSError."""
        data = memoryview(np.ascontiguousarray(row)).cast("B") if row.size else b""
        while len(data):
            data = data[self._file.write(data) :]
        self.ends.append(self._file.tell())

    def row(self, n: int) -> bytes:
        """Bytes of one frame. Raises OSError."""
        return os.pread(self._file.fileno(), self.ends[n + 1] - self.ends[n], self.ends[n])

    def close(self) -> None:
        self._file.close()


class _Frames:
    """All frames of a feed, as whole numbers; they need not fit in memory.

    Args:
        feed: scene and frames.
        count: of frames.
        steps: of a coordinate in the box of its object.
        folder: where they are kept meanwhile.
        on_progress: called with (frames done, frames in all).
    """

    def __init__(self, feed: Feed, count: int, steps: int, folder: Path, on_progress: Callable[[int, int], None]):
        self.feed, self.steps = feed, steps
        self.times = np.array([feed.frames.time(n) for n in range(count)])
        own = np.repeat(np.arange(len(feed.first)), feed.count)
        # Twice through the file: the boxes, then what lies in them.
        low, high = np.full((len(feed.first), 3), np.inf), np.full((len(feed.first), 3), -np.inf)
        for n in range(count):
            vertices = self._about(n, own)
            low = np.minimum(low, np.minimum.reduceat(vertices, feed.first))
            high = np.maximum(high, np.maximum.reduceat(vertices, feed.first))
            check_places(feed.frames.path, low, high, self._moving(n), frame=n)
            on_progress(n + 1, 2 * count)
        self.boxes = np.hstack([low, high - low]).astype("<f4")
        low, size = self.boxes[own, :3], self.boxes[own, 3:]
        scale = np.divide(steps, size, out=np.zeros_like(size), where=size > 0.0)
        self.vertices = len(own)
        self.moving, self.places, self.heights, self.states, self.drops, self.added = self._tables = [
            _Rows(folder) for _ in range(6)
        ]
        for n in range(count):
            self.moving.append(self._moving(n))
            self.places.append(np.rint(np.clip((self._about(n, own) - low) * scale, 0, steps)).astype("<u2").ravel())
            if (liquid := feed.liquid(n)) is not None:
                self.heights.append(liquid[0])
                self.states.append(liquid[1])
            self.drops.append(feed.drops(n).astype("<f4"))
            self.added.append(feed.added(n))
            on_progress(count + n + 1, 2 * count)

    def __enter__(self) -> _Frames:
        return self

    def __exit__(self, *_) -> None:
        for table in self._tables:
            table.close()

    def _moving(self, n: int) -> np.ndarray:
        """Centres of mass and their velocities in a frame, shape (O, 6)."""
        read = self.feed.frames.value
        return np.hstack([read("center_of_mass", n), read("center_of_mass_velocity", n)]).astype("<f4")

    def _about(self, n: int, own: np.ndarray) -> np.ndarray:
        """Vertices of a frame about the centres of mass of their objects ``own`` [m], shape (V, 3)."""
        return self.feed.vertices(self.feed.frames.value("position", n), self.feed.gone(n)) - self._moving(n)[own, :3]

    def pieces(self, news: dict, every: int, told: ShownQuantities | None = None) -> Iterator[bytes]:
        """Scene, with curves and arrows, then times, centres and velocities, positions, liquid and additions of every n-th."""
        kept = range(0, len(self.times), every)
        news = news | {
            "count": len(kept),
            "total": len(kept),
            "owners": [(-(-frame // every), *rest) for frame, *rest in news.get("owners", ())],
        }
        head = self.feed.head()
        head |= {"particles": 0, "springs": 0, "frames": len(kept), "frameTime": head["frameTime"] * every}
        columns = self.heights.ends[1] // 2 if self.heights.ends[1:] else 0
        head["replay"] = {"news": news, "steps": self.steps, "columns": columns, "vertices": self.vertices}
        head["replay"]["drops"] = [len(self.drops.row(n)) // 16 for n in kept]
        buffers = self.feed.buffers()
        buffers |= {name: buffers[name][: len(self.times) : every] for name in BY_FRAME if name in buffers}
        if told is not None:
            head["replay"]["told"], more = _told(told, len(self.times), every)
            buffers |= more
        scene = packed(_cleaned(head), buffers | {"boxes": self.boxes})
        yield struct.pack("<I", len(scene)) + scene
        yield self.times[::every].astype("<f8").tobytes()
        yield from map(self.moving.row, kept)
        yield from differences(map(self.places.row, [*kept, *kept]), len(kept))
        if columns:
            yield from differences(map(self.heights.row, [*kept, *kept]), len(kept))
            yield from map(self.states.row, kept)
            yield from map(self.drops.row, kept)
        yield from map(self.added.row, kept)


def _told(told: ShownQuantities, count: int, every: int) -> tuple[dict, dict[str, np.ndarray]]:
    """Header and arrays of what a report tells beside its picture: curves of all that the scene asks for at all frames, and
    vectors of arrows at those that are kept."""
    head, arrays = told.head(), {}
    head["curves"] = []
    for what in head["own"]:
        try:
            one, columns = told.curve(what)
        except MdanimError:
            continue
        n = len(head["curves"])
        head["curves"].append(one)
        arrays |= {f"time {n}": columns["time"], f"value {n}": columns["value"]}
    head["arrows"] = [word for word in head["arrows"] if word != "velocity" and count * told.objects <= MOST_ARROWS]
    for word in (word for word in head["arrows"] if word not in head["untold"]):
        arrays[f"arrows {word}"] = told.vectors(word)[:count:every]
    return head, arrays


def differences(rows: Iterable[bytes], count: int) -> Iterator[bytes]:
    """Rows of 16-bit numbers, given twice, as differences to the row before: the low bytes of all, then the high ones."""
    before = None
    for n, data in enumerate(rows):
        row = np.frombuffer(data, "<u2")
        change = row if n % count == 0 else row - before
        before = row
        yield change.view("u1")[n // count :: 2].tobytes()


def _cleaned(data):
    """The same data, with None for what JSON cannot say, and places in files without the folders of this machine."""
    if isinstance(data, dict):
        short = lambda name, value: Path(value).name if name in ("place", "span") and isinstance(value, str) else _cleaned(value)
        return {name: short(name, value) for name, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_cleaned(value) for value in data]
    return None if isinstance(data, float) and not np.isfinite(data) else data


# --- the page -----------------------------------------------------------------------------------------------------------


def _page(title: str, block: bytes, sections: Iterable[str]) -> str:
    files = {path[1:] or "index.html": body.decode() for path, (body, _) in packaged_files().items()}
    style = files["vendor.css"] + files["view.css"]
    modules = json.dumps([[name, files[name]] for name in in_order(files)])
    policy = (
        f"default-src 'none'; script-src {_hash(START)} blob:; style-src {_hash(style)}; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )
    page = files["index.html"]
    for old, new in (
        ('<meta charset="utf-8">', f'<meta charset="utf-8">\n<meta http-equiv="Content-Security-Policy" content="{policy}">'),
        ('<link rel="modulepreload" href="vendor.js">\n', ""),
        ('<link rel="stylesheet" href="vendor.css">\n', ""),
        ('<link rel="stylesheet" href="view.css">', f"<style>{style}</style>"),
        ("<title>mdanim-lammps</title>", f"<title>{html.escape(title)}</title>"),
        ("<body>", '<body class="report">'),
        (
            '<script type="module" src="main.js"></script>',
            f'<article>{"".join(sections)}</article>\n<script type="text/plain" id="replay">{_text(block)}</script>\n'
            f'<script type="text/plain" id="modules">{_text(gzip.compress(modules.encode(), 9, mtime=0))}</script>\n'
            f"<script>{START}</script>",
        ),
    ):
        if page.count(old) != 1:
            raise ValueError(f"index.html has no {old!r}")
        page = page.replace(old, new)
    return page


def in_order(files: dict[str, str]) -> list[str]:
    """Names of modules, each after those that it imports."""
    order: list[str] = []

    def add(name: str) -> None:
        if name not in order:
            for other in re.findall(r'from "\./([\w.]+)"', files[name]):
                add(other)
            order.append(name)

    add("main.js")
    return order


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode()


# --- what the folder tells ----------------------------------------------------------------------------------------------


def _asked(e: dict) -> str:
    """The demand of an expectation of a summary: a value with its tolerance, or a bound."""
    relation = e.get("relation", "=")
    return f"{e['value']:.6g} ± {e['tolerance']:.3g}" if relation == "=" else f"{relation} {e['value']:.6g}"


def _when(e: dict) -> float | str | None:
    """The time of an expectation, or its window."""
    return e["time"] if e.get("from") is None else f"{e['from']:.6g} to {e['time']:.6g}"


def _sections(folder: Path, news: dict) -> Iterable[str]:
    facts = news["facts"]
    yield _table("Cost", ["effect", "seconds", "asked for at"], _cost_rows(facts.get("cost") or {"other": news["cost"]}))
    summary = facts.get("summary", {})
    yield _table(
        "Expected and found",
        ["", "what", "at [s]", "expected", "found"],
        [("met" if e["met"] else "MISSED", e["what"], _when(e), _asked(e), e["found"]) for e in summary.get("expect", ())],
    )
    certificate = facts.get("certificate", {})
    if certificate:
        bound = certificate.get("bound")
        share = f"{certificate['fraction']:.2f} of the bound {bound:.4g} s" if bound else "no bound"
        rows = [(m["severity"], m["name"], m["object"], m["text"]) for m in certificate["margins"]]
        what = f"time step {certificate['timestep']:.4g} s, {share}; set by {certificate['object']}, {certificate['cause']}"
        yield _table("Certificate", ["", "limit", "object", ""], rows, what)
    try:
        scene = stored_scene(folder)
        verdicts = resolve(features.effects(), scene).verdicts.values()
        rows = [("on" if v.on else "off", v.name, v.reason, Path(str(v.span)).name if v.span else "") for v in verdicts]
        yield _table("Effects", ["", "effect", "why", "line"], rows)
    except MdanimError as error:
        yield _section("Effects", _paragraph(f"The stored scene cannot be read any more: {error}"))
    yield from _study(folder / STUDY)
    lock = folder / "scene.lock.txt"
    if lock.is_file():
        yield _section("Scene", f"<pre>{html.escape(lock.read_text(encoding='utf-8', errors='replace'))}</pre>", closed=True)
    made = read_manifest(folder)
    rows = [("program", made.get("program")), ("version", made.get("version")), ("Python", made.get("python"))]
    rows += sorted((made.get("packages") or {}).items())
    rows += [(f"sha256 of {name}", value) for name, value in (made.get("sha256") or {}).items()]
    yield _table("Made by", ["", ""], [row for row in rows if row[1]], closed=True)


def _cost_rows(cost: dict) -> list[tuple]:
    rows = [(name, part["seconds"], part["place"] or "") for name, part in cost.get("effects", {}).items()]
    rows += [(name, seconds, "") for name, seconds in cost["other"].items()]
    return [(name, f"{seconds:.3f}", place) for name, seconds, place in sorted(rows, key=lambda row: -row[1])]


def _study(folder: Path) -> Iterable[str]:
    """Its advice and its plot, where a study was made."""
    picture = folder / "study.png"
    if not (folder / "study.json").is_file():
        return
    advice = read_json(folder / "study.json", STUDY_FILE).get("advice")
    text = _paragraph(advice) if advice else ""
    check_plain(picture)
    if picture.is_file() and picture.stat().st_size <= MOST_PICTURE:
        text += f'<img alt="error against time" src="data:image/png;base64,{_text(picture.read_bytes())}">'
    yield _section("Study", text)


def _kept(every: int) -> str:
    return (
        ""
        if every == 1
        else _section("Frames", _paragraph(f"One of {every} frames is kept: all would make this file too large."))
    )


def _table(title: str, heads: list[str], rows: Iterable[Iterable], note: str = "", *, closed: bool = False) -> str:
    rows = list(rows)
    if not rows and not note:
        return ""
    return _section(title, (_paragraph(note) if note else "") + plain_table(heads, rows, _cell), closed=closed)


def _cell(value) -> str:
    if value is None:
        return "–"
    return html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))


def _paragraph(text: str) -> str:
    return f"<p>{html.escape(text)}</p>"


def _section(title: str, body: str, *, closed: bool = False) -> str:
    return f"<details{'' if closed else ' open'}><summary>{html.escape(title)}</summary>{body}</details>"
