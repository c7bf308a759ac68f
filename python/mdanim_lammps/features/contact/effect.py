# SPDX-License-Identifier: GPL-2.0-only
"""Contact of objects: at their drawn surfaces, or by the barrier of the paper."""

from .barrier import Contact
from .surface import SurfaceContact

EFFECTS = (Contact(SurfaceContact()),)
