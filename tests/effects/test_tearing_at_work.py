# SPDX-License-Identifier: GPL-2.0-only
"""Bodies that tear, against closed forms: what remains is free of stress; where and when they tear; what energy is gone."""

import math

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.errors import SceneError
from mdanim_lammps.export.csv import elastic
from mdanim_lammps.export.cut import Cut
from mdanim_lammps.features.tearing.rules import middles, over_two, over_two_of
from mdanim_lammps.results.ledger import Ledger
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.energy import energies
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.scene.parse import parse_scene

ROPE = """object cord {{
  shape {shape} from (0, 0, 3) m to (0, 0, 2) m thickness {thick} cm  resolution {h} cm
  elasticity {young} MPa  density 1000 kg/m^3  hold start  {more}
}}
control {{ time 1 s }}
"""
HUNG = """gravity (0, 0, -9.81) m/s^2
object cord {{
  shape {shape} from (0, 0, 3) m to (0, 0, 2) m thickness {thick} cm  resolution {h} cm
  elasticity {young} MPa  density 1000 kg/m^3  hold start  damping 0.2  tear-strain {e}
}}
object ball {{ shape sphere 10 cm  position (0, 0, 1.9) m  mass {mass} kg  elasticity rigid }}
joint ball cord ball {{ at (0, 0, 2) m }}
control {{ time {time} s }}
"""


@pytest.mark.parametrize("shape", ["rope", "chain"])
@pytest.mark.parametrize(("thick", "h"), [(1, 5), (3, 4), (4, 4)])
@pytest.mark.parametrize("cut", [[0], [7], [7, 8], [7, 9], [1, 4], [-1], [0, 2, 3, 5, -1]], ids=str)
def test_pieces_are_free_of_stress(prepared, shape, thick, h, cut):
    """Without load no force acts on any particle, and there is no energy, wherever a rope of any thickness is torn."""
    ready = prepared(ROPE.format(shape=shape, thick=thick, h=h, young=20, more="tear-strain 0.1"))
    low, high = ready.system.spring.T
    for link in (c % int(low.max() + 1) for c in cut):
        ready.plan.columns["torn"][(low <= link) & (high > link)] = 1.0
    with Instance(ready.plan) as instance:
        instance.setup()
        pull = 20e6 * math.pi / 4 * (thick / 100) ** 2
        assert np.abs(instance.array("f")).max() < 1e-12 * pull
        found = energies(instance, ready.system.center_of_mass(instance.array("x")))
    assert abs(found["elastic"]) < 1e-12 * pull and found["torn"] == 0.0


def watched(ready, seconds, looks):
    """Largest strain of a link, share that is torn, and energies, at even times."""
    strain, torn, told = [], [], []
    system, (i, j) = ready.system, ready.system.spring.T
    link = j - i == 1
    with Instance(ready.plan) as instance:
        instance.setup()
        for _ in range(looks):
            instance.run(max(1, round(seconds / looks / ready.certificate.timestep)))
            x, gone = instance.array("x"), instance.column("torn") > 0.0
            stretch = np.linalg.norm(x[i] - x[j], axis=1) / system.unloaded - 1.0
            strain.append(stretch[link & ~gone].max())
            torn.append(gone[link].sum())
            told.append(energies(instance, system.center_of_mass(x)))
    return np.array(strain), np.array(torn), told


@pytest.mark.parametrize(
    ("shape", "thick", "h", "young", "e", "mass", "time"),
    [("chain", 1, 5, 5, 0.1, 40, 0.25), ("rope", 1, 5, 5, 0.1, 40, 0.25), ("rope", 2, 4, 2, 0.3, 60, 0.4)],
)
def test_it_tears_at_the_strain_and_in_one_place(prepared, shape, thick, h, young, e, mass, time):
    """A ball pulls a cord apart: one link goes, at the strain e, with the energy E A e^2 h/2, and the ledger adds up."""
    ready = prepared(HUNG.format(shape=shape, thick=thick, h=h, young=young, e=e, mass=mass, time=time))
    strain, torn, told = watched(ready, time, 400)
    assert torn[-1] == 1
    first = int(torn.argmax())
    assert e * 0.97 < strain[:first].max() < e * 1.25  # others bear a quarter more; looks are far apart
    length, area = ready.system.unloaded[0], math.pi / 4 * (thick / 100) ** 2
    energy = 0.5 * young * 1e6 * area * e**2 * length
    # A rope that bends has the springs over two links besides, of which the neighbours keep what is theirs.
    assert told[-1]["torn"] == pytest.approx(energy, rel=0.03 if shape == "chain" else 0.1)
    total = [sum(v for v in one.values()) for one in told]
    swing = max(np.ptp([one[k] for one in told]) for k in told[0])
    assert np.ptp(total) < 1e-3 * swing


def test_it_never_heals(prepared):
    """A torn cord that lies together again stays torn; one that is only pushed together does not tear."""
    text = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n" + ROPE.format(
        shape="chain", thick=2, h=5, young=1, more="tear-strain 0.01 velocity (0, 0, 2) m/s"
    )
    _, torn, _ = watched(prepared(text), 0.2, 20)
    assert (np.diff(torn) >= 0).all()
    text = ROPE.format(shape="chain", thick=2, h=5, young=1, more="tear-strain 0.5 velocity (0, 0, 3) m/s")
    _, torn, _ = watched(prepared(text), 0.02, 20)
    assert torn[-1] == 0


def test_frames_expectations_and_surfaces_know_it(prepared, tmp_path):
    """`expect` counts shares and pieces, frames hold what is gone, and the surface has nothing between the pieces."""
    text = HUNG.format(shape="rope", thick=1, h=5, young=5, e=0.1, mass=40, time=0.3).replace("0.3 s }", "0.3 s frames 50 fps }")
    text += "expect cord.torn > 0\nexpect cord.pieces = 2\nexpect cord.pieces at 0 s = 1\nexpect cord.strain.max < 0.13\n"
    ready = prepared(text)
    done = simulate(ready, tmp_path)
    assert [outcome.met for outcome in done.outcomes] == [True] * 4, done.outcomes
    with Trajectory(tmp_path / "trajectory.h5") as trajectory:
        last = len(trajectory) - 1
        assert trajectory.field("torn", 0).sum() == 0 and trajectory.field("torn", last).sum() == 3
        gone = trajectory.gone(last)  # one link, and springs over it
        (link,) = gone[np.diff(gone, axis=1)[:, 0] == 1, 0]
        ends = trajectory.position(last)[link : link + 2]
        surface = trajectory.objects["cord"].surface(last)
        height, middle = np.asarray(surface.points)[:, 2], ends[:, 2].mean()
        assert np.abs(ends[0, 2] - ends[1, 2]) > 0.1
        assert not ((height > middle - 0.02) & (height < middle + 0.02)).any()
        assert surface.n_points == trajectory.objects["cord"].surface(0).n_points
    assert Ledger.read(tmp_path / "ledger.csv").array("torn")[-1] > 0.0


BOX = "object a { shape box (1, 1, 1) m position (0, 0, 1) m density 1 elasticity rigid tear-strain 0.1 }"
CHAIN = "object a { shape chain from (0, 0, 1) m to (1, 0, 1) m thickness 1 cm density 1 elasticity 1 MPa "
MISTAKES = [
    (BOX, 94, "a is rigid: it has no springs that could break"),
    (CHAIN.replace("1 cm", "1 cm length 0.8 m") + "tear-strain 0.1 }", 123, "is stretched by 25 % from the start"),
    (CHAIN + "tear-strain -1 }", 110, "tear-strain must be > 0"),
]


@pytest.mark.parametrize(("text", "column", "words"), MISTAKES, ids=["rigid", "stretched", "negative"])
def test_mistakes(text, column, words):
    """Place, cause and way out."""
    with pytest.raises(SceneError) as error:
        parse_scene(text + "\ncontrol { time 1 s }\n")
    (problem,) = error.value.problems
    assert words in problem.message and problem.hint and (problem.line, problem.column) == (1, column), str(problem)


def test_exports_leave_out_what_is_gone(prepared, tmp_path):
    """Strains of a torn cord are those of its pieces, and a table says nothing of its elastic energy."""
    text = HUNG.format(shape="chain", thick=1, h=5, young=5, e=0.1, mass=40, time=0.3).replace("0.3 s }", "0.3 s frames 50 fps }")
    ready = prepared(text)
    simulate(ready, tmp_path)
    with Trajectory(tmp_path / "trajectory.h5") as trajectory:
        last = len(trajectory) - 1
        assert len(trajectory.gone(last)) == 1
        cut = Cut(trajectory, (), 1, slice(None))
        assert cut.strain(cut.position(last), last).max() < 0.13
        found = elastic(ready.system, trajectory.position(last), trajectory.gone(last))
        assert np.isnan(found).tolist() == [True, False]
        assert np.isfinite(elastic(ready.system, trajectory.position(0), trajectory.gone(0))).all()


SHEET = """object paper {{
  shape sheet (0.5, 0.3) m thickness {t} mm  position (0, 0, 0.5) m  orientation axis (1, 2, 0) angle 40 deg  resolution 3 cm
  density 500  elasticity 2 MPa  hold faces x  tear-strain 0.1
}}
control {{ time 1 s }}
"""


@pytest.mark.parametrize("t", [1, 10])
@pytest.mark.parametrize("seed", range(4))
def test_pieces_of_sheets_are_free_of_stress(prepared, t, seed):
    """Without load no force acts on any particle, and there is no energy, whichever links of a sheet are gone."""
    ready = prepared(SHEET.format(t=t))
    system = ready.system
    over = over_two(system, slice(None))
    assert over.sum() > 0.8 * (~over).sum()
    gone = np.zeros(len(over), bool)
    gone[~over] = np.random.default_rng(seed).random((~over).sum()) < [0.02, 0.1, 0.4, 0.9][seed]
    a, b = system.spring[over].T
    middle = middles(system.spring, system.unloaded, over)
    links = {tuple(pair): torn for pair, torn in zip(system.spring.tolist(), gone.tolist())}
    either = [links[tuple(sorted((i, m)))] or links[tuple(sorted((m, j)))] for i, m, j in zip(a, middle, b)]
    gone[over] = either
    ready.plan.columns["torn"][gone] = 1
    pull = 2e6 * 1e-3 * t * 0.03
    with Instance(ready.plan) as instance:
        instance.setup()
        assert np.abs(instance.array("f")).max() < 1e-11 * pull
        assert abs(energies(instance, system.center_of_mass(instance.array("x")))["elastic"]) < 1e-12 * pull
        assert np.array_equal(instance.column("torn") > 0, gone)


SHELL = """object skin {{
  shape {shape} sheet thickness {t} mm  position (0, 0, 0.5) m  resolution {h} cm
  density 1000  elasticity 2 MPa  tear-strain 0.1
}}
control {{ time 1 s }}
"""


@pytest.mark.parametrize(("shape", "h"), [("sphere 10 cm", 2.5), ("box (20, 15, 12) cm", 2.5), ("cylinder 8 cm 20 cm", 2)])
@pytest.mark.parametrize("t", [1, 4])
@pytest.mark.parametrize("seed", range(3))
def test_pieces_of_curved_sheets(prepared, shape, h, t, seed):
    """Springs over two links go with either of them. Energy counts from the body without load, so there is none. Forces are less
    than 0.5 E t^3/h, where E t h is what stretches it by its length: 0.05 of them is in whole spheres and cylinders, which are
    bent, 0.42 at most was found in pieces, as the links of their springs are not in a row."""
    ready = prepared(SHELL.format(shape=shape, h=h, t=t))
    system, (model,) = ready.system, ready.context.system_models
    over = over_two_of(system, 0, model)
    assert 0.3 * (~over).sum() < over.sum()
    gone = np.zeros(len(over), bool)
    gone[~over] = np.random.default_rng(seed).random((~over).sum()) < [0.02, 0.1, 0.4][seed]
    middle = middles(system.spring, system.unloaded, over)
    links = {tuple(pair): torn for pair, torn in zip(system.spring.tolist(), gone.tolist())}
    gone[over] = [links[tuple(sorted((i, m)))] or links[tuple(sorted((m, j)))] for (i, j), m in zip(system.spring[over], middle)]
    forces = []
    for torn in (np.zeros(len(over), bool), gone):
        ready.plan.columns["torn"][:] = torn
        with Instance(ready.plan) as instance:
            instance.setup()
            assert np.array_equal(instance.column("torn") > 0, torn)
            forces.append(np.abs(instance.array("f")).max())
            assert abs(energies(instance, system.center_of_mass(instance.array("x")))["elastic"]) < 1e-12 * 2e6 * t * 1e-3 * 0.01
    spacing = float(system.spacing[0])
    assert max(forces) < 0.5 * 2e6 * (t * 1e-3) ** 3 / spacing


THROUGH = """gravity (0, 0, -9.81) m/s^2
object thing {{
  shape {shape}  position (0, 0, 0.5) m  hold faces x  resolution 4 cm
  density 700  elasticity {young}  damping 0.1  tear-strain {e}
}}
object ball {{ shape sphere 12 cm  position (0, 0, 0.72) m  velocity (0, 0, -6) m/s  density 2000  elasticity rigid }}
control {{ time 0.15 s  frames 40 fps }}
expect thing.torn > 0.02
expect thing.pieces >= 2
expect thing.pieces at 0 s = 1
"""
BODIES = {
    "sheet": THROUGH.format(shape="sheet (0.5, 0.4) m thickness 2 mm", young="1 MPa", e=0.1),
    "box": THROUGH.format(shape="box (0.6, 0.2, 0.1) m", young="300 kPa", e=0.05),
    "curved sheet": THROUGH.format(shape="box (0.5, 0.4, 0.2) m sheet thickness 3 mm", young="1 MPa", e=0.05),
}


@pytest.mark.parametrize("body", BODIES)
def test_sheets_and_solids_tear(prepared, tmp_path, body):
    """A ball flies through: energies add up, parts fall, and a surface of patches is drawn without those that are gone."""
    done = simulate(prepared(BODIES[body]), tmp_path)
    assert [outcome.met for outcome in done.outcomes] == [True] * 3, done.outcomes
    table = Ledger.read(tmp_path / "ledger.csv")
    told = {name: table.array(name) for name in table.terms}
    total = sum(told.values())
    assert np.ptp(total) < 2e-3 * max(np.ptp(one) for one in told.values())
    with Trajectory(tmp_path / "trajectory.h5") as trajectory:
        last, thing = len(trajectory) - 1, trajectory.objects["thing"]
        whole, torn = thing.surface(0), thing.surface(last)
        assert whole.n_points == torn.n_points and whole.n_cells == torn.n_cells
        area = whole.compute_cell_sizes(length=False, volume=False)["Area"]
        left = torn.compute_cell_sizes(length=False, volume=False)["Area"]
        first = int(np.flatnonzero(area == 0.0)[0])
        assert (area[:first] > 0.0).all() and not area[first:].any()  # at first the whole surface alone
        assert not left[:first].any() and left[first:].any()  # then patches alone
        cut = Cut(trajectory, (), 1, slice(None))  # what all exports take: the same triangles in all frames
        for frame, drawn in ((0, (area > 0.0).sum()), (last, (left > 0.0).sum())):
            corner = cut.surfaces(frame)[0][0][cut.bodies[0].triangle]
            size = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
            assert len(size) == len(area) and (size > 0.0).sum() == drawn
        told = trajectory.universe.trajectory[last].data["fields/torn"]
        assert told.sum() == len(trajectory.gone(last)) and len(told) == len(trajectory.metadata.bond)
        surface = trajectory.metadata.surfaces[trajectory.metadata.surface_of[0]]
        own = trajectory.gone(last) - trajectory.metadata.first[0]
        broken = {frozenset(pair) for pair in own.tolist()}
        for number, triangle in enumerate(surface.triangle[first:], first):
            patch = surface.patch[triangle[0]]
            members = set(surface.index[surface.patch == patch, 0].tolist())
            gone = any(pair <= members for pair in broken)
            assert (left[number] == 0.0) == gone
            if number > first + 150:
                break


def test_a_liquid_beside_what_tears_is_refused():
    """It finds solids by their cells."""
    text = "object a { shape box (1, 1, 1) m position (0, 0, 1) m density 1 elasticity 1 MPa tear-strain 0.1 }\n"
    pool = "gravity (0, 0, -9.81)\nliquid w { basin from (-2, -2, 0) to (2, 2, 3) density 1000 level 0.4 }\n"
    with pytest.raises(SceneError, match="may tear, and a liquid finds objects by their cells"):
        parse_scene(text + pool + "control { time 1 s }\n")


SLIT = """object a {{
  shape sheet (0.6, 0.3) m thickness 4 mm  position (0, 0, 1) m  density 1000  elasticity 1 MPa  damping 0.5
  resolution {h} m  hold faces y  toughness {tough} J/m^2
}}
control {{ time 0.15 s }}
"""


@pytest.mark.parametrize("h", [0.02, 0.01])
@pytest.mark.parametrize(("part", "runs"), [(0.9, False), (0.95, True)])
def test_a_slit_runs_at_the_toughness(prepared, h, part, runs):
    """A strip with a slit whose sides are apart by ``part`` of what G = E (u/H)^2 H/2 (1 - nu^2) asks for: for both spacings the
    tear goes on from the end of the slit, and along it, between 0.9 and 0.95 of u, 0.81 and 0.90 of G."""
    tough, height, slit = 20.0, 0.3, -0.1
    ready = prepared(SLIT.format(h=h, tough=tough))
    system, (i, j) = ready.system, ready.system.spring.T
    y, along = system.position[:, 1], 0.5 * (system.position[i, 0] + system.position[j, 0])
    rows = np.unique(y.round(9))
    level = rows[np.searchsorted(rows, 1e-9) - 1 :][:2].mean()
    cut = ((y[i] - level) * (y[j] - level) < 0.0) & (along < slit)
    ready.plan.columns["torn"][cut] = 1
    with Instance(ready.plan) as instance:
        instance.array("x")[:, 1] = y * (1.0 + part * math.sqrt(2.0 * tough * (1.0 - 1.0 / 9.0) / (1e6 * height)))
        instance.setup()
        instance.run(ready.certificate.steps)
        more = (instance.column("torn") > 0) & ~cut
    assert np.abs(0.5 * (y[i] + y[j]) - level)[more].max(initial=0.0) < 1.5 * system.spacing[0]
    reach = along[more].max(initial=slit)
    assert reach > 0.1 if runs else reach < 0.0


@pytest.mark.parametrize(
    ("strain", "x", "told"), [("tear-strain 0.3", 0, True), ("", 0, False), ("tear-strain 0.3", 2000, False)]
)
def test_what_lies_on_a_solid_that_tears_is_told_to_sink_in(prepared, strain, x, told):
    """Not where nothing tears, nor where nothing comes."""
    ready = prepared(
        "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n"
        f"object jelly {{ material jelly  shape box (20, 20, 10) cm  position (0, 0, 5) cm  resolution 4 cm  {strain} }}\n"
        f"object ball {{ material steel  shape sphere 3 cm  position ({x}, 0, 60) cm }}\ncontrol {{ time 0.5 s }}\n"
    )
    found = [note for note in ready.certificate.notes if "sinks in" in note.message]
    assert len(found) == told
    if told:
        assert "jelly may meet ball" in found[0].message and "larger tear-strain" in found[0].hint and found[0].span.line == 3
