# SPDX-License-Identifier: GPL-2.0-only
"""A body that never moves: its surface is that of its lattice, its particles are the corners of a box around it."""

import numpy as np
import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.model.build import build_models
from mdanim_lammps.model.inertia import tensor
from mdanim_lammps.model.shapes import extent
from mdanim_lammps.model.system import assemble
from mdanim_lammps.scene.scene import Box, HoldAll, Sphere
from model_samples import SHAPES, rotation, scene, shape_id, solid
from paths import MESHES

PLACE = (3.0, -2.0, 1.5)


def both(shape, h=0.09, **rest):
    """The same object that is held as a whole, with its corners and with its lattice."""
    made = scene(
        solid(shape, hold=(HoldAll(),), position=PLACE, rotation=rotation(0.3, -0.7, 0.4), mass=2.0, **rest), resolution=h
    )
    return build_models(made)[0], build_models(made, inside=True)[0]


@pytest.mark.parametrize("shape", SHAPES, ids=shape_id)
def test_its_surface_and_its_contact_are_those_of_its_lattice(shape):
    """Vertices, box, mass, centre; points, areas and depth of contact, which its four particles put in the same places."""
    few, lattice = both(shape)
    assert len(few.position) == 8 and len(lattice.position) > 100 and few.still and few.young == lattice.young
    vertex = few.surface.vertices(few.position)
    np.testing.assert_allclose(vertex, lattice.surface.vertices(lattice.position), rtol=0, atol=1e-13)
    assert (few.surface.triangle == lattice.surface.triangle).all()
    np.testing.assert_allclose(few.position.min(axis=0), vertex.min(axis=0), rtol=0, atol=1e-14)
    np.testing.assert_allclose(few.position.max(axis=0), vertex.max(axis=0), rtol=0, atol=1e-14)
    assert few.mass.sum() == pytest.approx(2.0, rel=1e-14) and (few.mass > 0.0).all()
    np.testing.assert_allclose(few.mass @ few.position / 2.0, PLACE, rtol=0, atol=1e-13)
    one, other = few.frame.contact, lattice.frame.contact
    for name in ("count", "edge", "filled", "cell", "at", "normal", "area", "kind", "depth"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    place = lambda body, model: weights(body) @ model.position[body.frame]
    np.testing.assert_allclose(place(one, few), place(other, lattice), rtol=0, atol=1e-12)


def weights(body) -> np.ndarray:
    """Weights of the particles of its frame in its points, shape (P, 4)."""
    frame = np.hstack([np.ones((4, 1)), body.frame_at])
    return np.hstack([np.ones((len(body.at), 1)), body.at]) @ np.linalg.inv(frame)


def test_equal_ones_share_their_surface():
    """Where they are turned alike; contact sees all of them as one kind of body."""
    held = dict(hold=(HoldAll(),))
    made = scene(
        solid(Sphere(0.5), "a", **held),
        solid(Sphere(0.5), "b", position=(2.0, 0, 0), **held),
        solid(Sphere(0.5), "c", position=(4.0, 0, 0), rotation=rotation(0.1, 0, 0), **held),
        solid(Sphere(0.5), "d", position=(6.0, 0, 0)),
        resolution=0.1,
    )
    a, b, c, d = models = build_models(made)
    assert a.surface is b.surface and a.frame is b.frame and a.surface is not c.surface and len(d.position) > 100
    system = assemble(models, made)
    assert system.density[:3] == pytest.approx(1.0 / (4.0 / 3.0 * np.pi * 0.5**3))
    assert np.diff(system.first)[:3].tolist() == [8, 8, 8] and system.still.tolist() == [True, True, True, False]
    assert system.contact_bodies[0].carried.tolist() == [0.0] * 8


def test_what_lies_in_a_liquid_has_its_lattice():
    """All of a scene in which particles inside act; a driven one alone is a box as others are."""
    made = scene(solid(Box((1.0, 1.0, 1.0)), hold=(HoldAll(),)), resolution=0.1)
    assert len(build_models(made)[0].position) == 8
    assert len(build_models(made, driven={0})[0].position) == 8
    assert len(build_models(made, driven={0}, inside=True)[0].position) == 11**3
    assert len(build_models(made, inside=True)[0].position) == 11**3


PLATE = """gravity (0, 0, -9.81) m/s^2
object floor { shape box (100, 100, 1) cm  position (0, 0, -0.005) m  density 1000  HOW  hold all }
object ball { shape sphere 5 cm  position (0, 0, 0.06) m  mass 1 kg  elasticity rigid  velocity (0, 0, -10) m/s }
control { time 0.1 s }
"""
BARBELL = (
    f'object barbell {{ shape mesh "{MESHES}/sliver.obj" scale 0.1  position (3, 0, 3) m  density 500  elasticity rigid }}\n'
)


@pytest.mark.parametrize("how", ["elasticity rigid", "elasticity 10 kPa"])
def test_features_alone_need_neither_inside_nor_surface(prepared, how):
    """A rigid ball comes faster than waves of what the plate is made of would, and nothing of that acts: the plate has no inside,
    its surface is 12 triangles, and no speed is doubted. A resolution sets nothing, so it is not held against the thinness."""
    ready = prepared(PLATE.replace("HOW", how))
    assert np.diff(ready.system.first).tolist() == [8, 8] and not ready.warnings
    floor = ready.context.models[0]
    assert len(floor.surface.triangle) == 12 and len(ready.system.contact_bodies[ready.system.contact_kind[0]].at) < 50
    low, high = (floor.surface.vertices(floor.position).min(axis=0), floor.surface.vertices(floor.position).max(axis=0))
    np.testing.assert_allclose([low, high], [(-0.5, -0.5, -0.01), (0.5, 0.5, 0.0)], rtol=0, atol=1e-15)
    coarse = prepared(PLATE.replace("HOW", f"{how}  resolution 1 m"))
    assert (coarse.system.position == ready.system.position).all() and coarse.certificate.timestep == ready.certificate.timestep
    assert coarse.system.spacing.tolist() == ready.system.spacing.tolist()


def test_points_of_a_surface_are_as_far_apart_as_the_spacing(prepared):
    """A mesh with a triangle of no area has no features: it meets the plate at points of both surfaces, and a
    resolution sets them."""
    with pytest.raises(SceneError, match="floor: thinner than the spacing allows"):
        prepared(PLATE.replace("HOW", "elasticity rigid  resolution 1 m") + BARBELL)
    ready = prepared(PLATE.replace("HOW", "elasticity rigid  resolution 1 cm") + BARBELL)
    assert np.diff(ready.system.first)[0] == 8 and len(ready.context.models[0].surface.triangle) == 2 * (2 * 100**2 + 4 * 100)


@pytest.mark.parametrize("shape", ["cylinder 1 cm 1 m", "cone 6 cm 5 cm", "ellipsoid (3, 4, 5) cm"])
def test_a_rigid_object_has_the_corners_of_a_box_about_its_centre(prepared, shape):
    """Eight particles, also of what is turned; their mean and velocity are those of the object, and the drawn surface is the
    shape."""
    turn = "orientation euler (20 deg, 30 deg, 40 deg)  velocity (1, 2, 3)  spin (0, 4, 5)"
    body = f"shape {shape}  position (0.1, 0.2, 3)  {turn}  density 1000  elasticity rigid"
    ready = prepared(f"object a {{ {body} }}\ncontrol {{ time 1 s }}\n")
    (model,), (solid,) = ready.models, ready.scene.solids
    assert len(model.position) == 8 and model.mass.min() > 0.0
    assert np.average(model.position, axis=0, weights=model.mass) == pytest.approx(solid.position, abs=1e-12)
    assert np.average(model.velocity, axis=0, weights=model.mass) == pytest.approx(solid.velocity, abs=1e-12)
    assert model.inertia == pytest.approx(tensor(solid.shape, model.mass.sum(), solid.rotation), rel=1e-12)
    drawn = (model.surface.vertices(model.position) - solid.position) @ np.array(solid.rotation)
    size = np.abs(extent(solid.shape)).max()
    assert np.abs(drawn).max() <= size * (1.0 + 1e-9)
