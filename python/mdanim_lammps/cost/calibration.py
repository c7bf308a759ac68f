# SPDX-License-Identifier: GPL-2.0-only
"""What this machine needs for one of each kind of work: measured once in a few small runs, and stored for all later scenes.

``python -m mdanim_lammps.cost.calibration`` measures and prints. That is done in a process of its own, because loading LAMMPS
takes its time only once in a process.
"""

from __future__ import annotations

import json
import math
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from .. import __version__
from ..effects.air_drag import SLOWING
from ..effects.liquid import AUTOMATON, COUPLING, OCCUPANCY, SWEEPS_PER_UPDATE, SWEPT
from ..effects.springs import fullness
from ..engine.commands import SKIN
from ..errors import OutputError, SetupError
from ..results.files import write_json

RATES = {
    "load": "loading LAMMPS and what results need [s]",
    "model": "modelling, per particle [s]",
    "insert": "handing to LAMMPS, per particle [s]",
    "step": "a step, whatever is in it [s]",
    "particle": "a step of a particle, beside springs and leap-frog [s]",
    "spring": "a step of a spring, where all lanes of the vector unit have work [s]",
    "dashpot": "what its dashpot adds, where all lanes have work [s]",
    "leap-frog": "a step of a particle that can move [s]",
    "lone leap-frog": "the same of one that is moved by itself, after the forces of a liquid, without drag [s]",
    "lone particle": "what handing over such a particle adds to the rest of a step [s]",
    "rebuild": "rebuilding lists, per particle [s]",
    "contact": "looking for objects that meet, per particle and rebuild [s]",
    "pair": "a step of a pair of particles within reach [s]",
    "wall": "finding particles near a wall, per particle and rebuild [s]",
    "handed": "a step of a particle that is handed to contact at surfaces [s]",
    "touching point": "a step of a point of a surface that touches another object [s]",
    "on plane": "a step of a point that touches a plane [s]",
    "near point": "watching a point near another object from one rebuild of lists to the next [s]",
    "near plane": "the same of a point near a plane [s]",
    "coupling": "a step of a particle in a liquid [s]",
    "cell": "a sweep of a cell of a liquid, with levelling [s]",
    "solid": "looking where a lattice cell of a solid is in a liquid [s]",
    "frame": "a frame: stopping, energies, writing [s]",
    "byte": "writing a byte of the trajectory [s]",
    "immersed": "measuring for a frame how much of a lattice cell is immersed [s]",
}
"""What is measured, and in which unit."""
METHOD = 5
"""To be counted up whenever a rate gets another meaning, or the plugin another speed: stored ones are then measured again."""
WIDE = frozenset({"avx512f", "avx512vl", "avx512dq"})
"""What a processor must have for the widest vectors of the plugin (has_avx512 in plugin/engine/blocks.cpp)."""
ROUNDS, ROUND = 25, 1e-3
"""Least of this many rounds of about this length [s]: what else the machine does only ever adds to the time, and hardly hits
every one of many short ones."""
AGAIN = 3
"""Least of this many, of what cannot be done in short rounds."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """The rates of this machine."""

    rates: dict[str, float]
    """Seconds for one of each kind of work, as in RATES."""
    stored: bool = True
    """Whether it is kept for later; not where no file can be written."""


def calibration(tell: Callable[[str], None] = lambda line: None) -> Calibration:
    """The rates of this machine: stored ones, or measured now. ``tell`` is given a line when that is done.

    A file that is broken, of another processor, version, METHOD or skin of lists is measured again. Raises SetupError when LAMMPS
    or the plugin cannot be used.
    """
    path = stored_at()
    rates = _read(path)
    if rates is not None:
        return Calibration(rates)
    if not _rates_here.cache_info().currsize:
        tell("calibrating this machine, once, for about 3 s ...")
    rates = _rates_here()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_json(path, holds_for() | {"rates": rates})
    except (OSError, OutputError) as error:
        tell(
            f"the calibration cannot be kept, it holds for this time only: {error}; "
            "set XDG_CACHE_HOME to a folder that can be written"
        )
        return Calibration(rates, stored=False)
    return Calibration(rates)


def stored_at() -> Path:
    """The file that holds the rates of this machine."""
    cache = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(cache) / "mdanim-lammps" / f"calibration-{__version__}.json"


def holds_for() -> dict[str, str | int | float]:
    """What rates depend on besides the version: they hold where all of it is the same."""
    return {"processor": processor(), "method": METHOD, "skin": SKIN}


def processor() -> str:
    """Name of this machine's processor."""
    return _cpuinfo("model name") or platform.processor() or platform.machine()


def lanes(damped: bool) -> int:
    """Numbers in a vector of the plugin, as best_width in plugin/engine chooses: wide ones where anything is damped."""
    return 8 if damped and set(_cpuinfo("flags").split()) >= WIDE else 4


@lru_cache
def _cpuinfo(key: str) -> str:
    """What Linux says of the first processor; empty where it does not."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith(key))
    except (OSError, StopIteration):
        return ""


def _read(path: Path) -> dict[str, float] | None:
    """The stored rates; None where there are none that are whole, positive, and hold here."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        rates = {name: float(data["rates"][name]) for name in RATES}
        good = all(data[k] == v for k, v in holds_for().items()) and all(0.0 < r < math.inf for r in rates.values())
        return rates if good else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


@lru_cache(maxsize=1)
def _rates_here() -> dict[str, float]:
    done = subprocess.run([sys.executable, "-m", __name__], capture_output=True, text=True)
    if done.returncode:
        why = done.stderr.strip().splitlines()
        raise SetupError(f"this machine cannot be calibrated: {why[-1] if why else 'no word why'}")
    return json.loads(done.stdout)


# --- measuring ----------------------------------------------------------------------------------------------

CUBE = """
gravity (0, 0, -{g})
ground z {ground} cm
object cube {{
  shape box ({n}, {n}, {n}) cm
  position (0, 0, 0)
  density 1000
  elasticity 1 MPa
  damping {damping}
  velocity ({v}, 0, 0) m/s
}}
object pebble {{
  shape box ({m}, {m}, {m}) cm
  position (0, 0, {z}) cm
  density 1000
  elasticity 1 MPa
  velocity ({v}, 0, 0) m/s
}}
control {{
  time 1 s
  frames 1000 fps
  resolution 1 cm
  contact-model paper
}}
"""
SLABS = """
gravity (0, 0, -{g})
ground z 0
repeat k in 0 .. {last} {{
  object slab[k] {{
    shape box (13, 13, 4) cm
    position (0, 0, 4*k + 2 + {gap}) cm
    density 1000
    elasticity 1 MPa
  }}
}}
control {{
  time 1 s
  resolution 1 cm
  friction 0.5
}}
"""
BALLS = """
ground z 0
object lower {{
  shape sphere 3 cm
  position (0, 0, 4) cm
  density 1000
  elasticity 1 MPa
  spin ({v}/0.03, 0, 0) rad/s
}}
object upper {{
  shape sphere 3 cm
  position (0, 0, 11) cm
  density 1000
  elasticity 1 MPa
}}
control {{
  time 1 s
  resolution 1 cm
  friction 0.5
}}
"""
POOL = """
gravity (0, 0, -9.81)
liquid water {
  basin from (-16, -16, 0) cm to (16, 16, 32) cm
  density 1000
  level 16 cm
}
object block {
  shape box (10, 10, 10) cm
  position (0, 0, 14) cm
  velocity (0, 0, -1.5) m/s
  density 900
  elasticity 2 MPa
}
control {
  time 1 s
  resolution 1 cm
}
"""
SMALL, LARGE = 2, 13
"""Cells along the edge of the two cubes."""
FAR, NEAR = 90, 9.5
"""Height of the pebble over the larger cube's middle [cm]: where no lists are needed, and where its box meets the cube's but
no particles are in reach."""
BELOW, UNDER = -1e8, -7.5
"""Height of the ground [cm]: where it has no concern, and a spacing under the larger cube, where lists are made anew however
particles move: where only objects are near each other, moving on together needs no new ones."""
EVERY = 5
"""Steps between rebuilds of lists where they are measured."""
FEW, MANY = 2, 22
"""Frames whose difference tells what one takes."""
TOUCH = 20
"""Steps of a round of two cubes in touch: for AGAIN such rounds the lists stay as they are, with all pairs of the start."""
STEPS = 480
"""While the block sinks in, so many that there is more than one burst of sweeps."""


def measure() -> dict[str, float]:
    """Run the small scenes and return the rates. Raises SetupError when LAMMPS or the plugin cannot be used."""
    start = time.process_time()
    from ..engine.instance import Instance
    from ..engine.plugin import open_lammps
    from ..run import loop as run  # noqa: F401  what a run loads

    open_lammps()[0].close()
    rates = {"load": time.process_time() - start}
    _prepare(_cubes(SMALL))  # whatever is loaded by the first of all
    small, large = (_cube(Instance, n) for n in (SMALL, LARGE))
    n = large["particles"] - small["particles"]
    rates["model"], rates["insert"] = (max(1e-9, large[k] / large["particles"]) for k in ("model", "insert"))
    rates["spring"] = max(1e-11, large["spring"])
    rates["dashpot"] = max(1e-11, _cube(Instance, LARGE, damping=0.1)["spring"] - rates["spring"])
    rates["leap-frog"] = max(1e-11, large["leapfrog"] / large["particles"])
    rates["particle"] = max(1e-10, (large["rest"] - small["rest"]) / n)
    rates["step"] = max(1e-7, small["rest"] - small["particles"] * rates["particle"])
    v = 0.5 * SKIN * 0.01 / ((EVERY - 0.5) * large["timestep"])
    moving = _cube(Instance, LARGE, v=v, z=NEAR, ground=UNDER, g=1e-6)  # does not fall on it meanwhile
    rates["rebuild"] = max(1e-9, EVERY * (moving["rest"] - large["rest"]) / large["particles"])
    rates["contact"], rates["wall"] = (max(1e-10, EVERY * moving[k] / large["particles"]) for k in ("contact", "ground"))
    rates["pair"] = _pairs(Instance)
    rates |= _surfaces(Instance)
    rates |= _pool(Instance)
    rates["lone particle"] = max(1e-11, rates["lone particle"] - rates["particle"])
    rates["frame"], rates["byte"] = _frames()
    rates["immersed"] = _immersed()
    return {name: rates[name] for name in RATES}


def _prepare(text: str):
    from ..run.prepare import prepare
    from ..scene.parse import parse_scene

    return prepare(parse_scene(text))


def _least(instance, clocks: dict[str, Callable[[], float]], rounds: int = ROUNDS) -> dict[str, float]:
    """Seconds of a step by clock, and of all of it, in processor time, as ``whole``.

    What a stretch of three times the steps takes longer, each being the least of some rounds: so what comes once with every
    stretch, as energies do with every frame, is not in it.
    """
    start = time.perf_counter()
    instance.run(5)
    steps = max(5, round(5.0 * ROUND / (time.perf_counter() - start)))
    clocks = {"whole": time.process_time, **clocks}
    best = {}
    for length in (steps, 3 * steps) * rounds:
        before = {k: clock() for k, clock in clocks.items()}
        instance.run(length)
        took = {k: clock() - before[k] for k, clock in clocks.items()}
        best[length] = {k: min(took[k], best.get(length, took)[k]) for k in clocks}
    return {k: (best[3 * steps][k] - best[steps][k]) / (2 * steps) for k in clocks}


def _cubes(n: int, **other: float) -> str:
    """A cube and a pebble over it, far above ground and at rest if nothing ``other`` is said."""
    return CUBE.format(n=n, **{"m": 2, "v": 0.0, "z": FAR, "damping": 0.0, "ground": BELOW, "g": 9.81, **other})


def _cube(Instance, n: int, **other: float) -> dict[str, float]:
    """Both of them for some time, at one speed; ``spring`` is the time of one in full lanes."""
    start = time.process_time()
    ready = _prepare(_cubes(n, **other))
    modelled = time.process_time()
    with Instance(ready.plan) as instance:
        instance.setup()
        inserted = time.process_time()
        fixes = {fix: (lambda fix=fix: instance.fix_seconds(fix)) for fix in ("leapfrog", "gravity", "contact", "ground")}
        found = _least(instance, {"springs": instance.bond_seconds, **fixes})
    rest = found["whole"] - sum(found[k] for k in ("springs", *fixes))
    springs = ready.system.spring
    spring = found["springs"] * fullness(springs, lanes(ready.plan.damped)) / len(springs)
    return {
        **found,
        "rest": rest,
        "particles": ready.system.particles,
        "spring": spring,
        "model": modelled - start,
        "insert": inserted - modelled,
        "timestep": ready.certificate.timestep,
    }


def _pairs(Instance) -> float:
    """A cube that lies on another: seconds of a pair of particles in a step, while they have not yet bounced off each other."""
    with Instance(_prepare(_cubes(12, m=12, z=12.0001)).plan) as instance:
        instance.setup()
        pairs, found = instance.fix_value("contact", 1), []
        for _ in range(AGAIN):
            before = instance.fix_seconds("contact")
            instance.run(TOUCH)
            found.append((instance.fix_seconds("contact") - before) / (TOUCH * pairs))
        return max(1e-10, min(found))


def _surfaces(Instance) -> dict[str, float]:
    """Contact at surfaces: a slab over the ground, two that lie on it, and a ball that turns between the ground and another."""
    from ..effects.contact_surface import SECONDS, TOUCHING
    from .meetings import facing

    def clocks(instance, *fixes: str) -> dict[str, Callable[[], float]]:
        return {fix: (lambda fix=fix: instance.fix_value(fix, SECONDS)) for fix in fixes}

    ready = _prepare(SLABS.format(g=1e-6, last=0, gap=1))
    with Instance(ready.plan) as instance:
        instance.setup()
        handed = _least(instance, clocks(instance, "ground"))["ground"] / ready.system.particles
    ready = _prepare(SLABS.format(g=9.81, last=1, gap=0))
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(TOUCH)
        step = _least(instance, clocks(instance, "contact", "ground"))
        touching = {fix: instance.fix_value(fix, TOUCHING) for fix in ("contact", "ground")}
    lying = ready.system.particles / 2
    timestep = ready.certificate.timestep
    ready = _prepare(BALLS.format(v=0.5 * SKIN * 0.01 / (EVERY * timestep)))
    each = EVERY * timestep / ready.certificate.timestep  # steps from one rebuild to the next
    ball = ready.system.particles / 2
    points = len(ready.system.contact_bodies[0].at) * facing(1.0)
    with Instance(ready.plan) as instance:
        instance.setup()
        turning = _least(instance, clocks(instance, "contact", "ground"))
    found = {
        "handed": handed,
        "touching point": (step["contact"] - 2 * lying * handed) / touching["contact"],
        "on plane": (step["ground"] - lying * handed) / touching["ground"],
        "near point": each * (turning["contact"] - 2 * ball * handed) / (2 * points),
        "near plane": each * (turning["ground"] - ball * handed) / points,
    }
    return {name: max(1e-10, seconds) for name, seconds in found.items()}


def _pool(Instance) -> dict[str, float]:
    """A block that sinks in: its rates, those of a particle and of a lattice cell when cells are updated; ``lone particle`` is
    all of the rest of a step."""
    ready = _prepare(POOL)
    particles, found = ready.system.particles, []
    for _ in range(AGAIN):
        with Instance(ready.plan) as instance:
            instance.setup()
            before = [instance.fix_value("liquid", k) for k in (SWEPT, AUTOMATON, OCCUPANCY)]
            instance.run(STEPS)
            swept, automaton, occupancy = (
                instance.fix_value("liquid", k) - b for k, b in zip((SWEPT, AUTOMATON, OCCUPANCY), before)
            )
            fixes = {fix: (lambda fix=fix: instance.fix_seconds(fix)) for fix in ("leapfrog", "gravity", "basin")}
            wet = {k: (lambda k=k: instance.fix_value("liquid", k)) for k in (AUTOMATON, OCCUPANCY, COUPLING)}
            step = _least(instance, {"springs": instance.bond_seconds, **fixes, **wet}, rounds=10)
        swept = max(1.0, swept)
        found.append(
            {
                "lone leap-frog": step["leapfrog"] * (1.0 - SLOWING) / particles,
                "lone particle": (2.0 * step["whole"] - sum(step.values())) / particles,
                "coupling": step[COUPLING] / particles,
                "cell": automaton / swept / ready.plan.grid.cells,
                "solid": occupancy / (swept / SWEEPS_PER_UPDATE) / len(ready.system.hexahedron),
            }
        )
    return {name: max(1e-11, min(each[name] for each in found)) for name in found[0]}


def _frames() -> tuple[float, float]:
    """Seconds of a frame and of a byte of it, from runs of two sizes that write more than they compute."""
    from ..results.trajectory_file import trajectory_bytes

    found = []
    for n in (SMALL, LARGE):
        ready = _prepare(_cubes(n))
        control = ready.scene.control
        size = trajectory_bytes(ready.models, 100, control.save, control.single, None) / 100
        few, many = (min(_run(ready, frames) for _ in range(AGAIN)) for frames in (FEW, MANY))
        found.append(((many - few) / (MANY - FEW), size))
    (small, few), (large, many) = found
    each = max(1e-11, (large - small) / (many - few))
    return max(1e-6, small - each * few), each


def _run(ready, frames: int) -> float:
    """Seconds of a run of so many frames, of one step each."""
    from ..run.loop import simulate

    ready = replace(ready, certificate=replace(ready.certificate, steps_per_frame=1, frames=frames))
    with tempfile.TemporaryDirectory() as folder:
        start = time.process_time()
        simulate(ready, Path(folder))
        return time.process_time() - start


def _immersed() -> float:
    """Seconds of a lattice cell whose immersed share is measured."""
    import numpy as np

    from ..results.expect import immersed_share

    system = _prepare(POOL).system
    corners, height = system.position[system.hexahedron], np.zeros(system.grid.shape[1::-1])
    found = []
    for _ in range(AGAIN):
        start = time.process_time()
        immersed_share(corners, system.grid, height)
        found.append(time.process_time() - start)
    return max(1e-10, min(found) / len(corners))


if __name__ == "__main__":
    print(json.dumps(measure()))
