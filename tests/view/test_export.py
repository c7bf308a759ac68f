# SPDX-License-Identifier: GPL-2.0-only
"""A report holds the run, in one file that needs and reaches nothing else."""

import base64
import gzip
import hashlib
import json
import re
import shutil
import struct
import tracemalloc
from types import SimpleNamespace

import numpy as np
import pytest
from mdanim_lammps import Scene, Trajectory, cli
from mdanim_lammps.errors import OutputError, RefusedError
from mdanim_lammps.picture.surfaces import shaded_mesh
from mdanim_lammps.results.files import claimed
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.progress import PROGRESS
from mdanim_lammps.view import export
from mdanim_lammps.view.export import differences, in_order, write_report
from mdanim_lammps.view.server import packaged_files
from scene_texts import SPLASH


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A finished run with a liquid."""
    made = tmp_path_factory.mktemp("splash")
    wavy = SPLASH.replace("model surface", "model waves  drops 1")
    (made / "splash.txt").write_text(wavy + "expect raft.position.z at 0.1 s = 0.1 +- 1 m\n")
    return Scene.load(made / "splash.txt").run().folder


def block_of(page: str) -> bytes:
    """The data of a report."""
    found = re.search(r'<script type="text/plain" id="replay">([^<]*)</script>', page)[1]
    return gzip.decompress(base64.b64decode(found))


def restored(data: bytes, row: int, rows: int) -> np.ndarray:
    """Input of `differences`, by a sum."""
    half = len(data) // 2
    low, high = np.frombuffer(data[:half], "u1"), np.frombuffer(data[half:], "u1")
    return np.cumsum((low + 256 * high.astype("u2")).reshape(rows, row), axis=0, dtype="u2")


def unpacked(block: bytes) -> dict:
    """All parts of a block."""
    size = struct.unpack_from("<I", block)[0]
    scene, at = block[4 : 4 + size], 4 + size
    length = struct.unpack_from("<I", scene, 4)[0]
    head = json.loads(scene[8 : 8 + length])
    arrays = {n: np.frombuffer(scene, "<" + kind, count, 8 + length + a) for n, (kind, a, count) in head["buffers"].items()}
    frames, objects = head["frames"], len(head["objects"])
    vertices, columns = head["replay"]["vertices"], head["replay"]["columns"]
    found = {"head": head, **arrays}
    for name, kind, shape in (("times", "<f8", (frames,)), ("moving", "<f4", (frames, objects, 6))):
        found[name] = np.frombuffer(block, kind, int(np.prod(shape)), at).reshape(shape)
        at += found[name].nbytes
    for name, row in (("places", 3 * vertices), ("heights", columns)):
        found[name] = restored(block[at : at + 2 * row * frames], row, frames)
        at += 2 * row * frames
    found["states"] = np.frombuffer(block, "u1", columns * frames, at).reshape(frames, columns)
    at += columns * frames
    found["drops"] = []
    for count in head["replay"]["drops"]:
        found["drops"].append(np.frombuffer(block, "<f4", 4 * count, at).reshape(count, 4))
        at += 16 * count
    assert at == len(block)
    return found


def test_differences_can_be_undone():
    """Also where they leave the range of 16 bits."""
    rows = np.random.default_rng(1).integers(0, 65536, (7, 30)).astype("<u2")
    np.testing.assert_array_equal(restored(b"".join(differences(map(bytes, [*rows, *rows]), 7)), 30, 7), rows)


@pytest.mark.parametrize("exact", [False, True])
def test_the_frames_are_those_of_the_run(folder, tmp_path, exact):
    """Vertices within half a step of each object's box, times to the bit, the liquid within half a step of the basin, drops."""
    assert write_report(folder, tmp_path / "r.html", exact=exact) == 1
    found, steps = unpacked(block_of((tmp_path / "r.html").read_text())), 65535 if exact else 4095
    with Trajectory(folder) as t:
        mesh = shaded_mesh(t.metadata, t.position(0))
        order = np.argsort(mesh.object_of_vertex, kind="stable")
        of, liquid = mesh.object_of_vertex[order], t.liquid
        np.testing.assert_array_equal(found["times"], t.times)
        boxes = found["boxes"].reshape(-1, 6)
        for n in range(len(t)):
            unit = boxes[of, 3:] / steps
            at = found["moving"][n][of, :3] + boxes[of, :3] + found["places"][n].reshape(-1, 3) * unit
            assert (np.abs(at - mesh.vertices(t.position(n))[order]) <= 0.51 * unit + 1e-6).all()
            height = liquid.low[2] + found["heights"][n] / 65535 * (liquid.high[2] - liquid.low[2])
            assert np.abs(height - t.liquid_height(n).ravel()).max() < 1e-5
            np.testing.assert_array_equal(found["drops"][n], t.liquid_drops(n))
        assert max(map(len, found["drops"])) > 0
        assert (found["states"] == 1).any() and found["head"]["replay"]["steps"] == steps


def test_all_that_the_folder_tells_is_in_it(folder, tmp_path):
    """The ledger, cost with lines, expectations, certificate, effects with reasons, the scene, versions and hashes."""
    write_report(folder, tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text()
    news = unpacked(block_of(page))["head"]["replay"]["news"]
    ledger = Ledger.read(folder / "ledger.csv")
    assert news["rows"] == [[r[c] for c in ledger.columns] for r in ledger.rows] and news["state"] == "done"
    article = page[page.index("<article>") : page.index("</article>")]
    for words in (
        "raft.position.z",
        ">met<",
        "time step",
        "buoyancy",
        "no ground in the scene",
        "object raft",
        "splash.txt:",
        "lammps",
    ):
        assert words in article, words
    assert hashlib.sha256((folder / "scene.lock.txt").read_bytes()).hexdigest() in article
    assert str(folder.parent) not in page and str(folder.parent).encode() not in block_of(page)


def test_nothing_is_asked_of_any_host(folder, tmp_path):
    """No address but in comments of licences; the policy allows the scripts and the style by their hashes, and no connection."""
    write_report(folder, tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text()
    assert not re.search(r"(src|href)=\"(?!data:)", page) and "@import" not in page and "url(" not in page
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    rules = dict(part.strip().partition(" ")[::2] for part in policy.split(";"))
    assert rules["default-src"] == "'none'" and "connect-src" not in rules and "unsafe" not in policy
    for tag, rule in (("script", "script-src"), ("style", "style-src")):
        (text,) = re.findall(rf"<{tag}>(.*?)</{tag}>", page, re.S)
        assert f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'" in rules[rule]


def test_text_of_strangers_stays_text(folder, tmp_path):
    """Words of a folder that look like HTML are shown, not obeyed."""
    bad = tmp_path / "bad.out"
    shutil.copytree(folder, bad)
    evil = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
    for name, change in (
        ("summary.json", lambda data: data["expect"][0].update(what=evil)),
        ("manifest.json", lambda data: data.update(version=evil, packages={evil: evil})),
        ("certificate.json", lambda data: data.update(cause=evil)),
        ("cost.json", lambda data: data["other"].update({evil: 1.0})),
    ):
        data = json.loads((bad / name).read_text())
        change(data)
        (bad / name).write_text(json.dumps(data))
    lock = (bad / "scene.lock.txt").read_text()
    (bad / "scene.lock.txt").write_text(f"# {evil}\n{lock}")
    write_report(bad, tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text()
    assert page.count("&lt;img src=x onerror") >= 6 and "<img src=x" not in page
    assert len(re.findall("<script", page)) == 3


def test_long_runs_are_thinned(folder, tmp_path, monkeypatch):
    """Above the limit every second, fourth, ... frame is kept, and the report says so."""
    assert write_report(folder, tmp_path / "whole.html") == 1
    packed = re.search(r'id="replay">([^<]*)</script>', (tmp_path / "whole.html").read_text())[1]
    monkeypatch.setattr(export, "MOST_BYTES", len(base64.b64decode(packed)) - 1)
    every = write_report(folder, tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text()
    found = unpacked(block_of(page))
    assert every in (2, 4) and f"One of {every} frames is kept" in page
    with Trajectory(folder) as t:
        np.testing.assert_array_equal(found["times"], t.times[::every])
        assert found["head"]["frameTime"] == pytest.approx(every * t.dt * t.steps_per_frame)
    assert found["head"]["replay"]["news"]["count"] == len(found["times"]) and len(found["head"]["replay"]["news"]["rows"]) == 6


def test_a_long_run_need_not_fit_in_memory(tmp_path):
    """A few of 500 frames of 4000 vertices, 12 MB as they are kept, are in memory at a time."""
    x = np.random.default_rng(2).normal(size=(4000, 3))
    values = {"position": x, "center_of_mass": np.zeros((1, 3)), "center_of_mass_velocity": np.ones((1, 3))}
    frames = SimpleNamespace(value=lambda name, n: (1.0 + 0.001 * n) * values[name], time=float, path=tmp_path)
    feed = SimpleNamespace(
        frames=frames, first=np.zeros(1, int), count=np.array([4000]), vertices=lambda x, gone: np.array(x),
        gone=lambda n: None, liquid=lambda n: None, added=lambda n: np.zeros((0, 3), "<f4"),
        drops=lambda n: np.zeros((0, 4)), head=lambda: {"frameTime": 0.1}, buffers=dict,
    )  # fmt: skip
    tracemalloc.start()
    try:
        with export._Frames(feed, 500, 4095, tmp_path, lambda *_: None) as kept:
            block = export.compressed(kept.pieces({}, 1), None)
            most = tracemalloc.get_traced_memory()[1]
            assert export.compressed(kept.pieces({}, 1), len(block) - 1) is None
    finally:
        tracemalloc.stop()
    assert most - 3 * len(block) < 2_000_000 and not list(tmp_path.iterdir())
    size = struct.unpack_from("<I", plain := gzip.decompress(block))[0]
    assert len(plain) == 4 + size + 500 * (8 + 24 + 6 * 4000)


def test_only_runs_that_have_ended(folder, tmp_path):
    """One that goes on is refused; a killed one is reported on as far as it came; an empty one has nothing to report."""
    killed = tmp_path / "killed.out"
    shutil.copytree(folder, killed)
    lines = (killed / PROGRESS).read_text().splitlines(keepends=True)
    (killed / PROGRESS).write_text("".join(line for line in lines[:4] if '"cost"' not in line))
    (killed / "summary.json").unlink()
    with claimed(killed), pytest.raises(RefusedError, match="mdanim-lammps view"):
        write_report(killed, tmp_path / "r.html")
    write_report(killed, tmp_path / "r.html")
    found = unpacked(block_of((tmp_path / "r.html").read_text()))
    assert found["head"]["replay"]["news"]["state"] == "killed" and len(found["times"]) == 3
    (killed / PROGRESS).write_text(lines[0])
    with pytest.raises(OutputError, match="no frame"):
        write_report(killed, tmp_path / "r.html")


def test_modules_come_after_what_they_import():
    """As the page links them one after the other."""
    files = {path[1:]: body.decode() for path, (body, _) in packaged_files().items() if path.endswith(".js")}
    order = in_order(files)
    assert set(order) == set(files) and order[-1] == "main.js"
    for k, name in enumerate(order):
        assert set(re.findall(r'from "\./([\w.]+)"', files[name])) <= set(order[:k])


def test_the_command(folder, tmp_path, capsys):
    """Beside the run unless -o says where, which must end in .html."""
    for arguments, code in (([], 0), (["-o", str(tmp_path / "x.html")], 0), (["-o", str(tmp_path / "x.pdf")], 2)):
        with pytest.raises(SystemExit) as end:  # noqa: PT012 -- some commands return, others exit
            cli.main(["report", str(folder), *arguments, "-q"])
            raise SystemExit(0)
        assert end.value.code == code
    assert (folder / "report.html").read_bytes() == (tmp_path / "x.html").read_bytes()
    (folder / "report.html").unlink()
