# SPDX-License-Identifier: GPL-2.0-only
"""Goals of rigid bodies, and what they reach: ``python bench/rigid_goals.py [WORD ...]``, lines that begin with a WORD.

Prints a table. Times are processor seconds of one core. All takes ten minutes,
most of it `heap`, whose other program needs .venv-peers (make .venv-peers/.installed), and `random scenes`.
"""

import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import one_thread  # noqa: F401
from timing import markdown

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "campaigns"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "effects"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "lab"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
import as_rigid
import rigid
import rigid_lab as lab
import rigid_motions
import rigid_tops
from rigid_samples import G, rolled, tilted

ROOT = Path(__file__).resolve().parents[1]


class Reached(NamedTuple):
    """A line of the table."""

    what: str
    goal: str
    found: str
    holds: bool | None
    """None where it is not measured."""


def off(found: float, wanted: float) -> float:
    return abs(found / wanted - 1.0)


# --- cost ---


def dominoes(folder: Path) -> Iterator[Reached]:
    """Four seconds of nine dominoes."""
    (_, ((_, _, steps, seconds, *_),)) = rigid.dominoes()
    yield Reached("dominoes: nine and a ball, 4 s", "≤ 1 s", f"{seconds} s, {steps:,} steps", float(seconds) <= 1.0)


def heap(folder: Path) -> Iterator[Reached]:
    """The first second of a thousand boxes, at a tenth of the overlap of MuJoCo's; ours at steps of 0.42/Omega."""
    sys.path.insert(0, str(ROOT / "bench" / "peers"))
    import all as peers

    rows = {}
    for name in ("ours, 0.25", "mujoco_rigid, CG"):
        rows[name] = peers.contender(name, "heap", {"time": 1.0, "bodies": 1000, "limit": 90.0, "fraction": 0.6})
    what = "heap of 1 000 boxes, 1 s, `contact-stiffness 0.25`, steps of 0.42/Ω"
    goal = "no slower than MuJoCo's CG at a tenth of its overlap"
    if any("failed" in row for row in rows.values()):
        yield Reached(what, goal, str([row.get("failed") for row in rows.values()]), None)
        return
    (ours, its), (deep, its_deep) = zip(*((r["cost"], float(r["note"].split()[-1])) for r in rows.values()))
    found = f"{ours:.1f} s against {its:.1f} s, overlap {deep:.3f} against {its_deep:.2f}"
    yield Reached(what, goal, found, ours <= its and deep <= 0.1 * its_deep)


def pile(folder: Path) -> Iterator[Reached]:
    """scenes/pile.txt, as bench/as_rigid.py changes it, without modelling and output."""
    from mdanim_lammps.engine.instance import Instance
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene
    from timing import seconds

    text = (as_rigid.SCENES / "pile.txt").read_text(encoding="utf-8")
    for was, now in as_rigid.APART["pile"].items():
        text = text.replace(was, now)
    ready = prepare(parse_scene(as_rigid.as_rigid(text)))
    with Instance(ready.plan) as instance:
        instance.setup()
        took = seconds(lambda: instance.run(ready.certificate.steps), time.process_time)
    yield Reached("pile.txt as rigid", "≤ 5 s", f"{took:.1f} s, {ready.certificate.steps:,} steps", took <= 5.0)


# --- motions ---


def rolling(folder: Path) -> Iterator[Reached]:
    """Down a held box with a slope of 0.2."""
    gravity, sine, _ = tilted(0.2)
    lying = lab.about((1, 0, 0), np.pi / 2)
    log = lab.cylinder(0.1, 0.3, at=(0, 0, 0.1), q=lying)
    across = log.mass * (0.1**2 / 2 + 0.3**2 / 12)
    hollow = log.put(moments=np.array([across, across, log.mass * 0.1**2]))
    slope = lab.box((40, 2, 1), at=(0, 0, -0.5), held=True)
    worst = 0.0
    for body, part in ((lab.ball(0.1, at=(0, 0, 0.1)), 5 / 7), (log, 2 / 3), (hollow, 1 / 2)):
        kept = {"frequency": lab.frequency_of(4.0, 0.2), "thin": 0.2, "planes": [], "gravity": gravity}
        with lab.World(folder, [body, slope], **kept) as world:
            worst = max(worst, off(rolled(world)[0], part * G * sine))
    yield Reached(
        "rolling: ball, full and hollow cylinder on a slope, over g sin θ/(1 + I/m r²)", "2e-3", f"{worst:.0e}", worst < 2e-3
    )


def free(folder: Path) -> Iterator[Reached]:
    """A body that spins about its middle axis."""
    _, rows = rigid.free()
    _, largest, _, momentum = rows[0]
    yield Reached("free body: angular momentum, 300 000 steps", "rounding", momentum, float(momentum) < 1e-10)
    yield Reached("free body: energy, 600 steps a turn", "1e-6, no drift", largest, float(largest) < 1e-6)
    found, period = rigid_motions.flips(folder, (0.05, 1.0, 0.05))
    worst = max(off(one, period) for one in found)
    yield Reached("free body: flips of the middle axis over the elliptic period", "1e-3", f"{worst:.0e}", worst < 1e-3)


def top(folder: Path) -> Iterator[Reached]:
    """A cone on its tip, blows of 2 % and of 0.2 % of its height."""
    body, rate = rigid_tops.top(np.radians(20.0), 150.0)
    worst = [off(rigid_tops.turned(folder, body, (0.0, 0.0), 2.0, 0.02 / depth)[0], rate) for depth in rigid.DEPTHS]
    told = f"{worst[0]:.0e} (blows 2 % deep), {worst[1]:.0e} (0.2 %)"
    yield Reached("heavy top: rate at which its axis goes around", "1e-3", told, max(worst) < 1e-3)


def rocking(folder: Path) -> Iterator[Reached]:
    """Housner's block."""
    fall, found, law = rigid_motions.rocking(folder)
    worst = float(np.abs(found / law - 1.0).max())
    yield Reached("rocking block: first fall over Housner's", "1e-2", f"{abs(fall - 1.0):.0e}", abs(fall - 1.0) < 1e-2)
    yield Reached("rocking block: amplitudes to the third", "0.1", f"{worst:.2f}", worst < 0.1)


def restitution(folder: Path) -> Iterator[Reached]:
    """Restitution of the point that meets the floor, and of a log and a column that lean."""
    for lowest, highest, most in ((0.4, 1.0, 0.02), (0.1, 0.3, 0.04)):
        asked = [e for e in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 0.9, 1.0) if lowest <= e <= highest]
        worst = {case: max(abs(rigid_motions.bounced(folder, case, e) - e) for e in asked) for case in rigid_motions.LANDING}
        told = ", ".join(f"{case} {value:.3f}" for case, value in worst.items())
        yield Reached(f"restitution of {lowest:g} to {highest:g}", f"{most:g}", told, max(worst.values()) <= most)
    blows = [(speed, e) for speed in (0.1, 0.01) for e in (0.8, 0.5, 0.2)]
    slow = [(speed, e, rigid_motions.bounced(folder, "ball on floor", e, speed)) for speed, e in blows]
    told = ", ".join(f"{left:.3f} of {e:g} at {speed:g}" for speed, e, left in slow)
    yield Reached("restitution at parts of the fastest speed", "0.02", told, all(abs(left - e) <= 0.02 for _, e, left in slow))
    leans = (0.0, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0)
    for case in rigid_motions.LONG:
        found = [
            (rigid_motions.leaning(folder, case, 0.5, lean)[0], rigid_motions.blow_by_blow(case, 0.5, lean)[0]) for lean in leans
        ]
        told = ", ".join(f"{left:.2f} ({least:.2f}) at {lean:g}°" for lean, (left, least) in zip(leans, found))
        off = max(max(left - max(0.5, least), min(0.5, least) - left) for left, least in found)
        what = f"restitution 0.5 of a {case} that leans: its centre between 0.5 and Newton's law blow by blow (in brackets)"
        yield Reached(what, "0.06", told, off <= 0.06)
    backs = [rigid_motions.falls_back(folder, 0.5, stiffness) for stiffness in (1.0, 16.0, 256.0)]
    told = ", ".join(f"{left:.2f}" for left in backs)
    what = "restitution 0.5 of the other edge of a column that falls back, blow at 0.06 m/s, `contact-stiffness` 1, 16, 256"
    yield Reached(what, "0.06 where contacts are hard", told, abs(backs[-1] - 0.5) <= 0.06)


def standing(folder: Path) -> Iterator[Reached]:
    """Stacks, arch and cards of the tests."""
    import test_rigid_structures as structures
    from mdanim_lammps.scene.parse import parse_scene

    first, last = structures.centres(parse_scene(structures.STACK.format(seconds=60), "stack"), 3.0, 60.0)
    moved = float(np.abs(last - first).max()) / 0.1
    yield Reached("ten boxes stand for 60 s: moved, over a side", "1e-3", f"{moved:.0e}", moved < 1e-3)
    for name, holds in (
        ("an arch", structures.test_an_arch_stands),
        ("a house of cards", structures.test_a_house_of_cards_stands),
    ):
        yield Reached(f"{name} stands for 10 s", "stands", *_passes(holds))


def _passes(test: Callable[[], None]) -> tuple[str, bool]:
    try:
        test()
    except AssertionError as error:
        return f"falls: {error}", False
    return "stands", True


def drafts(folder: Path) -> Iterator[Reached]:
    """scenes/float.txt, elastic and rigid."""
    *_, apart, _ = as_rigid.compared("float")
    yield Reached(
        "draft of a rigid float over that of the elastic one: farthest apart", "1 cm", f"{apart} cm", float(apart) < 1.0
    )


# --- books ---


def books(folder: Path) -> Iterator[Reached]:
    """Scenes of the gallery as rigid ones."""
    from mdanim_lammps import Scene

    worst = {}
    for name in ("dominoes", "henge", "billiard", "cradle", "tower", "cards", "quake", "splash"):
        path = folder / f"{name}.txt"
        path.write_text(as_rigid.as_rigid((as_rigid.SCENES / path.name).read_text(encoding="utf-8")), encoding="utf-8")
        worst[name] = float(np.abs(Scene.load(path).run(folder / name, movie=False).ledger.array("residual")).max())
    told = ", ".join(f"{name} {value:.0e}" for name, value in worst.items())
    yield Reached("residual of energy", "1e-3", told, max(worst.values()) <= 1e-3)


def random_scenes(folder: Path, seeds: range = range(300)) -> Iterator[Reached]:
    """The campaign of random scenes: none diverges, momentum to rounding where nothing takes it, residual below 1e-2 in each."""
    import test_rigid as campaign

    kinds = campaign.campaign(seeds, folder)
    told = ", ".join(f"{kind} {count}" for kind, count in sorted(kinds.items()))
    yield Reached(f"random scenes {seeds[0]} to {seeds[-1]}", "none diverges", told, not kinds["warned"])


def bits(folder: Path) -> Iterator[Reached]:
    """Ranks, threads, resumed runs, lists, order of objects."""
    files = ("tests/plugin/rigid/test_contact_identity.py", "tests/plugin/rigid/test_sleep.py")
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-n", "0", *files], capture_output=True, text=True, cwd=ROOT)
    (told,) = re.findall(r"\d+ (?:passed|failed).*(?= in )", done.stdout) or [done.stdout[-200:]]
    yield Reached("bits: ranks, resumed runs, lists, order of objects", "the same", f"tests: {told}", done.returncode == 0)


LINES = (dominoes, heap, pile, rolling, free, top, rocking, restitution, standing, drafts, books, random_scenes, bits)


def main(words: list[str]) -> int:
    """Prints lines as they are found."""
    names = {one.__name__.replace("_", " "): one for one in LINES}
    if unknown := [word for word in words if not any(name.startswith(word) for name in names)]:
        sys.exit(f"unknown: {', '.join(unknown)}; lines are {', '.join(names)}")
    head, missed = ("what", "goal", "found", "holds"), 0
    print(markdown(head, ()), flush=True)
    for name, line in names.items():
        if words and not any(name.startswith(word) for word in words):
            continue
        with tempfile.TemporaryDirectory() as place:
            for found in line(Path(place)):
                missed += found.holds is False
                holds = {True: "yes", False: "**no**", None: "not measured"}[found.holds]
                print(markdown(head, [found._replace(holds=holds)]).splitlines()[-1], flush=True)
    return min(missed, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
