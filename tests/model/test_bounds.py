# SPDX-License-Identifier: GPL-2.0-only
"""Extremes of size, place, time and material: a message within a bounded time and a bounded memory, never a traceback."""

import resource
import time

import numpy as np
import pytest
from mdanim_lammps.certificate import stable_step
from mdanim_lammps.errors import MdanimError, SceneError

ROOM = 1 << 30
"""Address space that a check may add [bytes]."""
SECONDS = 10.0
"""Processor time of a check [s]."""


@pytest.fixture
def bounded():
    """Let an allocation beyond ROOM fail with a MemoryError instead of filling the machine."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    with open("/proc/self/statm") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + ROOM, before[1]))
    started = time.process_time()
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)
    assert time.process_time() - started < SECONDS


def text(
    shape="box (20, 20, 20) cm",
    place="(0, 0, 1) m",
    mass="density 1000",
    elasticity="1 MPa",
    more="",
    control="time 1 s",
    scene="",
) -> str:
    """A scene of one object."""
    return (
        f"{scene}\nobject a {{ shape {shape} position {place} {mass} elasticity {elasticity} {more} }}\ncontrol {{ {control} }}\n"
    )


MESH = "{meshes}/knot.ply"
REFUSED = {
    **{
        f"shape {shape}": text(shape=shape)
        for shape in (
            "cylinder 1000 m 10 cm",
            "cylinder 1e-9 m 10 cm",
            "torus 1000 m 1 cm",
            "torus 100 m 1 cm",
            "cone 1000 m 1 cm",
            "ellipsoid (1 m, 1 m, 1e-7 m)",
            "ellipsoid (1e300 m, 1 m, 1e-300 m)",
            "sphere 1e308 m",
            "sphere 1e100 m",
            "sphere 1e-300 m",
            "box (1e308, 1e308, 1e308) m",
            "box (1e-300, 1e-300, 1e-300) m",
            "box (1, 1, 1e-9) m",
        )
    },
    **{f"scale {scale}": text(shape=f'mesh "{MESH}" scale {scale}') for scale in ("1e300", "1e-300", "1e-12", "1e9")},
    "place 1e18": text(place="(0, 0, 1e18) m"),
    "place 1e300": text(place="(1e300, 0, 0) m"),
    "resolution 1e-300": text(control="time 1 s resolution 1e-300 m"),
    "resolution 1e-5": text(control="time 1 s resolution 1e-5 m"),
    "time 1e8": text(control="time 1e8 s"),
    "time 1e12": text(control="time 1e12 s"),
    "time 1e300": text(control="time 1e300 s"),
    "frames 1e300": text(control="time 1 s frames 1e300 fps"),
    "timestep 1e-300": text(control="time 1 s timestep 1e-300 s"),
    "damping 1e300": text(more="damping 1e300"),
    "mass 5e-324": text(mass="mass 5e-324 kg"),
    "mass 1e-300": text(mass="mass 1e-300 kg"),
    "mass 1e300": text(mass="mass 1e300 kg"),
    "density 1e-300": text(mass="density 1e-300"),
    "density 1e300": text(mass="density 1e300"),
    "elasticity 1e300": text(elasticity="1e300 Pa"),
    "elasticity 1e-300": text(elasticity="1e-300 Pa"),
    "velocity 1e300": text(more="velocity (1e300, 0, 0) m/s"),
    "spin 1e300": text(more="spin (1e300, 0, 0) rad/s"),
    "gravity 1e300": text(scene="gravity (0, 0, -1e300) m/s^2\nground z 0 m"),
    "ground -1e300": text(scene="gravity (0, 0, -9.81) m/s^2\nground z -1e300 m"),
    "basin 1e300": text(
        scene="gravity (0, 0, -9.81) m/s^2\n"
        "liquid w { basin from (-1e300, -1e300, 0) m to (1e300, 1e300, 1e300) m density 1000 level 5 cm }"
    ),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("case", REFUSED)
def test_an_extreme_is_refused_with_a_message(case, prepared, bounded):
    """One problem at least, with a way out, and no warning of NumPy's."""
    from model_samples import MESHES

    with pytest.raises(MdanimError) as error:
        prepared(REFUSED[case].replace("{meshes}", str(MESHES)))
    problems = getattr(error.value, "problems", None)
    assert (problems and all(p.hint for p in problems)) or "\n" in str(error.value)
    assert len(str(error.value)) < 1500
    print(error.value)


def test_strong_dashpots_leave_a_bound():
    """The bound of strong dashpots is 2/b: their square root is not a difference of two equal numbers."""
    drag = np.array([1e2, 1e9, 1e13])
    assert stable_step(np.full(3, 1e6), drag)[1:] == pytest.approx(2.0 / drag[1:], rel=1e-6)
    assert stable_step(np.full(3, 1e6), drag)[0] == pytest.approx((np.sqrt(1e4 + 4e6) - 1e2) / 1e6, rel=1e-15)


def test_a_ring_that_fills_little_of_its_box_is_refused_before_it_is_searched(prepared):
    """Say how many cells would be searched; a thicker ring of the same radius is built."""
    with pytest.raises(MdanimError, match=r"box around it has 80 200 000 cells of 5 mm, and it fills about 276 000") as error:
        prepared(text(shape="torus 10 m 1 cm"))
    assert "several objects" in str(error.value)
    assert prepared(text(shape="torus 10 m 50 cm", control="time 1 s accuracy preview")).system.particles > 500


@pytest.mark.parametrize(("shape", "place"), [("sphere 1 mm", "(0, 0, 1e7) m"), ("sphere 1 m", "(0, 0, 1e9) m")])
def test_an_object_too_far_out_for_its_size_is_refused(prepared, shape, place):
    """At its position particles would differ by rounding alone; such a scene is read, and then refused at that position."""
    with pytest.raises(SceneError) as error:
        prepared(text(shape=shape, place=place))
    (problem,) = error.value.problems
    scene = text(shape=shape, place=place).splitlines()
    assert scene[problem.line - 1][problem.column - 1 :].startswith(place)
    assert "too far from the origin for its size" in problem.message
    assert "nearer to the origin" in problem.hint
