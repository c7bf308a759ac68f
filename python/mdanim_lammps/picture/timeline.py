# SPDX-License-Identifier: GPL-2.0-only
"""A picture of a run on several executors, from its log: what each executor did when, and which objects it owned."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..results.files import write_whole
from ..results.overwriting import MADE
from ..results.timeline import KINDS, Timeline
from .palette import rgb
from .plot import own_style

DOING = {"simulating": "#34495e", "moving": "#f28e2b", "waiting": "#d5dade", "frozen": "#8fd0f2", "held": "#c8a2c8"}
"""Colours of `KINDS`: simulating is dark, waiting is pale."""
EXECUTORS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442", "#2b2b2b")
"""Okabe and Ito's eight, told apart by colour-blind people too; the next eight are tints of them."""
NO_OWNER = "#eceeef"
"""Objects that never move have no owner."""
AGAIN = {"linestyle": "none", "marker": "v", "color": "#d62728", "markersize": 5, "clip_on": False}
"""Marks of windows that were begun again."""
COLUMNS = 1200
"""Most columns of pixels of a panel."""
PIECES = 240
"""Pieces of the wall time of an executor that has changed what it does more often: in each, colours in proportion."""
ROWS = 480
"""The same for rows of objects."""
NAMED = 32
"""Objects that have a row with their name each; up to `SINGLE` a row without; of more, groups share one."""
SINGLE = 160
GROUPS = 40
"""About as many groups as there are."""


def executor_colors(executors: int) -> np.ndarray:
    """One for each, from 0 to 1, shape (K, 3)."""
    base = np.array([rgb(c) for c in EXECUTORS])
    tint = [1.0 - 0.5 ** (turn) * (1.0 - base) for turn in range(-(-executors // len(EXECUTORS)))]
    return np.concatenate(tint)[:executors]


def shares(timeline: Timeline, columns: int) -> np.ndarray:
    """Part of each of so many pieces of the wall time that each executor was at each of `KINDS`, shape (K, kinds, columns)."""
    found = np.zeros((timeline.executors, len(KINDS), columns))
    piece = timeline.seconds / columns
    for executor, kind, _, begin, end in timeline.spans:
        begin, end = begin / piece, end / piece
        first, last = min(int(begin), columns - 1), min(int(end), columns - 1)
        row = found[executor, KINDS.index(kind)]
        row[first:last] += 1.0
        row[first] -= begin - first
        row[last] += end - last
    return found


def bars(share: np.ndarray, height: int) -> np.ndarray:
    """Every executor's bar, so many pixels and a white line: colours filled up by shares, shape (K
    * (height + 2), columns, 3)."""
    level = np.cumsum(share, axis=1)  # (K, kinds, columns)
    middle = (np.arange(height)[::-1] + 0.5) / height
    kind = (level[:, :, None, :] < middle[:, None]).sum(axis=1)  # as many as are below: the next one is here
    color = np.array([*(rgb(DOING[k]) for k in KINDS), (1.0, 1.0, 1.0)])
    picture = np.ones((len(share), height + 2, share.shape[2], 3))
    picture[:, 1:-1] = color[kind]
    return picture.reshape(-1, share.shape[2], 3)


def ownership(owner: np.ndarray, colors: np.ndarray) -> np.ndarray:
    """Objects over frames in the colours of their executors; in a group they are sorted by executor, shape (rows, columns, 3).

    :param owner: executor of every object in every frame, -1 for none, shape (F, M)
    """
    table = owner.T[:, np.linspace(0, len(owner) - 1, min(len(owner), COLUMNS)).round().astype(int)]
    count = len(table)
    if count > SINGLE:
        table = np.concatenate([np.sort(group, axis=0) for group in np.array_split(table, edges(count)[1:-1])])
    table = table[np.minimum(((np.arange(min(count, ROWS)) + 0.5) * count / min(count, ROWS)).astype(int), count - 1)]
    return np.concatenate([colors, [rgb(NO_OWNER)]])[table]


def edges(count: int) -> np.ndarray:
    """Where groups of objects begin, and the end: each as large as a round number."""
    size = count / GROUPS
    size = next(n for power in range(9) for n in (10**power, 2 * 10**power, 5 * 10**power) if n >= size)
    return np.append(np.arange(0, count, size), count)


def headline(timeline: Timeline, title: str = "") -> str:
    """The line above the picture. A dash, as titles end with marks of their own:
    ``Which of them float? – 2 executors, ...``."""
    control = "the supervisor" if timeline.control == "central" else "every executor alike"
    return f"{title or 'Run'} – {timeline.executors} executor{'s' * (timeline.executors > 1)}, owners decided by {control}"


@own_style()
def draw(timeline: Timeline, path: Path, title: str = "") -> None:
    """Write the picture as PNG. Raises OutputError when it cannot be written, or a run ended before it began."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    if not timeline.frames:
        raise OutputError(f"{path.parent}: the run ended before its first frame, there is nothing to draw")
    count, objects = timeline.executors, len(timeline.names)
    colors = executor_colors(count)
    doing, moving, owning = (float(h) for h in (count * np.clip(3.2 / count, 0.2, 0.42), 0.6, np.clip(0.17 * objects, 1.3, 4.0)))
    left = 1.0 if objects > NAMED else max(0.8, 0.08 * max(map(len, timeline.names)) + 0.15)
    width, height = left + 8.0 + (2.4 if count > 10 else 1.6), 0.5 + owning + 0.1 + moving + 0.65 + doing + 1.05
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)

    def panel(bottom: float, tall: float):
        return figure.add_axes((left / width, bottom / height, 8.0 / width, tall / height))

    _draw_owners(panel(0.5, owning), timeline, colors)
    _draw_moves(panel(0.6 + owning, moving), timeline)
    _draw_doing(panel(1.25 + owning + moving, doing), timeline, colors, 1.0 + 0.42 / doing)
    figure.text(left / width, 1.0 - 0.15 / height, fontsize=12, va="top", s=headline(timeline, title), parse_math=False)
    write_whole(path, lambda part: figure.savefig(part, dpi=130, format="png", metadata={"Software": MADE}))


def _draw_doing(axes, timeline: Timeline, colors: np.ndarray, legend_at: float) -> None:
    """A bar for each executor over wall time; above, the frames; on the right, how busy it was."""
    from matplotlib.patches import Patch

    count, end = timeline.executors, timeline.seconds or 1.0  # executors that were stopped at once have no spans
    columns = COLUMNS if len(timeline.spans) <= count * PIECES else PIECES
    axes.imshow(bars(shares(timeline, columns), 24), extent=(0.0, end, count - 0.5, -0.5), aspect="auto", interpolation="nearest")
    axes.set_yticks(range(count), [f"{e}" for e in range(count)], fontsize=9)
    for label, color in zip(axes.get_yticklabels(), colors):
        label.set(
            bbox={"facecolor": color, "edgecolor": "none", "pad": 2.0, "boxstyle": "round,pad=0.25"},
            color="white" if color @ [0.2126, 0.7152, 0.0722] < 0.5 else "black",
        )
    axes.tick_params(axis="y", length=0, pad=7)
    axes.set_xlabel("wall time since all executors began [s]")
    axes.set_ylabel("executor", labelpad=8)
    busy = timeline.busy()
    right = axes.secondary_yaxis("right")
    right.set_yticks(range(count), [f"{100 * b:.0f} %" for b in busy], fontsize=9)
    right.tick_params(length=0)
    right.set_ylabel("simulating", fontsize=9)
    ends = timeline.frame_ends()
    top = axes.secondary_xaxis("top")
    known = np.array(sorted(ends))
    some = known[np.unique(np.linspace(0, len(known) - 1, min(len(known), 9)).round().astype(int))] if len(known) else known
    top.set_xticks([ends[int(f)] for f in some], [str(f) for f in some], fontsize=8)
    top.set_xlabel("end of frame", fontsize=9)
    again = [ends[f] for f, n in zip(timeline.frames, timeline.retries) if n and f in ends]
    marks = axes.plot(again, np.full(len(again), -0.5), label=f"window begun again ({sum(timeline.retries)})", **AGAIN)
    legend = [*(Patch(color=DOING[k], label=k) for k in KINDS), *(marks if again else ())]
    axes.legend(
        handles=legend,
        ncols=len(legend),
        loc="lower left",
        bbox_to_anchor=(0.0, legend_at),
        fontsize=9,
        frameon=False,
        borderaxespad=0.0,
        borderpad=0.0,
    )


def _draw_moves(axes, timeline: Timeline) -> None:
    """How many objects moved on the way to each frame, and where windows were begun again."""
    frames, moves, retries = (np.array(a, float) for a in (timeline.frames, timeline.moves, timeline.retries))
    axes.bar(frames, moves, width=1.0, color=DOING["moving"])
    top = 1.25 * max(1.0, moves.max(initial=0.0))
    axes.set(ylim=(0.0, top), ylabel="objects\nmoved", xlim=_frame_range(timeline))
    axes.plot(frames[retries > 0], np.full((retries > 0).sum(), top), **AGAIN)
    axes.tick_params(labelbottom=False, labelsize=8)
    axes.yaxis.get_major_locator().set_params(integer=True, nbins=3)


def _draw_owners(axes, timeline: Timeline, colors: np.ndarray) -> None:
    """Objects over frames in the colours of their executors."""
    from matplotlib.patches import Patch

    owner, objects = timeline.owner(), len(timeline.names)
    low, high = _frame_range(timeline)
    axes.imshow(ownership(owner, colors), extent=(low, high, objects, 0.0), aspect="auto", interpolation="nearest")
    axes.set_xlabel("frame")
    axes.xaxis.get_major_locator().set_params(integer=True)
    if objects <= NAMED:
        axes.set_yticks(np.arange(objects) + 0.5, timeline.names, fontsize=8)
        axes.tick_params(axis="y", length=0)
    elif objects <= SINGLE:
        axes.set_ylabel("object, in the order of the scene")
    else:
        at = edges(objects)
        axes.set_ylabel(f"objects, in groups of {at[1]},\nin each sorted by executor")
        for y in at[1:-1]:
            axes.axhline(y, color="white", linewidth=0.6)
    legend = [Patch(color=c, label=str(e)) for e, c in enumerate(colors)]
    if (owner < 0).any():
        legend.append(Patch(color=NO_OWNER, label="none: never moves"))
    axes.legend(
        handles=legend,
        title="executor",
        ncols=2 if len(legend) > 10 else 1,
        loc="upper left",
        bbox_to_anchor=(1.005, 1.0),
        fontsize=8,
        title_fontsize=8,
        frameon=False,
        borderaxespad=0.0,
    )


def _frame_range(timeline: Timeline) -> tuple[float, float]:
    return timeline.frames[0] - 0.5, timeline.frames[-1] + 0.5
