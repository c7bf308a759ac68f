# SPDX-License-Identifier: GPL-2.0-only
"""Small scenes as text that tests of several rooms run."""

from __future__ import annotations

MEETING = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object slab {
  shape box (40, 30, 10) cm
  position (0, 0, 30) cm
  density 900
  elasticity 300 kPa
  hold faces x
}
object cube {
  shape box (10, 10, 10) cm
  position (2, 1, 44) cm
  orientation axis (1, 2, 0) angle 25 deg
  mass 1 kg
  elasticity 200 kPa
  velocity (0.3, 0, -4) m/s
  spin (0, 5, 1)
  drag 0.8
}
object plate {
  shape box (10, 10, 2.5) cm
  position (12, -4, 5) cm
  mass 0.2 kg
  elasticity 100 kPa
  velocity (0, 0, -3) m/s
}
control {
  time 40 ms
  frames 100 fps
  resolution 2.5 cm
}
"""


SPLASH = """
gravity (0, 0, -9.81) m/s^2
liquid water {
  basin from (-30, -25, 0) cm to (30, 25, 40) cm
  density 1000
  volume 45 l
  fill from (-30, -25, 0) cm to (20, 25, 40) cm
}
object wall {
  shape box (5, 30, 20) cm
  position (15, -10, 10) cm
  density 2000
  elasticity 1 MPa
  hold all
}
object raft {
  shape box (15, 15, 10) cm
  position (-8, 0, 26) cm
  orientation euler (0, 20, 10) deg
  density 400
  elasticity 100 kPa
  velocity (0, 0, -2) m/s
  drag 0.5
}
object stone {
  shape box (7.5, 7.5, 7.5) cm
  position (-20, -15, 5) cm
  density 2500
  elasticity 500 kPa
  damping 0.05
}
control {
  time 0.1 s
  frames 50 fps
  resolution 2.5 cm
  seed 5
}
"""


SHELF = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
walls from (-1, -1, 0) m to (1.2, 1, 2) m
object ball {
  shape sphere 6 cm
  position (0, 0, 20) cm
  mass 0.5 kg
  elasticity 100 kPa
  velocity (0, 0, -2) m/s
}
object plate {
  shape box (15, 15, 2.5) cm
  position (40, 0, 10) cm
  mass 0.3 kg
  elasticity 100 kPa
  velocity (0, 0, -1) m/s
  spin (0, 3, 0)
}
object falling {
  shape box (7.5, 7.5, 7.5) cm
  position (1, 0, 36) cm
  orientation axis (1, 1, 0) angle 20 deg
  mass 0.4 kg
  elasticity 150 kPa
  velocity (0, 0, -5) m/s
  damping 0.1
}
object feather {
  shape box (10, 5, 5) cm
  position (80, 0, 30) cm
  mass 0.01 kg
  elasticity 20 kPa
  drag 300
  velocity (2, 0, -3) m/s
}
object sheet {
  shape box (10, 10, 2.5) cm
  position (40, 1, 25) cm
  mass 0.2 kg
  elasticity 100 kPa
  velocity (0, 0, -4) m/s
  drag 0.5
}
object rock {
  shape box (10, 10, 10) cm
  position (-60, 0, 5) cm
  density 2500
  elasticity 1 MPa
  hold all
}
control { time 0.2 s  frames 50 fps  resolution 2.5 cm }
"""


POND = """
gravity (0, 0, -9.81) m/s^2
liquid water {
  basin from (-30, -25, 0) cm to (30, 25, 30) cm
  density 1000
  volume 45 l
  fill from (-30, -25, 0) cm to (20, 25, 30) cm
  MODEL
}
object above {
  shape box (10, 10, 10) cm
  position (0, 0, 120) cm
  density 800
  elasticity 100 kPa
  drag 0.3
  damping 0.1
  spin (1, 2, 3)
}
object wall {
  shape box (5, 30, 20) cm
  position (15, -10, 10) cm
  density 2000
  elasticity 1 MPa
  hold all
}
object higher {
  shape box (7.5, 7.5, 7.5) cm
  position (0, 0, 150) cm
  density 800
  elasticity 100 kPa
}
object raft {
  shape box (15, 15, 10) cm
  position (-8, 0, 26) cm
  orientation euler (0, 20, 10) deg
  density 400
  elasticity 100 kPa
  velocity (0, 0, -2) m/s
  drag 0.5
}
control { time 0.1 s  frames 50 fps  resolution 2.5 cm  seed 5 }
"""


FALL = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
object cube {
  shape box (10, 10, 10) cm
  position (0, 0, 20) cm
  density 1000
  elasticity 100 kPa
  spin (1, 2, 3)
}
object plate {
  shape box (20, 20, 5) cm
  position (0, 0, 5) cm
  density 1000
  elasticity 200 kPa
  drag 2
}
control {
  time 0.3 s
  frames 50 fps
  resolution 2.5 cm
}
expect cube.position.x at 0.3 s = 0 +- 1 m
expect cube.strain.max = 0 +- 0.5
expect energy.residual = 0 +- 1e-2
expect penetration.max = 0 +- 5 cm
"""
