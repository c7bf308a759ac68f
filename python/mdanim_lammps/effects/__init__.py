# SPDX-License-Identifier: GPL-2.0-only
"""The interface of an effect, the choice of effects that are on in a scene, and their context; effects themselves are in
features/."""

from .context import Context, Resolved, Verdict
from .effect import Effect
from .resolve import acting, resolve

__all__ = ["Context", "Effect", "Resolved", "Verdict", "acting", "resolve"]
