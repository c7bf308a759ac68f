# SPDX-License-Identifier: GPL-2.0-only
"""The settings that a study varies, scenes with a setting, and the ladders around a scene's own setting."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..certificate import fit_steps, may_end_early, whole_frames
from ..effects.varied import Varied, varied
from ..model.spacing import choose_spacing, scaled
from ..records import dataclass, extended
from ..run.prepare import Prepared, prepare
from ..scene.lock import lock_text
from ..scene.meshes import mesh_files
from ..scene.render import Render
from ..scene.scene import Accuracy, Save, SceneRecord

LADDERS = ("time step", "resolution", *(v.name for v in varied()))
ALL = "all"
"""Ladder of settings that are finer in everything at once: errors of the cells and of the contact may have opposite signs."""
FACTORS = (0.5, 0.75, 1.5, 2.0)
"""Cells of the ladders over the scene's own."""
LARGEST = 0.9
"""Largest time step of a ladder over the bound."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One point of a study; it has a field for each of `varied` too."""

    cells: float
    """Across the thinnest part."""
    fraction: float
    """Time step over the certified bound; 0 where nothing vibrates and the step is left to ``auto``."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Settings of features."""

    @property
    def key(self) -> str:
        """``c4-f0.5``: its name in files."""
        more = (f"-{v.letter}{value:g}" for v, value in values(self) if value != v.usual)
        return f"c{self.cells:g}-f{self.fraction:.4g}{''.join(more)}"

    def __str__(self) -> str:
        step = f", {self.fraction:.2f} of the bound" if self.fraction else ""
        return f"{self.cells:g} cells{step}{''.join(v.told(value) for v, value in values(self))}"


if not TYPE_CHECKING:
    Setting = extended(Setting, [(v.name, Any, field(default=v.usual)) for v in varied()])


def values(setting: Setting) -> list[tuple[Varied, Any]]:
    """The settings of features, each with its value."""
    return [(v, getattr(setting, v.name)) for v in varied()]


@dataclass(frozen=True, slots=True)
class Ladder:
    """Settings that differ in one thing, coarsest first."""

    name: str
    settings: tuple[Setting, ...]

    @property
    def converges(self) -> bool:
        """Whether its settings approach a limit."""
        return all(v.converges for v in varied() if v.name == self.name)

    def step(self, setting: Setting) -> float:
        """The quantity that goes to zero along the ladder, up to a factor."""
        if self.name == "time step":
            return setting.fraction
        return next((v.size(value) for v, value in values(setting) if v.name == self.name), 1.0 / setting.cells)


def thinnest(scene: SceneRecord) -> float:
    """Length that counts as the thinnest part [m]: spacing = thinnest / cells, for ``balanced`` 4. Raises SceneError.

    The same for all settings of a scene.
    """
    control = replace(scene.control, resolution=None, accuracy=Accuracy.BALANCED)
    return choose_spacing(replace(scene, control=control))[0] * Accuracy.BALANCED.cells


def own_setting(scene: SceneRecord, ready: Prepared) -> Setting:
    """The scene's own setting."""
    c = ready.certificate
    cells = round(float(thinnest(scene) / choose_spacing(scene)[0]), 6)
    return Setting(cells, c.fraction if math.isfinite(c.bound) else 0.0, **{v.name: v.of(scene) for v in varied()})


def with_setting(scene: SceneRecord, setting: Setting, *, repeat: int = 0) -> SceneRecord:
    """The scene with a setting; a repeat has another seed for all that draws numbers.

    Raises SceneError where an object is thinner than the spacing.
    """
    h = thinnest(scene) / setting.cells
    control = replace(scene.control, resolution=h, timestep=None, seed=scene.control.seed + repeat)
    scene = replace(scaled(scene, h / choose_spacing(scene)[0]), control=control)
    for v, value in values(setting):
        scene = scene if value is None else v.put(scene, value)
    if setting.fraction:
        bound = prepare(scene).certificate.bound
        scene = replace(scene, control=replace(scene.control, timestep=setting.fraction * bound * (1.0 + 1e-9)))
    return scene


def same_frames(scene: SceneRecord) -> SceneRecord:
    """The scene up to its last whole frame where it may depend on the time step whether a last, shorter frame follows.

    Runs of all settings have the same frames.
    """
    control = scene.control
    if not may_end_early(control):
        return scene
    end = whole_frames(control) / control.frames
    expects = tuple(e for e in scene.expects if e.time is None or e.time <= end * (1.0 + 1e-9))
    return replace(scene, expects=expects, control=replace(control, time=end))


def frames_only(scene: SceneRecord) -> SceneRecord:
    """The scene with as little in its trajectory as there can be; centres of mass stay in double precision."""
    return replace(scene, control=replace(scene.control, save=Save.BOUNDARY, single=True))


def ladders(scene: SceneRecord, ready: Prepared, own: Setting) -> tuple[list[Ladder], dict[str, str]]:
    """The ladders around a setting, and for each that is left out why."""
    out, left = [], {}
    if own.fraction:
        steps = {}
        for k in (1, 0, -1, -2, -3, -4):
            fraction = own.fraction * 2.0 ** (k / 2)
            if fraction <= LARGEST:
                # Steps that come to the same number per frame are one point; the scene's own keeps its name.
                steps.setdefault(fit_steps(scene, fraction * ready.certificate.bound * (1.0 + 1e-9))[0], fraction)
        out.append(Ladder("time step", tuple(replace(own, fraction=f) for f in steps.values())))
    else:
        left["time step"] = "nothing in the scene vibrates, every step is stable"
    n = own.cells
    cells = sorted({n, *(float(max(1, round(n * x))) for x in FACTORS)})
    cells = [c for c in cells if c == n or abs(c - n) >= 0.5]
    out.append(Ladder("resolution", tuple(replace(own, cells=c) for c in cells)))
    for v, value in values(own):
        if why := v.why_not(ready.context):
            left[v.name] = why
        else:
            out.append(Ladder(v.name, tuple(replace(own, **{v.name: x}) for x in v.ladder(value))))
    return out, left


def finer(own: Setting, cells: float, along: Sequence[Varied] | None = None) -> Setting:
    """A setting with other cells across, and those settings of features, all or these, that get finer with them.

    The time step stays the same share of its bound, which falls with all of them.
    """
    along = varied() if along is None else along
    return replace(own, cells=cells, **{v.name: v.finer(getattr(own, v.name), cells / own.cells) for v in along})


def together(own: Setting, found: Sequence[Ladder]) -> Ladder | None:
    """The ladder of settings that are finer in everything; None where one of the ladders that there are is that already."""
    cells = next((ladder for ladder in found if ladder.name == "resolution"), None)
    if cells is None or not {v.name for v in varied() if v.finer_is}.intersection(ladder.name for ladder in found):
        return None
    return Ladder(ALL, tuple(finer(own, s.cells) for s in cells.settings))


def scene_hash(scene: SceneRecord) -> str:
    """A word that is the same for scenes that move alike when run with the same setting.

    Accuracy, time step, resolution, what else a study varies, what is saved and how pictures look are left out; the program's
    version, what counts as the thinnest part, and what stands in mesh files count.
    """
    control = replace(scene.control, accuracy=Accuracy.BALANCED, timestep=None, resolution=None, save=Save.ALL, single=False)
    bare = replace(scene, name="scene", title="", control=control, render=Render())
    for v in varied():
        bare = v.put(bare, v.usual)
    digest = hashlib.sha256(f"{__version__}\n{thinnest(scene)!r}\n{lock_text(bare, mesh_files(bare))}".encode())
    return digest.hexdigest()
