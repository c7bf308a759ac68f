# SPDX-License-Identifier: GPL-2.0-only
"""Scenes of the feature in features/whole, which has all that a feature may have."""

OBJECTS = """
gravity (0, 0, -9.81) m/s^2
object table { shape box (24, 24, 8) cm  position (0, 0, 0) cm    density 1000  elasticity 1 MPa  hold all }
object bob   { shape box (8, 8, 8) cm    position (0, 22, 0) cm   density 500   elasticity 300 kPa }
object arm   { shape box (8, 8, 24) cm   position (60, 0, 0) cm   density 800   elasticity 500 kPa  hold face -z }
object flag  { shape box (8, 8, 8) cm    position (60, 20, 8) cm  density 300   elasticity 200 kPa  velocity (1, 1, 0) m/s }
object rider { shape box (8, 8, 8) cm    position (2, 1, 9) cm    density 700   elasticity 300 kPa  velocity (0, 0, -1) m/s }
object far   { shape sphere 6 cm         position (0, -60, 30) cm density 900   elasticity 300 kPa  velocity (0, 0, 2) m/s }
object post  { shape box (8, 8, 8) cm    position (5, -60, 10) cm density 1000  elasticity 1 MPa }
object stone { shape box (8, 8, 8) cm    position (-60, 0, 0) cm  density 1000  elasticity 1 MPa }
"""
"""A table that shakes, with a rider on it; an arm whose foot shakes; tethers: table to bob, arm to flag,
rider to ball, and post to stone."""
SHAKING = "rig (0, 0, 1) cm\n" + OBJECTS + "control { time 0.08 s  frames 100 fps  resolution 4 cm  friction 0.4 }\n"
REMEMBERING = "rig-memory 5 N/m\n" + SHAKING
