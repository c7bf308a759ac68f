# SPDX-License-Identifier: GPL-2.0-only
"""Contact of objects: at their drawn surfaces, or by the barrier of the paper."""

from .barrier import BarrierContact
from .surface import SurfaceContact

EFFECTS = (BarrierContact(SurfaceContact()),)
