# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

from __future__ import annotations

from ...scene.schema import Observable

SWITCHES: dict[str, str] = {}

QUANTITIES = {
    **{
        ("NAME", f"{what}.{axis}"): Observable(unit, f"{about}, {axis}")
        for what, unit, about in (
            ("position", "m", "centre of mass"),
            ("velocity", "m/s", "velocity of the centre of mass"),
            ("spin", "rad/s", "angular velocity, angular momentum about the centre of mass over inertia"),
            ("force", "N", "sum of all forces on an object, mass times acceleration, mean since the frame before"),
        )
        for axis in "xyz"
    },
    **{
        ("NAME", f"angle.{axis}"): Observable(
            "rad", f"angle by which an object has turned about {axis} since the start, if by less than half a turn between frames"
        )
        for axis in "xyz"
    },
    ("energy", "work"): Observable("J", "work that drives, motors, forces, wind and all else from outside have done so far"),
    ("energy", "power"): Observable("J/s", "power of these, mean since the frame before"),
    ("NAME", "speed"): Observable("m/s", "speed of the centre of mass"),
    ("NAME", "spin"): Observable("rad/s", "magnitude of the angular velocity"),
    ("NAME", "force"): Observable("N", "magnitude of the sum of all forces"),
    ("NAME", "kinetic"): Observable("J", "kinetic energy of an object: of flight, spin and vibrations"),
    ("NAME", "distance"): Observable(
        "m", "from the centre of mass to that of another object: `ball.distance(cube)`", takes="object"
    ),
}
