# SPDX-License-Identifier: GPL-2.0-only
"""Random bodies in a liquid with momentum, at the certified step: light and heavy, afloat, sinking, spinning."""

import numpy as np
import pytest
from mdanim_lammps.engine.geometry import Geometry
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.liquid import frames as liquid
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene

G, LEVEL, TOP = 9.81, 0.4, 1.0
DENSITIES = (50, 300, 700, 900, 1500, 3000, 10000)


def text(seed: int) -> str:
    """Two bodies over, at and under the surface of a pool of 25 x 25 columns, at up to 3 m/s."""
    random = np.random.default_rng(seed)
    bodies = ""
    for n, (x, z) in enumerate([(-0.22, random.uniform(0.2, 0.75)), (0.22, random.uniform(0.2, 0.75))]):
        size = random.uniform(0.14, 0.2)
        shape = random.choice([f"box ({size}, {size}, {size})", f"sphere {size / 2}", f"cylinder {size / 2} {size}"])
        density = random.choice(DENSITIES)
        turn, v, spin = random.uniform(-90, 90, 3), random.uniform(-1, 1, 3), random.uniform(-6, 6, 3)
        young = max(400, 0.4 * density)  # [kPa]: what is heavy and soft is crushed when it lands
        bodies += (
            f"object body[{n}] {{ shape {shape} m position ({x}, 0, {z}) m\n"
            f"  orientation euler ({turn[0]}, {turn[1]}, {turn[2]}) deg density {density}\n"
            f"  velocity ({v[0]}, {v[1]}, {3 * v[2]}) m/s spin ({spin[0]}, {spin[1]}, {spin[2]}) elasticity {young} kPa"
            f" damping 0.05 }}\n"
        )
    return (
        f"gravity (0, 0, -{G})\n"
        f"liquid water {{ basin from (-0.5, -0.5, 0) m to (0.5, 0.5, {TOP}) m density 1000 level {LEVEL} m model waves }}\n"
        f"{bodies}control {{ time 1.5 s resolution 4 cm }}\n"
    )


def check(path, seed: int) -> None:
    path.write_text(text(seed))
    ready = prepare(load_scene(path))
    system, geometry = ready.system, Geometry(ready.system)
    with Instance(ready.plan) as instance:
        instance.setup()
        units = instance.fix_value("liquid", 1)
        for _ in range(15):
            instance.run(int(0.1 / ready.certificate.timestep))
            x, v = instance.array("x"), instance.array("v")
            assert instance.fix_value("liquid", 0) == units
            # Energy of the start and of a fall from the rim, and what a splash throws up.
            speed = np.linalg.norm(system.center_of_mass(v), axis=1).max()
            assert speed < 8.0, f"{seed}: {speed} m/s"
            # A corner of a heavy body that lands on the floor gets 13.8 m/s where that is dry (seed 1), 15.8 in liquid (seed 16).
            assert np.abs(v - system.center_of_mass(v)[system.object]).max() < 16.0
        assert geometry.inverted(x).sum() <= 0.05 * len(system.hexahedron)
        level = liquid.heights(instance)[0]
    assert (level >= 0.0).all() and (level < 2 * TOP).all()


@pytest.mark.parametrize("seed", range(8))
def test_random_bodies_in_waves(tmp_path, seed):
    """No particle gets faster than the fall of its body explains, and not a unit of liquid is lost."""
    check(tmp_path / "random.txt", seed)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(8, 108))
def test_many_random_bodies_in_waves(tmp_path, seed):
    """The same for a hundred scenes."""
    check(tmp_path / "random.txt", seed)
