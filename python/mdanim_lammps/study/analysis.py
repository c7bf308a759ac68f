# SPDX-License-Identifier: GPL-2.0-only
"""From measured points to errors, orders, a Pareto front and one sentence of advice."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..scene.formatting import number, say
from ..scene.scene import Expect
from .error import Convergence, Growth, converge, distance, extent, growth, order_until
from .setting import Ladder, Setting
from .store import Point

SHARP = 0.1
"""An ``expect`` whose tolerance is a larger share of the motion than this is too inexact to measure errors by."""
ALIKE = 0.05
"""Relative difference of errors below which they are not ranked, repeated or not: the limit itself is an estimate."""
UNREPEATED = 0.1
"""Relative spread of seconds that is taken for granted as long as no point was repeated."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """A number and its spread over repeated measurements."""

    middle: float
    spread: float

    def below(self, other: Measurement) -> bool:
        """Whether this value is smaller by more than both spreads: values that differ by less are not ranked."""
        return self.middle + 0.5 * self.spread < other.middle - 0.5 * other.spread


@dataclass(frozen=True)
class Rated:
    """A point with its cost and its error."""

    point: Point
    seconds: Measurement
    """Wall time of simulation [s]."""
    error: Measurement
    """Of the centres of mass, rms over frames and objects, relative to the extent of the motion [-]."""
    closed: float | None
    """Largest error against the ``expect`` lines that state a truth, relative to the object's own motion; None without any."""
    front: bool = False
    """On the Pareto front: no distinguishable point is both cheaper and better."""


@dataclass(frozen=True)
class Analysis:
    """The results of a study."""

    own: Setting
    scale: float
    """Extent of the motion [m]."""
    rated: dict[str, Rated]
    """By key of the setting, cheapest first."""
    ladders: dict[str, Convergence]
    measured: dict[str, tuple[Setting, ...]]
    """Settings of each ladder that were measured, coarsest first."""
    until: dict[str, tuple[float, float]]
    """Of ladders without an order that begin with one: up to when [s], and that order."""
    touching: bool
    """Whether objects may touch each other or a plane."""
    growth: Growth | None
    """Divergence of the two finest runs of the time step's ladder."""

    @property
    def chaotic(self) -> bool:
        """Whether runs of neighbouring time steps diverge, so that no ladder converges."""
        found = self.ladders.get("time step")
        return bool(found and found.order is None and self.growth and self.growth.parted is not None)


def analyse(
    points: Mapping[str, Point],
    ladders: Sequence[Ladder],
    own: Setting,
    times: np.ndarray,
    expects: Sequence[Expect],
    names: Sequence[str],
    sharpness: float = SHARP,
    *,
    touching: bool = False,
) -> Analysis:
    """Rate every point that has run.

    Each ladder has a limit of its own. The best estimate of the motion is the scene's own run with the corrections of all
    ladders on top; errors are distances from that. A ladder without an order has its finest run for a limit, which is then
    taken to be as far from the truth as from the run before it.
    """
    run = {key: p for key, p in points.items() if p.tracks}
    best = run[own.key].tracks[0]
    scale = extent(best)
    found, measured, until = {}, {}, {}
    for ladder in ladders:
        settings = tuple(s for s in ladder.settings if s.key in run)
        if len(settings) > 1:
            sizes, tracks = [ladder.step(s) for s in settings], [run[s.key].tracks[0] for s in settings]
            measured[ladder.name] = settings
            found[ladder.name] = c = converge(sizes, tracks, scale)
            if c.order is None and (part := order_until(times, sizes, tracks, scale)):
                until[ladder.name] = part
    for limit in (c.limit for c in found.values()):
        best = best + (limit - run[own.key].tracks[0])
    steps = measured.get("time step", ())
    parting = growth(times, *(run[s.key].tracks[0] for s in steps[-2:]), scale) if len(steps) > 1 else None
    noise = _usual((p.seconds for p in run.values()), UNREPEATED)
    truths = sharp(expects, names, run[own.key].tracks[0], times, sharpness)
    doubt = math.sqrt(sum(c.doubt**2 for c in found.values()))
    errors = {key: [math.hypot(distance(t, best) / scale, doubt) if scale else 0.0 for t in p.tracks] for key, p in run.items()}
    wobble = max(ALIKE, _usual(errors.values(), 0.0))  # not 0 only where repeats have another seed, that is with a liquid
    rated = {
        key: Rated(p, _duration(p.seconds, noise), _value(errors[key], wobble), _closed(p, expects, truths))
        for key, p in run.items()
    }
    front = pareto({key: (r.seconds, r.error) for key, r in rated.items()})
    rated = {
        key: Rated(r.point, r.seconds, r.error, r.closed, key in front)
        for key, r in sorted(rated.items(), key=lambda item: item[1].seconds.middle)
    }
    return Analysis(own, scale, rated, found, measured, until, touching, parting)


def _usual(seen: Iterable[Sequence[float]], otherwise: float) -> float:
    """Median of the relative spreads, twice from the median to the least, of quantities that were measured more than once."""
    spreads = [2.0 * (1.0 - min(x) / float(np.median(x))) for x in seen if len(x) > 1 and np.median(x) > 0.0]
    return float(np.median(spreads)) if spreads else otherwise


def _duration(seen: Sequence[float], usual: float) -> Measurement:
    """The shortest of some durations: other work of a machine only makes durations longer. Spread as for `_value`."""
    return Measurement(min(seen), max(2.0 * (float(np.median(seen)) - min(seen)), usual * min(seen)))


def _value(seen: Sequence[float], usual: float) -> Measurement:
    """Median, and spread or the usual relative spread, whichever is larger: three runs may agree by chance."""
    middle = float(np.median(seen))
    return Measurement(middle, max(max(seen) - min(seen), usual * middle))


def sharp(
    expects: Sequence[Expect], names: Sequence[str], track: np.ndarray, times: np.ndarray, sharpness: float = SHARP
) -> dict[int, float]:
    """The ``expect`` lines that state a truth to measure errors by: index to what the error is relative to, in SI.

    That is the extent of the object's own motion for positions, that of the run or that of the truth, whichever goes farther; its
    largest speed for velocities, the value for others.
    Residuals and penetration are bounds, not truths; so is a line whose tolerance is a larger share than ``sharpness``.
    """
    out, way = {}, {name: extent(track[:, m][:, None]) for m, name in enumerate(names)}
    for e in expects:
        if e.quantity.startswith("position."):
            told = abs(e.value - track[0, names.index(e.subject), "xyz".index(e.quantity[-1])])
            if e.tolerance <= 1.1 * sharpness * told:
                way[e.subject] = max(way[e.subject], told)
    for k, e in enumerate(expects):
        kind = e.quantity.split(".")[0]
        if (e.subject, e.quantity) in (("energy", "residual"), ("penetration", "max"), ("liquid", "residual")):
            continue
        if kind in ("position", "velocity"):
            own = track[:, names.index(e.subject)]
            speed = np.linalg.norm(np.gradient(own, times, axis=0), axis=-1)
            scale = way[e.subject] if kind == "position" else float(speed.max())
        else:
            scale = abs(e.value)
        if scale > 0.0 and e.tolerance <= 1.1 * sharpness * scale:  # the scale is that of a run, itself not exact
            out[k] = scale
    return out


def _closed(point: Point, expects: Sequence[Expect], truths: Mapping[int, float]) -> float | None:
    """Largest error of a point's first run against the closed forms."""
    return max((abs(point.found[0][k] - expects[k].value) / scale for k, scale in truths.items()), default=None)


def pareto(values: Mapping[str, tuple[Measurement, Measurement]]) -> set[str]:
    """Keys that no other beats: one beats another by being clearly less in one thing and not clearly more in the other."""

    def beats(a: tuple[Measurement, Measurement], b: tuple[Measurement, Measurement]) -> bool:
        return any(a[i].below(b[i]) and not b[1 - i].below(a[1 - i]) for i in (0, 1))

    return {k for k, own in values.items() if not any(beats(other, own) for j, other in values.items() if j != k)}


# --- advice -----------------------------------------------------------------------------------------------------------


def advice(a: Analysis) -> str:
    """One plain sentence."""
    own = a.rated[a.own.key]
    if a.scale == 0.0:
        return "Nothing moves in this scene: every setting gives the same, take the cheapest."
    if a.chaotic:
        fold = f"grow e-fold every {number(a.growth.folding, 2)} s and " if math.isfinite(a.growth.folding) else ""
        return (
            f"This scene forgets how it began: differences between runs {fold}exceed 1 % of the motion from "
            f"t = {number(a.growth.parted)} s on whatever the setting, so no setting follows it to the end; choose by looks, "
            f"by the energy drift and by time."
        )
    same = [r for r in a.rated.values() if not own.error.below(r.error)]  # no worse within the spreads
    cheapest = min(same, key=lambda r: r.seconds.middle)
    better = [r for r in a.rated.values() if r.error.below(own.error) and r.error.middle <= 0.6 * own.error.middle]
    says = f"The scene's own setting ({a.own}) is {_percent(own.error.middle)} off and takes {_seconds(own.seconds.middle)}"
    if own.error.middle < 1e-6:
        says += ": no setting makes a difference that could be seen"
    elif cause := _cause(a):
        says += f", most of the error from the {cause}" + lost(a, cause, ", which has")
    if cheapest.seconds.below(own.seconds):
        says += (
            f"; {cheapest.point.setting} is as good in {_percent(cheapest.seconds.middle / own.seconds.middle, 2)} of the time"
        )
    if better and own.error.middle >= 1e-6:
        next_ = min(better, key=lambda r: r.seconds.middle)
        says += (
            f"; {next_.point.setting} brings {_percent(next_.error.middle)} for "
            f"{number(next_.seconds.middle / own.seconds.middle, 2)} times the time"
        )
    return says + "."


def lost(a: Analysis, name: str, begin: str) -> str:
    """The time until which a ladder has an order, and why not longer; empty where it has one for the whole run, or never."""
    if name not in a.until:
        return ""
    time, order = a.until[name]
    why = ": which particles meet in a blow changes with every number of cells" if name == "resolution" and a.touching else ""
    return f"{begin} order {number(order, 2)} up to t = {number(time, 2)} s and none from then on{why}"


def _cause(a: Analysis) -> str:
    """The ladder whose limit is farthest from the scene's own run, or may be, if it is more than half of all."""
    track = a.rated[a.own.key].point.tracks[0]
    shares = {name: math.hypot(distance(track, c.limit) / a.scale, c.doubt) for name, c in a.ladders.items()}
    total = sum(shares.values())
    name = max(shares, key=shares.get, default="")
    return name if total and shares[name] > 0.5 * total else ""


def _percent(x: float, digits: int = 2) -> str:
    return f"{number(100 * x, digits)} %"


def _seconds(x: float) -> str:
    return say(x, "s", 2 if x < 100.0 else 3)
