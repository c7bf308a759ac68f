# SPDX-License-Identifier: GPL-2.0-only
"""The features that can be simulated: one folder each. No other code knows a feature by its name.

A folder has facets, each a module that is looked for by its name:

``words``    its part of the language (scene/): SWITCHES, the causes that call for each of its effects; QUANTITIES, which
             ``expect``, ``record`` and pictures can ask for; MARGINS, the meaning of each of its limits; classes with settings,
             SCENE outside of all blocks, OBJECT, CONTROL and RENDER in these; BLOCKS of its own; TOUCHED, words for what objects
             touch, with the kind of block that brings it; MISPLACED, words that people write behind a setting, and what to write
             instead; ELASTICITIES, classes of further forms of ``elasticity``;
             CHECKS by the word of a block, and check(validator, top, held) of a whole scene (scene/validate.py);
             touched(scene), whether it brings something that objects may touch; points(scene), whether objects touch it or each
             other with points of their surfaces; width(scene), the width that sets the spacing of
             scenes without objects
``follow``   what follows from its words: fill(validator) gives blocks settings that follow from others, before records are made;
             explained() has texts for ``explain`` by the words that are told
``divide``   DIVIDES by the word of a block, functions (validator, record) that give the records that it stands for
``places``   check(validator, held) of a whole scene by the shapes of objects: what is not where it has to be
``measure``  how its quantities are measured (effects/measured.py): MEASURES, by subject and word as in QUANTITIES;
             unmeasured(scene, asked), problems of what is asked for and cannot be told
``effect``   EFFECTS, the effects that it brings (effects/effect.py): causes, columns, commands, planes, bound, ledger
``kept``     KEPT, the records that a trajectory keeps of it (effects/kept.py): attributes, tables of frames; Track, what it adds
             to a results.trajectory.Trajectory
``vary``     VARIED, settings that a study varies (effects/varied.py)
``picture``  how it is drawn (picture/drawn.py), looked for when a picture or an export is made: drawn(trajectory), what it adds;
             medium(trajectory, render), what all else is seen through
``body``     KINDS, the kinds of bodies that it brings (bodies/kind.py): what objects are made of, and how finely
``proposal`` words with which a scene would look the same (effects/proposal.py): before(envelope), by what is known before a run,
             and after(context, trajectory), by a run; None where there are none
``glue``     lines(context), lines of the file of glue of ``fix mdanim/rigid``: what moves as one rigid body
``advice``   notes(envelope), the remarks of `check` on a scene besides those of effects, whether or not any of them is on

Folders are found, so adding a feature touches no other module of the package; CONTRIBUTING.md lists its tests and docs. Those in
``MDANIM_FEATURES``, folders of such folders, are features too: to try one that is not part of the package. Its code is run, so it
may not come from a stranger.
"""

from __future__ import annotations

import os
import pkgutil
from collections.abc import Iterator
from functools import cache, lru_cache
from importlib import import_module
from types import ModuleType
from typing import Any

MORE = "MDANIM_FEATURES"
"""Environment variable: further folders of features, separated as in PATH."""

__path__ = [*__path__, *filter(None, os.environ.get(MORE, "").split(os.pathsep))]


@lru_cache(maxsize=1)
def names() -> tuple[str, ...]:
    """Folders of all features, in alphabetical order."""
    return tuple(sorted(module.name for module in pkgutil.iter_modules(__path__) if module.ispkg))


@cache
def _modules(name: str) -> frozenset[str]:
    """Modules in the folder of a feature, found once: facets of many kinds are looked for in each."""
    return frozenset(module.name for module in pkgutil.iter_modules(import_module(f"{__name__}.{name}").__path__))


def facets(kind: str) -> Iterator[ModuleType]:
    """The modules of this name that features have, in the order of `names`."""
    for name in names():
        if kind in _modules(name):
            module = f"{__name__}.{name}.{kind}"
            found = import_module(module)
            if getattr(found.__spec__, "_initializing", False):
                raise ImportError(f"{module} imports what is made of it; it may import scene/schema.py, not scene/scene.py")
            yield found


@lru_cache(maxsize=1)
def effects() -> tuple[Any, ...]:
    """All effects, each an effects.Effect, in the order in which their forces are summed."""
    return tuple(sorted((e for facet in facets("effect") for e in facet.EFFECTS), key=lambda e: (e.order, e.name)))
