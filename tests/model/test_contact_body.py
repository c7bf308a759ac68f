# SPDX-License-Identifier: GPL-2.0-only
"""Points and depths of undeformed bodies, and how systems and plans come by them."""

from dataclasses import fields, replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from mdanim_lammps.effects import Effect
from mdanim_lammps.engine.sub_plan import SubPlans
from mdanim_lammps.model import contact_body, shapes
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.cells import fill_cells
from mdanim_lammps.model.contact_body import DENSE, FINE, FLAT, SHARP, BodyFrame, make_contact_body
from mdanim_lammps.model.distance import distance, grid_distance
from mdanim_lammps.model.lattice import CORNERS, Cells, make_lattice
from mdanim_lammps.model.spread import _nearest_again, spread
from mdanim_lammps.model.system import assemble
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.scene import Box, Cone, Cylinder, Ellipsoid, Mesh, Sphere, Torus
from model_samples import SHAPES, rotation, scene, shape_id, solid
from paths import MESHES, SCENES
from scipy.spatial import cKDTree

ROUND = [s for s in SHAPES if not isinstance(s, Box)]
SMOOTH = [Sphere(0.5), Ellipsoid((0.6, 0.4, 0.3)), Torus(1.0, 0.3)]
SHARP_EDGED = [Cylinder(0.4, 1.0), Cone(0.5, 1.2)]


@cache
def cells_of(shape, across=5) -> Cells:
    """Cells of a shape, so many across its thickness, 3 for a mesh, with the centre of mass of the lattice at the origin."""
    across = 3 if isinstance(shape, Mesh) else across
    return make_lattice(fill_cells(shape, shapes.thickness(shape) / across)).cells


@cache
def body_of(shape, across=5):
    """The contact body of a shape, so many cells across its thickness."""
    return make_contact_body(shape, cells_of(shape, across))


def spline(body, X) -> np.ndarray:
    """Depth [m], shape (P,), at lattice coordinates (P, 3)."""
    grid = body.depth.reshape(*(body.count[::-1] + 5))
    nearest = np.rint(X).astype(int)
    u = X - nearest
    factor = np.stack([(0.5 - u) ** 2 / 2, 0.75 - u**2, (0.5 + u) ** 2 / 2])
    total = np.zeros(len(X))
    for step in product(range(3), repeat=3):
        x, y, z = (nearest + step + 1).T
        total += np.prod([factor[s, :, a] for a, s in enumerate(step)], axis=0) * grid[z, y, x]
    return total


def metres(body, cells, X) -> np.ndarray:
    """Lattice coordinates as places in the body frame [m]."""
    return cells.low + X * body.edge


def corners(body) -> tuple[np.ndarray, np.ndarray]:
    """Particles at the corners of the cells that carry the points, and their trilinear weights, each of shape (P, 8)."""
    nx, ny, _ = body.count
    cell = np.stack([body.cell % nx, body.cell // nx % ny, body.cell // (nx * ny)], axis=1)
    x, y, z = np.moveaxis(cell[:, None] + CORNERS, 2, 0)
    node = x + (nx + 1) * (y + (ny + 1) * z)
    particle = np.searchsorted(body.node, node)
    np.testing.assert_array_equal(body.node[particle], node)
    t = (body.at - cell)[:, None]
    return particle, np.where(CORNERS == 1, t, 1 - t).prod(axis=2)


# --- cuboids ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [(1, 1, 1), (4, 4, 4), (1, 2, 3), (5, 3, 2)])
def test_a_cuboid_has_the_points_of_the_definition(count):
    """Walk over the sides and their particles one by one: numbers, places, middles, normals, areas, kinds and order."""
    edge = np.array([0.1, 0.11, 0.09])
    high = edge * count / 2
    body = make_contact_body(Box(tuple(2 * high)), Cells(np.ones(count[::-1], bool), -high, high))
    expected = []
    for side in range(6):
        axis, end = divmod(side, 2)
        for z, y, x in product(*(range(n + 1) for n in count[::-1])):
            node = np.array([x, y, z])
            if node[axis] != end * count[axis]:
                continue
            area, centre, sharp = 1.0, node.astype(float), FLAT
            for a in {0, 1, 2} - {axis}:
                area *= edge[a]
                if node[a] in (0, count[a]):
                    area, sharp = area / 2, SHARP
                    centre[a] += 0.25 if node[a] == 0 else -0.25
            cell = np.minimum(node, np.array(count) - 1)
            flat = cell[0] + count[0] * (cell[1] + count[1] * cell[2])
            expected.append((sharp, flat, node, centre, np.eye(3)[axis] * (2 * end - 1), area))
    expected.sort(key=lambda point: point[0])
    kind, cell, at, centre, normal, area = (np.array(column) for column in zip(*expected))
    for name, column in dict(kind=kind, cell=cell, at=at, centre=centre, normal=normal).items():
        np.testing.assert_array_equal(getattr(body, name), column, err_msg=name)
    np.testing.assert_allclose(body.area, area, rtol=1e-14)
    np.testing.assert_array_equal(body.node, np.arange(np.prod(np.array(count) + 1)))
    assert body.depth is None
    assert body.filled.all()


def test_types_are_those_of_the_plugin():
    """Contiguous arrays of the types that the C function takes, not to be changed."""
    expected = dict(count="i4", node="i4", filled="u1", cell="i4", kind="u1", sharer="i4")
    for body in map(body_of, SHAPES):
        for name in (field.name for field in fields(body)):
            array = getattr(body, name)
            if not isinstance(array, np.ndarray):
                continue
            assert array.dtype == expected.get(name, "f8"), name
            assert array.flags.c_contiguous, name
            assert not array.flags.writeable, name
        points = len(body.cell)
        assert body.at.shape == body.centre.shape == body.normal.shape == (points, 3)
        assert body.area.shape == body.kind.shape == (points,)


# --- all shapes -------------------------------------------------------------------------------------------------------


def acting(body):
    """Which points act together: fine ones, and all others."""
    fine = body.kind == FINE
    return [~fine, fine] if fine.any() else [~fine]


@pytest.mark.parametrize(
    ("shape", "h", "fine"),
    [
        pytest.param(Sphere(0.2), 0.1, True, id="a ball of four cells"),
        pytest.param(Sphere(0.3), 0.1, False, id="of six"),
        pytest.param(Ellipsoid((0.2, 0.3, 0.3)), 0.1, True, id="an ellipsoid"),
        pytest.param(Cylinder(0.2, 0.4), 0.1, False, id="a cylinder touches along lines"),
    ],
)
def test_balls_of_few_cells_have_fine_points(shape, h, fine):
    """A ninth of the least radius apart, behind all dense ones; every other shape has none."""
    (model,) = build_models(scene(solid(shape), resolution=h))
    body = model.frame.contact
    is_fine = body.kind == FINE
    assert is_fine.any() == fine
    assert (np.diff(body.kind.astype(int)) >= 0).all()
    if fine:
        assert shapes.area(shape) / is_fine.sum() == pytest.approx((shapes.thickness(shape) / 18) ** 2, rel=0.1)


@pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
def test_areas_sum_to_the_drawn_surface(shape):
    """Every part of the surface belongs to one of the points that act together."""
    body = body_of(shape)
    for some in acting(body):
        assert body.area[some].sum() == pytest.approx(shapes.area(shape), rel=1e-9)


@pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
def test_forces_of_an_even_pressure_cancel(shape):
    """Areas times outward normals sum to nothing over a closed surface, and their work on a growing body is three volumes."""
    cells, body = cells_of(shape), body_of(shape)
    force = body.area[:, None] * body.normal
    for some in acting(body):
        assert abs(force[some].sum(axis=0)).max() < 2e-3 * body.area[some].sum()
        assert (metres(body, cells, body.centre) * force)[some].sum() == pytest.approx(3 * shapes.volume(shape), rel=5e-3)


@pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
def test_weights_reproduce_points_at_rest_and_in_a_rotation(shape):
    """Points are carried by filled cells: moved with the particles, they are where a rigid body has them."""
    cells = cells_of(shape)
    lattice, body = make_lattice(cells), body_of(shape)
    assert body.filled[body.cell].all()
    particle, weight = corners(body)
    turned = np.array(rotation(0.3, -0.7, 1.1)).T
    for matrix in (np.eye(3), turned):
        moved = np.einsum("pc,pcd->pd", weight, (lattice.position @ matrix + 0.5)[particle])
        np.testing.assert_allclose(moved, metres(body, cells, body.at) @ matrix + 0.5, atol=1e-12)


@pytest.mark.parametrize("shape", ROUND, ids=shape_id)
def test_points_are_carried_by_the_nearest_filled_cell(shape):
    """No middle of a filled cell is nearer than that of the carrier."""
    body = body_of(shape)
    z, y, x = np.nonzero(body.filled.reshape(body.count[::-1]))
    middle = (np.stack([x, y, z], axis=1) + 0.5) * body.edge
    nearest, _ = cKDTree(middle).query(body.at * body.edge)
    nx, ny, _ = body.count
    carrier = np.stack([body.cell % nx, body.cell // nx % ny, body.cell // (nx * ny)], axis=1) + 0.5
    np.testing.assert_allclose(np.linalg.norm((body.at - carrier) * body.edge, axis=1), nearest, atol=1e-12)


@pytest.mark.parametrize("shape", [*ROUND, Ellipsoid((0.2, 0.4, 0.8)), Cylinder(0.1, 2.0)], ids=shape_id)
def test_points_are_spread_evenly_over_the_true_surface(shape):
    """Equal areas and no two points near each other; of a mesh, areas and distances differ more."""
    spacing = shapes.thickness(shape) / (8 if isinstance(shape, Mesh) else 20)
    point, normal, area = spread(shape, spacing)
    apart = cKDTree(point).query(point, 2)[0][:, 1] / spacing
    least, mean, differ = (0.0, 0.7, 0.4) if isinstance(shape, Mesh) else (0.65, 0.9, 1e-12)
    assert apart.min() > least
    assert apart.mean() > mean
    assert area.std() < differ * area.mean()
    assert area.mean() == pytest.approx(spacing**2, rel=0.03)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1, rtol=1e-12)
    off = shapes.depth(shape, point) if isinstance(shape, Mesh) else distance(shape, point)
    assert abs(off).max() < (0.1 if isinstance(shape, Mesh) else 1e-12) * spacing
    if not isinstance(shape, Mesh):
        for other, step in product(np.eye(3), (-1e-3, 1e-3)):
            # Away from creases, the direction in which the distance changes most.
            change = (distance(shape, point + step * spacing * other) / (step * spacing)) + normal @ other
            assert np.quantile(abs(change), 0.99) < 0.01


def test_points_of_a_mesh_keep_the_sides_of_a_sheet_apart():
    """Normals of a mesh are those of its faces but for points on bends: no mean of two sides that face each other."""
    shape = Mesh(MESHES / "knot.ply", 0.01)
    spacing = shapes.thickness(shape) / 8
    point, normal, _ = spread(shape, spacing)
    rise = [shapes.depth(shape, point + sign * 0.5 * spacing * normal) for sign in (-1, 1)]
    assert np.quantile((rise[0] - rise[1]) / spacing, 0.01) > 0.9


# --- depth ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", ROUND, ids=shape_id)
def test_depth_is_the_distance_at_the_nodes(shape):
    """The spline goes through the signed distance at every node that has both neighbours, and lies near it in between."""
    cells, body = cells_of(shape), body_of(shape)
    at = [np.arange(-4.0, n + 5.0) for n in body.count]
    expected = grid_distance(shape, *(low + edge * x for low, edge, x in zip(cells.low, cells.edge, at)))[3:-3, 3:-3, 3:-3]
    z, y, x = np.meshgrid(*(x[3:-3] for x in at[::-1]), indexing="ij")
    X = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    np.testing.assert_allclose(spline(body, X), expected.ravel(), atol=1e-9 * float(body.edge.min()))


@pytest.mark.parametrize("shape", ROUND, ids=shape_id)
def test_depth_is_nothing_on_the_surface(shape):
    """On a smooth surface to a hundredth of a cell; the spline rounds edges and tips, where it is off by less than 0.4 cells."""
    body = body_of(shape, across=8)
    off = abs(spline(body, body.at)) / body.edge.min()
    assert off.max() < (0.012 if type(shape) in map(type, SMOOTH) else 0.4)
    assert np.median(off) < (0.02 if isinstance(shape, Mesh) else 0.01)


@pytest.mark.parametrize("shape", ROUND, ids=shape_id)
def test_depth_grows_against_the_normals(shape):
    """Its gradient is the inward normal: to 3 degrees on a smooth surface, and in the mean of one with edges to 12."""
    body = body_of(shape, across=8)
    step = 1e-4
    change = [(spline(body, body.at + step * e) - spline(body, body.at - step * e)) / (2 * step) for e in np.eye(3)]
    gradient = np.stack(change, axis=1) / body.edge
    along = -(gradient * body.normal).sum(axis=1) / np.linalg.norm(gradient, axis=1)
    if type(shape) in map(type, SMOOTH):
        assert along.min() > np.cos(np.radians(3))
    assert along.mean() > np.cos(np.radians(12))


def test_the_spline_is_linear_where_its_values_are():
    """Coefficients of a linear function are its values."""
    z, y, x = np.indices((6, 7, 8))
    values = 2.0 * x - 3.0 * y + 0.5 * z + 1.0
    np.testing.assert_allclose(contact_body._spline(values), values, atol=1e-13)


@pytest.mark.parametrize(
    "shape", [Ellipsoid((0.6, 0.4, 0.3)), Ellipsoid((0.5, 0.5, 0.1)), *SHARP_EDGED, Torus(1.0, 0.3)], ids=shape_id
)
def test_distance_is_that_of_the_nearest_of_many_points(shape):
    """In and around a body, in its middle and on its planes of symmetry."""
    low, high = shapes.extent(shape)
    size = high - low
    places = np.random.default_rng(5).uniform(low - 0.3 * size, high + 0.3 * size, (600, 3))
    places[:50, 2] = 0.0
    places[50:60] *= 1e-3
    places[60] = 0.0
    spacing = float(size.min()) / 100
    nearest, _ = cKDTree(spread(shape, spacing).point).query(places)
    found = distance(shape, places)
    # The points are never nearer than the surface, and there is one within a spacing of the nearest place.
    too_far = (nearest - abs(found)) / spacing
    assert -1e-9 < too_far.min() < too_far.max() < 1
    assert np.median(too_far) < 0.05
    np.testing.assert_array_equal(found > 0, shapes.contains(shape, places))


@pytest.mark.parametrize(
    "shape", [Mesh(MESHES / "knot.ply", 0.01), Mesh(SCENES / "meshes" / "duck.ply", 0.03)], ids=["knot", "duck"]
)
def test_distance_to_a_mesh_is_that_of_vtk(shape):
    """By triangles of samples near by and of nodes around further off, the same as by a search among all triangles: to a
    fiftieth of a cell within two cells; beyond it is at most 5 % more, and never less."""
    low, high = shapes.extent(shape)
    edge = shapes.thickness(shape) / 5
    x, y, z = (np.arange(a - 4 * edge, b + 5 * edge, edge) for a, b in zip(low, high))
    found = grid_distance(shape, x, y, z).ravel()
    zs, ys, xs = np.meshgrid(z, y, x, indexing="ij")
    expected = shapes.depth(shape, np.stack([xs, ys, zs], axis=-1).reshape(-1, 3))
    close = abs(expected) < 2 * edge
    assert 1000 < close.sum() < 0.7 * len(close)
    assert ((abs(found) - abs(expected)) / edge).min() > -1e-9
    np.testing.assert_allclose(found[close], expected[close], atol=0.02 * edge)
    assert np.quantile(abs(found - expected)[close], 0.995) < 2e-3 * edge
    np.testing.assert_allclose(found, expected, rtol=0.05, atol=0.02 * edge)


def test_points_stay_with_the_nearest_when_points_move():
    """Owners after points have moved are those of a search among all, also where two points are equally near."""
    random = np.random.default_rng(8)
    place = random.uniform(size=(20_000, 6)) * [1, 1, 1, 0.1, 0.1, 0.1]
    point = random.uniform(size=(900, 6)) * [1, 1, 1, 0.1, 0.1, 0.1]
    owner = cKDTree(point).query(place)[1]
    moved = point + 0.02 * random.normal(size=point.shape)
    found = _nearest_again(moved, place, owner)
    np.testing.assert_array_equal(found, cKDTree(moved).query(place)[1])
    assert 0 < (found != owner).sum() < len(place) / 2


@pytest.mark.parametrize("what", [spread, distance])
def test_cuboids_have_their_own_rule(what):
    """Nothing here is for cuboids, and says so."""
    with pytest.raises(TypeError, match="Box"):
        what(Box((1.0, 1.0, 1.0)), np.zeros((1, 3)) if what is distance else 0.1)


# --- kinds ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def made(monkeypatch) -> list:
    """The shapes of which contact bodies are made, in this order."""
    made = []
    make = contact_body.make_contact_body
    monkeypatch.setattr(contact_body, "make_contact_body", lambda shape, *rest: made.append(shape) or make(shape, *rest))
    return made


BALL, BRICK, RING = Sphere(0.2), Box((0.4, 0.4, 0.4)), Torus(0.4, 0.2)


def zoo():
    """A scene of five solids of three shapes."""
    order = [BRICK, BALL, BRICK, RING, BALL]
    return scene(*(solid(s, name=f"s{k}", position=(2.0 * k, 0.0, 0.0)) for k, s in enumerate(order)), resolution=0.1)


def test_equal_shapes_share_a_body_that_is_made_at_first_use(made):
    """Kinds are numbered as they appear; a body is made once for all solids of its kind, and not before someone asks."""
    whole = zoo()
    models = build_models(whole)
    system = assemble(models, whole)
    assert system.contact_kind.tolist() == [0, 1, 0, 2, 1]
    assert system.contact_kind.dtype == np.int32
    assert made == []
    bodies = system.contact_bodies
    assert list(bodies) == [0, 1, 2]
    assert made == [BRICK, BALL, RING]
    for m, model in enumerate(models):
        assert bodies[system.contact_kind[m]] is model.frame.contact
        assert len(model.frame.contact.node) == len(model.position)
    assert system.contact_bodies[1].kind[0] == DENSE
    assert len(made) == 3


def test_particles_are_at_their_nodes():
    """Node numbers follow the particles of a model, and lattice coordinates its body frame."""
    for model in build_models(zoo()):
        body, low = model.frame.contact, model.frame.cells.low
        nx, ny, _ = body.count + 1
        place = np.stack([body.node % nx, body.node // nx % ny, body.node // (nx * ny)], axis=1)
        np.testing.assert_allclose(low + place * body.edge, model.position - model.position.mean(axis=0), atol=1e-12)


def test_plans_have_bodies_where_an_effect_asks_for_them(made, monkeypatch):
    """Only for the column ``body``, and for parts of a plan only the kinds that they have, with the numbers of the whole."""
    plan = prepare(zoo()).plan
    assert plan.body_fixes == ()
    assert plan.contact_bodies == {}
    assert made == []
    asking = Effect()
    asking.name, asking.fix = "asking", "asker"
    plan = replace(plan, effects=(*plan.effects, asking), asked={**plan.asked, "asking": ("body",)})
    part = SubPlans(plan).part([1, 3, 4], grid=False)
    assert part.body_fixes == plan.body_fixes == ("asker",)
    assert part.system.contact_kind.tolist() == [1, 2, 1]
    assert list(part.contact_bodies) == [1, 2]
    assert made == [BALL, RING]
    assert list(plan.contact_bodies) == [0, 1, 2]
    assert all(plan.contact_bodies[k] is body for k, body in part.contact_bodies.items())


def test_a_frame_keeps_its_body(made):
    """The second call gives the first one's object."""
    frame = BodyFrame(BALL, cells_of(BALL))
    assert frame.contact is frame.contact
    assert made == [BALL]
