# SPDX-License-Identifier: GPL-2.0-only
"""From measured points to errors, orders, a Pareto front and one sentence of advice."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..effects.varied import varied
from ..records import dataclass
from ..scene.formatting import number, say
from ..scene.scene import Expect
from .error import Convergence, Growth, converge, difference, distance, extent, growth, order_until
from .setting import ALL, Ladder, Setting, values
from .store import Point

SHARP = 0.1
"""An ``expect`` whose tolerance is a larger share of the motion than this is too inexact to measure errors by."""
ALIKE = 0.05
"""Relative difference of errors below which they are not ranked, repeated or not: the limit itself is an estimate."""
UNSURE = 0.5
"""Share of an error from which on the doubt of all errors is told."""
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
    """Error of the centres of mass against the limit of all, rms over frames and objects, relative to the extent of the motion
    [-]."""
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
    limit: np.ndarray
    """The best estimate of the motion [m], shape (F, M, 3): that to which runs finer in everything at once tend."""
    doubt: float
    """How far the limit may be off, relative to the extent; inf where only the own setting has been measured."""
    finest: Setting
    """Setting of the finest of the runs that the limit comes from."""
    rated: dict[str, Rated]
    """By key of the setting, cheapest first."""
    ladders: dict[str, Convergence]
    measured: dict[str, tuple[Setting, ...]]
    """Settings of each ladder that were measured, coarsest first; also of those that approach no limit."""
    until: dict[str, tuple[float, float]]
    """For ladders without an order that begin with one: up to when [s], and that order."""
    touching: bool
    """Whether objects may touch each other or a plane."""
    growth: Growth | None
    """Divergence of the two finest runs of the time step's ladder."""

    @property
    def chaotic(self) -> bool:
        """Whether runs of neighbouring time steps diverge, so that no ladder converges."""
        found = self.ladders.get("time step")
        return bool(found and found.order is None and self.growth and self.growth.parted is not None)

    def off(self, rated: Rated) -> float:
        """Error of a point that is to be expected: its distance from the limit, and how far the limit may be off."""
        return math.hypot(rated.error.middle, self.doubt)

    def more(self, a: Rated, b: Rated) -> tuple[float, float]:
        """Least and most by which the error of a point exceeds that of another, wherever within its doubt the truth is."""
        if self.scale == 0.0:
            return 0.0, 0.0
        tracks = a.point.tracks[0], b.point.tracks[0]
        least, most = difference(*tracks, self.limit, self.doubt * self.scale)
        return least / self.scale, most / self.scale

    def better(self, a: Rated, b: Rated) -> bool:
        """Whether a point has the smaller error, wherever within its doubt the truth is, and by more than repeats differ."""
        return a.error.below(b.error) and self.more(a, b)[1] < 0.0

    def as_good(self, a: Rated, b: Rated) -> bool:
        """Whether the error of a point is no larger, wherever within its doubt the truth is, but by what repeats differ."""
        return self.more(a, b)[1] <= 0.5 * (a.error.spread + b.error.spread)


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

    Errors are distances from the limit of the ladder whose settings are finer in everything (`setting.together`); where nothing
    touches that is the ladder of cells. Limits of single ladders are not added: their errors may have opposite signs, and then a
    setting that is finer in one thing alone is farther from the truth. What that ladder does not vary adds to its doubt.
    """
    run = {key: p for key, p in points.items() if p.tracks}
    first = run[own.key].tracks[0]
    scale = extent(first)
    found, measured, until = {}, {}, {}
    for ladder in ladders:
        settings = tuple(s for s in ladder.settings if s.key in run)
        if len(settings) > 1:
            measured[ladder.name] = settings
            if not ladder.converges:
                continue
            sizes, tracks = [ladder.step(s) for s in settings], [run[s.key].tracks[0] for s in settings]
            short = ladder.settings[-1] not in settings
            found[ladder.name] = c = converge(sizes, tracks, scale, short=short)
            if c.order is None and (part := order_until(times, sizes, tracks, scale)):
                until[ladder.name] = part
    limit, doubt, finest = _limit(found, measured, own, first, scale)
    steps = measured.get("time step", ())
    parting = growth(times, *(run[s.key].tracks[0] for s in steps[-2:]), scale) if len(steps) > 1 else None
    noise = _usual((p.seconds for p in run.values()), UNREPEATED)
    truths = sharp(expects, names, first, times, sharpness)
    errors = {key: [distance(t, limit) / scale if scale else 0.0 for t in p.tracks] for key, p in run.items()}
    wobble = max(ALIKE, _usual(errors.values(), 0.0))  # not 0 only where repeats have another seed, that is with a liquid
    rated = {
        key: Rated(p, _duration(p.seconds, noise), _value(errors[key], wobble), _closed(p, expects, truths))
        for key, p in sorted(run.items(), key=lambda item: min(item[1].seconds))
    }
    a = Analysis(own, scale, limit, doubt, finest, rated, found, measured, until, touching, parting)
    front = pareto(rated, lambda x, y: rated[x].seconds.below(rated[y].seconds), lambda x, y: a.better(rated[x], rated[y]))
    return replace(a, rated={key: replace(r, front=key in front) for key, r in rated.items()})


_ALONG = tuple(v.name for v in varied() if v.finer_is)
COVERED = {ALL: ("resolution", *_ALONG, "time step"), **dict.fromkeys(("resolution", *_ALONG), ("time step",))}
"""Ladders that vary what another one varies too: the time step falls with the spacing and with stiffer contact."""
FIRST = (ALL, "resolution", *_ALONG, *(v.name for v in varied() if not v.finer_is), "time step")
"""Ladders by how much they vary."""


def _limit(
    found: Mapping[str, Convergence], measured: Mapping[str, Sequence[Setting]], own: Setting, track: np.ndarray, scale: float
) -> tuple[np.ndarray, float, Setting]:
    """The best estimate of the motion [m], how far it may be off relative to the extent, and the finest run that it is from."""
    name = next((name for name in FIRST if name in found), None)
    if name is None:
        return track, math.inf, own
    apart = [n for n in found if n != name and n not in COVERED.get(name, ())]
    beside = [math.hypot(distance(track, found[n].limit) / scale, found[n].doubt) if scale else 0.0 for n in apart]
    return found[name].limit, math.hypot(found[name].doubt, *beside), measured[name][-1]


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
    Lines with ``<`` or ``>``, residuals and penetration are bounds, not truths; so is a line whose tolerance is a larger share
    than ``sharpness``.
    """
    out, way = {}, {name: extent(track[:, m][:, None]) for m, name in enumerate(names)}
    for e in expects:
        if e.quantity.startswith("position.") and e.relation == "=":
            told = abs(e.value - track[0, names.index(e.subject), "xyz".index(e.quantity[-1])])
            if e.tolerance <= 1.1 * sharpness * told:
                way[e.subject] = max(way[e.subject], told)
    for k, e in enumerate(expects):
        kind = e.quantity.split(".")[0]
        if e.relation != "=" or e.kind.bound:
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


def pareto(keys: Iterable[str], cheaper: Callable[[str, str], bool], better: Callable[[str, str], bool]) -> set[str]:
    """Keys that no other beats: one beats another by being clearly less in one thing and not clearly more in the other."""
    keys = list(keys)

    def beats(a: str, b: str) -> bool:
        return (cheaper(a, b) and not better(b, a)) or (better(a, b) and not cheaper(b, a))

    return {own for own in keys if not any(beats(other, own) for other in keys if other != own)}


# --- advice -----------------------------------------------------------------------------------------------------------


def advice(a: Analysis) -> str:
    """One plain sentence."""
    own = a.rated[a.own.key]
    if a.scale == 0.0:
        return "Nothing moves in this scene, so all settings give the same result: take the cheapest."
    if a.chaotic:
        fold = f"grow e-fold every {number(a.growth.folding, 2)} s and " if math.isfinite(a.growth.folding) else ""
        return (
            f"This scene is chaotic: differences between runs {fold}exceed 1 % of the motion from "
            f"t = {number(a.growth.parted)} s on with any setting, so no setting is right to the end; choose by appearance, "
            f"by the energy drift and by time."
        )
    if math.isinf(a.doubt):
        return f"The error of the scene's own setting ({a.own}) is not known: no other setting fits the time given; use --budget."
    says = f"The scene's own setting ({a.own}) is {_off(a, own)} off and takes {_seconds(own.seconds.middle)}"
    if a.off(own) < 1e-6:
        says += ": no setting makes a difference that could be seen"
    elif against := worse(a):
        what = next((v.finer_is for v, value in values(against) if value != getattr(a.own, v.name)), "more cells")
        says += f"; {what} alone ({against}) makes it worse, as errors of the cells and of the contact have opposite signs"
    elif cause := _cause(a):
        says += f", most of the error from the {cause}" + lost(a, cause, ", which has")
    if same := as_good(a):
        says += f"; {same.point.setting} is as good in {_percent(same.seconds.middle / own.seconds.middle, 2)} of the time"
    if (next_ := better(a)) and a.off(own) >= 1e-6:
        times = number(next_.seconds.middle / own.seconds.middle, 2)
        says += f"; {next_.point.setting} brings {_off(a, next_)} for {times} times the time"
    elif a.doubt > UNSURE * own.error.middle and a.off(own) >= 1e-6:
        says += f"; how far others are off is no better known than to {_percent(_up(a.doubt))}"
    return says + "."


def _off(a: Analysis, rated: Rated) -> str:
    """``2.1 ± 0.3 %``: the error of a point, and how well it is known."""
    return off(rated.error.middle, a.doubt)


def off(error: float, doubt: float) -> str:
    """An error and how well it is known; ``up to 3 %`` where it may as well be none. A doubt is rounded up."""
    if math.isinf(doubt):
        return "not known"
    if error < 0.999 * doubt:  # a finest run is as far off as it is doubted
        return f"up to {_percent(_up(error + doubt, 2))}"
    return f"{number(100 * error, 2)} ± {_percent(_up(doubt))}" if doubt > 0.01 * error else _percent(error)


def _up(x: float, digits: int = 1) -> float:
    """A positive number rounded up to one digit, or two where the first is 1; or to two."""
    first = 10.0 ** math.floor(math.log10(x))
    unit = first / 10.0 if digits > 1 or x < 2.0 * first else first
    return unit * math.ceil(x / unit * (1.0 - 1e-12))


def as_good(a: Analysis) -> Rated | None:
    """The cheapest point that is clearly cheaper than the own one and no worse, wherever within its doubt the truth is."""
    own = a.rated[a.own.key]
    same = (r for r in a.rated.values() if r.seconds.below(own.seconds) and a.as_good(r, own))
    return min(same, key=lambda r: r.seconds.middle, default=None)


def better(a: Analysis) -> Rated | None:
    """The cheapest point that is clearly better than the own one, wherever within its doubt the truth is."""
    own = a.rated[a.own.key]
    found = (r for r in a.rated.values() if a.better(r, own) and r.error.middle <= 0.6 * own.error.middle)
    return min(found, key=lambda r: r.seconds.middle, default=None)


def worse(a: Analysis) -> Setting | None:
    """The finest setting of a single ladder that is farther from the truth than the own one, wherever that is: errors cancel."""
    own = a.rated[a.own.key]
    for name in (*_ALONG, "resolution") if ALL in a.ladders else ():
        finest = a.measured.get(name, (a.own,))[-1]
        if finest != a.own and a.better(own, a.rated[finest.key]):
            return finest
    return None


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
    single = {name: c for name, c in a.ladders.items() if name != ALL}
    shares = {name: math.hypot(distance(track, c.limit) / a.scale, c.doubt) for name, c in single.items()}
    total = sum(shares.values())
    name = max(shares, key=shares.get, default="")
    return name if total and shares[name] > 0.5 * total else ""


def _percent(x: float, digits: int = 2) -> str:
    return f"{number(100 * x, digits)} %"


def _seconds(x: float) -> str:
    return say(x, "s", 2 if x < 100.0 else 3)
