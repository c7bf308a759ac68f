# SPDX-License-Identifier: GPL-2.0-only
"""What an effect is, which effects are on in a scene, and what they are given; the effects themselves are in features/."""

from .context import Context, Resolved, Verdict
from .effect import Effect
from .resolve import acting, decide, resolve

__all__ = ["Context", "Effect", "Resolved", "Verdict", "acting", "decide", "resolve"]
