# SPDX-License-Identifier: GPL-2.0-only
"""The guard: every kind of breakdown stops the run with step, object, cause and cure, and keeps what was good."""

import json
import re

import numpy as np
import plugin_path
import pytest
from mdanim_lammps import Trajectory
from mdanim_lammps.engine.geometry import INVERTED, NOT_FINITE, Geometry
from mdanim_lammps.engine.plugin import open_lammps
from mdanim_lammps.errors import DivergedError, ExitCode
from mdanim_lammps.features.liquid.balance import load_energy
from mdanim_lammps.results.checkpoint import Checkpoint
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.run.energy import least_energy
from mdanim_lammps.run.guard import CLASSES, LEAST_RESIDUAL, RESIDUAL_FACTOR, Guard, energy_class, fastest
from mdanim_lammps.run.loop import simulate, write_inputs
from mdanim_lammps.run.observe import Observer
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.scene.scene import Accuracy
from twin.lattice import stiffness_matrix

HIT = """
{world}
object ball {{
  shape {shape}
  position (0, 0, 30) cm
  density 1000
  elasticity {young} kPa
  velocity (0, 0, {speed})
}}
{more}
control {{
  time {time} s
  frames 100 fps
  resolution 2.5 cm
  {control}
}}
"""


BOX = "box (10, 10, 10) cm"


def hit(shape=BOX, young=20.0, speed=-1.0, world="ground z 0", more="", time=0.3, control=""):
    """A cube above something, thrown down."""
    return HIT.format(shape=shape, young=young, speed=speed, world=world, more=more, time=time, control=control)


def run(text, folder, *, insist=False):
    """Run a scene; returns the result and the Prepared."""
    path = folder / "hit.txt"
    path.write_text(text)
    ready = prepare(load_scene(path), allow_unstable=insist)
    out = folder / "hit.out"
    out.mkdir()
    write_inputs(ready, out)
    return simulate(ready, out), ready


def seen(ready, x, v):
    """Observations of all objects of a scene without ``expect`` lines."""
    everything = np.arange(len(ready.system.names))
    return Observer(ready.plan, ()).observe(everything, everything, x, v)


BLOCK = "object block { shape box (30, 30, 30) cm position (0, 0, 5) cm density 1000 elasticity 2 kPa hold all }"


@pytest.mark.parametrize(
    ("text", "insist", "told"),
    [
        pytest.param(
            hit(young=100, control="timestep 5 ms"),
            True,
            ["ball: the energies do not add up, residual", "of what ball bears", "timestep auto"],
            id="time step above the bound",
        ),
        pytest.param(
            hit(young=100, time=2, control="timestep 10 ms").replace("100 fps", "1 fps"),
            True,
            ["ball: (LAMMPS stopped|its positions)", "of what ball bears", "timestep auto"],
            id="far above, few frames",
        ),
        pytest.param(
            hit(young=100, time=2, control="contact-model surface\n timestep 10 ms").replace("100 fps", "1 fps"),
            True,
            ["ball: (LAMMPS stopped|its positions)", "of what ball bears", "timestep auto"],
            id="far above, particles lost while surfaces touch",
        ),
        pytest.param(
            hit(young=1, speed=-20),
            False,
            ["ball: it has left the ground: all of it is beyond z = 0 m", "of the wave speed", "write elasticity"],
            id="thrown through the ground",
        ),
        pytest.param(
            hit(shape=f"{BOX} orientation euler (10, 20, 30) deg", speed=-3, time=2),
            False,
            [r"ball: \d+ of its \d+ cells have been inside out since step", "of the wave speed", "write elasticity"],
            id="crumpled",
        ),
        pytest.param(
            hit(young=2, speed=-6, world="", more=BLOCK),
            False,
            ["ball: it is inside block", "at 6 m/s", "lower speed"],
            id="into another object",
        ),
    ],
)
def test_a_breakdown_stops_the_run(tmp_path, text, insist, told):
    """Name the step, the object, the cause and what to change; keep good frames and the checkpoint."""
    with pytest.raises(DivergedError) as caught:
        run(text, tmp_path, insist=insist)
    assert caught.value.exit_code == ExitCode.DIVERGED == 6
    lines = str(caught.value).split("\n")
    assert re.match(r"step \d+, t = [\d.e-]+ s: " + told[0], lines[0])
    for start, words, line in zip(("  cause: ", "  change: "), told[1:], lines[1:]):
        assert line.startswith(start) and re.search(words, line)
    assert lines[3] == f"  the last good frame and checkpoint are kept in {tmp_path / 'hit.out'}"
    step = int(lines[0].split()[1].rstrip(","))
    with Trajectory(tmp_path / "hit.out") as t:
        assert t.steps[-1] < step or "LAMMPS" in lines[0]
        assert all(np.isfinite(t.position(i)).all() for i in range(len(t)))
        assert len(Ledger.read(tmp_path / "hit.out" / "ledger.csv").rows) == len(t)
    assert Checkpoint.read(tmp_path / "hit.out" / "checkpoint").step <= t.steps[-1]


def test_inverted_cells_are_only_counted_where_the_user_insists(tmp_path):
    """Go on with crumpled cells under --allow-unstable, and say in the summary how many there were."""
    result, _ = run(hit(shape="sphere 6 cm", young=2, speed=-3, time=1.5), tmp_path, insist=True)
    assert json.loads((result.folder / "summary.json").read_text())["inverted_cells"] >= 1
    (tmp_path / "kind").mkdir()
    result, _ = run(hit(), tmp_path / "kind")
    assert json.loads((result.folder / "summary.json").read_text())["inverted_cells"] == 0


def test_a_class_of_energy_that_is_missed_is_told(tmp_path):
    """Warn at the end of a run, at the scene line, with the residual found; be silent where it was met."""
    hard = hit(young=100, speed=-3, control="accuracy reference\n timestep 1.38 ms")
    (tmp_path / "hard").mkdir()
    (tmp_path / "kind").mkdir()
    result, _ = run(hard, tmp_path / "hard")
    assert 1e-4 < result.ledger.residual < LEAST_RESIDUAL
    assert [w.severity for w in result.warnings] == ["warning"]
    assert "'accuracy reference' stands for; most of it came from t = " in result.warnings[0].message
    assert result.warnings[0].span.text.strip() == "accuracy reference"
    result, _ = run(hit(young=100, world=""), tmp_path / "kind")
    assert result.ledger.residual < 1e-3 and not result.warnings


DROP = """gravity (0, 0, -9.81) m/s^2
ground z 0 m
object box {{ shape box (20, 20, 20) cm  position (0, 0, 0.17) m  velocity (0, 0, -3) m/s  density 1000  elasticity 1 MPa }}
control {{ time 0.2 s  {control} }}
"""


def test_the_cause_of_a_residual_is_told(tmp_path):
    """A box that lands: the frame in which surfaces met, and the step that is too long for it; damping is not a cure, and a
    quarter of the step is."""
    result, _ = run(DROP.format(control="friction 0.5"), tmp_path)
    (warning,) = result.warnings
    when = next(r["time"] for r in result.ledger.rows if r["wall"])
    assert f"to {when:.4g} s, where surfaces met: a step is long for the onset" in warning.message
    assert warning.hint == "where it matters, write a higher accuracy or a smaller timestep"
    (tmp_path / "short").mkdir()
    short, _ = run(DROP.format(control="friction 0.5 accuracy reference"), tmp_path / "short")
    assert short.ledger.residual < 0.2 * result.ledger.residual


@pytest.mark.parametrize("accuracy", list(Accuracy))
def test_the_energy_guard_is_generous(prepared, tmp_path, accuracy):
    """Stop at fifty times the class, and never below 0.05; give no number no pass."""
    ready = prepared(hit(control=f"accuracy {accuracy.value}"))
    guard = Guard(ready, tmp_path)
    v = ready.system.top_speed(ready.system.velocity)
    limit = max(LEAST_RESIDUAL, RESIDUAL_FACTOR * CLASSES[accuracy])
    assert energy_class(ready.scene) == CLASSES[accuracy]
    guard.energy(10, 0.99 * limit, v)
    guard.energy(10, -0.99 * limit, v)
    for residual in (1.01 * limit, -1.01 * limit, np.nan):
        with pytest.raises(DivergedError, match="the energies do not add up"):
            guard.energy(10, residual, v)


def test_a_stop_suspects_the_step_where_only_the_energies_are_off(prepared, tmp_path):
    """Where every margin is kept a hit is suspected only while cells are inside out."""
    guard = Guard(prepared(hit(speed=-0.1)), tmp_path)
    for crumpled, suspicion in ((False, "the step is probably too long"), (True, "probably hit or squeezed")):
        guard.crumpled = crumpled
        with pytest.raises(DivergedError, match=suspicion):
            guard.energy(10, 1.0, guard.ready.system.top_speed(guard.ready.system.velocity))


REST = """
object a {{ shape sphere 10 cm position (0, 0, {z}) m density 1000 kg/m^3 elasticity 1 MPa }}
control {{ time {time} s frames 1 fps {control} }}
"""


@pytest.mark.parametrize("z", [1.0, 1e5])
def test_a_body_at_rest_does_not_diverge(tmp_path, z):
    """Rounding makes energies of 1e-22 J in a minute, more far from the origin: nothing that an account is kept of."""
    result, ready = run(REST.format(z=z, time=60, control=""), tmp_path)
    assert max(abs(r["kinetic"] + r["elastic"]) for r in result.ledger.rows) < ready.system.mass.sum() * 1e-12
    assert result.ledger.residual < 1e-3
    assert not result.warnings


IN_BALANCE = """
gravity (0, 0, -9.81) m/s^2
liquid water {{ basin from (0, 0, 0) cm to (64, 64, 64) cm  density 1000 kg/m^3  level 40 cm  model {model} }}
object a {{ shape box (16, 16, 16) cm  position (32, 32, 20) cm  density 1000 kg/m^3  elasticity 500 kPa }}
control {{ time 1 s  resolution {cell} cm }}
"""


@pytest.mark.parametrize("model", ["waves", "surface"])
def test_a_body_in_balance_in_a_liquid_does_not_diverge(tmp_path, model):
    """It moves no more than rounding moves it; the weights of it and of the liquid, 10 J and more, round to 1e-13 J. Masses of a
    single cell are those by volume, so that weight and lift are one at each particle."""
    result, _ = run(IN_BALANCE.format(model=model, cell=16), tmp_path)
    assert max(abs(r["kinetic"] + r["elastic"]) for r in result.ledger.rows) < 1e-12
    assert result.ledger.residual < 1e-3
    assert not result.warnings


@pytest.mark.parametrize("model", ["waves", "surface"])
def test_a_body_in_balance_is_strained_by_fitted_masses_alone(tmp_path, model):
    """Weight acts on fitted masses, lift on volumes by cells. Their difference f does at most the work of a sudden load,
    4 (f K^-1 f / 2) with the stiffness K of the springs; it is far below the energies that the account balances."""
    result, ready = run(IN_BALANCE.format(model=model, cell=4), tmp_path)
    system = ready.system
    load = np.zeros((len(system.mass), 3))
    load[:, 2] = 9.81 * (1000.0 * system.volume - system.mass)
    stiff = stiffness_matrix(system.position, system.spring, system.stiffness).toarray()
    static = 0.5 * float(load.ravel() @ np.linalg.pinv(stiff, rcond=1e-9, hermitian=True) @ load.ravel())
    most = max(r["kinetic"] + r["elastic"] for r in result.ledger.rows)
    assert 0.5 * static < most <= 4.0 * static
    assert load_energy(ready.scene, system)[0] == pytest.approx(static, rel=0.5)  # springs in a row for the lattice
    assert result.ledger.residual < 1e-3
    assert not result.warnings


@pytest.mark.parametrize(
    ("density", "height"),
    [pytest.param(1500, 8, id="lies"), pytest.param(1050, 20, id="sinks"), pytest.param(500, 48, id="falls")],
)
def test_bodies_out_of_balance_in_a_liquid_keep_their_account(tmp_path, density, height):
    """They have energies by their own weight: a thousandth of those counts, as it does without a liquid, and they add up."""
    text = IN_BALANCE.format(model="waves", cell=4).replace("32, 20)", f"32, {height})").replace("1 s", "0.3 s")
    result, ready = run(text.replace("density 1000 kg/m^3  elast", f"density {density} kg/m^3  elast"), tmp_path)
    most = max(r["kinetic"] + r["elastic"] for r in result.ledger.rows)
    assert least_energy(ready.scene, ready.system) < 1e-5 * most
    assert result.ledger.residual < 1e-3


def test_a_faint_vibration_has_an_account(tmp_path):
    """A spin of a micrometre a second holds more than the least energy, and its energies add up to that."""
    text = REST.format(z=1.0, time=3, control="").replace("elasticity", "spin (0, 0, 1e-5) rad/s elasticity")
    result, _ = run(text, tmp_path)
    first = result.ledger.rows[0]["kinetic"]
    assert result.ledger.floor < first
    assert result.ledger.residual < 1e-3


def test_a_cone_that_falls_on_its_tip_is_foreseen(tmp_path):
    """At 0.17 of the wave speed the tip folds up and stays so: a dent that is told, and of which `check` has told."""
    text = (
        "ground z 0\nobject a { shape cone 3 m 5 m position (0, 0, 7) m orientation axis (1, 0, 0) angle 180 deg "
        "density 1000 elasticity 100 kPa velocity (0, 0, -1.9) m/s }\ncontrol { time 20 s frames 1 fps resolution 1 m }"
    )
    result, ready = run(text, tmp_path)
    dent, foreseen = result.warnings[0], next(m for m in ready.certificate.margins if m.name == "amplitude")
    assert re.match(
        r"a got a dent: \d+ of its \d+ cells have been turned inside out by a blow; a may hit at 1.9 m/s", dent.message
    )
    assert foreseen.severity == "warning" and foreseen.text in dent.message and foreseen.hint == dent.hint
    assert json.loads((result.folder / "summary.json").read_text())["dents"]["a"] > 0
    assert dent.span.line == 2 and result.ledger.residual < energy_class(ready.scene)


def test_what_lammps_says_is_passed_on(prepared, tmp_path):
    """Blame an object and the time step only where particles have flown apart; other ends speak for themselves."""
    ready = prepared(hit(young=1, speed=-20))
    guard = Guard(ready, tmp_path)
    flown = guard.explain_failure(
        7, DivergedError("LAMMPS stopped: ERROR: Bond atoms 1 2\nmissing"), fastest(ready.system, ready.system.velocity)
    )
    assert "ball: LAMMPS stopped: ERROR: Bond atoms 1 2 missing" in str(flown) and "  change: write elasticity" in str(flown)
    assert "ball: LAMMPS" in str(
        guard.explain_failure(7, DivergedError("LAMMPS stopped: Lost atoms"), fastest(ready.system, ready.system.velocity[:5]))
    )
    other = str(guard.explain_failure(7, DivergedError("LAMMPS stopped: ERROR: no open cell is left"), 0))
    assert other.startswith("step 7, t = ") and "no open cell" in other and "cause" not in other and str(tmp_path) in other


@pytest.mark.parametrize(("array", "value"), [("x", np.nan), ("v", -np.inf)])
def test_what_has_overflowed_is_named(prepared, tmp_path, array, value):
    """One particle of the second object alone: that object stops the run, not the first."""
    text = hit().replace(
        "control", "object rock { shape sphere 5 cm position (1, 0, 1) m density 900 elasticity 20 MPa }\ncontrol", 1
    )
    ready = prepared(text)
    state = {"x": ready.system.position.copy(), "v": ready.system.velocity.copy()}
    Guard(ready, tmp_path).check(1, seen(ready, **state))
    state[array][-1, 1] = value
    with pytest.raises(DivergedError, match=r"step 7, .*: rock: its positions or velocities are NaN or infinite"):
        Guard(ready, tmp_path).check(7, seen(ready, **state))


# --- the plugin's loops ---------------------------------------------------------------------------------------------

TWO = """
object a {{ shape {a} position (0, 0, 0) density 1000 elasticity 100 kPa {more} }}
object b {{ shape {b} position (0, 0, 1) m density 1000 elasticity 100 kPa {more} }}
control {{ time 1 s resolution 2 cm }}
"""
BOX, SHEET = "box (10, 10, 10) cm", "box (20, 20, 2) cm"


@pytest.fixture
def two(prepared):
    """Make the Geometry and the positions of two objects, the second moved to ``at`` [m]."""
    open_lammps()[0].close()  # which maps the libraries that the plugin is linked to

    def make(a=BOX, b=BOX, at=(0.0, 0.0, 1.0), more=""):
        system = prepared(TWO.format(a=a, b=b, more=more)).system
        x = system.position.copy()
        x[system.first[1] :] += np.array(at) - [0.0, 0.0, 1.0]
        return Geometry(system), x

    return make


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("where", ["x", "v"])
def test_what_is_not_finite_is_found(two, value, where):
    """Find the first particle with one bad number; the largest finite ones are fine."""
    geometry, x = two()
    v = np.zeros_like(x)
    v[0] = x[-1] = np.finfo(float).max
    assert geometry.not_finite(x, v) is None
    {"x": x, "v": v}[where][[37, 40], [2, 0]] = value
    assert geometry.not_finite(x, v) == 37


def test_a_glance_tells_how_far_objects_reach(two):
    """Give the lowest and highest particle along each axis, and whether a number or a cell is bad."""
    geometry, x = two(a="sphere 7 cm", at=(0.3, 0.2, -0.1))
    v = np.zeros_like(x)
    x += np.random.default_rng(1).normal(0.0, 0.001, x.shape)
    found, reach = geometry.glance(x, v)
    assert found == 0
    first = geometry.system.first
    for m in range(2):
        part = x[first[m] : first[m + 1]]
        assert np.array_equal(reach[m], np.concatenate([part.max(0), -part.min(0)]))
    x[-1, 2] -= 0.1
    found, reach = geometry.glance(x, v)
    assert found == INVERTED and -reach[1, 5] == x[first[1] :, 2].min()
    v[5, 1] = np.nan
    assert geometry.glance(x, v)[0] == NOT_FINITE


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        pytest.param(lambda x: x, 0, id="as it is"),
        pytest.param(lambda x: x[:, [1, 2, 0]], 0, id="rotated"),
        pytest.param(lambda x: x * [1.0, 1.0, 0.05], 0, id="pressed flat"),
        pytest.param(lambda x: x * [1.0, 1.0, -1.0], 250, id="mirrored"),
        pytest.param(lambda x: x * [1.0, 1.0, 0.0], 250, id="no thickness"),
    ],
)
def test_inverted_cells_are_counted(two, change, expected):
    """See a mirrored cell, and no turned or squeezed one."""
    geometry, x = two()
    assert np.count_nonzero(geometry.inverted(np.ascontiguousarray(change(x)))) == expected


def test_a_corner_pushed_through_its_cell_inverts_it(two):
    """Name the one cell."""
    geometry, x = two()
    x[0] += 0.03  # a cell and a half along each edge of 2 cm
    assert np.flatnonzero(geometry.inverted(x)).tolist() == [0]


@pytest.mark.parametrize(
    ("b", "at", "more", "found"),
    [
        pytest.param(BOX, (0.0, 0.0, 0.11), "", None, id="apart"),
        pytest.param(BOX, (0.003, 0.007, 0.091), "", None, id="0.45 of a cell deep, as in the hardest contact"),
        pytest.param(BOX, (0.003, 0.007, 0.065), "", {0, 1}, id="almost two cells deep"),
        pytest.param(BOX, (0.0, 0.0, 0.0), "", {0, 1}, id="all of it"),
        pytest.param(BOX, (0.0, 0.0, 0.0), "hold all", None, id="both held: they may overlap"),
        pytest.param("sphere 3 cm", (0.01, 0.0, 0.0), "", (1, 0), id="a small one within"),
        pytest.param(SHEET, (0.0, 0.0, 0.055), "", None, id="a sheet on it"),
        pytest.param(SHEET, (0.0, 0.0, 0.005), "", (1, 0), id="a sheet in it"),
        pytest.param("torus 12 cm 4 cm", (0.0, 0.0, 0.0), "", None, id="a ring around it: the ring's middle is in the box"),
    ],
)
def test_objects_inside_each_other_are_found(two, b, at, more, found):
    """Tell depth beyond contact from contact, whatever the boxes say."""
    geometry, x = two(b=b, at=at, more=more)
    pair = geometry.sunk(x)
    assert (pair if not isinstance(found, set) else set(pair or ())) == found


def test_cells_that_stand_out_of_a_drawn_surface_are_in_nothing(two):
    """Find nothing where drawn surfaces are a fifth of a cell in each other, from whatever side."""
    geometry, x = two(a="sphere 7.2 cm orientation euler (13, 27, 41) deg", b="sphere 7.2 cm", at=(0.0, 0.0, 0.0))
    ball = x[geometry.system.first[1] :].copy()
    for way in np.random.default_rng(0).normal(size=(500, 3)):
        x[geometry.system.first[1] :] = ball + way / np.linalg.norm(way) * (2 * 0.072 - 0.004)
        assert geometry.sunk(x) is None, way


def test_a_sheet_that_holds_the_centre_of_another_is_entered(two):
    """Ask for the centre where a body has no deeper cells: two crossed sheets, and two on each other."""
    for angle, at, found in ((1, (0.0, 0.0, 0.0), True), (0, (0.0, 0.0, 0.021), False)):
        geometry, x = two(a=SHEET, b=SHEET, at=at)
        part = x[geometry.system.first[1] :]
        if angle:
            part[:] = part[:, [0, 2, 1]]
        assert (geometry.sunk(x) is not None) == found


def test_the_command_line_ends_with_six(tmp_path, capsys):
    """Print the message on stderr, without a traceback, and exit with 6."""
    from mdanim_lammps.cli import main

    (tmp_path / "hit.txt").write_text(hit(young=1, speed=-20))
    with pytest.raises(SystemExit) as caught:
        main([str(tmp_path / "hit.txt"), "--no-movie", "-q"])
    error = capsys.readouterr().err
    assert caught.value.code == 6
    assert "mdanim-lammps: error: step" in error and "change: write elasticity" in error and "Traceback" not in error


OVERFLOW = """
import sys
from pathlib import Path
import numpy as np
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.engine.geometry import Geometry
from mdanim_lammps.scene.parse import load_scene
system = prepare(load_scene(Path(sys.argv[1])), allow_unstable=True).plan.system
x = system.position.copy()
for m in range(2):  # both in one place
    x[system.object == m] -= x[system.object == m].mean(0)
print(Geometry(system).sunk(np.ascontiguousarray(x / np.abs(x).max() * float(sys.argv[2]))))
"""


@pytest.mark.parametrize("size", [1e300, 1.7e308])
def test_objects_of_any_size_are_looked_at(tmp_path, size):
    """Come to an end also where the extent of what is looked at exceeds every number."""
    side = "shape box (10, 10, 10) cm density 1000 elasticity 2 kPa"
    text = f"object a {{ {side} position (0, 0, 0) }}\nobject b {{ {side} position (15, 0, 0) cm }}\n"
    text += "control { time 1 s resolution 2.5 cm }"
    (tmp_path / "two.txt").write_text(text)
    done = plugin_path.python(OVERFLOW, tmp_path / "two.txt", size, timeout=60.0)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() in ("None", "(0, 1)")
