# SPDX-License-Identifier: GPL-2.0-only
"""Draw what executors of a run did, and objects that they owned: ``python docs/images/timeline.py crowd.out timeline.png``."""

import sys
from pathlib import Path

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from mdanim_lammps import Run
from mdanim_lammps.picture.plot import own_style

DOING = {"simulating": "#34495e", "moving": "#f28e2b", "waiting": "#d5dade", "frozen": "#8fd0f2", "held": "#c8a2c8"}
EXECUTORS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442", "#2b2b2b")
"""Okabe and Ito's eight, told apart by colour-blind people too."""


@own_style()
def main(folder: str, picture: str) -> None:
    """Write the picture of a run."""
    run = Run(folder)
    log = run.timeline
    figure = Figure(figsize=(10.0, 5.5), layout="constrained")
    doing, owning = figure.subplots(2, height_ratios=(1.0, 2.0))
    for kind, color in DOING.items():
        for executor in range(log.executors):
            spans = [(begin, end - begin) for e, k, _, begin, end in log.spans if (e, k) == (executor, kind)]
            doing.broken_barh(spans, (executor - 0.4, 0.8), color=color, linewidth=0.0)
    busy = doing.secondary_yaxis("right")
    busy.set_yticks(range(log.executors), [f"{100 * part:.0f} % simulating" for part in log.busy()])
    doing.set(xlim=(0.0, log.seconds), yticks=range(log.executors), ylabel="executor", xlabel="wall time [s]")
    doing.invert_yaxis()
    doing.legend(
        handles=[Patch(color=color, label=kind) for kind, color in DOING.items()],
        ncols=5,
        loc="lower left",
        bbox_to_anchor=(0, 1),
    )
    owner = np.sort(log.owner(), axis=1) if len(log.names) > 160 else log.owner()
    colors = ListedColormap(["#eceeef", *EXECUTORS[: log.executors]])
    owning.imshow(owner.T, cmap=colors, vmin=-1, vmax=log.executors - 1, aspect="auto", interpolation="nearest")
    owning.set(xlabel="frame", ylabel="objects, sorted by executor" if len(log.names) > 160 else "object")
    owning.legend(
        handles=[Patch(color=EXECUTORS[e], label=str(e)) for e in range(log.executors)],
        title="executor",
        loc="upper left",
        bbox_to_anchor=(1, 1),
    )
    figure.suptitle(run.scene.record.title or run.scene.record.name, parse_math=False)
    figure.savefig(Path(picture), dpi=130)


if __name__ == "__main__":
    main(*sys.argv[1:])
