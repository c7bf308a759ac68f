# SPDX-License-Identifier: GPL-2.0-only
"""Scenes with meshes that have creases and holes: what is held or rigid touches them by their features."""

import numpy as np
import pytest
import rigid_meshes
from mdanim_lammps.engine.geometry import Geometry
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.rigid.touching import STEP, omega
from mdanim_lammps.model import creased
from mdanim_lammps.scene.scene import Mesh
from model_samples import MESHES

STAIRS = [(0, 0), (0.9, 0), (0.9, 0.2), (0.6, 0.2), (0.6, 0.4), (0.3, 0.4), (0.3, 0.6), (0, 0.6)]
SCENE = """gravity (0, 0, -9.81) m/s^2
object held {{ shape mesh "held.obj" scale 1  position ({x!r}, {y!r}, {z!r}) m  density 1000  elasticity rigid  hold all }}
object it {{ {it}  density 1000  elasticity rigid }}
control {{ time {time} s  friction 0.5  restitution 0.5 }}
"""


def scene(folder, points, triangles, it, time) -> str:
    """The text of a scene with a mesh at its own place, whose file is written."""
    rows = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()] + [f"f {a} {b} {c}\n" for a, b, c in triangles + 1]
    (folder / "held.obj").write_text("".join(rows))
    a, b, c = (points[triangles[:, k]] for k in range(3))
    six = np.einsum("td,td->t", a, np.cross(b, c))
    x, y, z = ((six[:, None] * (a + b + c)).sum(0) / (4 * six.sum())).tolist()
    return SCENE.format(x=x, y=y, z=z, it=it, time=time)


def run(ready) -> np.ndarray:
    """Centres of mass at the end [m]."""
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        return ready.system.center_of_mass(instance.array("x"))


def test_a_marble_runs_through_a_spiral_pipe(prepared, tmp_path):
    """By features: eight particles each, and steps that they allow; at points of surfaces it took eight times as many. It stays
    in the pipe and comes down by as much as the pipe does on its way."""
    radius, drop = 0.15, 0.06
    text = scene(
        tmp_path, *rigid_meshes.pipe(radius, drop, 2, 0.025, 0.029, 60, 20), "shape sphere 1 cm  position (15, 1, -1.4) cm", 0.6
    )
    ready = prepared(text)
    assert ready.system.particles == 16 and not ready.warnings
    assert ready.certificate.timestep > 0.9 * STEP / omega(ready.context)
    x, y, z = run(ready)[1]
    turned = np.arctan2(y, x) % (2 * np.pi)
    assert turned > 0.5
    assert np.hypot(np.hypot(x, y) - radius, z + drop * turned / (2 * np.pi)) < 0.025 - 0.01 + 1e-3


@pytest.mark.parametrize("it", ["shape box (20, 20, 20) cm", "shape cylinder 10 cm 20 cm", "shape torus 10 cm 4 cm"])
def test_it_stands_on_a_step(prepared, tmp_path, it):
    """Where it is put down: nothing creeps, and nothing falls through."""
    height = 0.04 if "torus" in it else 0.1
    ready = prepared(scene(tmp_path, *rigid_meshes.profile(STAIRS, 1.0), f"{it}  position (0.45, 0, {0.4 + height}) m", 0.5))
    assert ready.system.particles == 16 and ready.certificate.timestep > 0.9 * STEP / omega(ready.context)
    assert run(ready)[1] == pytest.approx((0.45, 0.0, 0.4 + height), abs=2e-3)


@pytest.mark.parametrize(("name", "known"), [("dumbbell", True), ("knot", True), ("sliver", False)])
def test_which_meshes_are_known(name, known):
    """All that are closed and whose triangles have areas; those that move with up to 1000 corners."""
    shape = Mesh(MESHES / f"{name}.{'ply' if name == 'knot' else 'obj'}")
    assert creased.is_known(shape) == known
    assert creased.may_move(shape) == (name == "dumbbell")


def test_a_concave_mesh_that_moves_touches_by_features(prepared):
    """A dumbbell, whose neck, 3.9 cm wide, falls across the edge of a box: it stays there."""
    text = f"""gravity (0, 0, -9.81) m/s^2
    object post {{ shape box (3.8, 40, 40) cm  position (0, 0, 0.2) m  density 1000  elasticity rigid  hold all }}
    object barbell {{ shape mesh "{MESHES}/dumbbell.obj" scale 0.03  position (0, 0, 0.4155) m
      orientation axis (1, 0, 0) angle 90 deg  density 1000  elasticity rigid }}
    control {{ time 0.5 s  friction 0.5 }}
    """
    ready = prepared(text)
    assert ready.certificate.timestep > 0.9 * STEP / omega(ready.context) and not ready.warnings
    before = ready.system.center_of_mass(ready.system.position)[1]
    after = run(ready)[1]
    assert abs(after[0] - before[0]) < 0.02 and before[2] - 0.06 < after[2] < before[2] + 1e-3


@pytest.mark.parametrize(
    "shape", ["torus 10 cm 3 cm", f'mesh "{MESHES}/cuboid.obj" scale 0.05', f'mesh "{MESHES}/dumbbell.obj" scale 0.03']
)
def test_few_particles_of_rings_and_meshes(prepared, shape):
    """Eight, with mass, centre and moments of the shape; a rod through the hole of a ring is not inside of it, and a convex mesh
    has the cell in which things would be."""
    aside = 0 if "torus" in shape else 1
    text = f"""gravity (0, 0, -9.81) m/s^2
    object it {{ shape {shape}  position (0, 0, 0.5) m  density 1000  elasticity rigid  spin (1, 2, 3) rad/s }}
    object rod {{ shape cylinder 1 cm 40 cm  position ({aside}, 0, 0.5) m  density 1000  elasticity rigid }}
    control {{ time 0.1 s }}
    """
    ready = prepared(text)
    assert np.diff(ready.system.first).tolist() == [8, 8]
    assert ready.system.center_of_mass(ready.system.position)[0] == pytest.approx((0, 0, 0.5), abs=1e-12)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        x = instance.array("x")
        assert ready.system.center_of_mass(x)[0, 2] == pytest.approx(0.5 - 0.5 * 9.81 * 0.1**2, abs=1e-6)
        assert Geometry(ready.system).sunk(x) is None


def test_what_has_no_features_is_eight_particles_too(prepared):
    """A mesh whose features are not known, struck by an elastic ball: both go on as the middle of both does, with all energy, and
    the ball is thrown back. Alone over ground the mesh has no cells, and stays on it."""
    text = f"""gravity (0, 0, 0) m/s^2
    object it {{ shape mesh "{MESHES}/sliver.obj" scale 0.03  position (0, 0, 0) m  density 1000
      elasticity rigid  resolution 3 cm }}
    object ball {{ shape sphere 5 cm  position (0, 0, 0.11) m  mass 1  elasticity 300 kPa
      velocity (0, 0, -1) m/s  resolution 4 cm }}
    control {{ time 0.1 s }}
    """
    ready = prepared(text)
    system = ready.system
    assert system.first[1] == 8
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        momentum = np.add.reduceat(system.mass[:, None] * instance.array("v"), system.first[:-1])
    np.testing.assert_allclose(momentum.sum(axis=0), (0.0, 0.0, -1.0), rtol=0, atol=1e-9)
    struck, ball = system.mass_of
    fastest = 2.0 / (struck + ball)  # of the mesh after a central elastic blow
    assert 0.7 * struck * fastest < -momentum[0, 2] <= struck * fastest
    alone = prepared(f"""ground z 0 m  gravity (0, 0, -9.81) m/s^2
    object it {{ shape mesh "{MESHES}/sliver.obj" scale 0.03  position (0, 0, 0.0455) m  density 1000  elasticity rigid }}
    control {{ time 0.1 s  friction 0.5 }}
    """)
    assert alone.system.frames[0].cells.filled.shape == (1, 1, 1)
    assert run(alone)[0] == pytest.approx((0.0, 0.0, 0.045), abs=2e-3)


def test_a_cube_lies_on_a_plate_with_a_hole(prepared, tmp_path):
    """6 cm from the middle of the hole: two of its corners, over which the far side of the hole has an edge, found no side there,
    and it fell through."""
    ring, sectors = [(0.01, 0.0), (0.3, 0.0), (0.3, 0.03), (0.01, 0.03)], 48
    turns = 2.0 * np.pi * np.arange(sectors) / sectors
    lines = [f"v {r * np.cos(a)} {r * np.sin(a)} {z}" for a in turns for r, z in ring]
    for k in range(sectors):
        one, next_ = 4 * k + 1, 4 * ((k + 1) % sectors) + 1
        lines += [f"f {one + i} {next_ + i} {next_ + j} {one + j}" for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))]
    (tmp_path / "plate.obj").write_text("\n".join(lines) + "\n")
    text = f"""gravity (0, 0, -9.81) m/s^2
    object plate {{ shape mesh "{tmp_path}/plate.obj"  origin file  position (0, 0, 0) m  hold all }}
    object cube {{ shape box (4, 4, 4) cm  position (0.06, 0, 0.055) m  density 2000  elasticity rigid }}
    control {{ time 0.1 s  restitution 0.3 }}
    """
    ready = prepared(text)
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(ready.certificate.steps)
        centre = ready.system.center_of_mass(instance.array("x"))[1]
    assert centre == pytest.approx((0.06, 0.0, 0.05), abs=2e-3)


def test_a_thin_held_mesh_has_no_cells_to_search(prepared, tmp_path):
    """An angle of 0.2 mm and a metre: it was refused for the cells in the box around it."""
    points, triangles = rigid_meshes.profile([(0, 0), (1, 0), (1, 2e-4), (2e-4, 2e-4), (2e-4, 1), (0, 1)], 1.0)
    text = scene(tmp_path, points, triangles, "shape sphere 2 cm  position (0.5, 0, 0.5) m", 0.1).replace(
        "held.obj", f"{tmp_path}/held.obj"
    )
    assert prepared(text).system.particles == 16
