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
import re
import struct
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from .. import effects
from ..api import STUDY, stored_scene
from ..effects import resolve
from ..errors import MdanimError, OutputError, RefusedError
from ..results.files import read_json, write_whole
from ..results.stored import STUDY as STUDY_FILE
from ..results.stored import read_manifest
from ..results.untrusted import check_places, check_plain
from .feed import Feed, packed
from .server import packaged_files
from .tail import Known, Tail

STEPS, STEPS_EXACT = 4095, 65535
"""Of the box of an object: 0.3 mm of the beam of 1.2 m, and 0.02 mm."""
MOST_BYTES = 20_000_000
"""Of the packed frames: beyond it every n-th frame is left."""
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
    tail = Tail(folder)
    if tail.live:
        raise RefusedError(f"{folder}: the run goes on; wait for its end, stop it, or look at it: mdanim-lammps view {folder}")
    feed, news = tail.feed(), _cleaned(tail.news(Known()))
    try:
        if not tail.count:
            raise OutputError(f"{folder}: there is no frame to report on; run the scene again with --force")
        frames = _Frames(feed, tail.count, STEPS_EXACT if exact else STEPS, on_progress)
        every = 1
        while len(block := gzip.compress(frames.block(news, every), 9, mtime=0)) > MOST_BYTES and every < tail.count:
            every *= 2
    finally:
        feed.close()
    page = _page(feed.title, block, [*_sections(folder, news), _kept(every)])
    write_whole(path, page)
    return every


class _Frames:
    """All frames of a feed, as whole numbers."""

    def __init__(self, feed: Feed, count: int, steps: int, on_progress: Callable[[int, int], None]):
        self.feed, self.steps = feed, steps
        read = feed.frames.value
        own = np.repeat(np.arange(len(feed.first)), feed.count)
        self.times = np.array([feed.frames.time(n) for n in range(count)])
        self.moving = np.array(
            [np.hstack([read("center_of_mass", n), read("center_of_mass_velocity", n)]) for n in range(count)], "<f4"
        )
        # Twice through the file, so that it need not fit in memory: the boxes, then what lies in them.
        low, high = np.full((len(feed.first), 3), np.inf), np.full((len(feed.first), 3), -np.inf)
        about: Callable[[int], np.ndarray] = lambda n: feed.vertices(read("position", n)) - self.moving[n, own, :3]
        for n in range(count):
            vertices = about(n)
            low = np.minimum(low, np.minimum.reduceat(vertices, feed.first))
            high = np.maximum(high, np.maximum.reduceat(vertices, feed.first))
            on_progress(n + 1, 2 * count)
        check_places(feed.frames.path, low, high, self.moving)
        self.boxes = np.hstack([low, high - low]).astype("<f4")
        low, size = self.boxes[own, :3], self.boxes[own, 3:]
        scale = np.divide(steps, size, out=np.zeros_like(size), where=size > 0.0)
        self.places = np.empty((count, 3 * len(own)), "<u2")
        for n in range(count):
            self.places[n] = np.rint(np.clip((about(n) - low) * scale, 0, steps)).astype("<u2").ravel()
            on_progress(count + n + 1, 2 * count)
        liquid = [feed.liquid(n) for n in range(count)] if feed.metadata.liquid else []
        self.heights, self.states = (np.array([frame[k] for frame in liquid]) for k in (0, 1)) if liquid else (None, None)
        self.drops = [feed.drops(n).astype("<f4") for n in range(count)]

    def block(self, news: dict, every: int) -> bytes:
        """Scene, then times, centres and velocities, positions and liquid of every n-th frame."""
        kept = slice(None, None, every)
        times = self.times[kept]
        news = news | {
            "count": len(times),
            "total": len(times),
            "owners": [(-(-frame // every), *rest) for frame, *rest in news.get("owners", ())],
        }
        head = self.feed.head()
        head |= {"particles": 0, "springs": 0, "frames": len(times), "frameTime": head["frameTime"] * every}
        columns = 0 if self.heights is None else self.heights.shape[1]
        drops = self.drops[kept]
        head["replay"] = {"news": news, "steps": self.steps, "columns": columns, "vertices": self.places.shape[1] // 3}
        head["replay"]["drops"] = list(map(len, drops))
        scene = packed(_cleaned(head), self.feed.buffers() | {"boxes": self.boxes})
        parts = [struct.pack("<I", len(scene)), scene, times.astype("<f8").tobytes(), self.moving[kept].tobytes()]
        parts.append(differences(self.places[kept]))
        if columns:
            parts += [differences(self.heights[kept]), self.states[kept].tobytes(), *(rows.tobytes() for rows in drops)]
        return b"".join(parts)


def differences(rows: np.ndarray) -> bytes:
    """Rows of 16-bit numbers as differences to the row before, all low bytes first, then all high ones."""
    change = rows.copy()
    change[1:] -= rows[:-1]
    pairs = change.astype("<u2").view("u1").reshape(-1, 2)
    return pairs[:, 0].tobytes() + pairs[:, 1].tobytes()


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


def _sections(folder: Path, news: dict) -> Iterable[str]:
    facts = news["facts"]
    yield _table("Cost", ["effect", "seconds", "asked for at"], _cost_rows(facts.get("cost") or {"other": news["cost"]}))
    summary = facts.get("summary", {})
    yield _table(
        "Expected and found",
        ["", "what", "at [s]", "expected", "found"],
        [
            ("met" if e["met"] else "MISSED", e["what"], e["time"], f"{e['value']:.6g} ± {e['tolerance']:.3g}", e["found"])
            for e in summary.get("expect", ())
        ],
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
        verdicts = resolve(effects.EFFECTS, scene).verdicts.values()
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
    line = lambda cells, tag: "<tr>" + "".join(f"<{tag}>{_cell(c)}</{tag}>" for c in cells) + "</tr>"
    body = "".join(line(row, "td") for row in rows)
    head = line(heads, "th") if any(heads) else ""
    return _section(title, (_paragraph(note) if note else "") + f"<table>{head}{body}</table>", closed=closed)


def _cell(value) -> str:
    if value is None:
        return "–"
    return html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))


def _paragraph(text: str) -> str:
    return f"<p>{html.escape(text)}</p>"


def _section(title: str, body: str, *, closed: bool = False) -> str:
    return f"<details{'' if closed else ' open'}><summary>{html.escape(title)}</summary>{body}</details>"
