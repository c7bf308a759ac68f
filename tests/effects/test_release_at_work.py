# SPDX-License-Identifier: GPL-2.0-only
"""Release of what is held or driven: it falls and flies from then on, keeps its motion, and the ledger closes."""

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.parse import parse_scene

G = 9.81
GRAVITY = "gravity (0, 0, -9.81) m/s^2\n"
CUBE = "object cube { shape box (10, 10, 10) cm position (0, 0, 1) m density 700 hold all elasticity "
KINDS = {
    "soft": CUBE + "60 kPa",
    "hard": CUBE + "20 MPa",
    "rigid": CUBE + "rigid",
    "rope": "object cube { shape rope from (0, 0, 1) m to (0.5, 0, 1) m thickness 1 cm density 900 elasticity 1 MPa hold all",
}


def rows_of(ready, pieces: int = 10) -> tuple[list[dict], np.ndarray, np.ndarray]:
    """Rows of the ledger, and places and velocities of the centre of the first object, each of so many parts of the run."""
    rows, places, velocities = [], [], []
    with Instance(ready.plan) as instance:
        instance.setup()
        for n in range(pieces + 1):
            if n:
                instance.run(ready.certificate.steps // pieces)
            centre = instance.system.center_of_mass(instance.array("x"))
            rows.append(energies(instance, centre))
            places.append(centre[0].copy())
            velocities.append(instance.system.center_of_mass(instance.array("v"))[0].copy())
    return rows, np.array(places), np.array(velocities)


def off(rows: list[dict]) -> float:
    """Largest change of all energies less the work, over the largest energy that came or went."""
    total = np.array([sum(v for k, v in row.items() if k != "work") - row["work"] for row in rows])
    return float(np.abs(total - total[0]).max() / max(abs(row[k] - rows[0][k]) for row in rows for k in row))


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_let_go_falls(prepared, kind):
    """It stands until then, and falls by g t^2/2 to a step; the ledger closes, and its drive does no work."""
    ready = prepared(GRAVITY + KINDS[kind] + "  release 0.1 s }\ncontrol { time 0.3 s }\n")
    rows, places, velocities = rows_of(ready, 3)
    dt = ready.certificate.timestep
    end = ready.certificate.steps // 3 * 3 * dt
    assert np.array_equal(places[0], places[1]) or np.abs(places[1] - places[0]).max() < 0.5 * G * dt * dt
    assert places[0][2] - places[3][2] == pytest.approx(0.5 * G * (end - 0.1) ** 2, abs=0.6 * G * 0.2 * dt)
    assert velocities[3] == pytest.approx([0.0, 0.0, -G * (end - 0.1)], abs=G * dt)
    # the energy of a rigid body is that of the velocities half a step before and after, which is m (g dt/2)^2/2 less
    assert off(rows) < 1e-3 and abs(rows[-1]["work"]) < 0.13 * ready.system.mass.sum() * (G * dt) ** 2


@pytest.mark.parametrize("kind", ["soft", "hard", "rigid"])
def test_what_is_driven_flies_on(prepared, kind):
    """With the velocity and the spin that its drive gave it; the work is the energy that it has brought."""
    text = KINDS[kind] + "  release 0.1 s drive velocity (1, 0, 2) m/s drive turn (0, 0, 6) rad/s }\ncontrol { time 0.25 s }\n"
    ready = prepared(GRAVITY + text)
    rows, places, velocities = rows_of(ready, 5)
    dt = ready.certificate.timestep
    after = ready.certificate.steps // 5 * 5 * dt - 0.1
    assert velocities[5] == pytest.approx([1.0, 0.0, 2.0 - G * after], abs=G * dt)
    assert places[5] == pytest.approx([0.1 + after, 0.0, 1.2 + 2.0 * after - 0.5 * G * after**2], abs=3.0 * dt)
    assert off(rows) < 1e-3
    energy = 0.5 * 0.7 * (1.0 + 4.0) + 0.5 * 0.7 * 0.01 / 6.0 * 36.0 + 0.7 * G * 0.2
    assert rows[-1]["work"] == pytest.approx(energy, rel=2e-3)  # a soft cube bulges by its spin


def test_a_path_by_keys_throws(prepared):
    """A rigid stone that a key has at its fastest at the release goes on with that speed; the drive's later keys do nothing."""
    text = (
        GRAVITY + CUBE + "rigid key 0.2 s at (0.4, 0, 1.2) m key 0.4 s at (0, 0, 1) m release 0.1 s }\ncontrol { time 0.2 s }\n"
    )
    ready = prepared(text)
    rows, places, velocities = rows_of(ready, 2)
    # half way: x' = 0.4/0.2 * 3/2, as slopes at both ends of a cubic curve are 0
    dt = ready.certificate.timestep
    after = ready.certificate.steps // 2 * 2 * dt - 0.1
    # the mean over two steps is off by dt^2/6 times the third derivative, 12*0.4/0.2^3
    assert velocities[2] == pytest.approx([3.0, 0.0, 1.5 - G * after], abs=dt**2 / 6.0 * 12.0 * 0.4 / 0.2**3 * 1.01)
    assert places[2] == pytest.approx([0.2 + 3.0 * after, 0.0, 1.1 + 1.5 * after - 0.5 * G * after**2], abs=5e-3)
    assert off(rows) < 1e-3


def test_a_bar_that_is_held_by_a_face_falls_with_its_swing(prepared):
    """The centre has the momentum of the free part; behind the release gravity alone changes it."""
    bar = (
        "object bar { shape box (40, 8, 8) cm position (0, 0, 1) m density 700 elasticity 300 kPa hold face -x release 0.1 s }\n"
    )
    ready = prepared(GRAVITY + bar + "control { time 0.2 s resolution 4 cm }\n")
    rows, _, velocities = rows_of(ready, 20)
    dt = ready.certificate.timestep * (ready.certificate.steps // 20)
    gained = np.diff(velocities[11:], axis=0)
    np.testing.assert_allclose(gained, np.broadcast_to([0.0, 0.0, -G * dt], gained.shape), atol=1e-9)
    assert -G * 0.1 < velocities[10][2] < -0.1 * G * 0.1  # it swings down while it is held
    assert off(rows) < 1e-3


def test_a_stone_that_is_let_go_lands_on_what_lies_below(prepared):
    """Contact is on because of the release, and the stone comes to rest on the table, not in it."""
    for elasticity in ("rigid", "2 MPa"):
        text = f"""gravity (0, 0, -9.81) m/s^2
object table {{ shape box (30, 30, 10) cm position (0, 0, -5) cm density 1000 elasticity rigid hold all }}
object stone {{ shape box (10, 10, 10) cm position (0, 0, 8) cm density 900 elasticity {elasticity} hold all release 0.1 s }}
control {{ time 0.8 s contact-damping 0.8 friction 0.3 accuracy preview }}
"""
        ready = prepared(text)
        assert ready.context.on("contact")
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(ready.certificate.steps)
            height = instance.system.center_of_mass(instance.array("x"))[1, 2]
        assert height == pytest.approx(0.05, abs=3e-3)


def test_a_cork_that_is_let_go_rises(prepared):
    """In a liquid, where it counts as unyielding until its release."""
    text = (
        GRAVITY
        + """liquid water { basin from (-20, -20, 0) cm to (20, 20, 40) cm density 1000 kg/m^3 level 25 cm }
object cork { shape box (10, 10, 10) cm position (0, 0, 9) cm density 300 elasticity 200 kPa hold all release 0.1 s }
control { time 0.5 s resolution 5 cm }
"""
    )
    rows, places, _ = rows_of(prepared(text), 5)
    assert abs(places[1][2] - places[0][2]) < 1e-4 and places[5][2] > places[0][2] + 0.05
    assert off(rows) < 1e-2


@pytest.mark.parametrize(
    "shape",
    [
        "box (10, 10, 10) cm position (0, 0, 1) m hold face -x",
        "sheet (20, 20) cm thickness 1 mm position (0, 0, 1) m hold face -x",
        "rope from (0, 0, 1) m to (0.4, 0, 1) m thickness 1 cm hold start",
    ],
)
def test_all_of_it_is_held_where_a_hold_says_so(prepared, shape):
    """Also where another one names a part."""
    text = f"object cube {{ shape {shape} hold all density 300 elasticity 1 MPa release 0.1 s }}\ncontrol {{ time 0.2 s }}\n"
    system = prepared(text).system
    assert system.pinned.all() and not system.held.any() and len(system.spring)


def test_the_lock_has_it():
    scene = parse_scene(KINDS["rigid"] + " release 250 ms }\ncontrol { time 1 s }\n", "cube.txt")
    assert scene.solids[0].release == 0.25
    assert parse_scene(lock_text(scene), "lock.txt").solids[0].release == 0.25


@pytest.mark.parametrize(
    ("words", "message", "way_out"),
    [
        ("release 1 s", "nothing of cube is held, so nothing of it can be driven or released", "write hold all, or hold face -x"),
        ("hold all release -1 s", "release must be >= 0", ""),
        ("hold all release 1 m", "release must be a time", "units that fit: s ms min"),
    ],
)
def test_what_is_refused(words, message, way_out):
    with pytest.raises(SceneError) as refused:
        prepare(parse_scene(f"{KINDS['soft'].replace('hold all ', '')} {words} }}\ncontrol {{ time 2 s }}\n", "cube.txt"))
    assert message in str(refused.value) and way_out in str(refused.value) and "cube.txt:1:" in str(refused.value), refused.value


@pytest.mark.parametrize(
    ("words", "message", "way_out"),
    [
        ("hold all velocity (1, 0, 0) m/s", "cube is held as a whole, and its velocity is not used", "drive velocity"),
        ("hold all spin (0, 0, 3) rad/s", "cube is held as a whole, and its spin is not used", "drive turn"),
        ("hold all drag 1 N*s/m", "cube is held as a whole, and its drag is not used", "leave out the drag or the hold"),
        ("hold all release 1 s velocity (1, 0, 0) m/s", "cube is held until 1 s, and its velocity is not used", "drive velocity"),
        ("hold all release 1 s spin (0, 0, 3) rad/s", "cube is held until 1 s, and its spin is not used", "drive turn"),
        ("hold all release 2 s", "cube is let go at 2 s, and the run ends at 2 s", "write an earlier time"),
    ],
)
def test_what_does_nothing_is_told(words, message, way_out):
    """A velocity of what is held is lost when it is let go; what is held in a part has it, and says nothing."""
    told = lambda own: [str(w) for w in parse_scene(f"{cube} {own} }}\ncontrol {{ time 2 s }}\n", "cube.txt").warnings]
    cube = KINDS["soft"].replace("hold all ", "")
    found = told(words)
    assert len(found) == 1 and message in found[0] and way_out in found[0], found
    assert not told(words.replace("hold all", "hold face -x").replace("2 s", "1 s"))
