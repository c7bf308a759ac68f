# SPDX-License-Identifier: GPL-2.0-only
"""Results that are found once for a scene, or for what belongs to one, and kept as long as it lives."""

from __future__ import annotations

import functools
import weakref
from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def once_for(owner: Callable[..., Any]) -> Callable[[Function], Function]:
    """Decorates a function with the same result for all arguments of the same ``owner(*arguments)``; those behind the first one
    count by their values. Owners are told apart by identity, because their values take long to compare. A result must not hold
    its owner, which would live for ever."""

    def decorate(function: Function) -> Function:
        found: dict[tuple, Any] = {}

        @functools.wraps(function)
        def kept(*arguments: Any) -> Any:
            of = owner(*arguments)
            key = (id(of), *arguments[1:])
            if key not in found:
                found[key] = function(*arguments)
                weakref.finalize(of, found.pop, key, None).atexit = False
            return found[key]

        return kept  # type: ignore[return-value]

    return decorate
