# SPDX-License-Identifier: GPL-2.0-only
"""Cost of modelling, and quality of its bodies: prints the figures of docs/physics-solids.md.

python bench/modelling.py cost       seconds and peak memory of a large box, ball and mesh, and of 10 000
objects python bench/modelling.py physics    stiffness of bars, cantilevers against Timoshenko
python bench/modelling.py masses     moments of inertia, and what their fit costs
python bench/modelling.py shapes     how well cells fill round bodies
python bench/modelling.py forecast   processor seconds and memory that are told before modelling, and those it took
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
from mdanim_lammps.model import build_models, check_geometry, shapes  # noqa: E402
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
    "box": ("box (1, 1, 1) m", 1 / 80),
    "plate": ("box (2, 2, 0.04) m", 0.01),
    "ball": ("sphere 0.5 m", 1 / 80),
    "larger ball": ("sphere 0.5 m", 1 / 120),
    "needle": ("cone 1 cm 100 m", 0.005),
    "rod": ("cylinder 1 cm 100 m", 0.005),
    "ring": ("torus 1 m 0.1 m", 0.0125),
    "lens": ("ellipsoid (0.6, 0.4, 0.1) m", 0.0125),
    "duck": ('mesh "duck.ply" scale 0.03', 0.006),
    "boat": ('mesh "boat.stl" scale 0.01', 0.012),
    "bottle": ('mesh "bottle.stl" scale 0.01', 0.004),
}


def told(name: str) -> None:
    """Print one row; runs in a process of its own."""
    from mdanim_lammps.model import plan_spacing, work
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    shape, h = TOLD[name]
    shape = shape.replace('mesh "', f'mesh "{ROOT}/scenes/meshes/')
    case = parse_scene(
        f"ground z 0 m\nobject a {{ shape {shape} position (0, 0, 300) m density 500 elasticity 1 MPa }}\n"
        f"gravity (0, 0, -9.81) m/s^2\ncontrol {{ time 1 s resolution {h!r} m }}"
    )
    plan, start = plan_spacing(case), time.process_time()
    particles = prepare(case).system.particles
    took, peak = time.process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    seconds = work.seconds(case, plan.h, plan.total)
    print(f"| {name} | {particles:,} | {seconds:.1f} | {took:.1f} | {plan.memory * 1e-9:.2f} | {peak:.2f} |")


def forecast() -> None:
    print(
        "| body | particles | told [s] | took [s] | told [GB] | peak without LAMMPS [GB] |\n|---|---|---|---|---|---|", flush=True
    )
    for name in TOLD:
        process = multiprocessing.get_context("spawn").Process(target=told, args=(name,))
        process.start()
        process.join()


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


if __name__ == "__main__":
    parts = {"cost": cost, "physics": physics, "masses": masses, "shapes": round_bodies, "forecast": forecast}
    for part in sys.argv[1:] or parts:
        parts[part]()
        print()
