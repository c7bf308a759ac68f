# SPDX-License-Identifier: GPL-2.0-only
"""glTF 2.0 in one binary file. What keeps its shape is a node that moves and turns. The format bends a mesh over time by morph
targets alone: each frame is one, as the difference to the first frame, and an animation lets one after the other count."""

from __future__ import annotations

import json
import shutil
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..errors import UsageError
from .cut import Cut
from .usd import OPACITY, linear

LARGEST = 2**32 - 2**20
"""Bytes: the file counts its own length in 32 bits."""
FLOAT, UINT = 5126, 5125
VERTICES, INDICES = 34962, 34963


def write(cut: Cut, folder: Path, stem: str, on_frame: Callable[[int], None]) -> list[str]:
    total, stiff = len(cut.frames), cut.stiff
    bent = np.flatnonzero(~stiff)
    start = cut.surfaces(cut.frames[0])
    _refuse_too_large(cut, sum(len(start[n][0]) for n in bent))
    part = folder / "buffer"
    with open(part, "wb") as file:
        out = _Buffer(file)
        meshes = [_mesh(cut, n, surface, out) for n, surface in enumerate(start)]
        for done, frame in enumerate(cut.frames[1:], 1):
            now = cut.surfaces(frame) if len(bent) else []
            for n in bent:
                meshes[n].setdefault("targets", []).append(_attributes(now[n][0] - start[n][0], now[n][1] - start[n][1], out))
            on_frame(done)
        nodes = [{"name": body.name, "mesh": n} for n, body in enumerate(cut.bodies)]
        for n in np.flatnonzero(stiff):
            nodes[n]["translation"] = cut.motion.centre[0, n].tolist()
        animation = _animation(cut, stiff, out) if total > 1 else []
    materials = _materials(cut, meshes)
    # glTF has y up: the root turns the scene's z there.
    turned = {"name": stem, "rotation": [-(0.5**0.5), 0.0, 0.0, 0.5**0.5], "children": list(range(1, len(meshes) + 1))}
    document = {
        "asset": {"version": "2.0", "generator": "mdanim-lammps"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [turned, *nodes],
        "meshes": [
            {"name": body.name, "primitives": [mesh]} | ({"weights": [0.0] * (total - 1)} if "targets" in mesh else {})
            for body, mesh in zip(cut.bodies, meshes)
        ],
        "materials": materials,
        "accessors": out.accessors,
        "bufferViews": out.views,
        "buffers": [{"byteLength": out.length}],
        **({"animations": animation} if animation else {}),
    }
    _join(document, part, out.length, folder / f"{stem}.glb")
    on_frame(total)
    ways = [f"{stiff.sum()} objects that keep their shape move and turn as nodes"] if stiff.any() else []
    if len(bent) and total > 1:
        ways.append(f"{total - 1} morph targets for {len(bent)} meshes; between frames positions are mixed linearly")
    ways.append("lengths are metres; the root node turns z to y, which is up in glTF")
    if cut.sheds_drops:
        ways.append("drops of the liquid are left out: their number changes, and a mesh of glTF keeps its points")
    return ways


def _refuse_too_large(cut: Cut, vertices: int) -> None:
    """Raise UsageError for a file beyond what the format allows; ``vertices`` are those of what bends."""
    total = len(cut.frames)
    expected = 24 * vertices * total + (0 if cut.stiff.all() else 4 * total**2) + 28 * total * cut.stiff.sum()
    if expected > LARGEST:
        fewer = int(np.ceil(expected / LARGEST)) + 1
        raise UsageError(
            f"--to gltf: {total} frames of {vertices} vertices would take {expected / 1e9:.1f} GB, the format allows 4 GB; "
            f"take fewer frames (--every {fewer}) or objects (--objects), or --to usd"
        )


def _attributes(position: np.ndarray, normal: np.ndarray, out: _Buffer) -> dict[str, int]:
    """Accessors of positions and normals, both of shape (V, 3)."""
    return {"POSITION": out.add(position, FLOAT, VERTICES, bounds=True), "NORMAL": out.add(normal, FLOAT, VERTICES)}


def _mesh(cut: Cut, n: int, surface: tuple[np.ndarray, np.ndarray], out: _Buffer) -> dict:
    """A body in the first frame; about its centre if it keeps its shape. Its material is that of ``_materials``."""
    body, (x, normal) = cut.bodies[n], surface
    attributes = _attributes(x - (cut.motion.centre[0, n] if cut.stiff[n] else 0.0), normal, out)
    if body.paint is not None:
        attributes["COLOR_0"] = out.add(np.column_stack([linear(body.paint / 255.0), np.ones(len(x))]), FLOAT, VERTICES)
    return {"attributes": attributes, "indices": out.add(body.triangle.ravel().astype(np.uint32), UINT, INDICES)}


def _materials(cut: Cut, meshes: list[dict]) -> list[dict]:
    """A material for each look of bodies; writes its number into their meshes."""
    materials, known = [], {}
    for mesh, body in zip(meshes, cut.bodies):
        key = (body.color if body.paint is None else (1.0, 1.0, 1.0), body.clear)
        if key not in known:
            known[key] = len(materials)
            color = [*linear(np.array(key[0])).tolist(), OPACITY if body.clear else 1.0]
            look = {"pbrMetallicRoughness": {"baseColorFactor": color, "metallicFactor": 0.0, "roughnessFactor": 0.5}}
            materials.append(look | ({"alphaMode": "BLEND"} if body.clear else {}))
        mesh["material"] = known[key]
    return materials


def _join(document: dict, part: Path, length: int, path: Path) -> None:
    """Write the document and the binary part, which is removed, as one file."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file, open(part, "rb") as data:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + length))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", length, b"BIN\0"))
        shutil.copyfileobj(data, file)
    part.unlink()


def _animation(cut: Cut, stiff: np.ndarray, out: _Buffer) -> list[dict]:
    """One animation of all nodes: places and rotations of what keeps its shape, weights of all else."""
    total, motion = len(cut.frames), cut.motion
    times = out.add((cut.times - cut.times[0]).astype(np.float32), FLOAT, bounds=True)
    samplers, channels = [], []

    def follow(node: int, path: str, sampler: int) -> None:
        channels.append({"sampler": sampler, "target": {"node": node, "path": path}})

    def sample(values: np.ndarray) -> int:
        samplers.append({"input": times, "output": out.add(values, FLOAT), "interpolation": "LINEAR"})
        return len(samplers) - 1

    if not stiff.all():
        weights = sample(np.eye(total, dtype=np.float32)[:, 1:].ravel())
        for n in np.flatnonzero(~stiff).tolist():
            follow(n + 1, "weights", weights)
    for n in np.flatnonzero(stiff).tolist():
        for path, values in (("translation", motion.centre[:, n]), ("rotation", motion.rotation[:, n])):
            if np.ptp(values, axis=0).any():
                follow(n + 1, path, sample(values))
    return [{"name": "run", "samplers": samplers, "channels": channels}] if channels else []


class _Buffer:
    """The binary part, written as it grows, and the tables that say where things are in it."""

    def __init__(self, file):
        self.file, self.length = file, 0
        self.views: list[dict] = []
        self.accessors: list[dict] = []

    def add(self, values: np.ndarray, kind: int, target: int | None = None, *, bounds: bool = False) -> int:
        """Append numbers, of shape (n,) or (n, 3) or (n, 4); returns their accessor."""
        values = np.ascontiguousarray(values, np.float32 if kind == FLOAT else np.uint32)
        view = {"buffer": 0, "byteOffset": self.length, "byteLength": values.nbytes} | ({"target": target} if target else {})
        of = {(1,): "SCALAR", (2, 3): "VEC3", (2, 4): "VEC4"}[(values.ndim, *values.shape[1:])]
        accessor = {"bufferView": len(self.views), "componentType": kind, "count": len(values), "type": of}
        if bounds:
            accessor |= {"min": np.atleast_1d(values.min(axis=0)).tolist(), "max": np.atleast_1d(values.max(axis=0)).tolist()}
        self.file.write(values)
        self.length += values.nbytes
        self.views.append(view)
        self.accessors.append(accessor)
        return len(self.accessors) - 1
