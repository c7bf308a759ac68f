# SPDX-License-Identifier: GPL-2.0-only
"""Spellings of an older version of the Python interface: for one version they still work, and a warning tells the new one."""

from __future__ import annotations

import warnings


def warn(old: str, new: str, *, level: int = 3) -> None:
    """Tell the caller of the caller, or of a higher ``level``, what to write."""
    warnings.warn(
        f"{old} is an old spelling that the next version will not know; write {new}", DeprecationWarning, stacklevel=level
    )


class OnceMethod:
    """Value of a property that was a method: it may still be called."""

    __slots__ = ()

    def __call__(self) -> OnceMethod:
        warn("the call of a property", "it without brackets, e.g. scene.certificate")
        return self
