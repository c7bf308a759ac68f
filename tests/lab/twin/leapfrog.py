# SPDX-License-Identifier: GPL-2.0-only
"""Naive twin of plugin/leapfrog/law.h: eq. (3.12) as printed, with velocities kept at half steps."""

import numpy as np


def leapfrog(x, v, force, mass, drag, dt, steps):
    """Positions and whole-step velocities (3.10) after so many steps, and the energy that drag took.

    ``force(x)`` gives (N, 3); ``mass``, ``drag`` (lambda) are (N,). Starts from whole-step velocities.
    In the half step before or after v_n drag takes lambda dt/2 v_n times the mean of v_n and the half-step velocity;
    and lambda dt/2 times F dt/2m times (2/3 v_half - 1/2 v_n), positive after v_n, negative before.
    """
    half_drag = 0.5 * dt * drag[:, None]
    mean = lambda whole, half: (half_drag * whole * 0.5 * (whole + half)).sum()
    lag = lambda whole, half: (half_drag * 0.5 * push(x) * (2.0 / 3.0 * half - 0.5 * whole)).sum()
    phi = (drag * dt / (2.0 * mass))[:, None]
    push = lambda at: dt / mass[:, None] * force(at)
    half = (1.0 - phi) * v + 0.5 * push(x)  # (3.12) with v_n = (v_- + v_+) / 2 solved for v_+
    lost = mean(v, half) + lag(v, half)
    for _ in range(steps):
        x = x + dt * half
        old, half = half, (1.0 - phi) / (1.0 + phi) * half + push(x) / (1.0 + phi)
        v = 0.5 * (old + half)
        before, after = mean(v, old) - lag(v, old), mean(v, half) + lag(v, half)
        lost += before + after
    return x, v, lost - after


def exponential(x, v, force, mass, drag, dt, steps):
    """The same with the exact solution of m dv/dt = F - lambda v over each half step."""
    rate = (drag / mass)[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        gain = np.where(rate > 0.0, -np.expm1(-rate * dt / 2.0) / rate, dt / 2.0) / mass[:, None]
    keep = np.exp(-rate * dt / 2.0)
    for _ in range(steps):
        half = keep * v + gain * force(x)
        x = x + dt * half
        v = keep * half + gain * force(x)
    return x, v
