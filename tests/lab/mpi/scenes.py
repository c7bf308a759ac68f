# SPDX-License-Identifier: GPL-2.0-only
"""Short scenes in which everything happens that executors must get right."""

from scene_texts import GRAVITY, ON_GROUND, SHELF, SPLASH, solid

FLYING = """
gravity (0, 0, -9.81) m/s^2
ground z 0 m
walls from (0, 0, -1) m to (1.6, 1.6, 3) m
repeat i in 1 .. 4 {
  repeat j in 1 .. 4 {
    object ball[i*4 + j] {
      shape      sphere 9 cm
      position   (i*0.3, j*0.3, 0.25 + 0.12*((i + j) mod 3)) m
      mass       0.8 kg
      elasticity 300 kPa
      drag       0.2
      damping    0.02
      velocity   (rand(-6, 6), rand(-6, 6), rand(-3, 2)) m/s
    }
  }
}
control { time 0.2 s  frames 100 fps  resolution 5 cm  contact-model paper }
expect energy.residual = 0 +- 2e-2
expect penetration.max = 0 +- 5 cm
expect ball[5].position.z at 0.2 s = 0.5 +- 0.5 m
"""
"""Balls that fly about and meet others all the time."""
MIXED = (
    SHELF.replace("time 0.2 s  frames 50 fps", "time 0.12 s  frames 100 fps")
    + solid("shelf", "box (40, 10, 5) cm", "(-20, 40, 20) cm", "density 900", "hold faces x", elasticity="300 kPa")
    + solid(
        "onto",
        "box (10, 10, 5) cm",
        "(-20, 42, 30) cm",
        "density 900",
        "velocity (0, 0, -3) m/s  drag 0.5  damping 0.1",
        elasticity="200 kPa",
    )
    + solid("skimming", "box (10, 10, 10) cm", "(-60, 0, 17) cm", "density 600", "velocity (1, 0, -2) m/s")
)
"""Damped and dragged, thin, held at faces and as a whole, with one that lands on the rock."""
PASSING = FLYING.split("expect")[0] + "effects { contact off }"
"""The same where nothing feels another: no island but of one."""
RAFTS = (
    SPLASH.replace("time 0.1 s", "time 0.24 s")
    + solid("buoy", "box (10, 10, 7.5) cm", "(-15, 18, 30) cm", "density 300")
    + solid("above", "box (10, 10, 10) cm", "(18, 8, 120) cm", "density 800")
)
"""Two that fall into the liquid, one that lies in it, one that never comes near."""
DAM = SPLASH[: SPLASH.index("object raft")] + "control { time 0.2 s  frames 50 fps  resolution 2.5 cm  seed 5 }"
"""Nothing moves but the liquid."""
HEAVY = (
    ON_GROUND
    + solid(
        "block", "box (40, 30, 20) cm", "(0, 0, 11) cm", "density 900", "velocity (0, 0, -2) m/s  spin (1, 2, 0)  damping 0.05"
    )
    + solid("crumb", "box (5, 5, 5) cm", "(60, 0, 20) cm", "density 900")
    + "control { time 0.06 s  frames 100 fps  resolution 2.5 cm }\n"
)
"""One object that is nearly all of the work."""
BOUNCE = """
object left  { shape box (20, 20, 20) cm  position (-18, 0, 0) cm  density 900  elasticity 1 MPa  velocity (4, 0, 0.5) m/s }
object right { shape box (20, 20, 20) cm  position (18, 3, 0) cm   density 900  elasticity 1 MPa  velocity (-4, 0, 0) m/s \
 damping 0.02 }
control { time 0.12 s  frames 200 fps  resolution 4 cm }
"""
"""Two that meet, together are too much for one executor, and part again."""
ALONE = HEAVY[: HEAVY.index("object crumb")] + HEAVY[HEAVY.index("control") :]
"""Fewer objects than executors."""
RESTING = """
gravity (0, 0, -9.81) m/s^2
object stone { shape box (10, 10, 10) cm  position (0, 0, 10) cm  density 2500  elasticity 1 MPa  hold all }
control { time 0.05 s  frames 100 fps  resolution 2.5 cm }
"""
"""Nothing moves at all."""
HASTY = (
    FLYING.split("control")[0].replace("1 .. 4", "1 .. 2")
    + "control { time 1.05 ms  frames 20000 fps  timestep 0.05 ms  resolution 5 cm }"
)
"""Frames of one step."""
UNEVEN = FLYING.split("control")[0].replace("1 .. 4", "1 .. 3") + "control { time 0.107 s  frames 100 fps  resolution 5 cm }"
"""A last frame that is shorter than the others."""
POOL = RAFTS.replace("time 0.24 s", "time 0.16 s")
"""The same, shorter."""
WAVES = POOL.replace("model surface", "model waves manning 0.03 drops 1 wave -x amplitude 2 cm period 0.5 s")
"""The same in a liquid with momentum."""
APART = (
    GRAVITY
    + solid("falling", "box (10, 10, 10) cm", "(0, 0, 0) m", "density 900", "velocity (0, 0, -2) m/s")
    + solid("below", "box (10, 10, 10) cm", "(0, 0, -20) cm", "density 900", "hold faces z", elasticity="1 MPa")
    + solid("hanging", "box (10, 10, 10) cm", "(5, 0, 0) m", "density 900", "hold faces z", elasticity="1 MPa")
    + "control { time 0.1 s  frames 100 fps  resolution 2.5 cm }\n"
)
"""One that moves fast, onto one that hardly moves, and another of these."""
SEAMS = """
gravity (0, 0, -9.81) m/s^2
repeat j in 0 .. 1 {
  repeat i in 0 .. 1 {
    object slab[2*j + i] { shape box (60, 40, 10) cm  position (0.6*i - 0.3, j, -0.05) m  density 1000
      elasticity 2 MPa  hold all }
  }
  object box[j] { shape box (20, 20, 20) cm  position (-0.12, j, 0.1) m  velocity (0.5, 0, 0) m/s  density 500
    elasticity 2 MPa }
}
control { time 0.16 s  frames 50 fps  resolution 5 cm }
"""
"""Two boxes that slide over the seams of held slabs, far from each other."""
