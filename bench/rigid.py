# SPDX-License-Identifier: GPL-2.0-only
"""Rigid bodies of fix mdanim/rigid, beside those of LAMMPS: ``python bench/rigid.py [TABLE ...]``, all of TABLES without a word.

The tables are those of docs/fix_mdanim_rigid.md, `tops`, `sleep` and `blocks` those of docs/physics-rigid.md.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from timing import print_tables

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "lab"))
import plugin_lab as lab
import rigid_lab
import rigid_tops

ROOT = Path(__file__).resolve().parent.parent
STYLES = ("mdanim/rigid", "rigid molecule", "rigid/nve molecule")
TURN = 600
"""Time steps of a turn."""
SIDE = 21
"""Particles along the side of the body that is timed."""


def instance(body: lab.Body, *commands: str):
    """A LAMMPS instance with a body."""
    with tempfile.TemporaryDirectory() as folder:
        return lab.load(body, Path(folder), [*commands, "run 0"])


def spinning() -> lab.Body:
    """Six particles with moments 1, 2, 3, which turn nearly about the middle axis at 1 rad per unit of time."""
    x = np.repeat(np.diag(np.sqrt([1.0, 0.5, 0.0])), 2, axis=0) * np.tile([[1.0], [-1.0]], (3, 1))
    return lab.particles(x, np.ones(6, int), v=np.cross((1e-3, 1.0, 1e-3), x))


def free() -> tuple[list[str], list[list]]:
    """A free body for 500 turns: the largest error of energy, the one at the end, that of angular momentum."""
    body, rows = spinning(), []

    def angular(x: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.cross(x, body.mass[:, None] * v).sum(0)

    for style in STYLES:
        lmp = instance(body, f"fix r all {style}", f"timestep {2.0 * np.pi / TURN!r}")
        energies, momenta = [], []
        for _ in range(100):
            lmp.command(f"run {5 * TURN} pre no post no")
            x, v = lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v")
            energies.append(lab.kinetic(body, v) / lab.kinetic(body, body.v) - 1.0)
            momenta.append(np.abs(angular(x, v) - angular(body.x, body.v)).max())
        lmp.close()
        rows.append([f"fix {style}", f"{np.abs(energies).max():.1e}", f"{energies[-1]:.1e}", f"{max(momenta):.1e}"])
    return ["", "largest error of energy", "after 500 turns", "of angular momentum"], rows


def cost() -> tuple[list[str], list[list]]:
    """Processor time of a step of one body under gravity, a particle; the least of seven rounds, styles in turns."""
    n = np.arange(SIDE)
    body = lab.particles(np.stack(np.meshgrid(n, n, n), -1).reshape(-1, 3), np.ones(SIDE**3, int))
    running = [instance(body, f"fix r all {s}", "fix g all mdanim/gravity 0 0 -1e-3", "timestep 1e-3") for s in STYLES]
    least = np.full(len(STYLES), np.inf)
    for _ in range(7):
        for k, lmp in enumerate(running):
            start = time.process_time()
            lmp.command("run 100 pre no post no")
            least[k] = min(least[k], (time.process_time() - start) / 100 / len(body.x))
    for lmp in running:
        lmp.close()
    return ["", "ns a particle-step"], [[f"fix {s}", f"{1e9 * t:.1f}"] for s, t in zip(STYLES, least)]


def followed(bodies: list, seconds: float, **setting) -> list:
    """A row: bodies, steps, processor time [s] and per step of a body [us], drift of energy, deepest contact over the thinnest
    part, the worst bound."""
    with tempfile.TemporaryDirectory() as folder, rigid_lab.World(Path(folder), bodies, **setting) as world:
        steps, first, start = round(seconds / world.dt), world.energy(), time.process_time()
        world.run(steps)
        took = time.process_time() - start
        deepest = world.number("deepest") / min(b.thin for b in bodies)
        off = world.energy() / first - 1.0
        numbers = (f"{took:.2f}", f"{1e6 * took / steps / len(bodies):.2f}", f"{off:.1e}", f"{deepest:.3f}")
        return [len(bodies), steps, *numbers, f"{world.number('worst_bound'):.1f}"]


HEAD = ["", "bodies", "steps", "processor s", "us a body-step", "energy off", "deepest", "worst bound"]


def dominoes() -> tuple[list[str], list[list]]:
    """Nine dominoes of 6 x 20 x 40 cm and a ball at 3 m/s, 4 s."""
    bodies = [rigid_lab.box((0.06, 0.2, 0.4), at=(0.2 * n, 0.0, 0.2)) for n in range(9)]
    bodies.append(rigid_lab.ball(0.08, 800.0, at=(-0.35, 0.0, 0.36), v=(3.0, 0.0, 0.0)))
    return HEAD, [["dominoes, 4 s", *followed(bodies, 4.0, frequency=rigid_lab.frequency_of(3.0, 0.06), thin=0.06)]]


def heap_of(count: int) -> tuple[list, list[str], float]:
    """Cubes of 10 cm that fall into a shaft, its planes, and the frequency of contacts."""
    random, side = np.random.default_rng(1), max(2, round((count / 2.5) ** (1 / 3)))
    bodies = []
    for n in range(count):
        i, j, k = n % side, n // side % side, n // side // side
        shift = 0.02 * random.random(2)
        at = (0.16 * (i - (side - 1) / 2) + shift[0], 0.16 * (j - (side - 1) / 2) + shift[1], 0.12 + 0.17 * k)
        bodies.append(rigid_lab.box((0.1, 0.1, 0.1), at=at, q=rigid_lab.about(random.random(3) - 0.5, 3.0 * random.random())))
    wide = 0.08 * side + 0.1
    walls = [f"plane {axis} {end} {sign * wide!r}" for axis in "xy" for end, sign in (("lo", -1), ("hi", 1))]
    speed = np.sqrt(2 * 9.81 * 0.17 * (count // side // side))
    return bodies, ["plane z lo 0.0", *walls], rigid_lab.frequency_of(speed, 0.1)


def heap() -> tuple[list[str], list[list]]:
    """The first second of a heap of 200."""
    bodies, planes, frequency = heap_of(200)
    return HEAD, [["heap, 1 s", *followed(bodies, 1.0, frequency=frequency, planes=planes)]]


def tops() -> tuple[list[str], list[list]]:
    """Two seconds of tops and coins against their steady motions, at two depths of contact; and a tippe top."""
    rows = []
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for spin in (150.0, 300.0):
            body, rate = rigid_tops.top(np.radians(20.0), spin)
            found = [rigid_tops.turned(folder, body, (0.0, 0.0), 2.0, 0.02 / depth)[0] for depth in DEPTHS]
            rows.append([f"cone on its tip, leans by 20°, spins at {spin:.0f} rad/s", rate, *found])
        for lean, rate in ((30.0, 6.0), (30.0, 10.0), (60.0, 6.0), (60.0, 10.0)):
            body, middle = rigid_tops.coin(np.radians(lean), rate)
            found = [rigid_tops.turned(folder, body, (middle, 0.0), 2.0, 0.02 / depth)[0] for depth in DEPTHS]
            rows.append([f"coin on its rim, leans by {lean:.0f}°, circle of {100 * abs(middle):.1f} cm", rate, *found])
        leans, changed = rigid_tops.tippe_leans(folder, [0.0, 0.5, 1.0, 1.5, 2.0, 2.5])
    head = ["goes around at [rad/s]", "closed form", *(f"blows {100 * depth:g} % deep" for depth in DEPTHS)]
    told = [[name, *(f"{number:.4f}" for number in numbers)] for name, *numbers in rows]
    lean = f"tippe top, 250 rad/s: leans by {', '.join(f'{a:.0f}' for a in leans)}° at 0, 0.5 … 2.5 s"
    return head, [*told, [f"{lean}; Jellett's integral changes by {changed:.0e}", "", "", ""]]


DEPTHS = (0.02, 0.002)
"""Depths of a blow at 1 m/s, over the thinnest part: that of scenes, and a tenth."""
SLEEP = "sleep 1e-4 1e-2 0.1"
"""Rule of scenes with parts of 10 cm: 1e-4 sqrt(g s), 1e-3 g, sqrt(s/g)."""


def sleep(seconds: int = 5) -> tuple[list[str], list[list]]:
    """A heap of 200 cubes that comes to rest, second by second without and with sleep, in turns."""
    rows = []
    bodies, planes, frequency = heap_of(200)
    with tempfile.TemporaryDirectory() as a, tempfile.TemporaryDirectory() as b:
        kept = {"frequency": frequency, "thin": 0.1, "planes": planes}
        with rigid_lab.World(Path(a), bodies, **kept) as awake, rigid_lab.World(Path(b), bodies, words=SLEEP, **kept) as sleeping:
            for second in range(1, seconds + 1):
                took = []
                for world in (awake, sleeping):
                    start = time.process_time()
                    world.run(round(1.0 / world.dt))
                    took.append(f"{time.process_time() - start:.2f}")
                rows.append([f"up to {second} s", *took, f"{sleeping.number('asleep'):.0f}", f"{sleeping.number('stilled'):.0e}"])
    return ["heap of 200 cubes", "without [s]", "with sleep [s]", "asleep then", "stilled [J]"], rows


def poured(layers: int, until: float, words: str) -> tuple[float, list[int]]:
    """Processor seconds of scenes/blocks.txt with so many layers, without modelling and output, and how many sleep after each
    tenth of its time."""
    text = (ROOT / "scenes" / "blocks.txt").read_text()
    for old, new in (("layers = 10", f"layers = {layers}"), ("2.5 s", f"{until} s"), ("friction 0.5", f"friction 0.5 {words}")):
        assert old in text
        text = text.replace(old, new)
    ready = prepare(parse_scene(text))
    took, asleep = 0.0, []
    with Instance(ready.plan) as run:
        run.setup()
        for _ in range(10):
            start = time.process_time()
            run.run(ready.certificate.steps // 10)
            took += time.process_time() - start
            asleep.append(int(run.fix_value("rigid", "asleep")) if words else 0)
    return took, asleep


def blocks() -> tuple[list[str], list[list]]:
    """Blocks that are poured out, until they lie."""
    rows = []
    for layers, until in ((3, 2.2), (10, 2.5)):
        (awake, _), (sleeps, asleep) = (poured(layers, until, words) for words in ("", "sleep on"))
        rows.append([f"{100 * layers}, {until} s", f"{awake:.1f}", f"{sleeps:.1f}", " ".join(map(str, asleep))])
    return ["blocks", "without [s]", "with sleep [s]", "asleep after each tenth"], rows


TABLES = {"tops": tops, "sleep": sleep, "blocks": blocks, "free": free, "cost": cost, "dominoes": dominoes, "heap": heap}

if __name__ == "__main__":
    print_tables(TABLES, sys.argv[1:])
