# SPDX-License-Identifier: GPL-2.0-only
"""Scenes of which the certificate is asked, and its margins by name."""

from __future__ import annotations

BOX = """
object a {{
  shape box ({size}, {size}, {size}) cm
  position (0, 0, 0) m
  density 1000
  elasticity {young} kPa
  {extra}
}}
control {{
  time 1 s
  resolution 1 cm
  {control}
}}
"""


def box(size=4, young=100, extra="", control=""):
    """A scene of one cube."""
    return BOX.format(size=size, young=young, extra=extra, control=control)


POOL = """gravity (0, 0, -9.81)
liquid water {{
  basin from (-0.5, -0.5, 0) m to (0.5, 0.5, 2) m
  density 1000
  level {level} m
  model surface
  {liquid}
}}
object cube {{
  shape box (20, 20, 20) cm
  position (0, 0, {height})
  density {density}
  elasticity {young} kPa
}}
control {{
  time 1 s
  resolution 5 cm
}}
"""


def pool(density=500, height=0.6, young=100, level=0.5, liquid="", more=""):
    """A scene of one cube above a liquid."""
    return POOL.format(density=density, height=height, young=young, level=level, liquid=liquid) + more


def margin(certificate, name, object=None):
    """The margin of this name, of this object where there are several."""
    found = [m for m in certificate.margins if m.name == name and object in (None, m.object)]
    assert len(found) == 1
    return found[0]


PILE = """gravity (0, 0, -10)
ground z 0
object foot {{
  shape box (10, 10, 10) cm
  position (0, 0, 5) cm
  density 1000
  elasticity {foot} kPa
  {extra}
}}
object top {{
  shape box ({wide}, 10, {high}) cm
  position ({x}, 0, {z}) cm
  density 2000
  elasticity 400 kPa
  {top}
}}
control {{
  time 1 s
  resolution 2.5 cm
  {control}
}}
"""


def pile(foot=100, wide=10, high=20, x=0, z=20.5, extra="", top="", control=""):
    """A block with another one on it."""
    return PILE.format(foot=foot, wide=wide, high=high, x=x, z=z, extra=extra, top=top, control=control)
