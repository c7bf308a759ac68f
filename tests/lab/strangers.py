# SPDX-License-Identifier: GPL-2.0-only
"""Output folders as strangers craft them: one value of one file is another one than a run writes."""

from __future__ import annotations

import copy
import json
import random
from pathlib import Path

import h5py
import numpy as np
from mdanim_lammps.results.trajectory_file import CHECKSUM, STEP, TIME, checksum, datasets_of_frames, row_checksum

ODD = [
    *(None, True, -1, 0, 1, 2**53, 1e308, -0.5, 10**400, float("nan"), float("inf")),
    *("", "x", "\ud800", "<b>", "../../x", "\x1b[2J"),
    *([], {}, [[]], [None], [1, 2, 3], {"a": 1}, {"": {}}),
]
"""Values of JSON; json.dumps writes some of them as no JSON is written."""
ARRAYS = [
    *(np.zeros(0), np.zeros((0, 3)), np.zeros(3), np.zeros((2, 2, 2)), np.full(3, np.nan), np.float64(0.0), np.float64(np.inf)),
    *(np.array([b"x"]), np.array([b"\xff"]), np.array([2**62]), np.array([-1]), np.array([1j]), np.array([True, False])),
]


def crafted_json(path: Path, chance: random.Random) -> str:
    """Change a JSON file, each line of it where it is progress.jsonl; returns what was changed."""
    lines = path.suffix == ".jsonl"
    text = path.read_text()
    data = [json.loads(line) for line in text.splitlines()] if lines else json.loads(text)
    what = ""
    for _ in range(chance.choice((1, 1, 1, 3))):
        what += f" {_change(data, chance)}"
    whole = "\n".join(map(json.dumps, data)) + "\n" if lines and isinstance(data, list) else json.dumps(data)
    path.write_text(whole.replace("1e+308", chance.choice(("1e308", "1e999"))))
    return path.name + what


def _change(data, chance: random.Random) -> str:
    """Put something odd into a place of nested data, or take it out."""
    place, node = "", data
    while True:
        keys = list(node) if isinstance(node, dict) else list(range(len(node)))
        key = chance.choice(keys)
        place += f".{key}"
        if not isinstance(node[key], (dict, list)) or not node[key] or chance.random() < 0.3:
            break
        node = node[key]
    if chance.random() < 0.2:
        del node[key]
        return f"{place} is gone"
    if chance.random() < 0.1 and isinstance(node, list):
        node += copy.deepcopy(node) * chance.choice((1, 50))
        return f"{place[: place.rindex('.')]} stands twice"
    node[key] = copy.deepcopy(chance.choice(ODD))
    return f"{place} = {str(node[key])[:30]!a}"


def crafted_trajectory(path: Path, chance: random.Random) -> str:
    """Change a table or an attribute of a trajectory, and make checksums of it as a stranger could; returns what was changed."""
    with h5py.File(path, "r+") as file:
        places = []
        file.visititems(lambda name, node: places.append((name, None)) if isinstance(node, h5py.Dataset) else None)
        file.visititems(lambda name, node: places.extend((name, key) for key in node.attrs))
        name, key = chance.choice(places)
        value = chance.choice(ARRAYS)
        if key is not None:
            file[name].attrs[key] = value if chance.random() < 0.7 else chance.choice(("x", "", 0, -1, np.nan))
        elif chance.random() < 0.5 and file[name].size:
            data = file[name][()]
            at = tuple(chance.randrange(n) for n in data.shape)
            odd = {"S": [b"", b"x", b"\xff"], "i": [0, -1, 127], "u": [0, 1, 127]}
            value = data[at] = chance.choice(odd.get(data.dtype.kind, [0.0, -1.0, np.nan, 1e30]))
            file[name][...] = data
        else:
            del file[name]
            if chance.random() < 0.8:
                file[name] = value
        _seal(file)
    return f"{path.name} {name} {key or ''} = {value!r}"[:200]


def _seal(file: h5py.File) -> None:
    """Checksums that fit, where there is something that they can fit."""
    try:
        tables = datasets_of_frames(file)
        sums, steps, times = (tables.pop(name) for name in (CHECKSUM, STEP, TIME))
        for frame in range(len(sums)):
            rows = [row_checksum(steps[frame], times[frame])]
            sums[frame] = rows + [checksum(np.ascontiguousarray(table[frame])) for table in tables.values()]
    except (KeyError, TypeError, ValueError, IndexError, OSError, AttributeError):
        return
