# SPDX-License-Identifier: GPL-2.0-only
"""A study from beginning to end: the scene's own setting, the ladders around it, and the results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from ..errors import DivergedError, RefusedError, UsageError
from ..records import dataclass
from ..run.prepare import prepare
from ..scene.scene import SceneRecord
from .analysis import Analysis, advice, analyse
from .bench import BUDGET, Bench
from .report import write_report
from .setting import LADDERS, Ladder, ladders, own_setting, same_frames, scene_hash, together
from .store import Point, Store


@dataclass(frozen=True)
class Study:
    """The results of a study."""

    scene: SceneRecord
    folder: Path
    points: dict[str, Point]
    ladders: tuple[Ladder, ...]
    analysis: Analysis
    left_out: dict[str, str]
    """Ladders and points that were not measured, and why."""

    @property
    def advice(self) -> str:
        """One plain sentence."""
        return advice(self.analysis)


def run_study(
    scene: SceneRecord,
    folder: Path,
    *,
    budget: float = BUDGET,
    only: Sequence[str] = (),
    force: bool = False,
    on_progress: Callable[[str], None] = lambda line: None,
) -> Study:
    """Measure ladders around a scene's own setting for ``budget`` seconds of wall time; leaves study.json, .csv and .png.

    Points that ``folder`` holds already are not measured again; every new one is stored as soon as it is there.

    Args:
        folder: of the study, usually SCENE.out/study.
        only: names of ladders (LADDERS); empty is all.
        force: delete a study of another scene.
        on_progress: called with each line of progress.

    Raises SceneError, OutputError; RefusedError when the budget is too small for the scene's own setting, DivergedError when
    that diverges; Interrupted after Ctrl-C, with all finished points kept.
    """
    if unknown := [name for name in only if name not in LADDERS]:
        raise UsageError(f"there is no ladder '{unknown[0]}'; known are {', '.join(LADDERS)}")
    scene = same_frames(scene)
    store = Store(folder, scene_hash(scene), force=force)
    ready = prepare(scene)
    own = store.named(own_setting(scene, ready), ready.certificate.timestep)
    found, left = ladders(scene, ready, own)
    found = [ladder for ladder in found if not only or ladder.name in only]
    left = {name: why for name, why in left.items() if not only or name in only}
    bench = Bench(scene, ready, own, store, budget, on_progress)
    joint = together(own, found)
    found = ([joint] if joint else []) + found
    settings = list(dict.fromkeys([own, *(s for ladder in found for s in ladder.settings)]))
    left |= {str(s): why for s, why in bench.measure_all(settings, first=joint.settings if joint else ()).items()}
    point = store.points.get(own.key)
    if point is None:
        raise RefusedError(f"the scene's own setting ({own}) {left[str(own)]}; give it more with --budget")
    if not point.tracks:
        raise DivergedError(f"the scene's own setting ({own}) cannot be measured: {point.problem}")
    analysis = analyse(
        store.points,
        found,
        own,
        store.times,
        scene.expects,
        ready.system.names,
        touching=any(e.presses for e in ready.plan.effects),
    )
    study = Study(scene, folder, store.points, tuple(found), analysis, left)
    write_report(study, store, budget)
    return study
