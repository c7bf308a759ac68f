# SPDX-License-Identifier: GPL-2.0-only
"""Cost of modelling, and quality of its bodies: prints the figures of docs/physics-solids.md.

python bench/modelling.py cost       seconds and peak memory of a large box, ball and mesh, and of 10 000
objects python bench/modelling.py physics    stiffness of bars, cantilevers against Timoshenko
python bench/modelling.py masses     moments of inertia, and what their fit costs
python bench/modelling.py shapes     how well cells fill round bodies
python bench/modelling.py spacings   impulses where two spacings meet
python bench/modelling.py forecast   processor seconds and memory that are told before modelling, and those it took
python bench/modelling.py held       processor seconds of modelling and of the run, of scenes of held bodies
python bench/modelling.py goals      the same of meshes of 30 000 particles (3 s at most) and of 1.8 million (15 s)
"""

from __future__ import annotations

import multiprocessing
import resource
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "tests" / "lab"))

from mdanim_lammps.errors import SceneError  # noqa: E402
from mdanim_lammps.model import shapes  # noqa: E402
from mdanim_lammps.model.build import build_models  # noqa: E402
from mdanim_lammps.model.overlap import check_geometry  # noqa: E402
from mdanim_lammps.scene.scene import Box, Mesh, Sphere  # noqa: E402
from model_samples import SHAPES, model, scene, shape_id, solid  # noqa: E402


def many(shape, step, count=10_000):
    """Objects on a cubic grid."""
    place = np.stack(np.unravel_index(np.arange(count), (22, 22, 22)), axis=1) * step
    return [solid(shape, f"body[{i}]", position=tuple(p)) for i, p in enumerate(place)]


COSTS = {
    "one box, 99^3 cells": lambda: ([solid(Box((0.99, 0.99, 0.99)))], 0.01),
    "one ball of 10^6 particles": lambda: ([solid(Sphere(0.615))], 0.01),
    "duck of 6.6 10^5 particles": lambda: ([solid(Mesh(ROOT / "scenes/meshes/duck.ply", 0.01))], 0.0008),
    "10 000 boxes of 27 particles": lambda: (many(Box((0.2, 0.2, 0.2)), 0.25), 0.1),
    "10 000 balls of 6 cells across": lambda: (many(Sphere(0.12), 0.25), 0.04),
}


def measure(name: str) -> None:
    """Print one row; runs in a process of its own, so that the peak memory is its own."""
    solids, h = COSTS[name]()
    case = scene(*solids, resolution=h)
    start = time.perf_counter()
    models = build_models(case)
    built = time.perf_counter()
    check_geometry(case, models)
    checked = time.perf_counter()
    particles, springs = (sum(len(getattr(m, field)) for m in models) for field in ("position", "spring"))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    build, check = built - start, checked - built
    print(f"| {name} | {particles:,} | {springs:,} | {build:.2f} | {check:.2f} | {peak:.2f} |")


def cost() -> None:
    print("| scene | particles | springs | build_models [s] | check_geometry [s] | peak memory [GB] |")
    print("|---|---|---|---|---|---|")
    sys.stdout.flush()
    for name in COSTS:
        process = multiprocessing.get_context("spawn").Process(target=measure, args=(name,))
        process.start()
        process.join()


TOLD = {
    "cuboid": "box (1, 1, 1) m",
    "plate": "box (2, 2, 0.04) m",
    "ball": "sphere 0.5 m",
    "cylinder": "cylinder 0.4 m 1 m",
    "rod": "cylinder 1 cm {long} m",
    "cone": "cone 0.5 m 1 m",
    "needle": "cone 1 cm {long} m",
    "ring": "torus 1 m 0.1 m",
    "lens": "ellipsoid (0.6, 0.4, 0.1) m",
    "mesh of 12 triangles": 'mesh "{tests}/cuboid.obj"',
    "boat, mesh of 448": 'mesh "{scenes}/boat.stl" scale 0.01',
    "bottle, mesh of 1 200": 'mesh "{scenes}/bottle.stl" scale 0.01',
    "duck, mesh of 4 212": 'mesh "{scenes}/duck.ply" scale 0.03',
}
SIZES = (1e3, 1e4, 1e5, 1e6)
MESHES = {"tests": f"{ROOT}/tests/lab/meshes", "scenes": f"{ROOT}/scenes/meshes"}


def told(name: str, size: float) -> None:
    """Print one row; runs in a process of its own."""
    from mdanim_lammps.model import work
    from mdanim_lammps.model.spacing import estimate_particles, plan_spacing
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    def text(shape: str, h: float) -> str:
        return (
            f"ground z 0 m\nobject a {{ shape {shape} position (0, 0, 3000) m density 500 elasticity 1 MPa }}\n"
            f"gravity (0, 0, -9.81) m/s^2\ncontrol {{ time 1 s resolution {h!r} m }}"
        )

    # Needles keep their four cells across and grow along; all other shapes are cut finer.
    shape, h = TOLD[name].format(long=f"{size / (1800 if 'cone' in TOLD[name] else 4200):.4g}", **MESHES), 0.005
    if "{long}" not in TOLD[name]:
        (body,) = parse_scene(text(shape, h)).solids
        low, high = 1e-4, float(shapes.thickness(body.shape))
        while high / low > 1.001:
            h = (low * high) ** 0.5
            low, high = (h, high) if estimate_particles(body.shape, h) > size else (low, h)
    import pyvista  # noqa: F401  libraries are loaded once, in 1 to 2 s
    import scipy.linalg
    import scipy.ndimage
    import scipy.spatial
    import scipy.special  # noqa: F401

    case = parse_scene(text(shape, h))
    plan, start = plan_spacing(case), time.process_time()
    particles = prepare(case).system.particles
    took, peak = time.process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    seconds = work.seconds(case, plan.h, plan.particles)
    print(
        f"| {name} | {particles:,} | {seconds:.2f} | {took:.2f} | {seconds / took:.2f} | {plan.memory * 1e-9:.2f} | {peak:.2f} |",
        flush=True,
    )


def print_told(cases) -> None:
    """A row for each of some names and sizes."""
    print("| body | particles | told [s] | took [s] | told over took | told [GB] | peak without LAMMPS [GB] |")
    print("|---|---|---|---|---|---|---|", flush=True)
    for case in cases:
        process = multiprocessing.get_context("spawn").Process(target=told, args=case)
        process.start()
        process.join()


def forecast() -> None:
    print_told((name, size) for size in SIZES for name in TOLD)


def goals() -> None:
    meshes = [name for name in TOLD if "mesh" in name][1:]
    print_told([*((name, 3e4) for name in meshes[::-1]), ("cuboid", 1.8e6), ("ball", 1.8e6)])


def physics() -> None:
    from spring_lab import cantilever, stretched

    print("| cells thick | E / E asked | nu | deflection | frequency |\n|---|---|---|---|---|")
    for cells in (1, 2, 3, 4, 6, 8):
        young, nu = stretched(model(Box((24.0, cells, cells)), 1.0))
        deflection, frequency = cantilever(cells)
        print(f"| {cells} | {young:.6f} | {nu:.4f} | {deflection:.3f} | {frequency:.3f} |")


def masses() -> None:
    from mdanim_lammps.features.springs.effect import spring_norm
    from mdanim_lammps.model import masses as fitting
    from mdanim_lammps.model.system import assemble

    print("| shape | cells across | error by shares | error left | least w | largest w | stable step |")
    print("|---|---|---|---|---|---|---|")
    for shape in (Box((1.0, 1.0, 1.0)), Box((4.0, 2.0, 1.0)), *SHAPES[1:]):
        for cells in (1, 2, 3, 4, 5, 8):
            h = shapes.thickness(shape) / cells
            try:
                case = scene(solid(shape), resolution=h)
                system = assemble(build_models(case), case)
            except SceneError:
                continue
            weight = system.mass / (system.share / system.share.sum())
            found = np.einsum("n,na,nb->ab", system.share, system.position, system.position) / system.share.sum()
            true = shapes.second_moments(shape)
            ratio = np.linalg.eigvals(np.linalg.solve(fitting.inertia(true), fitting.inertia(found))).real
            stiff = spring_norm(system, system.stiffness) / system.share
            step = np.sqrt(stiff.max() / (stiff / weight).max())
            print(
                f"| {shape_id(shape)} | {cells} | {abs(ratio - 1).max():.3f} | {system.inertia_error[0]:.3f} "
                f"| {weight.min():.2f} | {weight.max():.2f} | {step:.2f} |"
            )


def round_bodies() -> None:
    print("| shape | cells across | edge / spacing | volume of cells / true | particles |")
    print("|---|---|---|---|---|")
    for shape in SHAPES[1:]:
        for cells in (2, 3, 4, 6, 8):
            h = shapes.thickness(shape) / cells
            body = model(shape, h)
            volume = len(body.hexahedron) * np.prod(body.cell) / shapes.volume(shape)
            edge, particles = body.cell[0] / h, len(body.position)
            print(f"| {shape_id(shape)} | {cells} | {edge:.3f} | {volume:.4f} | {particles} |")


SPACINGS = {
    "ball": ("sphere 3 cm", 3.0, "", 0.04),
    "ball, plate held at its edges": ("sphere 3 cm", 3.0, "hold faces x  hold faces y", 0.06),
    "ball, plate all held": ("sphere 3 cm", 3.0, "hold all", 0.05),
    "cube, flat": ("box (5, 5, 5) cm", 2.5, "", 0.04),
    "cube, on a corner": ("box (5, 5, 5) cm orientation axis (1, 1, 0) angle 54.7 deg", 4.33, "", 0.04),
}


def spacings() -> None:
    """A body hits a plate, 3 cm thick, at 0.5 m/s: both fine, the plate coarse, both coarse."""
    import tempfile

    from mdanim_lammps import Scene

    fine, coarse, material = "resolution 7.5 mm", "resolution 15 mm", "density 1000 elasticity 200 kPa"
    print("| blow | fine | plate coarse | both coarse | largest energy residual |", flush=True)
    print("|---|---|---|---|---|", flush=True)
    for name, (shape, half, hold, end) in SPACINGS.items():
        rows, residual = [], 0.0
        for plate, body in ((fine, fine), (coarse, fine), (coarse, coarse)):
            case = Scene.from_text(
                f"object plate {{ shape box (24, 24, 3) cm position (0, 0, 0) m {material} {hold} {plate} }}\n"
                f"object body {{ shape {shape} position (0.4, 0.4, {half + 1.6}) cm {material} {body} "
                f"velocity (0, 0, -0.5) m/s }}\ncontrol {{ time {end} s frames 200 fps }}"
            )
            with tempfile.TemporaryDirectory() as folder:
                run = case.run(folder + "/run")
                rows.append(1.0 + run.trajectory.objects["body"].velocity[-1, 2] / 0.5)
                residual = max(residual, run.ledger.residual)
        print(f"| {name} | {rows[0]:.3f} | {rows[1]:.3f} | {rows[2]:.3f} | {residual:.1e} |", flush=True)


HELD = ("helter", "marbles", "marble_lift", "shaker")


def held() -> None:
    """With libraries loaded before, by another scene and by LAMMPS as a run opens it, with which modelling finds how deep what is
    round starts in others; seconds of the process that reads mesh files count."""
    import tempfile

    from mdanim_lammps import Scene
    from mdanim_lammps.engine.plugin import open_lammps

    def spent() -> float:
        child = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.process_time() + child.ru_utime + child.ru_stime

    print("| scene | objects | modelling [s] | of it reading meshes [s] | run [s] | modelling over both |")
    print("|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        scenes = {name: Scene.load(ROOT / "scenes" / f"{name}.txt") for name in ("barge", *HELD)}
        scenes.pop("barge").prepared  # noqa: B018  for its libraries
        open_lammps()[0].close()
        for name, case in scenes.items():
            start, alone = spent(), time.process_time()
            objects = len(case.prepared.system.names)
            took, alone = spent() - start, time.process_time() - alone
            case.run(f"{folder}/{name}")
            ran = spent() - start - took
            reading = f"{max(0.0, took - alone):.2f}"
            print(f"| {name} | {objects} | {took:.2f} | {reading} | {ran:.2f} | {took / (took + ran):.2f} |", flush=True)


if __name__ == "__main__":
    parts = {
        "cost": cost,
        "held": held,
        "spacings": spacings,
        "physics": physics,
        "masses": masses,
        "shapes": round_bodies,
        "forecast": forecast,
        "goals": goals,
    }
    for part in sys.argv[1:] or parts:
        parts[part]()
        print()
