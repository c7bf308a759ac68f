# SPDX-License-Identifier: GPL-2.0-only
"""The Python interface (docs/python.md): scenes and runs. Its names are imported from the package itself."""

from .run import Run
from .scene import Scene

__all__ = ["Run", "Scene"]
