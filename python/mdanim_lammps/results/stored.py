# SPDX-License-Identifier: GPL-2.0-only
"""Contents of the JSON files of an output folder: one form for each, which its readers share. Names that older versions did not
write are not needed."""

from __future__ import annotations

from pathlib import Path

from ..effects.varied import varied
from .files import MARK, read_json
from .forms import flag, many, maybe, number, positive, record, table, text, whole

MANIFEST = record(
    {},
    {
        "program": maybe(text),
        "version": maybe(text),
        "python": maybe(text),
        "scene": maybe(text),
        "movie": maybe(text),
        "draws": maybe(flag),
        "packages": maybe(table(maybe(text))),
        "sha256": maybe(table(maybe(text))),
    },
)
COST = record(
    {
        "wall": number,
        "steps": whole,
        "particles": whole,
        "effects": table(record({"seconds": number, "place": maybe(text)}, {"share": number, "clocks": table(number)})),
        "other": table(number),
    }
)
SUMMARY = record(
    {},
    {
        "penetration": number,
        "expect": many(
            record(
                {"what": text, "time": maybe(number), "value": number, "tolerance": number, "found": maybe(number), "met": flag},
                {"relation": text, "from": maybe(number)},
            )
        ),
    },
)
CERTIFICATE = record(
    {
        "timestep": number,
        "bound": maybe(number),
        "fraction": number,
        "object": text,
        "cause": text,
        "margins": many(record({"severity": text, "name": text, "object": text, "text": text})),
    }
)
SETTING = record(
    {"cells": positive, "fraction": number}, {v.name: maybe(whole) if v.usual is None else positive for v in varied()}
)
RUNS = record({**dict.fromkeys(("seconds", "wall", "drift", "penetration"), many(number)), "found": many(many(maybe(number)))})
STUDY = record(
    {},
    {
        "hash": maybe(text),
        "advice": maybe(text),
        "points": many(
            record(
                {
                    "setting": SETTING,
                    "timestep": maybe(positive),
                    "steps": whole,
                    "particles": whole,
                    "runs": RUNS,
                    "problem": text,
                }
            )
        ),
    },
)
FACTS = {"cost": COST, "summary": SUMMARY, "certificate": CERTIFICATE}
"""Forms of the files that are told of a run that has ended, by their names without ``.json``."""


def read_manifest(folder: Path) -> dict:
    """manifest.json of an output folder. Raises OutputError."""
    return read_json(folder / MARK, MANIFEST)


def read_facts(folder: Path) -> dict[str, dict]:
    """Files of `FACTS` that a folder has. Raises OutputError where one is damaged."""
    paths = {name: folder / f"{name}.json" for name in FACTS}
    return {name: read_json(path, FACTS[name]) for name, path in paths.items() if path.exists()}
