# SPDX-License-Identifier: GPL-2.0-only
"""Basins: their cells, and what does not fit into them, told before anything runs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mdanim_lammps import features
from mdanim_lammps.effects import resolve
from mdanim_lammps.errors import SceneError, Span
from mdanim_lammps.features.liquid import basin
from mdanim_lammps.features.liquid.record import Current, Inflow, Liquid, LiquidModel, Puddle
from mdanim_lammps.model import shapes
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.spacing import choose_spacing
from mdanim_lammps.model.system import assemble
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.rotation import rotation_euler
from mdanim_lammps.scene.scene import Box, HoldAll, HoldFaces, Mesh, Side, Switch
from model_samples import MESHES, SHAPES, scene, shape_id, solid
from paths import REPOSITORY

WATER = Liquid(
    "water",
    (0.0, 0.0, 0.0),
    (1.0, 1.0, 1.0),
    1000.0,
    volume=0.5,
    spans={word: Span("test.txt", line, 3) for line, word in enumerate(("basin", "volume", "level"), 11)},
)
CUBE = Box((0.4, 0.4, 0.4))
ABOVE = (0.5, 0.5, 1.5)


def block(shape=CUBE, name="block", position=ABOVE, density=500.0, **rest):
    """A solid of this density."""
    return solid(shape, name, position=position, mass=None, density=density, **rest)


def grid_of(made):
    """Its cells."""
    return basin.plan_grid(made.liquid, choose_spacing(made)[0])


def falling(*solids, h=0.1, liquid=WATER):
    """A scene with gravity."""
    return replace(scene(*solids, resolution=h, liquid=liquid), gravity=(0.0, 0.0, -9.81))


def problems(*solids, h=0.1, effects=None, **liquid):
    """Problems of these solids and this liquid."""
    made = replace(falling(*solids, h=h, liquid=replace(WATER, **liquid)), effects=effects or {})
    resolved = resolve(features.effects(), made)
    return [p for e in resolved.effects for p in e.problems(resolved, build_models(made), grid_of(made))]


# --- cells --------------------------------------------------------------------------------------------------


@settings(derandomize=True)
@given(st.tuples(*[st.floats(0.2, 5.0)] * 3), st.floats(0.01, 0.06))
def test_cells_fill_the_basin_and_are_hardly_longer_than_the_spacing(size, h):
    """Divide every side into whole cells, up to a tenth longer than the spacing; a third off below ten."""
    grid = basin.plan_grid(replace(WATER, high=size), h)
    for side, n, edge in zip(size, grid.shape, grid.cell):
        assert n * edge == pytest.approx(side, rel=1e-12)
        low, high = (0.999999, 1.1) if side >= 10 * h else (2 / 3, 4 / 3)
        assert low * h <= edge <= high * h * (1 + 1e-9)


def test_volume_is_rounded_to_whole_cells():
    """Round to the nearest number of cells."""
    grid = basin.plan_grid(WATER, 0.1)
    assert (grid.shape, grid.cells) == ((10, 10, 10), 1000)
    assert [grid.units(x) for x in (0.5, 0.50049, 0.50051, 0.0004)] == [500, 500, 501, 0]


def test_cells_belong_to_a_region_by_their_centre():
    """Count a cell whose centre is inside, as the fix does."""
    grid = basin.plan_grid(WATER, 0.1)
    assert grid.cells_within((0, 0, 0), (1, 1, 1)) == 1000
    assert grid.cells_within((0.04, 0, 0), (0.24, 1, 0.26)) == 2 * 10 * 3


@pytest.mark.parametrize(
    ("liquid", "level"),
    [
        pytest.param({"volume": 0.5}, 0.5, id="volume"),
        pytest.param({"volume": None, "level": 0.3}, 0.3, id="level"),
        pytest.param({"volume": None, "level": 0.8, "fill": ((0.0, 0.0, 0.4), (0.5, 1.0, 1.0))}, 0.2, id="dam"),
        pytest.param(
            {
                "volume": None,
                "level": 0.8,
                "fill": ((0.0, 0.0, 0.4), (0.5, 1.0, 1.0)),
                "pool": (Puddle((0.5, 0, 0), (1, 1, 0.2)),),
            },
            0.3,
            id="pool",
        ),
    ],
)
def test_level_at_rest(liquid, level):
    """Spread what is poured over the whole floor."""
    assert basin.liquid_level(replace(WATER, **liquid)) == pytest.approx(level, rel=1e-12)


# --- particles' volumes -------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
def test_particles_share_the_true_volume(shape):
    """Give each particle a part of the true volume, by its cells: masses, which are fitted to moments, are not in proportion."""
    h = shapes.thickness(shape) / 4
    made = scene(solid(shape, "a"), solid(CUBE, "b", position=(9.0, 0, 0), mass=3.0), resolution=min(h, 0.1))
    system = assemble(build_models(made), made)
    one, two = np.add.reduceat(system.volume, system.first[:-1])
    assert one == pytest.approx(shapes.volume(shape), rel=1e-12) and two == pytest.approx(0.064, rel=1e-12)
    cells = np.add.reduceat(system.share, system.first[:-1])
    of_a_cell = np.array([shapes.volume(shape), 0.064]) / cells
    np.testing.assert_allclose(system.volume, system.share * of_a_cell[system.object], rtol=1e-12)
    assert np.ptp(system.mass[system.object == 0] / system.volume[system.object == 0]) > 0.1 / shapes.volume(shape)
    assert np.array_equal(np.unique(system.hexahedron), np.arange(system.particles))
    assert (system.object[system.hexahedron] == system.object[system.hexahedron[:, :1]]).all()


# --- what does not fit --------------------------------------------------------------------------------------


def test_a_basin_with_a_floating_block_is_fine():
    """Find nothing wrong, also with an obstacle that sticks out of the basin."""
    pillar = block(Box((0.2, 0.2, 3.0)), "pillar", (0.1, 0.1, 1.0), hold=(HoldAll(),))
    assert not problems(block(), pillar)


def test_a_basin_too_narrow_is_told():
    """Ask for three cells along every side, and offer a resolution that gives them."""
    (problem,) = problems(block(Box((0.1, 0.1, 0.1))), h=0.1, high=(1.0, 0.2, 1.0), volume=0.01)
    assert problem.line == 11 and "2 cells wide along y" in problem.message
    assert "resolution 6 cm" in problem.hint
    assert not problems(block(Box((0.1, 0.1, 0.1))), h=0.06, high=(1.0, 0.2, 1.0), volume=0.01)


def test_a_basin_too_large_for_memory_is_told_before_models_are_made(monkeypatch):
    """Millions of particles take longer than a refusal may."""
    monkeypatch.setattr(basin, "available_memory", lambda: 1e4)
    monkeypatch.setattr("mdanim_lammps.run.prepare.build_models", lambda *_, **__: pytest.fail("models are made"))
    with pytest.raises(SceneError, match="GB are free"):
        prepare(falling(block()))


def test_a_basin_too_large_for_memory_is_told(monkeypatch):
    """Refuse with the estimate and a resolution that will do."""
    monkeypatch.setattr(basin, "available_memory", lambda: 1e4)
    (problem,) = problems(h=0.1)
    assert problem.line == 11 and "1 000 cells of 10 cm" in problem.message and "are free" in problem.message
    coarser = float(problem.hint.split()[2]) / 100
    assert basin.plan_grid(WATER, coarser).cells * basin.BYTES_PER_CELL <= 1e4


def test_waves_that_no_checkpoint_holds_are_told(monkeypatch):
    """Refuse more state than LAMMPS can count in a restart file, with a resolution that will do."""
    monkeypatch.setattr(basin, "available_memory", lambda: 1e12)
    waves, fine = replace(WATER, model=LiquidModel.WAVES), 1.1e-3
    (problem,) = basin.too_large(waves, basin.plan_grid(waves, fine))
    assert "are the most that waves can have" in problem.message
    coarser = float(problem.hint.split()[2]) * {"cm": 1e-2, "mm": 1e-3}[problem.hint.split()[3].rstrip(",")]
    assert not basin.too_large(waves, basin.plan_grid(waves, coarser))


def test_a_drop_is_no_liquid():
    """Refuse less than half a cell."""
    (problem,) = problems(block(), volume=4e-4)
    assert problem.line == 12 and "less than half a cell of 1 l" in problem.message
    assert not problems(block(), volume=6e-4)


@pytest.mark.parametrize(("volume", "fits"), [(0.93, True), (0.94, False)])
def test_liquid_has_room_only_beside_what_stands_in_it(volume, fits):
    """Take off the room of 0.064 m^3 that a held block fills at the start."""
    found = problems(block(position=(0.5, 0.5, 0.3), hold=(HoldAll(),)), volume=volume)
    assert fits == (not found)
    if not fits:
        assert found[0].line == 12 and "has room for 936 l" in found[0].message


@pytest.mark.parametrize(("volume", "fits"), [(0.46, True), (0.48, False)])
def test_liquid_has_room_only_in_what_is_filled(volume, fits):
    """The same with a fill region that half of the block stands in."""
    found = problems(block(position=(0.5, 0.5, 0.3), hold=(HoldAll(),)), volume=volume, fill=((0.0, 0.0, 0.0), (0.5, 1.0, 1.0)))
    assert fits == (not found)
    if not fits:
        assert "the part that is filled has room for 468 l" in found[0].message


@pytest.mark.parametrize(
    ("density", "rest", "fits"),
    [
        pytest.param(500.0, {}, True, id="floats: displaces half of its volume"),
        pytest.param(2000.0, {}, False, id="sinks: displaces all of it"),
        pytest.param(500.0, {"model": LiquidModel.PAPER}, False, id="the paper's model: may sink"),
        pytest.param(500.0, {"effects": {"buoyancy": Switch.OFF}}, False, id="without buoyancy"),
        pytest.param(2000.0, {"effects": {"liquid": Switch.OFF}}, True, id="without liquid"),
    ],
)
def test_a_body_needs_room_to_sink_in(density, rest, fits):
    """Refuse 0.064 m^3 into a basin with 0.05 m^3 of room, at its place."""
    found = problems(block(density=density), volume=0.95, **rest)
    assert fits == (not found)
    if not fits:
        assert found[0].line == 2 and "block displaces up to 64 l" in found[0].message
        assert "room for 50 l more" in found[0].message


def test_bodies_that_fit_alone_may_not_fit_together():
    """Add up what they displace."""
    two = [block(name=name, position=(x, 0.5, 1.5), density=2000.0) for name, x in (("a", 0.25), ("b", 0.75))]
    (problem,) = problems(*two, volume=0.9)
    assert problem.line == 12 and "together displace up to 128 l" in problem.message
    assert not problems(two[0], volume=0.9)


def test_a_body_held_at_one_side_takes_the_room_that_it_has():
    """Let a beam over the basin be: it cannot fall in."""
    ends = HoldFaces((Side.MINUS_X, Side.PLUS_X))
    beam = block(Box((1.0, 0.4, 0.4)), density=2000.0, position=(0.5, 0.5, 1.3), hold=(ends,))
    assert not problems(beam, volume=0.95)


def test_a_level_fits_wherever_it_is():
    """Fill up to a level beside what stands there, and keep that amount in mind for what falls in."""
    standing = block(position=(0.5, 0.5, 0.2), hold=(HoldAll(),))
    assert not problems(standing, volume=None, level=1.0)
    (problem,) = problems(standing, block(density=3000.0), volume=None, level=0.95)
    assert "room for 50 l more" in problem.message


def test_a_mesh_displaces_its_own_volume():
    """Weigh the density of a mesh by the volume that it encloses."""
    shape = Mesh(MESHES / "knot.ply", 0.003)
    room = math.prod(WATER.high)
    volume = shapes.volume(shape)
    made = dict(shape=shape, density=2000.0, position=(0.5, 0.5, 2.0))
    h = shapes.thickness(shape) / 2
    if basin.plan_grid(WATER, h).cells > 1e6:
        pytest.skip("the mesh is too fine for this basin")
    assert not problems(block(**made), h=h, volume=room - 1.01 * volume)
    assert problems(block(**made), h=h, volume=room - 0.99 * volume)


def test_a_level_of_no_cell_is_told():
    """Refuse a level that leaves the basin dry, at its line."""
    (problem,) = problems(block(), volume=None, level=4e-4)
    assert problem.line == 13 and "less than half a cell" in problem.message
    assert not problems(block(), volume=None, level=6e-3)


def test_a_part_to_fill_between_cell_centres_is_told():
    """Say that no cell has its centre there, not that there is no room."""
    (problem,) = problems(block(), fill=((0.06, 0.0, 0.0), (0.14, 1.0, 1.0)))
    assert "no cell of the basin has its centre" in problem.message and "resolution 7.2 cm" in problem.hint
    assert not problems(block(), fill=((0.0, 0.0, 0.0), (0.08, 1.0, 1.0)), volume=0.05)


@pytest.mark.parametrize(("across", "along", "fits"), [(0.9, 0.9, False), (0.8, 0.9, True), (0.9, 0.4, True)])
def test_a_body_must_leave_liquid_beside_it(across, along, fits):
    """Refuse a raft with less than one and a half cells beside it along both axes: nothing tells how deep it floats."""
    found = problems(block(Box((across, along, 0.3))), volume=0.3)
    assert fits == (not found)
    if not fits:
        assert found[0].line == 2 and "fills the basin from wall to wall but for 10 cm" in found[0].message
    assert not problems(block(Box((across, along, 0.3)), hold=(HoldAll(),)), volume=0.3)


BOAT = Mesh(REPOSITORY / "scenes/meshes/boat.stl", 0.01)


def test_an_open_hull_is_told():
    """Warn of the boat under model surface, not of a duck, nor in waves, which know the air in a hull."""

    def told(shape, **liquid):
        made = scene(block(shape, "boat"), resolution=0.03, liquid=replace(WATER, high=(2.0, 2.0, 2.0), **liquid))
        return basin.open_hulls(made, build_models(made))

    (warning,) = told(BOAT, model=LiquidModel.SURFACE)
    assert warning.severity == "warning" and "boat is open and hollow" in warning.message
    assert "leave model surface out" in warning.hint
    assert not told(BOAT)
    assert not told(Mesh(BOAT.path.with_name("duck.ply"), 0.03), model=LiquidModel.SURFACE)


@pytest.mark.parametrize(
    ("size", "more", "told"),
    [
        pytest.param((0.8, 0.8, 0.1), {"hold": (HoldAll(),)}, "", id="a shelf"),
        pytest.param((0.8, 0.8, 0.1), {"hold": (HoldAll(),), "rotation": rotation_euler((0.6, 0.0, 0.0))}, "", id="it slopes"),
        pytest.param(
            (0.8, 0.8, 0.19), {"hold": (HoldAll(),), "rotation": rotation_euler((0.8, 0.0, 0.0))}, "1.9 cells", id="steep"
        ),
        pytest.param((0.8, 0.8, 0.2), {"hold": (HoldAll(),), "rotation": rotation_euler((0.8, 0.0, 0.0))}, "", id="of two cells"),
        pytest.param((0.1, 0.8, 0.8), {"hold": (HoldAll(),)}, "", id="an upright wall"),
        pytest.param((0.1, 0.8, 0.8), {"hold": (HoldAll(),), "rotation": rotation_euler((0.0, 0.0, 0.5))}, "", id="turned"),
        pytest.param((0.1, 0.8, 0.8), {"hold": (HoldAll(),), "rotation": rotation_euler((0.0, 0.1, 0.0))}, "1 cells", id="leans"),
        pytest.param(
            (0.1, 0.8, 0.8),
            {"hold": (HoldAll(),), "position": (0.5, 0.5, 1.5), "rotation": rotation_euler((0.0, 0.1, 0.0))},
            "",
            id="above the basin",
        ),
        pytest.param((0.8, 0.8, 0.1), {}, "", id="a plank afloat"),
        pytest.param((0.8, 0.1, 0.1), {}, "", id="a rod"),
    ],
)
def test_what_leaks_is_told(size, more, told):
    """Warn of what is too thin to hold a liquid with momentum, by its name and thickness, with a resolution that will do."""

    def warnings(h, **liquid):
        made = scene(
            block(Box(size), "plank", **{"position": (0.5, 0.5, 0.5), **more}), resolution=h, liquid=replace(WATER, **liquid)
        )
        return basin.leaky_walls(made, build_models(made), grid_of(made))

    found = warnings(0.1)
    assert [w.severity for w in found] == ["warning"] * bool(told)
    assert not warnings(0.1, model=LiquidModel.SURFACE)
    if told:
        assert found[0].message.startswith(f"plank: {shapes.thickness(Box(size)) * 100:g} cm thick, {told} of water")
        amount, unit = found[0].hint.split("resolution ")[1].split(" in control")[0].split()
        assert not warnings(float(amount) * {"cm": 0.01, "mm": 0.001}[unit])


@pytest.mark.parametrize(
    ("maker", "told"),
    [
        ({"current": (Current("-x", 12.0),)}, ""),
        ({"current": (Current("-x", 13.0),)}, "the current comes at 13 m/s"),
        ({"inflow": (Inflow((0.0, 0.0, 0.0), (0.5, 0.5, 0.5), 0.1, (0.0, -1e9, 0.0)),)}, "the inflow comes at 1e9 m/s"),
    ],
)
def test_liquid_that_comes_too_fast_is_refused(maker, told):
    """In a basin of 1 m liquid flows at 4 sqrt(9.81) = 12.5 m/s at most."""
    made = replace(scene(resolution=0.1, liquid=replace(WATER, **maker)), gravity=(0.0, 0.0, -9.81))
    found = basin.check_basin(made, (), grid_of(made), lifts=True)
    assert [p.severity for p in found] == ["error"] * bool(told)
    if told:
        assert found[0].message.startswith(told) and "at 12.5 m/s at most" in found[0].message
        assert found[0].hint.startswith("write at most 12 m/s")


@pytest.mark.parametrize(("size", "told"), [((0.1, 0.8, 0.8), 1), ((0.106, 0.8, 0.8), 0), ((0.8, 0.8, 0.1), 0)], ids=str)
def test_upright_walls_of_less_than_a_cell_are_told(size, told):
    """A basin whose side is not a multiple of the spacing has cells of 10.6 cm: a wall of 10 cm leaves some of each open, a shelf
    is cut all the same."""
    made = scene(
        block(Box(size), "wall", position=(0.5, 0.5, 0.5), hold=(HoldAll(),)),
        resolution=0.1,
        liquid=replace(WATER, high=(1.06,) * 3),
    )
    found = basin.leaky_walls(made, build_models(made), grid_of(made))
    assert len(found) == told
    if told:
        assert found[0].message.startswith(
            "wall: 10 cm thick, 0.943 cells of water, which leaks through what is thinner than a cell"
        )
        assert found[0].hint == "write resolution 9 cm in control, or make it 11 cm thick"


def test_hulls_that_leak_are_told():
    """Its planks are 7 cm thick: the boat is told where cells are larger than half of that."""
    for h, told in ((0.04, 1), (0.034, 0)):
        made = scene(block(BOAT, "boat"), resolution=h, liquid=replace(WATER, high=(2.0, 2.0, 2.0)))
        assert len(basin.leaky_walls(made, build_models(made), grid_of(made))) == told


def test_what_a_hull_encloses():
    """The boat's inside is about as large as its planks: the hull without them, 118 l, less 60 l."""
    made = scene(block(BOAT, "boat"), resolution=0.025, liquid=replace(WATER, high=(2.0, 2.0, 2.0)))
    (model,) = build_models(made)
    # Whole cells of 2.5 cm on planks of 7 cm.
    assert basin.enclosed(made.solids[0], model) == pytest.approx(58 / 60, abs=0.1)
