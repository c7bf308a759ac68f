# SPDX-License-Identifier: GPL-2.0-only
"""What the two laws of contact do: ``python bench/contact.py [rest|slope|level|roll|corner|pass]``, all without a word.

Every row is a short scene of its own; the tables are those of docs/physics-contact.md.
"""

import math
import sys
from collections.abc import Callable

import numpy as np
from timing import markdown

G = 9.81
STUFF = "density 1000  elasticity 1 MPa"
WAVE = math.sqrt(1.2 * 1e6 / 1000.0)
"""Wave speed of STUFF [m/s]."""
MODELS = ("surface", "paper")
SPEEDS = (0.2, 0.4, 0.6)
"""Of bodies that meet, over the wave speed."""


class World:
    """A scene in LAMMPS, and what becomes of its last object."""

    def __init__(self, text: str, control: str):
        from mdanim_lammps.engine.instance import Instance
        from mdanim_lammps.run.prepare import prepare
        from mdanim_lammps.scene.parse import parse_scene

        self.ready = prepare(parse_scene(f"{text}\ncontrol {{ time 100 s  {control} }}\n"))
        self.instance = Instance(self.ready.plan)
        self.instance.setup()
        system = self.ready.system
        self.mine = slice(system.first[-2], system.first[-1])
        self.mass = system.mass[self.mine]
        self.effects = self.ready.plan.effects
        self.start = self.energy()

    def run(self, time: float) -> None:
        """Go on for so long [s]."""
        self.instance.run(max(1, round(time / self.ready.plan.certificate.timestep)))

    @property
    def place(self) -> np.ndarray:
        """Of the centre of the last object [m], shape (3,)."""
        return self.mass @ self.instance.array("x")[self.mine] / self.mass.sum()

    @property
    def velocity(self) -> np.ndarray:
        """Of the same [m/s], shape (3,)."""
        return self.mass @ self.instance.array("v")[self.mine] / self.mass.sum()

    def spin(self) -> np.ndarray:
        """Its angular velocity [1/s], shape (3,)."""
        arm = self.instance.array("x")[self.mine] - self.place
        turning = (self.mass[:, None] * np.cross(arm, self.instance.array("v")[self.mine])).sum(0)
        return np.linalg.solve(inertia(self.mass, arm), turning)

    def energy(self) -> float:
        """All that the ledger counts, without gravity [J]."""
        scene, system = self.ready.scene, self.ready.system
        v = self.instance.array("v")
        kinetic = 0.5 * float((system.mass * (v**2).sum(1)).sum())
        kept = sum(e.energy(self.instance, scene, system) for e in self.effects if e.ledger and e.name != "gravity")
        return kinetic + kept + sum(sum(e.lost(self.instance, scene, system).values()) for e in self.effects if e.losses(scene))

    def close(self) -> None:
        """End LAMMPS."""
        self.instance.close()


def inertia(mass: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Tensor of inertia [kg m^2], shape (3, 3)."""
    square = (arm**2).sum(1)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]
    return (mass[:, None, None] * square).sum(0)


def tilted(tangent: float) -> str:
    """Gravity of a slope that goes down along +x."""
    c = 1.0 / math.hypot(1.0, tangent)
    return f"gravity ({G * tangent * c!r}, 0, {-G * c!r})\nground z 0"


def block(z: float = 10.0, cells: int = 4, more: str = "") -> tuple[str, str]:
    """A cube of 20 cm, and the words of control for its cells."""
    return (
        f"object c {{ shape box (20, 20, 20) cm  position (0.3, 0.2, {z}) cm  {STUFF}  {more} }}",
        f"resolution {20 / cells} cm",
    )


# --- what is measured: rows of a table ------------------------------------------------------------------------------


def rest() -> tuple[list[str], list[list]]:
    """A body that is put on a held slab, with drag: how far its lowest point of all then is from the slab's surface."""
    rows = []
    for name, shape, height in (
        ("cube", "box (20, 20, 20) cm", 10.0),
        ("ball", "sphere 10 cm", 10.0),
        ("cylinder", "cylinder 8 cm 12 cm", 6.0),
        ("cone", "cone 10 cm 16 cm", 4.0),
        ("torus", "torus 10 cm 4 cm", 4.0),
    ):
        row = [name]
        for model in MODELS:
            gap = 0.0 if model == "surface" else 1.5
            world = World(
                f"gravity (0, 0, {-G})\nobject slab {{ shape box (60, 60, 10) cm  position (0, 0, -5) cm  {STUFF}  hold all }}\n"
                f"object c {{ shape {shape}  position (0.3, 0.4, {height + gap}) cm  {STUFF}  drag 20 N*s/m }}",
                f"resolution 2.5 cm  contact-model {model}",
            )
            world.run(3.0)
            surface = world.ready.models[-1].surface.vertices(world.instance.array("x")[world.mine])
            row.append(f"{surface[:, 2].min() / 0.025:.3f}")
            world.close()
        rows.append(row)
    return ["on a slab", "surface: lowest point [h]", "paper"], rows


def slope() -> tuple[list[str], list[list]]:
    """A cube on a slope with mu 0.5: what it moves after it has settled; how fast it slides."""
    rows = []
    for tangent in (0.40, 0.48, 0.60, 0.80):
        text, control = block()
        world = World(f"{tilted(tangent)}\n{text}", f"{control}  friction 0.5")
        world.run(1.0)
        place, speed = world.place[0], world.velocity[0]
        world.run(1.0)
        c = 1.0 / math.hypot(1.0, tangent)
        want = G * c * (tangent - 0.5)
        moved = (world.place[0] - place) / 0.2
        gained = (world.velocity[0] - speed) / want
        rows.append([tangent, f"{moved:.1e}" if tangent < 0.5 else "slides", f"{gained:.4f}" if tangent > 0.5 else "-"])
        world.close()
    return ["tangent of the slope", "moves in the second second [side]", "acceleration over g (sin - mu cos)"], rows


def level() -> tuple[list[str], list[list]]:
    """A cube that slides on the level with mu 0.3 and stops."""
    rows = []
    for speed in (0.5, 1.0, 2.0):
        text, control = block(more=f"velocity ({speed}, 0, 0)")
        world = World(f"gravity (0, 0, {-G})\nground z 0\n{text}", f"{control}  friction 0.3")
        place = world.place[0]
        world.run(2.0 * speed / (0.3 * G))
        rows.append([speed, f"{(world.place[0] - place) / (speed**2 / (2 * 0.3 * G)):.4f}"])
        world.close()
    return ["speed [m/s]", "stopping way over v^2/(2 mu g)"], rows


def roll() -> tuple[list[str], list[list]]:
    """A ball rolls down a slope with a tangent of 0.2, mu 0.5; I is that of its lattice."""
    rows = []
    for cells in (6, 8, 12):
        world = World(
            f"{tilted(0.2)}\nobject c {{ shape sphere 10 cm  position (0.1, 0.07, 10) cm  density 1000  elasticity 4 MPa }}",
            f"resolution {20 / cells} cm  friction 0.5",
        )
        arm = world.instance.array("x")[world.mine] - world.place
        share = inertia(world.mass, arm)[1, 1] / (world.mass.sum() * 0.01)
        want = G * 0.2 / math.hypot(1.0, 0.2) / (1.0 + share)
        place = world.place.copy()
        world.run(0.8)
        way = world.place - place
        rows.append([cells, f"{share:.3f}", f"{way[0] / (0.5 * want * 0.64):.4f}", f"{abs(way[1] / way[0]):.1e}"])
        world.close()
    return ["cells across", "I/(M R^2)", "way over that of g sin/(1 + I/(M R^2))", "aside over way"], rows


def corner() -> tuple[list[str], list[list]]:
    """A cube falls on its edge or corner at 0.03 c on a free slab, equally soft: speed up over that down, energy."""
    rows = []
    for cells in (2, 3, 4, 6):
        h = 100 / cells
        row: list = [cells]
        for model in MODELS:
            world = World(
                f"object slab {{ shape box (200, 200, 100) cm  position (0, 0, -50) cm  {STUFF} }}\n"
                f"object c {{ shape box (100, 100, 100) cm  position (13, 7, {83.7 + 0.7 * h}) cm  orientation axis (1, 1, 0) "
                f"angle 40 deg  {STUFF}  velocity (0, 0, {-0.03 * WAVE}) }}",
                f"resolution {h} cm  contact-model {model}",
            )
            falling = 0.5 * world.mass.sum() * (0.03 * WAVE) ** 2
            world.run(20.0 / WAVE)
            v = world.velocity / (0.03 * WAVE)
            w = np.linalg.norm(world.spin()) / (0.03 * WAVE)
            off = abs(world.energy() - world.start) / falling
            row += [f"{v[2]:.3f}", f"{math.hypot(v[0], v[1]):.3f}", f"{w:.3f}", f"{off:.0e}"]
            world.close()
        rows.append(row)
    return ["cells"] + [f"{m}: {what}" for m in MODELS for what in ("up", "aside", "spin L/v", "energy")], rows


def passing() -> tuple[list[str], list[list]]:
    """Bodies of four cells, or plates, that meet head on: whether they part, and the energy that is missing."""
    cases: dict[str, tuple[str, str]] = {
        "plate of one cell": (
            "box (120, 60, 10) cm  position (0, 0, -5) cm  hold faces x",
            "box (50, 50, 50) cm  position (0, 0, 33) cm",
        ),
        "plate of two": (
            "box (120, 60, 20) cm  position (0, 0, -10) cm  hold faces x",
            "box (50, 50, 50) cm  position (0, 0, 33) cm",
        ),
        "cubes, turned": (
            "box (40, 40, 40) cm  position (0, 0, -20) cm",
            "box (40, 40, 40) cm  position (3, 2, 28) cm  orientation axis (0, 0, 1) angle 30 deg",
        ),
        "corner on corner": (
            "box (40, 40, 40) cm  position (0, 0, -34.641) cm  orientation axis (1, -1, 0) angle 54.7356 deg",
            "box (40, 40, 40) cm  position (3, 0, 42.641) cm  orientation axis (1, -1, 0) angle 54.7356 deg",
        ),
        "balls": ("sphere 20 cm  position (0, 0, -20) cm", "sphere 20 cm  position (3, 2, 28) cm"),
        "ball on a corner": (
            "sphere 20 cm  position (0, 0, -20) cm",
            "box (40, 40, 40) cm  position (3, 0, 42.641) cm  orientation axis (1, -1, 0) angle 54.7356 deg",
        ),
    }
    rows = []
    for name, (lower, upper) in cases.items():
        rows.append([name, *(met(lower, upper, v * WAVE, model) for v in SPEEDS for model in MODELS)])
    return ["what meets"] + [f"{v} c, {m}" for v in SPEEDS for m in MODELS], rows


def met(lower: str, upper: str, speed: float, model: str) -> str:
    """The upper body meets the lower one: the energy that is off in the end, or what became of them."""
    from mdanim_lammps.errors import DivergedError

    world = World(
        f"object a {{ shape {lower}  {STUFF} }}\nobject b {{ shape {upper}  {STUFF}  velocity (0, 0, {-speed}) }}",
        f"resolution 10 cm  contact-model {model}",
    )
    try:
        world.run(1.5 / speed + 0.3)
        lower_one = slice(0, world.mine.start)
        below, sinking = (
            np.average(world.instance.array(name)[lower_one, 2], weights=world.ready.system.mass[lower_one]) for name in "xv"
        )
        parted = world.place[2] > below + 0.1 and world.velocity[2] > sinking
        return f"{abs(world.energy() / world.start - 1.0):.0e}" if parted else "passes"
    except DivergedError:
        return "stops"
    finally:
        world.close()


TABLES: dict[str, Callable[[], tuple[list[str], list[list]]]] = {
    "rest": rest, "slope": slope, "level": level, "roll": roll, "corner": corner, "pass": passing
}  # fmt: skip


def main(words: list[str]) -> None:
    """Print the tables."""
    for word in words or TABLES:
        print(f"\n{TABLES[word].__doc__}\n")
        print(markdown(*TABLES[word]()))


if __name__ == "__main__":
    main(sys.argv[1:])
