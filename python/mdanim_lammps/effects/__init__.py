# SPDX-License-Identifier: GPL-2.0-only
"""The effects, in the order in which their forces are summed. Adding one: a file here, a row in this table."""

from .air_drag import AirDrag
from .boundaries import GroundPlane, WallPlanes
from .contact import Contact
from .contact_surface import SurfaceBasin, SurfaceContact, SurfaceGround, SurfaceWalls
from .context import Context, Resolved, Verdict
from .damping import Damping
from .effect import Effect
from .gravity import Gravity
from .liquid import Basin, Buoyancy, LiquidAutomaton, LiquidDrag
from .resolve import acting, decide, resolve
from .springs import Springs

EFFECTS: tuple[Effect, ...] = (
    Springs(),
    Damping(),
    Gravity(),
    Contact(SurfaceContact()),
    GroundPlane(SurfaceGround()),
    WallPlanes(SurfaceWalls()),
    Basin(SurfaceBasin()),
    AirDrag(),
    LiquidAutomaton(),
    Buoyancy(),
    LiquidDrag(),
)

__all__ = ["EFFECTS", "Context", "Effect", "Resolved", "Verdict", "acting", "decide", "resolve"]
