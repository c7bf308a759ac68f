# SPDX-License-Identifier: GPL-2.0-only
"""One spacing for all objects, division of cuboids, cells of other shapes, and what does not fit."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from mdanim_lammps.errors import SceneError
from mdanim_lammps.features.liquid.record import Liquid
from mdanim_lammps.model import build, shapes, spacing
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.cells import TooThin, _without_nubs, box_counts, fill_cells
from mdanim_lammps.model.limits import bounding_cells
from mdanim_lammps.model.spacing import plan_spacing
from mdanim_lammps.model.springs import MAX_ASPECT
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.scene.scene import Accuracy, Box, Cone, Cylinder, HoldAll, Mesh, Sphere
from model_samples import MESHES, SHAPES, model, scene, shape_id, solid

BEAM = Box((1.2, 0.3, 0.1))


@pytest.mark.parametrize(("accuracy", "h"), [(Accuracy.PREVIEW, 0.05), (Accuracy.BALANCED, 0.025), (Accuracy.REFERENCE, 0.0125)])
def test_accuracy_is_the_number_of_cells_across_the_thinnest_part(accuracy, h):
    """Divide the thinnest part of all solids, and name the solid that has it."""
    plan = plan_spacing(scene(solid(Sphere(0.3), "ball"), solid(BEAM, "beam"), accuracy=accuracy))
    assert plan.h == pytest.approx(h)
    assert plan.set_by == "beam"
    assert plan.total == sum(plan.particles)
    # Particles, vertices of the drawn ball, nine points of contact for each cell of its surface; a box has neither.
    ball = Sphere(0.3)
    more = 200 * shapes.vertices(ball, plan.h) + 300 * 9 * shapes.area(ball) / plan.h**2
    assert plan.memory == pytest.approx(1500 * plan.total + more)


def test_resolution_overrides_accuracy():
    """Take the spacing that the scene asks for."""
    plan = plan_spacing(scene(solid(BEAM), resolution=0.02))
    assert (plan.h, plan.set_by) == (0.02, "resolution")


def test_a_held_plate_asks_for_few_cells():
    """Cells of 2.5 times its thickness where something elastic can move; two across other obstacles, and in a liquid."""
    plate = solid(Box((2.0, 2.0, 0.02)), "plate", hold=(HoldAll(),))
    ball = solid(Sphere(0.5), "ball")
    assert plan_spacing(scene(plate, ball)).h == pytest.approx(0.05)
    assert plan_spacing(scene(plate, solid(Sphere(0.05), "ball"))).h == pytest.approx(0.025)
    assert plan_spacing(scene(plate, ball, resolution=0.05)).h == 0.05
    with pytest.raises(SceneError, match="plate: thinner than the spacing allows") as caught:
        plan_spacing(scene(plate, ball, resolution=0.051))
    assert "write resolution 5 cm" in caught.value.problems[0].hint
    for shape, h in ((Box((2.0, 0.07, 0.02)), 0.01), (Cylinder(0.01, 1.0), 0.01), (Cylinder(1.0, 0.02), 0.05)):
        assert plan_spacing(scene(solid(shape, "bar", hold=(HoldAll(),)), ball)).h == pytest.approx(h)
    assert plan_spacing(scene(plate, solid(Sphere(0.5), "ball", hold=(HoldAll(),)))).h == pytest.approx(0.01)
    pool = Liquid("water", (-2, -2, 0), (2, 2, 2), 1000.0, level=1.0)
    assert plan_spacing(scene(plate, ball, liquid=pool)).h == pytest.approx(0.01)


def test_a_liquid_alone_is_32_cells_wide():
    """Go by the basin where there is no solid."""
    water = Liquid("water", (-1, -2, 0), (1, 2, 1), 1000.0, level=0.5)
    plan = plan_spacing(scene(liquid=water))
    assert (plan.h, plan.set_by, plan.total) == (2 / 32, "water", 0)


def test_a_solid_thinner_than_the_resolution_is_refused():
    """Point at every solid that is too thin, with the resolution that would do, which then does."""
    thin = [solid(BEAM, "beam"), solid(Sphere(0.5), "ball"), solid(Cylinder(0.5, 0.05), "disc")]
    with pytest.raises(SceneError) as caught:
        plan_spacing(scene(*thin, resolution=0.11))
    beam, disc = caught.value.problems
    assert beam.message == "beam: thinner than the spacing allows, 10 cm at its thinnest, spacing 11 cm"
    assert "resolution 5 cm" in beam.hint and "resolution 2.5 cm" in disc.hint
    assert beam.span is thin[0].spans["shape"]
    assert len(build_models(scene(*thin, resolution=0.025))) == 3


def test_thin_objects_of_a_repeat_are_one_problem():
    """They stand at one place of the text; another shape is a problem of its own."""
    text = "repeat i in 1 .. 20 { object b[i] { shape box (SIDES) m position (3*i, 0, 0) m mass 1 kg elasticity 1 MPa } }\n"
    scenes = [
        parse_scene(text.replace("SIDES", s) + "control { time 1 s resolution 1 m }") for s in ("1, 1, 0.1", "1, 1, 0.01*i")
    ]
    found = []
    for one in scenes:
        with pytest.raises(SceneError) as caught:
            plan_spacing(one)
        found.append([p.message.split(":")[0] for p in caught.value.problems])
    assert found == [["b[1] and 19 more"], [f"b[{i}]" for i in range(1, 21)]]


def test_what_does_not_fit_in_memory_is_refused(monkeypatch):
    """Refuse with the estimate before anything is built, and offer a resolution that does fit."""
    monkeypatch.setattr(spacing, "available_memory", lambda: 2e6)
    with pytest.raises(SceneError) as caught:
        plan_spacing(scene(solid(BEAM), resolution=0.025))
    (problem,) = caught.value.problems
    assert problem.line == 9
    assert "about 3 185 particles at a spacing of 2.5 cm need 0.0 GB" in problem.message
    coarser = float(problem.hint.split()[-2]) / 100
    assert 0.025 < coarser < 0.06
    plan_spacing(scene(solid(BEAM), resolution=coarser))
    with pytest.raises(SceneError, match="beam sets the spacing"):
        plan_spacing(scene(solid(BEAM, "beam"), accuracy=Accuracy.BALANCED))


def test_a_mesh_file_in_other_units_is_named(monkeypatch):
    """Point at the mesh that has most of the particles, not at the small object that sets the spacing; offer a scale."""
    monkeypatch.setattr(spacing, "available_memory", lambda: 2e6)
    in_cm = solid(Mesh(MESHES.parents[2] / "scenes" / "meshes" / "boat.stl"), "boat")
    with pytest.raises(SceneError) as caught:
        plan_spacing(scene(in_cm, solid(Sphere(0.1), "ball")))
    (problem,) = caught.value.problems
    assert problem.message.startswith("boat is 120 m long, as its mesh file is read in metres: about")
    assert "scale 0.01" in problem.hint
    assert problem.span is in_cm.spans["shape"]
    with pytest.raises(SceneError, match="ball sets the spacing"):
        plan_spacing(scene(solid(Mesh(in_cm.shape.path, 0.5), "boat"), solid(Sphere(0.1), "ball")))


def test_an_absurd_resolution_is_refused_at_once():
    """Estimate 10^24 particles of every shape without making any."""
    for shape in SHAPES:
        with pytest.raises(SceneError, match="are free"):
            plan_spacing(scene(solid(shape), resolution=1e-8))


def test_available_memory_is_that_of_a_machine():
    """Find between 10 MB and 100 TB."""
    assert 1e7 < spacing.available_memory() < 1e14


@pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
def test_particles_are_estimated_well(shape):
    """Stay within a quarter of the true number at 3 to 10 cells across."""
    for cells in (3, 5, 10):
        h = shapes.thickness(shape) / cells
        assert spacing.estimate_particles(shape, h) == pytest.approx(len(model(shape, h).position), rel=0.25)


@pytest.mark.parametrize(
    ("size", "h", "count"),
    [
        pytest.param((1.2, 0.3, 0.1), 0.025, (48, 12, 4), id="cubes"),
        pytest.param((1.0, 1.0, 1.0), 0.3, (3, 3, 3), id="spacing grows to divide a cube"),
        pytest.param((1.0, 1.0, 1.0), 1.0, (1, 1, 1), id="one cell"),
        pytest.param((0.9, 0.6, 0.31), 0.1, (9, 6, 3), id="slightly long cells along z"),
        pytest.param((10.0, 1.0, 0.101), 0.1, (100, 10, 1), id="plate"),
        pytest.param((1.2, 2.1, 2.1), 0.5, (2, 4, 4), id="fewer, longer cells where more would be further off"),
        pytest.param((1.25, 1.25, 1.0), 0.5, (3, 3, 2), id="near the spacing: 4 x 4 x 3 are nearer to cubes"),
    ],
)
def test_cuboids_are_divided_into_near_cubes(size, h, count):
    """Find the division that has nearly cubic cells near the spacing."""
    assert box_counts(size, h) == count


@settings(max_examples=300, deadline=None)
@given(st.tuples(*[st.floats(1.0, 12.0)] * 3))
@example((1.0, 2.0, 1.25))
def test_every_cuboid_can_be_divided(size):
    """Keep the aspect up to 1.2 from two cells thickness on, and the mean edge within a factor of 2."""
    edge = np.divide(size, box_counts(size, 0.5))
    assert edge.max() / edge.min() <= MAX_ASPECT * (1 + 1e-6)
    # Three cells leave room enough (measured: at most 1.24).
    assert abs(np.log(np.prod(edge) ** (1 / 3) / 0.5)) <= np.log(1.25 if min(size) >= 1.5 else 2.0) + 1e-9


def test_a_cuboid_that_cannot_be_divided_is_refused():
    """Refuse 1 x 1.5 x 1 cells (aspect 1.5 or 1.33), and name a resolution that will do."""
    awkward = Box((0.1, 0.149, 0.1))
    with pytest.raises(SceneError) as caught:
        model(awkward, 0.1)
    (problem,) = caught.value.problems
    assert "its edges cannot be divided into nearly equal cells at 10 cm" in problem.message
    number, unit = problem.hint.split()[2:4]
    assert model(awkward, float(number) * {"cm": 0.01, "mm": 0.001}[unit])


@pytest.mark.parametrize("shape", [s for s in SHAPES if not isinstance(s, Box)], ids=shape_id)
@pytest.mark.parametrize(("cells", "error"), [(3, 0.06), (4, 0.06), (8, 0.015)])
def test_filled_cells_have_nearly_the_volume(shape, cells, error):
    """Fill the volume within a few per cent with cubes near the spacing, in one piece.

    The volume is no better because the outline counts too: a tenth of a cell that stands out weighs as much as 1 %.
    """
    from scipy import ndimage

    h = shapes.thickness(shape) / cells
    filled = fill_cells(shape, h)
    assert filled.filled.sum() * np.prod(filled.edge) == pytest.approx(shapes.volume(shape), rel=error)
    np.testing.assert_allclose(filled.edge, filled.edge[0], rtol=1e-12)
    assert abs(filled.edge[0] / h - 1) <= (0.04 if cells == 8 else 0.12) + 1e-9
    assert ndimage.label(filled.filled)[1] == 1


@pytest.mark.parametrize("shape", [Sphere(0.5), Cylinder(0.4, 1.0)], ids=shape_id)
def test_cells_are_as_symmetric_as_the_shape(shape):
    """Mirror the cells of a ball and of a rod in every plane, and turn them about z."""
    filled = fill_cells(shape, 0.13).filled
    for axis in range(3):
        np.testing.assert_array_equal(filled, np.flip(filled, axis))
    np.testing.assert_array_equal(filled, np.swapaxes(filled, 1, 2))


def test_a_body_that_falls_apart_is_refused():
    """Refuse two blocks on a thin neck when cells miss the neck, and name a resolution that catches it."""
    dumbbell = Mesh(MESHES / "dumbbell.obj", 0.1)
    with pytest.raises(SceneError) as caught:
        model(dumbbell, 0.1)
    (problem,) = caught.value.problems
    assert "not in one piece" in problem.message and problem.line == 2
    number, unit = problem.hint.split()[2:4]
    assert len(model(dumbbell, float(number) * {"cm": 0.01, "mm": 0.001}[unit]).position) > 600


@pytest.mark.parametrize(("most", "tried"), [(1e3, 1), (1e2, 0)])
def test_finer_cells_are_tried_up_to_a_number(monkeypatch, most, tried):
    """A large body in pieces is refused soon: the search ends before it has looked at millions of cells."""
    looked = []

    def fill(shape, h, loose=False):
        looked.append(h)
        raise TooThin("its cells are not in one piece")

    monkeypatch.setattr(build, "fill_cells", fill)
    monkeypatch.setattr(build, "MOST_TRIED", most)
    dumbbell = Mesh(MESHES / "dumbbell.obj", 0.1)
    with pytest.raises(SceneError) as caught:
        model(dumbbell, 0.1)
    message = caught.value.problems[0].message
    assert (" nor at " in message) == bool(tried) and "at 10 cm" in message
    cells = [bounding_cells(dumbbell, h) for h in looked[1:]]
    assert bool(cells) == bool(tried) and sum(cells) <= most < sum(cells) + bounding_cells(dumbbell, 0.8 * looked[-1])


def test_two_bodies_in_one_file_are_refused():
    """Say that separate bodies want separate objects."""
    with pytest.raises(SceneError, match=r"two-parts\.obj has 2 parts that do not hang together"):
        model(Mesh(MESHES / "two-parts.obj"), 0.5)


def test_all_problems_come_in_one_pass():
    """Report the missing mesh and the broken one together, each at its shape."""
    bodies = [solid(Mesh(MESHES / name), name) for name in ("missing.stl", "open.obj", "cuboid.obj")]
    with pytest.raises(SceneError) as caught:
        plan_spacing(scene(*bodies))
    assert [p.message.split(":")[0] for p in caught.value.problems] == ["missing.stl", "open.obj"]
    assert all(p.line == 2 and p.hint for p in caught.value.problems)


@pytest.mark.parametrize("shape", [s for s in SHAPES if not isinstance(s, Box)], ids=shape_id)
@pytest.mark.parametrize("cells", [4, 8])
def test_filled_cells_have_nearly_the_outline(shape, cells):
    """Stay within 0.4 cells of the shape on all six sides, so that others rest on it where it is drawn.

    A cone's rim is thinner than a cell: half a cell there, and the tip may end early.
    """
    low, high = shapes.extent(shape)
    filled = fill_cells(shape, shapes.thickness(shape) / cells)
    off = np.concatenate([low - filled.low, filled.high - high]) / filled.edge[0]
    if isinstance(shape, Cone):
        assert off[5] > -2.5
        off[5] = 0.0
    assert np.abs(off).max() <= (0.5 + 1e-9 if isinstance(shape, Cone) else 0.4)


def test_a_nub_is_taken_away_and_a_needle_is_not():
    """Drop a cell that stands alone on a flat face; keep the cells of a needle, one thick."""
    block = np.zeros((5, 5, 5), bool)
    block[:4] = True
    with_nub = block.copy()
    with_nub[4, 2, 2] = True
    np.testing.assert_array_equal(_without_nubs(with_nub), block)
    needle = np.ones((6, 1, 1), bool)
    np.testing.assert_array_equal(_without_nubs(needle), needle)


def test_an_object_with_a_resolution_of_its_own_has_it_alone():
    """A marble of 5 mm cells on a plate: the plate's thickness sets the spacing of the rest, the marble does not."""
    made = scene(
        solid(Box((1.0, 1.0, 0.08)), "plate"), solid(Sphere(0.02), "marble", resolution=0.005), accuracy=Accuracy.BALANCED
    )
    plan = plan_spacing(made)
    assert (plan.h, plan.of, plan.set_by) == (pytest.approx(0.02), (pytest.approx(0.02), 0.005), "plate")
    plate, marble = build_models(made)
    assert plate.spacing == pytest.approx(0.02, rel=0.05) and marble.spacing == pytest.approx(0.005, rel=0.05)
    assert plan.particles[1] == pytest.approx(len(marble.position), rel=0.1)
    assert plan_spacing(scene(*made.solids[1:])).h == 0.005  # nothing else asks


def test_the_same_shape_at_two_spacings_is_two_bodies():
    """Equal objects share arrays; those of another spacing do not."""
    models = build_models(scene(*(solid(Sphere(0.1), f"b{k}", resolution=h) for k, h in enumerate((0.05, 0.025, 0.05)))))
    assert models[0].frame is models[2].frame is not models[1].frame
    assert len(models[1].position) > 3 * len(models[0].position)


def test_a_spacing_of_its_own_is_checked_and_named():
    """Too thin for its own spacing, or too large for the memory: the message points at the object's line."""
    with pytest.raises(SceneError, match=r"marble: thinner than the spacing allows, 4 cm at its thinnest, spacing 5 cm") as error:
        plan_spacing(scene(solid(BEAM), solid(Sphere(0.02), "marble", resolution=0.05), resolution=0.02))
    assert "write resolution 2 cm in it" in str(error.value)
    with pytest.raises(SceneError, match="ball: about") as error:
        plan_spacing(scene(solid(BEAM), solid(Sphere(1.0), "ball", resolution=1e-4), resolution=0.02))
    assert "in it" in str(error.value)


def test_scaled_spacings_are_those_of_objects_alone():
    """A study makes all spacings finer together; a preview takes them away."""
    made = scene(solid(BEAM), solid(Sphere(0.2), "ball", resolution=0.05), resolution=0.02)
    assert [s.resolution for s in spacing.scaled(made, 0.5).solids] == [None, 0.025]
    assert [s.resolution for s in spacing.scaled(made, None).solids] == [None, None]


@pytest.mark.parametrize("size", [(4.5, 11.045, 25.23), (5.255, 6.735, 8.87), (0.3, 7, 9)])
def test_rigid_plates_in_a_liquid_have_cells_of_any_aspect(prepared, size):
    """Springs ask for nearly cubic ones, which these do not have at this spacing; the whole volume is in them."""
    text = (
        "gravity (0, 0, -9.81)\nliquid l { basin from (-40, -40, 0) cm to (40, 40, 60) cm  density 1000  level 30 cm }\n"
        f"object plate {{ shape box {size} cm  position (0, 0, 45) cm  density 500  elasticity rigid }}\n"
        "control { time 0.1 s  resolution 5 cm }\n"
    )
    volume = 1e-6 * np.prod(size)
    assert prepared(text).system.volume.sum() == pytest.approx(volume)
    with pytest.raises(SceneError, match="thin"):
        prepared(text.replace("elasticity rigid", "elasticity 1 MPa"))


def test_cells_of_a_liquid_are_those_of_what_displaces_most():
    """A hull with a sail beside a quay: a fourth of the hull's thickness, however thin the sail and however thick the quay. So
    are those of the sail; where something soft reads its surface they are as long as it is thin."""
    scene = (
        "gravity (0, 0, -9.81) m/s^2\nliquid water { basin from (-2, -1, 0) m to (2, 1, 2) m density 1000 level 0.6 m }\n"
        "object quay { shape box (1, 1, 1) m position (1.2, 0, 0.5) m density 3000 elasticity rigid hold all }\n"
        "object hull { shape box (80, 30, 18) cm position (-1.2, 0, 0.64) m density 300 elasticity rigid }\n"
        "object sail { shape box (1, 50, 50) cm position (-1.18, 0, 1.2) m density 40 elasticity rigid }\n"
        "control { time 1 s }\n"
    )
    plan = plan_spacing(parse_scene(scene))
    assert plan.set_by == "hull" and plan.h == pytest.approx(0.045)
    assert plan.of[2] == plan.h and plan.particles[2] < 400  # one cell across
    soft = "object duck { shape sphere 10 cm  position (0, 0.5, 0.7) m  density 300  elasticity 1 MPa }\ncontrol {"
    assert plan_spacing(parse_scene(scene.replace("control {", soft))).of[2] == pytest.approx(0.01)
