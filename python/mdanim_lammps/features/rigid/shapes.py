# SPDX-License-Identifier: GPL-2.0-only
"""Shapes whose features ``fix mdanim/rigid`` knows (docs/fix_mdanim_rigid.md)."""

from ...scene.scene import Box, Cone, Cylinder, Ellipsoid, Sphere

ON_OBJECTS = (Box, Sphere)
"""On each other."""
ON_PLANES = (*ON_OBJECTS, Cylinder, Cone, Ellipsoid)
"""On planes."""
