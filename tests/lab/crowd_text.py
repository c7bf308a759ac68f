# SPDX-License-Identifier: GPL-2.0-only
"""Ten thousand objects as a scene."""

from __future__ import annotations

TEXT = """
gravity (0, 0, -9.81)
ground z 0
repeat i in 0 .. 99 {
  repeat j in 0 .. 99 {
    object b[100*i + j] {
      shape box (10, 10, 10) cm
      position (0.13*i, 0.13*j, 0.0502 + 0.002*((i + j) mod 2)) m
      density 1000
      elasticity 100 kPa
      velocity (rand(-1, 1), rand(-1, 1), -1)
    }
  }
}
control {
  time 1 s
  resolution 5 cm
}
"""
