# SPDX-License-Identifier: GPL-2.0-only
"""Scenes drawn at random, in a child of bounded memory: each is checked or refused in seconds, none is read as another."""

import json
import math
import random
import re
import resource
import signal
import subprocess
import sys
import time
import traceback

import pytest

SECONDS = 10.0
"""Longest time for one scene."""
MEMORY = 4 * 2**30
"""Address space of the child: LAMMPS and the libraries take some 1.3 GiB of it."""
NUMBERS = [
    "0",
    "1",
    "-1",
    "0.5",
    "1e-300",
    "1e300",
    "1e18",
    "5e-324",
    "1e9",
    "1e-9",
    "2^0.5",
    "rand(0, 1)",
    "a",
    "b",
    "1/0",
    "9^9^9",
]
UNITS = ["", "m", "cm", "mm", "km", "kg", "g", "s", "ms", "Pa", "kPa", "GPa", "m/s", "N/m", "fps", "deg", "rad", "kg/m^3", "m^2"]


def number(draw: random.Random, unit: str, low: float, high: float) -> str:
    """A fair number in most cases, else an odd one."""
    if draw.random() < 0.985:
        return f"{math.exp(draw.uniform(math.log(low), math.log(high))):.4g} {unit}"
    return f"{draw.choice(NUMBERS)} {draw.choice([unit, draw.choice(UNITS)])}"


def vector(draw: random.Random, unit: str, size: float) -> str:
    """Three numbers, seldom two or four."""
    count = 3 if draw.random() < 0.99 else draw.choice([2, 4])
    values = [f"{draw.uniform(-size, size):.4g}" if draw.random() < 0.99 else draw.choice(NUMBERS) for _ in range(count)]
    return f"({', '.join(values)}) {unit}"


def shape(draw: random.Random) -> str:
    """A shape that is not very thin: what thin ones cost is for tests of the model."""

    def size() -> str:
        return number(draw, "m", 0.05, 0.5)

    kind = draw.choice(["box", "sphere", "ellipsoid", "cylinder", "cone", "torus"])
    if kind in ("box", "ellipsoid"):
        return f"{kind} ({size()}, {size()}, {size()})"
    if kind == "torus":
        return f"torus {number(draw, 'm', 0.3, 1)} {number(draw, 'm', 0.05, 0.3)}"
    return f"{kind} {size()}" + (f" {size()}" if kind != "sphere" else "")


def scene(seed: int) -> str:
    """A scene of some blocks, each with settings in and out of range, and a few words that do not belong there."""
    draw = random.Random(seed)
    lines = ["let a = 2", f"let b = {number(draw, 'm', 0.01, 1)}"]
    if draw.random() < 0.9:
        lines.append("gravity (0, 0, -9.81) m/s^2" if draw.random() < 0.9 else f"gravity {vector(draw, 'm/s^2', 10)}")
    if draw.random() < 0.4:
        lines.append(f"ground z -{number(draw, 'm', 1, 5)}")
    if draw.random() < 0.2:
        lines.append(f"walls from (-9, -9, -9) m to {vector(draw, 'm', 30)}")
    for k in range(draw.randint(1, 4)):
        settings = [f"shape {shape(draw)}", f"position ({3 * k}, 0, {number(draw, 'm', 0.5, 3)})"]
        settings.append(draw.choice([f"mass {number(draw, 'kg', 0.1, 50)}", f"density {number(draw, 'kg/m^3', 100, 5000)}"]))
        settings.append(f"elasticity {number(draw, 'Pa', 1e4, 1e8)}")
        optional = [
            f"velocity {vector(draw, 'm/s', 2)}", f"spin {vector(draw, 'rad/s', 9)}", f"damping {number(draw, '', 0.01, 1)}",
            f"drag {number(draw, 'N*s/m', 0.01, 10)}",
            f"hold {draw.choice(['all', 'faces x', 'face -z', 'within box (0,0,0) m to (9,9,9) m'])}",
            f"orientation axis {vector(draw, '', 1)} angle {number(draw, 'deg', 1, 300)}",
            f"color {draw.choice(['red', 'rde', 'navy', 'tan', 'pink'])}",
            draw.choice(["friction 0.5", "damping 0.1", "drag 1 N*s/m"]),
        ]  # fmt: skip
        settings += [s for s in optional if draw.random() < 0.12]
        lines.append(f"object o{k} {{ " + "\n".join(settings) + " }")
    if draw.random() < 0.3:
        amount = draw.choice([f"volume {number(draw, 'm^3', 0.01, 4)}", f"level {number(draw, 'm', 0.1, 1)}"])
        lines.append(
            f"liquid w {{ basin from (-2, -2, 0) m to (2, 2, {number(draw, 'm', 1, 3)})\n density 1 g/cm^3\n {amount} }}"
        )
    control = [f"time {number(draw, 's', 0.5, 20)}"]
    optional = [
        f"frames {number(draw, 'fps', 5, 60)}",
        "accuracy preview",
        f"resolution {number(draw, 'm', 0.03, 0.2)}",
        f"timestep {number(draw, 's', 1e-6, 1e-3)}",
    ]
    control += [s for s in optional if draw.random() < 0.3]
    lines.append("control { " + "\n".join(control) + " }")
    text = "\n".join(lines) + "\n"
    if draw.random() < 0.15:
        pieces = re.findall(r"\s+|\w+|.", text)
        for _ in range(draw.randint(1, 3)):
            at = draw.randrange(len(pieces))
            pieces[at] = draw.choice(
                ["", pieces[at] * 2, draw.choice(pieces), "{", "}", "(", "\0", "é", "repeat i in 1 .. 9 {", "1e999"]
            )
        text = "".join(pieces)
    return text


def check(seed: int) -> str:
    """Result of one scene: ``good``, or ``refused``; anything else is a fault."""
    from mdanim_lammps.errors import MdanimError
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.lock import lock_text
    from mdanim_lammps.scene.parse import parse_scene

    try:
        record = parse_scene(scene(seed))
        again = parse_scene(lock_text(record), record.name, strict=True)
        if again != record or lock_text(again) != lock_text(record):
            return "read back as another scene"
        prepare(record)
    except MdanimError as error:
        return "refused" if str(error).strip() else "refused without a word"
    return "good"


def child(first: int, count: int) -> None:
    """Check scenes one after the other, and print what became of each as a line of JSON."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

    def late(*_) -> None:
        raise TimeoutError(f"more than {SECONDS} s")

    signal.signal(signal.SIGALRM, late)
    for seed in range(first, first + count):
        begin = time.process_time()
        signal.alarm(60)
        try:
            outcome = check(seed)
        except BaseException:
            outcome = traceback.format_exc()
        signal.alarm(0)
        print(json.dumps([seed, outcome, time.process_time() - begin]), flush=True)


def examine(first: int, count: int) -> None:
    """Run a child; all its scenes must be good or refused, quickly, and both must occur."""
    done = subprocess.run([sys.executable, __file__, str(first), str(count)], capture_output=True, text=True, timeout=60 * count)
    rows = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("[")]
    assert len(rows) == count, f"the child died at scene {first + len(rows)}:\n{scene(first + len(rows))}\n{done.stderr[-2000:]}"
    for seed, outcome, seconds in rows:
        assert outcome in ("good", "refused"), f"scene {seed}:\n{scene(seed)}\n{outcome}"
        assert seconds < SECONDS, f"scene {seed} took {seconds:.1f} s:\n{scene(seed)}"
    assert {outcome for _, outcome, _ in rows} == {"good", "refused"}


def test_few_random_scenes():
    """A fixed small set."""
    examine(0, 30)


@pytest.mark.soak
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("first", range(10_000, 12_000, 100))
def test_random_scenes(first):
    """2 000 scenes."""
    examine(first, 100)


def expression(draw: random.Random, depth: int) -> str:
    """An expression that means the same here and in Python, but for ^ and mod."""
    if depth == 0 or draw.random() < 0.2:
        return draw.choice(["1", "2.5", "x", "y", "0.25", "3e2", "pi"])
    left, right = expression(draw, depth - 1), expression(draw, depth - 1)
    form = draw.choice(
        [
            "{} + {}",
            "{} - {}",
            "{}*{}",
            "({})/({})",
            "({})",
            "-{}",
            "sqrt(abs({}))",
            "min({}, {})",
            "({})^2",
            "2^-({})",
            "({}) mod ({})",
            "sin({})",
        ]
    )
    return form.format(left, right)


def test_expressions_mean_what_they_mean_in_python():
    """300 random expressions have the value that Python gives them, to the last bit, or are refused where Python raises."""
    from mdanim_lammps.errors import SceneError
    from mdanim_lammps.scene.parse import parse_scene

    scene = "let x = 1.5\nlet y = -0.75\ncontrol { time 1 s }\n"
    scene += "object a { shape sphere 1 m position (0, 0, 0) mass 1 elasticity 1e6 }\n"
    names = {"x": 1.5, "y": -0.75, "pi": math.pi, "sqrt": math.sqrt, "abs": abs, "min": min, "sin": math.sin}
    values, lines = [], ""
    for seed in range(300):
        text = expression(random.Random(seed), 5)
        try:
            value = eval(text.replace("^", "**").replace("mod", "%"), {"__builtins__": {}}, names)
            finite = isinstance(value, float | int) and math.isfinite(value)
        except (ArithmeticError, ValueError):
            finite = False
        if finite:
            lines += f"let value{seed} = {text}\nexpect a.strain.max = value{seed}\n"
            values.append((text, float(value)))
        else:
            with pytest.raises(SceneError):
                parse_scene(f"{scene}let value = {text}\n")
    found = [expect.value for expect in parse_scene(scene + lines).expects]
    assert len(found) == len(values) > 200
    assert [(text, value, read) for (text, value), read in zip(values, found) if value != read] == []


if __name__ == "__main__":
    child(int(sys.argv[1]), int(sys.argv[2]))
