# SPDX-License-Identifier: GPL-2.0-only
"""What can be simulated: one folder per feature, and nothing outside of it knows the feature by its name.

A folder has facets, each a module that is looked for by its name:

``words``    what it adds to the language (scene/): SWITCHES, what calls for each of its effects; QUANTITIES, what ``expect`` can
             check; MARGINS, what each of its limits means; SCENE, a class with settings that stand outside of all blocks;
             CHECKS by the word of a block, and check(validator, top, held) of a whole scene (scene/validate.py);
             touched(scene), whether it brings something that objects may touch; width(scene), what scenes without objects go by
``measure``  how its quantities are found (effects/measured.py): MEASURES in a run that has ended, RECORDED in one object
``effect``   EFFECTS, the effects that it brings (effects/effect.py): causes, columns, commands, planes, bound, ledger
``advice``   notes(envelope), what `check` tells of a scene beside what effects tell, whether or not any of them is on

Folders are found, so adding a feature touches no other file. Those in ``MDANIM_FEATURES``, folders of such folders, are
features too: to try one that is not part of the package. Its code is run, so it may not come from a stranger.
"""

from __future__ import annotations

import os
import pkgutil
from collections.abc import Iterator
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any

MORE = "MDANIM_FEATURES"
"""Environment variable: further folders of features, separated as in PATH."""

__path__ = [*__path__, *filter(None, os.environ.get(MORE, "").split(os.pathsep))]


@lru_cache(maxsize=1)
def names() -> tuple[str, ...]:
    """Folders of all features, in alphabetical order."""
    return tuple(sorted(module.name for module in pkgutil.iter_modules(__path__) if module.ispkg))


def facets(kind: str) -> Iterator[ModuleType]:
    """The modules of this name that features have, in the order of `names`."""
    for name in names():
        module = f"{__name__}.{name}.{kind}"
        if find_spec(module):
            yield import_module(module)


@lru_cache(maxsize=1)
def effects() -> tuple[Any, ...]:
    """All effects, each an effects.Effect, in the order in which their forces are summed."""
    return tuple(sorted((e for facet in facets("effect") for e in facet.EFFECTS), key=lambda e: (e.order, e.name)))
