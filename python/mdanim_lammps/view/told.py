# SPDX-License-Identifier: GPL-2.0-only
"""Curves of quantities and vectors of arrows of a run, for a page."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path

import numpy as np

from .. import features
from ..effects import resolve
from ..effects.measured import Of, Recorded
from ..errors import MdanimError, OutputError
from ..picture.run_values import RunValues
from ..results.quantities import quantity_of, unmeasured
from ..results.trajectory import Trajectory
from ..scene.naming import labelled, objects_by_name
from ..scene.quantities import GLOBALS, QUANTITIES, Asked
from ..scene.render import Render
from ..scene.schema import Observable
from ..scene.shown import ARROWS

Named = str | list[str]
"""A quantity as a page asks for it: one that the scene asks for, as it is written there, or a subject and its word."""


class ShownQuantities:
    """Quantities of a run, at the frames that it has; may be used by several threads.

    Args:
        folder: output folder of the run.
        columns: of its ledger, as of `RunValues`; a run that goes on has no ledger.csv.

    Raises:
        OutputError: no trajectory there, or a damaged one.
    """

    def __init__(self, folder: Path, columns: Mapping[str, np.ndarray] | None = None):
        self._turn = threading.Lock()
        self._trajectory = Trajectory(folder)
        self._values = RunValues(self._trajectory, columns)
        if columns is not None:
            self.renew(columns)

    def renew(self, columns: Mapping[str, np.ndarray]) -> None:
        """Take the frames that have come since, as many as the ledger has rows. Raises OutputError."""
        count = len(columns["time"])
        with self._turn:
            if count != len(self._trajectory):
                self._trajectory = self._trajectory.renewed(count)
                self._values = RunValues(self._trajectory, columns)

    def head(self) -> dict:
        """Quantities that can be asked for, with units: ``own``, those of the scene, ``words`` of any object, ``globals``; the
        words of ``arrows``, those of them that are ``means`` since the frame before, and why those are ``untold`` of which
        frames know nothing of any object."""
        with self._turn:
            words = {word: of.unit for (kind, word), of in self._free() if kind == "NAME"}
            arrows = [word for word in ARROWS if word == "velocity" or f"{word}.x" in words]
            return {
                "own": {what: of.unit for what, of in self.own.items()},
                "words": words,
                "globals": {f"{kind}.{word}": of.unit for (kind, word), of in self._free() if kind in GLOBALS},
                "arrows": arrows,
                "untold": {word: why for word in arrows if (why := self._untold(word))},
                "means": [word for word in arrows if quantity_of(Asked("", f"{word}.x")).since],
            }

    @property
    def objects(self) -> int:
        """How many objects there are."""
        return len(self._trajectory.names)

    @cached_property
    def own(self) -> dict[str, Asked]:
        """Quantities that the scene records or draws, as they are written."""
        if (scene := self._trajectory.scene) is None:
            return {}
        asked = (*scene.render.plot, *scene.records)
        return {of.what: of for of in asked if self._has(of)}

    def curve(self, named: Named) -> tuple[dict, dict[str, np.ndarray]]:
        """``what`` it is, its ``unit``, whether a value is the ``mean`` since the frame before; ``time`` [s] and ``value``.

        Raises ValueError for what is not a quantity of a subject of the run, MdanimError where the run does not tell it.
        """
        with self._turn:
            of = self._asked(named)
            if self._trajectory.scene and (problems := unmeasured(self._trajectory.scene, [of])):
                raise OutputError(problems[0].message)
            value = self._values.series(of)
            time = self._trajectory.times[: len(value)]
            head = {"what": of.what, "unit": of.unit, "mean": self._values.is_mean(of)}
            return head, {"time": time.astype("<f4"), "value": value[: len(time)].astype("<f4")}

    def vectors(self, word: str) -> np.ndarray:
        """A vector of all objects at all frames, float32, shape (F, O, 3), NaN where it is not known.

        Raises ValueError for a word that arrows do not have.
        """
        if word not in ARROWS:
            raise ValueError(word)
        t = self._trajectory
        with self._turn:
            if word == "velocity":
                return t.center_velocities.astype("<f4")
            found = np.full((len(t), len(t.names), 3), np.nan, "<f4")
            for m, name in enumerate(t.names):
                if self._has(Asked(name, f"{word}.x")):
                    one = self._values.vector(name, word)[: len(t)]
                    found[: len(one), m] = one
            return found

    def _untold(self, word: str) -> str:
        """Why a vector is not told of any object; empty where it is of one."""
        names = self._trajectory.names
        problems = unmeasured(self._trajectory.scene, [Asked(name, f"{word}.x") for name in names])
        return problems[0].message if names and len(problems) == len(names) else ""

    def _asked(self, named: Named) -> Asked:
        if isinstance(named, str):
            if named not in self.own:
                raise ValueError(named)
            return self.own[named]
        subject, word = named
        kind = subject if subject in GLOBALS else "NAME"
        if not (isinstance(subject, str) and (kind, word) in QUANTITIES and subject in (*GLOBALS, *self._trajectory.names)):
            raise ValueError(named)
        if QUANTITIES[kind, word].takes and not QUANTITIES[kind, word].alone:
            raise ValueError(named)
        return Asked(subject, word, of=kind)

    def _free(self) -> Iterator[tuple[tuple[str, str], Observable]]:
        """Quantities that need nothing in brackets and are known of an object at least."""
        scene, names = self._trajectory.scene, self._trajectory.names
        if scene is None:
            return
        resolved = resolve(features.effects(), scene)
        for (kind, word), of in QUANTITIES.items():
            if kind == "NAMES" or of.bound or (of.takes and not of.alone) or (of.needs and not resolved.on(of.needs)):
                continue
            subjects = names if kind == "NAME" else (kind,)
            if any(self._has(Asked(subject, word, of=kind)) for subject in subjects):
                yield (kind, word), of

    def _has(self, of: Of) -> bool:
        """Whether the run has what a quantity is found from."""
        quantity = quantity_of(of)
        try:
            return not isinstance(quantity, Recorded) or self._values.has(quantity.column_of(of))
        except MdanimError:
            return False


def shown(render: Render, names: tuple[str, ...]) -> dict:
    """Arrows, words and curves that a scene has laid over its pictures, with numbers of objects in place of names: ``arrows``,
    ``trails``, ``labels``, ``captions``, ``plots``. A line that names an object which is not there is left out."""
    of = objects_by_name(names)
    arrows = [[one.vector, of.get(one.name, []) if one.name else None, one.scale] for one in render.arrows]
    return {
        "arrows": arrows,
        "trails": [[m, one.time] for one in render.trail for m in of.get(one.name, [])],
        "labels": [[group, one.text] for one in render.label for group in labelled(of.get(one.name, []), names)],
        "captions": [[one.text, one.begin, one.end] for one in render.caption],
        "plots": [one.what for one in render.plot],
    }
