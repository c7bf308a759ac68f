# SPDX-License-Identifier: GPL-2.0-only
"""Cost of effects: ``python bench/effects.py added|shares [rounds]``, ``... forecast [scene ...]`` prints a table in Markdown
(docs/cost.md).

``added``: one scene with its effects added one by one. ``shares``: parts of clocks that several effects share, as they are to be
set in effects/*.py and, of a pass, in plugin/passes/pass_run.cpp. ``forecast``: expected and measured cost of every scene of
scenes/ (runs them all), or of those named.
 Variants take turns, so that all of them see the same machine; figures are medians of processor time, or
of the styles' own clocks; for ``shares`` minima of short rounds, because those clocks run on while others have the processor.
What effects cost that are on and have nothing to do: bench/sleeping.py.
"""

import statistics
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import one_thread  # noqa: F401

SCENES = Path(__file__).parent.parent / "scenes"
ROUNDS = 15
ROUND = 0.05
"""About the length of a round [s]."""
SHORT = 10
"""Rounds for one of the others, where minima are wanted."""

POND = """
gravity (0, 0, -9.81)
walls from (-60, -60, 0) cm to (60, 60, 200) cm
ground z 0
repeat i in 0 .. 3 {{
  object block[i] {{
    shape box (10, 10, 10) cm
    position ((i - 1.5)*11.5, 0, 22) cm
    density 500
    elasticity 1 MPa
    damping 0.05
    drag 0.1
  }}
}}
object plank {{
  shape box (46, 10, 4) cm
  position (0, 0, 29.2) cm
  density 600
  elasticity 1 MPa
}}
liquid water {{
  basin from (-40, -20, 0) cm to (40, 20, 60) cm
  density 1000
  level 20 cm
  model surface
}}
control {{
  time 100 s
  resolution 1 cm
  {timestep}
}}
effects {{ {off} }}
"""
ORDER = ("springs", "gravity", "damping", "air-drag", "walls", "ground", "contact", "basin", "liquid", "buoyancy", "liquid-drag")

FLIGHT = """
gravity (0, 0, -9.81)
{more}
object cube {{
  shape box (18, 18, 18) cm
  position (0, 0, 50) m
  density 1000
  elasticity 1 MPa
  velocity (0, 0, -{v})
}}
control {{
  time 100 s
  frames 1 fps
  resolution 1 cm
  timestep 0.05 ms
}}
effects {{ {off} }}
"""
SEA = "liquid water {{ basin from (-50, -50, 0) cm to (50, 50, 60) cm density 1000 level 30 cm drag {drag} model surface }}"


class Runner:
    """A live scene that runs in rounds."""

    def __init__(self, text: str, length: float = ROUND, change=lambda plan: plan):
        from mdanim_lammps.engine.instance import Instance
        from mdanim_lammps.run.prepare import prepare
        from mdanim_lammps.scene.parse import parse_scene

        self.ready = prepare(parse_scene(text))
        self.instance = Instance(change(self.ready.plan))
        self.instance.setup()
        self.particles = self.ready.system.particles
        self.instance.run(20)
        start = time.process_time()
        self.instance.run(20)
        self.steps = max(20, round(20 * length / (time.process_time() - start)))

    def clocks(self) -> dict[str, float]:
        """Seconds so far of every effect, and of the clocks that several effects share."""
        from mdanim_lammps.features.liquid.frames import COUPLING

        found = {e.name: sum(e.clocks(self.instance).values()) for e in self.ready.plan.effects}
        coupling = {"coupling": self.instance.fix_value("liquid", COUPLING)} if self.ready.plan.grid else {}
        leapfrog, bonds = self.instance.fix_seconds("leapfrog"), self.instance.bond_seconds()
        return found | coupling | {"leapfrog": leapfrog, "bonds": bonds, "pass": leapfrog + bonds + found.get("gravity", 0.0)}

    def round(self) -> dict[str, float]:
        """Seconds of a step: of processor time as ``step``, and by clock."""
        before, start = self.clocks(), time.process_time()
        self.instance.run(self.steps)
        step = (time.process_time() - start) / self.steps
        return {"step": step} | {k: (s - before[k]) / self.steps for k, s in self.clocks().items()}


def measure(texts: dict[str, str], rounds: int, of=statistics.median, **changes) -> dict[str, dict[str, float]]:
    """Seconds of a step, by variant and clock, the median ``of`` all rounds; variants take turns. ``changes`` are those of the
    plans of some of them."""
    short = SHORT if of is min else 1
    runners = {name: Runner(text, ROUND / short, changes.get(name, lambda plan: plan)) for name, text in texts.items()}
    found = {name: [] for name in texts}
    for _ in range(rounds * short):
        for name, runner in runners.items():
            found[name].append(runner.round())
    for runner in runners.values():
        runner.instance.close()
    return {
        name: {k: of(r[k] for r in rows) for k in rows[0]} | {"particles": runners[name].particles}
        for name, rows in found.items()
    }


def added(rounds: int) -> None:
    """One scene, effects added one by one, at the time step that all of them together need."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    ready = prepare(parse_scene(POND.format(timestep="", off="")))
    timestep = f"timestep {ready.certificate.timestep!r} s"
    texts = {
        name: POND.format(timestep=timestep, off=" ".join(f"{o} off" for o in ORDER[k + 1 :])) for k, name in enumerate(ORDER)
    }
    found = measure(texts, rounds)
    print(
        f"{ready.system.particles} particles, {len(ready.system.spring)} springs, {ready.plan.grid.cells} cells of liquid; "
        f"{1 / ready.certificate.timestep:.0f} steps per second of the scene\n"
    )
    print("| effect | us per step | adds | adds per second of the scene |\n|---|---|---|---|")
    last = 0.0
    for name in ORDER:
        step = 1e6 * found[name]["step"]
        print(
            f"| {'' if name == ORDER[0] else '+ '}{name} | {step:.1f} | {step - last:+.1f} us, "
            f"{100 * (step - last) / step:+.1f} % | "
            f"{1e-6 * (step - last) / ready.certificate.timestep:+.2f} s |"
        )
        last = step


DIRECTIONS, AXES = 13, 3
"""Springs of a particle to partners after it: all, and those along the edges of cells."""


def along_axes(plan):
    """A plan without diagonals: the step takes so much less as their springs take, which tells what one without springs takes."""
    way = plan.system.position[plan.bonds[:, 1]] - plan.system.position[plan.bonds[:, 0]]
    kept = (abs(way) > 0.5 * plan.spacing).sum(axis=1) == 1
    return replace(plan, bonds=plan.bonds[kept], bond_kind=plan.bond_kind[kept])


def shares(rounds: int) -> None:
    """Parts of shared clocks, to be set in effects/*.py and pass_run.cpp."""
    plain = FLIGHT.format(more="", v=3, off="").replace("-9.81", "-1e-6")  # as many rebuilds with gravity as without
    found = measure(
        {
            "plain": plain,
            "no gravity": plain.replace("gravity (0, 0, -1e-6)", ""),
            "damped": plain.replace("elasticity 1 MPa", "elasticity 1 MPa\n  damping 0.1"),
            "drag": plain.replace("elasticity 1 MPa", "elasticity 1 MPa\n  drag 1"),
            "along_axes": plain,
        },
        rounds,
        min,
        along_axes=along_axes,
    )
    of = {name: values["pass"] for name, values in found.items()}
    without = of["along_axes"] - AXES / (DIRECTIONS - AXES) * (of["plain"] - of["along_axes"])
    print(f"OF_LEAPFROG {(without - of['plain'] + of['no gravity']) / of['plain']:.2f}   of a pass")
    print(f"OF_DRAG     {1 - of['plain'] / of['drag']:.2f}   of a pass")
    print(f"OF_GRAVITY  {1 - of['no gravity'] / of['plain']:.2f}   of a pass")
    bare = {k: found[k]["leapfrog"] for k in found}
    print(f"DASHPOTS  {1 - found['plain']['bonds'] / found['damped']['bonds']:.2f}   of the springs' clock")
    print(f"SLOWING   {1 - bare['plain'] / bare['drag']:.2f}   of the leap-frog's clock")
    wet = {
        f"drag {d}": FLIGHT.format(more=SEA.format(drag=d), v=0, off="")
        .replace("50) m", "0.3) m")
        .replace("density 1000\n  elas", "density 500\n  elas")
        for d in (0, 4)
    }
    coupling = {k: f["coupling"] for k, f in measure(wet, rounds, min).items()}
    print(f"DRAGGING  {1 - coupling['drag 0'] / coupling['drag 4']:.2f}   of the coupling's clock")


def forecasts(*names: str) -> None:
    """Expected and measured cost of all scenes, both in processor time, which others on the machine do not stretch."""
    from mdanim_lammps.cost.forecast import whole
    from mdanim_lammps.engine.plugin import open_lammps
    from mdanim_lammps.run.loop import simulate
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    open_lammps()[0].close()
    print(
        "| scene | expected | measured | expected / measured | largest parts, expected and measured [s] |\n|---|---|---|---|---|"
    )
    for path in sorted(SCENES.glob("*.txt")):
        if path.stem == "rubber" or (names and path.stem not in names):
            continue  # the first is a fragment that another scene includes
        start = time.process_time()
        ready = prepare(load_scene(path))
        setup = time.process_time() - start
        with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as folder:
            told = whole(ready, Path(first), setup=setup)
            began = time.perf_counter()
            cost = simulate(ready, Path(folder)).cost
            wall = time.perf_counter() - began
        measured = time.process_time() - start
        scale = (measured - setup) / wall  # clocks of effects tell wall time
        largest = sorted(told.parts, key=told.parts.get, reverse=True)[:4]
        parts = ", ".join(
            f"{k} {told.parts[k]:.2f} {(cost.parts[k] * scale + (setup if k == 'setup' else 0.0)):.2f}" for k in largest
        )
        print(f"| {path.stem} | {told.wall:.2f} s | {measured:.2f} s | {told.wall / measured:.2f} | {parts} |", flush=True)


if __name__ == "__main__":
    what = {"added": added, "shares": shares, "forecast": forecasts}
    if len(sys.argv) < 2 or sys.argv[1] not in what:
        sys.exit(__doc__)
    if sys.argv[1] == "forecast":
        forecasts(*sys.argv[2:])
    else:
        what[sys.argv[1]](int(sys.argv[2]) if len(sys.argv) > 2 else ROUNDS)
