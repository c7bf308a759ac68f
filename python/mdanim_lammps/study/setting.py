# SPDX-License-Identifier: GPL-2.0-only
"""The settings that a study varies, scenes with a setting, and the ladders around a scene's own setting."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from .. import __version__
from ..certificate import fit_steps, may_end_early, whole_frames
from ..model.spacing import choose_spacing
from ..run.prepare import Prepared, prepare
from ..scene.formatting import number
from ..scene.limits import CONTACT_STIFFNESS
from ..scene.lock import lock_text
from ..scene.meshes import mesh_files
from ..scene.render import Render
from ..scene.scene import Accuracy, LiquidModel, Save, SceneRecord

LADDERS = ("time step", "resolution", "sweeps", "contact")
ALL = "all"
"""Ladder of settings that are finer in everything at once: errors of the cells and of the contact may have opposite signs."""
FACTORS = (0.5, 0.75, 1.5, 2.0)
"""Cells of the ladders over the scene's own."""
LARGEST = 0.9
"""Largest time step of a ladder over the bound."""
TOUCHING = ("contact", "ground", "walls")
"""Effects that push objects back with ``contact-stiffness`` and are likely to act; a basin's floor and walls push back too."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One point of a study."""

    cells: float
    """Across the thinnest part."""
    fraction: float
    """Time step over the certified bound; 0 where nothing vibrates and the step is left to ``auto``."""
    sweeps: int | None = None
    """Sweeps of the liquid's automaton per update; None is ``auto``."""
    contact: float = 1.0
    """``contact-stiffness``."""

    @property
    def key(self) -> str:
        """``c4-f0.5``: its name in files."""
        sweeps = f"-s{self.sweeps}" if self.sweeps is not None else ""
        return f"c{self.cells:g}-f{self.fraction:.4g}{sweeps}" + (f"-k{self.contact:g}" if self.contact != 1.0 else "")

    def __str__(self) -> str:
        sweeps = "" if self.sweeps is None else f", {self.sweeps} sweep{'' if self.sweeps == 1 else 's'}"
        step = f", {self.fraction:.2f} of the bound" if self.fraction else ""
        contact = "" if self.contact == 1.0 else f", contact-stiffness {self.contact:g}"
        return f"{self.cells:g} cells{step}{sweeps}{contact}"


@dataclass(frozen=True, slots=True)
class Ladder:
    """Settings that differ in one thing, coarsest first."""

    name: str
    settings: tuple[Setting, ...]

    def step(self, setting: Setting) -> float:
        """The quantity that goes to zero along the ladder, up to a factor."""
        match self.name:
            case "time step":
                return setting.fraction
            case "resolution" | "all":
                return 1.0 / setting.cells
            case "contact":
                return setting.contact**-0.5  # a load goes with the square of the depth that it presses surfaces into each other
            case _:
                return 1.0 / setting.sweeps


def thinnest(scene: SceneRecord) -> float:
    """Length that counts as the thinnest part [m]: spacing = thinnest / cells, for ``balanced`` 4. Raises SceneError.

    The same for all settings of a scene.
    """
    control = replace(scene.control, resolution=None, accuracy=Accuracy.BALANCED)
    return choose_spacing(replace(scene, control=control))[0] * Accuracy.BALANCED.cells


def own_setting(scene: SceneRecord, ready: Prepared) -> Setting:
    """The scene's own setting."""
    c = ready.certificate
    sweeps = scene.liquid.sweeps if scene.liquid else None
    cells = round(float(thinnest(scene) / choose_spacing(scene)[0]), 6)
    return Setting(cells, c.fraction if math.isfinite(c.bound) else 0.0, sweeps, scene.control.contact_stiffness)


def with_setting(scene: SceneRecord, setting: Setting, *, repeat: int = 0) -> SceneRecord:
    """The scene with a setting; a repeat of a scene with liquid has another seed for its automaton.

    Raises SceneError where an object is thinner than the spacing.
    """
    control = replace(
        scene.control,
        resolution=thinnest(scene) / setting.cells,
        timestep=None,
        seed=scene.control.seed + repeat,
        contact_stiffness=setting.contact,
    )
    scene = replace(scene, control=control)
    if setting.sweeps is not None:
        scene = replace(scene, liquid=replace(scene.liquid, sweeps=setting.sweeps))
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
    if ready.plan.grid is not None and scene.liquid.model is not LiquidModel.WAVES:
        out.append(Ladder("sweeps", tuple(replace(own, sweeps=k) for k in (1, 2, 4, 8, 16))))
    else:
        left["sweeps"] = "no automaton"
    if any(ready.verdicts[name].on for name in TOUCHING):
        factors = (
            x for k in (-2, -1, 0, 1, 2, 3) if CONTACT_STIFFNESS.least <= (x := own.contact * 2.0**k) <= CONTACT_STIFFNESS.most
        )
        out.append(Ladder("contact", tuple(replace(own, contact=x) for x in factors)))
    else:
        left["contact"] = f"nothing touches: {ready.verdicts['contact'].reason}, and there is neither ground nor walls"
    return out, left


def finer(own: Setting, cells: float) -> Setting:
    """A setting with other cells across, and contact that sinks in less by as much as the spacing is smaller.

    The depth goes with 1/√stiffness. The time step stays the same share of its bound, which falls with both.
    """
    contact = own.contact * (cells / own.cells) ** 2
    contact = min(max(contact, CONTACT_STIFFNESS.least), CONTACT_STIFFNESS.most)
    return replace(own, cells=cells, contact=float(number(contact, 6)))


def together(own: Setting, found: Sequence[Ladder]) -> Ladder | None:
    """The ladder of settings that are finer in everything; None where one of the ladders that there are is that already."""
    cells = next((ladder for ladder in found if ladder.name == "resolution"), None)
    if cells is None or not any(ladder.name == "contact" for ladder in found):
        return None
    return Ladder(ALL, tuple(finer(own, s.cells) for s in cells.settings))


def scene_hash(scene: SceneRecord) -> str:
    """A word that is the same for scenes that move alike when run with the same setting.

    Accuracy, time step, resolution, sweeps, contact stiffness, what is saved and how pictures look are left out; the program's
    version, what counts as the thinnest part, and what stands in mesh files count.
    """
    control = replace(
        scene.control,
        accuracy=Accuracy.BALANCED,
        timestep=None,
        resolution=None,
        contact_stiffness=1.0,
        save=Save.ALL,
        single=False,
    )
    liquid = scene.liquid and replace(scene.liquid, sweeps=None)
    bare = replace(scene, name="scene", title="", control=control, liquid=liquid, render=Render())
    digest = hashlib.sha256(f"{__version__}\n{thinnest(scene)!r}\n{lock_text(bare, mesh_files(bare))}".encode())
    return digest.hexdigest()
