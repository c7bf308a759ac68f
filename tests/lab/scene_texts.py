# SPDX-License-Identifier: GPL-2.0-only
"""Small scenes as text that tests of several rooms run."""

from __future__ import annotations

GRAVITY = "gravity (0, 0, -9.81) m/s^2\n"
ON_GROUND = GRAVITY + "ground z 0 m\n"


def solid(name: str, shape: str, position: str, weight: str, *settings: str, elasticity: str = "100 kPa") -> str:
    """An object as a line of a scene; ``weight`` is its mass or its density."""
    found = (f"shape {shape}", f"position {position}", weight, f"elasticity {elasticity}", *settings)
    return f"object {name} {{ {'  '.join(found)} }}\n"


RAFT = solid(
    "raft",
    "box (15, 15, 10) cm",
    "(-8, 0, 26) cm",
    "density 400",
    "orientation euler (0, 20, 10) deg  velocity (0, 0, -2) m/s  drag 0.5",
)
WALL = solid("wall", "box (5, 30, 20) cm", "(15, -10, 10) cm", "density 2000", "hold all", elasticity="1 MPa")

MEETING = (
    ON_GROUND
    + solid("slab", "box (40, 30, 10) cm", "(0, 0, 30) cm", "density 900", "hold faces x", elasticity="300 kPa")
    + solid(
        "cube",
        "box (10, 10, 10) cm",
        "(2, 1, 44) cm",
        "mass 1 kg",
        "orientation axis (1, 2, 0) angle 25 deg  velocity (0.3, 0, -4) m/s  spin (0, 5, 1)  drag 0.8",
        elasticity="200 kPa",
    )
    + solid("plate", "box (10, 10, 2.5) cm", "(12, -4, 5) cm", "mass 0.2 kg", "velocity (0, 0, -3) m/s")
    + """control {
  time 40 ms
  frames 100 fps
  resolution 2.5 cm
}
"""
)


SPLASH = (
    GRAVITY
    + """liquid water {
  basin from (-30, -25, 0) cm to (30, 25, 40) cm
  density 1000
  volume 45 l model surface
  fill from (-30, -25, 0) cm to (20, 25, 40) cm
}
"""
    + WALL
    + RAFT
    + solid("stone", "box (7.5, 7.5, 7.5) cm", "(-20, -15, 5) cm", "density 2500", "damping 0.05", elasticity="500 kPa")
    + """control {
  time 0.1 s
  frames 50 fps
  resolution 2.5 cm
  seed 5
}
"""
)


SHELF = (
    ON_GROUND
    + "walls from (-1, -1, 0) m to (1.2, 1, 2) m\n"
    + solid("ball", "sphere 6 cm", "(0, 0, 20) cm", "mass 0.5 kg", "velocity (0, 0, -2) m/s")
    + solid("plate", "box (15, 15, 2.5) cm", "(40, 0, 10) cm", "mass 0.3 kg", "velocity (0, 0, -1) m/s", "spin (0, 3, 0)")
    + solid(
        "falling",
        "box (7.5, 7.5, 7.5) cm",
        "(1, 0, 36) cm",
        "mass 0.4 kg",
        "orientation axis (1, 1, 0) angle 20 deg  velocity (0, 0, -5) m/s  damping 0.1",
        elasticity="150 kPa",
    )
    + solid(
        "feather", "box (10, 5, 5) cm", "(80, 0, 30) cm", "mass 0.01 kg", "drag 300  velocity (2, 0, -3) m/s", elasticity="20 kPa"
    )
    + solid("sheet", "box (10, 10, 2.5) cm", "(40, 1, 25) cm", "mass 0.2 kg", "velocity (0, 0, -4) m/s", "drag 0.5")
    + solid("rock", "box (10, 10, 10) cm", "(-60, 0, 5) cm", "density 2500", "hold all", elasticity="1 MPa")
    + "control { time 0.2 s  frames 50 fps  resolution 2.5 cm }\n"
)


POND = (
    GRAVITY
    + """liquid water {
  basin from (-30, -25, 0) cm to (30, 25, 30) cm
  density 1000
  volume 45 l
  fill from (-30, -25, 0) cm to (20, 25, 30) cm
  MODEL
}
"""
    + solid("above", "box (10, 10, 10) cm", "(0, 0, 120) cm", "density 800", "drag 0.3", "damping 0.1", "spin (1, 2, 3)")
    + WALL
    + solid("higher", "box (7.5, 7.5, 7.5) cm", "(0, 0, 150) cm", "density 800")
    + RAFT
    + "control { time 0.1 s  frames 50 fps  resolution 2.5 cm  seed 5 }\n"
)


FALL = (
    ON_GROUND
    + solid("cube", "box (10, 10, 10) cm", "(0, 0, 20) cm", "density 1000", "spin (1, 2, 3)")
    + solid("plate", "box (20, 20, 5) cm", "(0, 0, 5) cm", "density 1000", "drag 2", elasticity="200 kPa")
    + """control {
  time 0.3 s
  frames 50 fps
  resolution 2.5 cm
}
expect cube.position.x at 0.3 s = 0 +- 1 m
expect cube.strain.max = 0 +- 0.5
expect energy.residual = 0 +- 1e-2
expect penetration.max = 0 +- 5 cm
"""
)

POOL = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
liquid water {
  basin from (-20, -20, 0) cm to (20, 20, 40) cm
  density 1000 kg/m^3
  level 10 cm
}
object cube {
  shape box (10, 10, 10) cm
  position (0, 0, 16) cm
  density 500 kg/m^3
  elasticity 100 kPa
}
control { time 0.4 s  resolution 5 cm  frames 20 fps }
"""
"""A cube above a small basin."""
