# SPDX-License-Identifier: GPL-2.0-only
"""Random scenes: none may break down at the certified time step, and most should at three times it.

One to four solids of random shapes, stiffness over three decades, density over two, at up to half of the slowest wave speed,
on the ground, between walls, over a liquid, or in free space. Spacing 1, at most 2000 particles and 2000 steps.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from mdanim_lammps.errors import DivergedError
from trial import Trial

STEPS = 2000
BROKEN = 0.5
"""Energy residual of a scene that has blown up: where run/guard.py stops a preview."""
MOST = 0.05
"""Energy residual that a random scene may have at the certified step, a tenth of that: bodies that hit walls at half of
the wave speed and fold up reach 0.03."""
TIMES = 3.0
"""How many certified time steps are too long: they are half of the bound, which is up to 1.24 times below the exact limit."""
APART = 8.2
"""Between centres; the largest body reaches 4 in every direction, and objects may not overlap at the start."""


@dataclass(frozen=True)
class Text:
    """A random scene; hypothesis shows it as it stands."""

    scene: str

    def __repr__(self) -> str:
        return f"\n{self.scene}"


def number(low: float, high: float):
    """Numbers with few digits, so that scenes are readable."""
    return st.integers(0, 100).map(lambda n: round(low + (high - low) * n / 100.0, 6))


def decades(low: float, high: float):
    """10^low .. 10^high, evenly in the exponent."""
    return number(low, high).map(lambda e: float(f"{10.0**e:.4g}"))


def vector(size):
    return st.tuples(size, size, size)


SHAPES = st.one_of(
    st.tuples(*[st.integers(1, 4)] * 3).map(lambda n: f"box {n}"),
    number(1.5, 3.5).map(lambda r: f"sphere {r}"),
    vector(number(1.5, 3.5)).map(lambda r: f"ellipsoid {r}"),
    st.tuples(number(1.5, 2.5), number(2.0, 5.0)).map(lambda a: f"cylinder {a[0]} {a[1]}"),
    st.tuples(number(2.0, 2.8), number(4.0, 4.8)).map(lambda a: f"cone {a[0]} {a[1]}"),
    number(1.1, 1.4).map(lambda r: f"torus 2.5 {r}"),
)
PLACES = ("free", "ground", "walls", "liquid")


@st.composite
def scenes(draw) -> Text:
    """A whole scene."""
    count = draw(st.integers(1, 4))
    bodies = [(draw(SHAPES), draw(decades(3, 6)), draw(decades(2, 4))) for _ in range(count)]
    slowest = min((1.2 * young / density) ** 0.5 for _, young, density in bodies)
    place = draw(st.sampled_from(PLACES))
    load = draw(number(0.001, 0.02))
    # Weight of the worst one at the foot of a pile of all of them, over its elasticity.
    g = load * min(young / density for _, young, density in bodies) / (8.0 * count)
    text = ""
    if place != "free":
        text += f"gravity (0, 0, {-g:.6g})\n"
    low, high = (-9.0, -9.0, 0.0), (9.0, 9.0, 24.0)
    if place == "ground":
        text += "ground z 0\n"
    elif place == "walls":
        text += f"walls from {low} m to {high} m\n"
    elif place == "liquid":
        text += (
            f"liquid water {{ basin from {low} m to {high} m density {draw(decades(2, 4))} level {draw(st.integers(1, 6))} m }}\n"
        )
    for k, (shape, young, density) in enumerate(bodies):
        x, y = (APART * (side - 0.5) for side in (k & 1, k >> 1 & 1))
        z = 7.0 * (place == "liquid") + draw(number(4.1, 6.0))
        # Towards the middle of the scene more often than not, so that they meet.
        aim = np.array([-x, -y, 0.0]) / APART + draw(vector(number(-1.0, 1.0)))
        v = tuple((draw(number(0.0, 0.5)) * slowest * aim / max(1e-9, np.linalg.norm(aim))).round(6).tolist())
        turned = tuple(draw(vector(st.integers(0, 360))))
        spin = tuple(round(a * slowest, 6) for a in draw(vector(number(-0.05, 0.05))))
        more = draw(st.sampled_from(("", "", "", " damping 0.1", f" drag {density}")))
        text += (
            f"object o{k} {{ shape {shape} position ({x}, {y}, {z}) orientation euler {turned} deg density {density} "
            f"elasticity {young} Pa velocity {v} spin {spin}{more} }}\n"
        )
    return Text(text)


def control(step: float | None = None, more: str = "contact-model paper") -> str:
    """Frames so rare that they set no time step, or exactly as long as it."""
    return (
        f"control {{ time 10^9 frames 0.000001 fps resolution 1 {more} }}\n"
        if step is None
        else (f"control {{ time {4 * STEPS * step!r} frames {1.0 / step!r} fps timestep {step!r} resolution 1 {more} }}\n")
    )


@dataclass
class Tally:
    """Counts of random scenes."""

    drift: list[float] = field(default_factory=list)
    """Largest energy residual of each, at the certified step."""
    lost: list[float] = field(default_factory=list)
    """Cells of liquid lost, at the certified step, of each with a liquid."""
    met: int = 0
    """How many had a contact, or touched ground, walls or basin."""
    kinds: dict[str, int] = field(default_factory=dict)
    """Number of scenes of each place."""
    particles: int = 0
    """Size of the largest."""
    contact: list[bool] = field(default_factory=list)
    """Which have contact in their bound."""
    diverged: list[bool] = field(default_factory=list)
    """Which broke down at TIMES the certified step."""

    def share(self, contact: bool | None = None) -> float:
        """Share of scenes, or of those with or without contact, that broke down at TIMES the certified step."""
        return float(np.mean([d for d, c in zip(self.diverged, self.contact) if contact in (None, c)]))

    def __str__(self) -> str:
        without = self.contact.count(False)
        return (
            f"{len(self.drift)} random scenes, up to {self.particles} particles, {STEPS} steps; {self.met} touch something: "
            + ", ".join(f"{n} {place}" for place, n in sorted(self.kinds.items()))
            + f". At the certified step none breaks down, energy residual at most {max(self.drift):.1e}, half of them below "
            f"{np.median(self.drift):.1e}, {max(self.lost, default=0):g} cells of liquid lost. At {TIMES:g} times that step "
            f"{self.share():.0%} break down: {self.share(False):.0%} of the {without} without contact, "
            f"{self.share(True):.0%} of the {len(self.contact) - without} with it"
        )


def play(scene: Text, tally: Tally, *more: str) -> Trial:
    """Run a scene at the step that is certified; its trial, closed. Raises DivergedError. ``more`` goes into control."""
    with Trial(scene.scene + control(None, *more)) as t:
        tally.particles = max(tally.particles, t.system.particles)
        t.run(STEPS, 40)
        tally.drift.append(t.drift)
        if t.ready.plan.grid:
            tally.lost.append(t.lost_cells)
        touched = [
            e.penetration(t.instance) > 0.0 or e.energy(t.instance) > 0.0
            for e in t.ready.plan.effects
            if e.ledger in ("contact", "wall")
        ]
        tally.met += any(touched)
        place = next((p for p in PLACES if p in scene.scene), "free")
        tally.kinds[place] = tally.kinds.get(place, 0) + 1
    return t


def breaks_down(scene: Text, bound: float) -> bool:
    """Whether a scene blows up within STEPS at TIMES half of its bound."""
    try:
        with Trial(scene.scene + control(TIMES * 0.5 * bound), unstable=True) as t:
            for _ in range(20):
                t.run(STEPS // 20, 1)
                if t.drift > BROKEN:
                    return True
            return False
    except DivergedError:
        return True


def try_scenes(count: int, check) -> Tally:
    """Draw so many scenes, always the same ones; ``check(scene, trial)`` may raise what hypothesis then shrinks."""
    tally = Tally()

    @settings(max_examples=count, derandomize=True, deadline=None, database=None)
    @given(scenes())
    def each(scene):
        t = play(scene, tally)
        check(t)
        tally.contact.append(t.ready.verdicts["contact"].on)
        tally.diverged.append(breaks_down(scene, t.ready.certificate.bound))

    each()
    return tally


def play_scenes(count: int, check, more: str) -> Tally:
    """The same scenes, with ``more`` in control, at their certified step alone."""
    tally = Tally()

    @settings(max_examples=count, derandomize=True, deadline=None, database=None)
    @given(scenes())
    def each(scene):
        check(play(scene, tally, more))

    each()
    return tally
