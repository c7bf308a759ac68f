# SPDX-License-Identifier: GPL-2.0-only
"""Sheets against closed forms: scenes, what is measured of them, and what theory says. Printed by ``python bench/sheets.py``."""

import math
from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise

import numpy as np
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.sheets.weave import weave
from mdanim_lammps.model import shapes
from mdanim_lammps.run.energy import energies
from mdanim_lammps.scene.scene import Sheet
from rope_cases import DOWN, G, made, settled

NU = 1.0 / 3.0
"""Poisson's ratio of a sheet."""


def sheet(size: str, thickness: str, *more: str, name: str = "cloth") -> str:
    """An object of a density of 1000 kg/m^3."""
    if not any("position" in one for one in more):
        more = ("position (0, 0, 0) m", *more)
    return f"object {name} {{ shape sheet {size} m thickness {thickness}  density 1000 kg/m^3  {'  '.join(more)} }}\n"


# --- in its plane, from its springs -------------------------------------------------------------------------------


def pulled(size: tuple[float, float], h: float, axis: int, young: float = 1e6, thickness: float = 2e-3) -> tuple[float, float]:
    """Stiffness of a sheet between two opposite sides that are held, and free to slide along these, over E t times width by
    length; and its Poisson's ratio in the middle. From the matrix of its springs."""
    return pulled_layer(weave(Sheet(size, thickness), h), size, axis, young, thickness)


def pulled_layer(woven, size, axis: int, young: float = 1e6, thickness: float = 2e-3) -> tuple[float, float]:
    """The same of a flat layer in the xy plane, a lattice or triangles."""
    place, particles = woven.place[:, :2], len(woven.place)
    low, high = (woven.sides[side] for side in (("-x", "+x"), ("-y", "+y"))[axis])
    held = np.zeros(particles, bool)
    held[low] = held[high] = True
    matrix = stiffness(place, *woven.springs(young, thickness, 1.0, held))
    fixed = np.zeros((particles, 2), bool)
    fixed[low, axis] = fixed[high, axis] = True
    fixed[low[len(low) // 2], 1 - axis] = True
    strain = 0.01
    u = np.zeros((particles, 2))
    u[high, axis] = strain * size[axis]
    free = ~fixed.ravel()
    moved = u.ravel()
    from scipy.sparse.linalg import spsolve

    moved[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix @ moved)[free])
    force = (matrix @ moved).reshape(-1, 2)[high, axis].sum()
    first, last = (woven.sides[side] for side in (("-y", "+y"), ("-x", "+x"))[axis])
    across = moved.reshape(-1, 2)[:, 1 - axis]
    middle = len(first) // 2
    narrower = -(across[last[middle]] - across[first[middle]]) / size[1 - axis]
    return float(force / (young * thickness * size[1 - axis] * strain)), float(narrower / strain)


def stiffness(place: np.ndarray, pair: np.ndarray, value: np.ndarray):
    """The matrix of springs [N/m], sparse, shape (D N, D N), about particles [m], shape (N, D)."""
    from scipy.sparse import csr_matrix

    (i, j), dimensions = pair.T, place.shape[1]
    way = place[j] - place[i]
    length = np.linalg.norm(way, axis=1)
    n = way / length[:, None]
    k, turned = value[:, 0], value[:, 0] * (value[:, 2] - value[:, 1]) / length
    along = n[:, :, None] * n[:, None, :]
    block = k[:, None, None] * along + turned[:, None, None] * (np.eye(dimensions) - along)
    rows, columns, values = [], [], []
    for a, b, sign in ((i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)):
        for p in range(dimensions):
            for q in range(dimensions):
                rows.append(dimensions * a + p)
                columns.append(dimensions * b + q)
                values.append(sign * block[:, p, q])
    size = dimensions * len(place)
    return csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (size, size))


def tip(woven, young: float = 1e6, thickness: float = 2e-3) -> float:
    """How far the end of a flat strip along x yields across its plane, clamped by all within a link of its other end, over
    P l^3/3 E I."""
    from scipy.sparse.linalg import spsolve

    place = woven.place
    pair, value = woven.springs(young, thickness, 1.0, np.zeros(len(place), bool))
    matrix = stiffness(place, pair, value)[2::3][:, 2::3]
    x, width = place[:, 0], np.ptp(place[:, 1])
    held, end = x < x.min() + 1.1 * woven.h, x > x.max() - 1e-9
    bent = spsolve(matrix[~held][:, ~held].tocsc(), end[~held] / end.sum())
    return float(bent[end[~held]].mean() * 3.0 * young * width * thickness**3 / 12.0 / (x.max() - x[held].max()) ** 3)


def blown(woven, young: float = 1e6, thickness: float = 2e-3) -> float:
    """How far a closed sheet around a sphere yields to a pressure inside, over p r^2 (1 - nu)/2 E t."""
    from scipy.sparse.linalg import lsqr

    place, triangle = woven.place, woven.triangle
    pair, value = woven.springs(young, thickness, 1.0, np.zeros(len(place), bool))
    a, b, c = (place[triangle[:, k]] for k in range(3))
    force = np.zeros_like(place)
    np.add.at(force, triangle, (np.cross(b - a, c - a) / 6.0)[:, None])
    r = np.linalg.norm(place, axis=1)
    moved = lsqr(stiffness(place, pair, value), force.ravel(), atol=1e-10, btol=1e-10, iter_lim=20000)[0].reshape(-1, 3)
    out = float((moved * place).sum() / r.sum())
    return out / (float(r.mean()) ** 2 * (1.0 - NU) / (2.0 * young * thickness))


def modulus(size: tuple[float, float], h: float, angle: float) -> tuple[float, float]:
    """Young's modulus by the stress of an even strain along a direction [rad], over that of the sheet, and Poisson's ratio: from
    the springs around a particle in the middle."""
    young, thickness = 1e6, 2e-3
    woven = weave(Sheet(size, thickness), h)
    pair, value = woven.springs(young, thickness, 1.0, np.zeros(len(woven.place), bool))
    middle = int(np.linalg.norm(woven.place, axis=1).argmin())
    i, j = pair.T
    own = (i == middle) | (j == middle)
    way = woven.place[j[own]] - woven.place[i[own]]
    length = np.linalg.norm(way, axis=1)
    n = way / length[:, None]
    k = value[own, 0] * length**2
    tensor = np.einsum("s,sa,sb,sc,sd->abcd", k, n, n, n, n) / (2.0 * woven.h * woven.apart)
    flat = tensor.reshape(4, 4)
    compliance = np.linalg.pinv(flat).reshape(2, 2, 2, 2)
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    one = np.einsum("abcd,a,b,c,d", compliance, along, along, along, along)
    other = np.einsum("abcd,a,b,c,d", compliance, across, across, along, along)
    return float(1.0 / (one * young * thickness)), float(-other / one)


# --- in runs -------------------------------------------------------------------------------------------------------


def stretch(side: str) -> tuple[float, float]:
    """Elongation of a sheet of 1 m that hangs from one side, and rho g L^2/2 E [m]."""
    turn = {"-x": "axis (0, 1, 0) angle 90 deg", "+y": "axis (1, 0, 0) angle 90 deg"}[side]
    size = "(1, 0.1)" if side == "-x" else "(0.1, 1)"
    text = DOWN + sheet(size, "2 mm", f"orientation {turn}", "elasticity 2 MPa", f"hold face {side}", "drag 2 N*s/m")
    x, ready = settled(text, 1.2)
    woven = ready.models[0].frame.woven
    row = woven.sides["+x" if side == "-x" else "-y"]
    start = ready.system.position
    return -float((x - start)[row, 2].mean()), 1000.0 * G / (2.0 * 2e6)


def strip(length: float, width: float, axis: int, *more: str, young: float = 20e6, thickness: float = 4e-3) -> tuple[str, object]:
    """A strip whose first two rows of particles across it are held, and its lattice. It is bent from the middle between both."""
    size = (length, width) if axis == 0 else (width, length)
    shape, elastic = f"({size[0]}, {size[1]})", f"elasticity {young} Pa"
    woven = made(sheet(shape, f"{thickness} m", elastic)).models[0].frame.woven
    far = [1.0, 1.0, 1.0]
    far[axis] = 1.01 * _row(woven, axis) - 0.5 * length
    hold = f"hold within box (-1, -1, -1) m to ({far[0]}, {far[1]}, {far[2]}) m"
    return sheet(shape, f"{thickness} m", elastic, hold, *more), woven


def _row(woven, axis: int) -> float:
    """Distance of the first two rows of particles across a strip [m]."""
    return 0.5 * woven.h if axis == 0 else woven.apart


def cantilever(length: float, width: float, axis: int, thickness: float = 2e-3) -> tuple[float, float]:
    """Deflection of the end of a strip by a small load there, and P l^3/3 E I [m]: from the matrix of its springs."""
    from scipy.sparse.linalg import spsolve

    young = 1e6
    woven = made(strip(length, width, axis, thickness=thickness)[0]).models[0].frame.woven
    row = _row(woven, axis)
    held = woven.place[:, axis] < 1.01 * row - 0.5 * length
    pair, value = woven.springs(young, thickness, 1.0, held)
    matrix = across(pair, value, len(held))
    tip = woven.sides[("+x", "+y")[axis]]
    load = np.zeros(len(held))
    load[tip] = woven.share[tip] / woven.share[tip].sum()
    moved = np.zeros(len(held))
    moved[~held] = spsolve(matrix[~held][:, ~held].tocsc(), load[~held])
    return float(load @ moved), (length - 0.5 * row) ** 3 / (3.0 * young * width * thickness**3 / 12.0)


def across(pair: np.ndarray, value: np.ndarray, particles: int):
    """The matrix of springs across the plane that all particles are in [N/m], sparse, shape (N, N)."""
    from scipy.sparse import csr_matrix

    i, j = pair.T
    turned = value[:, 0] * (value[:, 2] - value[:, 1]) / value[:, 2]
    rows, columns = np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i])
    return csr_matrix((np.concatenate([turned, turned, -turned, -turned]), (rows, columns)), (particles, particles))


ELASTICA = {1.0: (0.30172, 0.05643), 3.0: (0.60325, 0.25442), 6.0: (0.74457, 0.43459), 10.0: (0.81061, 0.55500)}
"""Deflection and shortening of a cantilever, over its length, at P L^2/E I (Bisshopp and Drucker 1945)."""


def elastica(alpha: float, of: int, length: float = 0.5, width: float = 0.06) -> tuple[float, float]:
    """Deflection (0) or shortening (1) of the end of a strip that a force across bends far, over its length."""
    young, thickness = 20e6, 0.01
    text, woven = strip(length, width, 0, "drag 3 N*s/m  damping 0.1", young=young, thickness=thickness)
    free = length - 0.5 * _row(woven, 0)
    force = alpha * young * width * thickness**3 / 12.0 / free**2
    tip = woven.sides["+x"]
    share = woven.share[tip] / woven.share[tip].sum()
    commands = []
    for n, part in enumerate(share.tolist()):
        commands += [f"group tip{n} id {tip[n] + 1}", f"fix push{n} tip{n} addforce 0 0 {-force * part!r}"]
    x, ready = settled(text, 1.6, *commands)
    moved = (share[:, None] * (x - ready.system.position)[tip]).sum(axis=0)
    return float((-moved[2], -moved[0])[of] / free), ELASTICA[alpha][of]


def membrane(sides: str = "hold faces x  hold faces y", size: float = 1.0) -> tuple[float, float]:
    """Depth in the middle of a square sheet that is held at all four sides and sinks by its weight, and that of the membrane."""
    young, thickness = 1e6, 1e-3
    text = DOWN + sheet(
        f"({size}, {size})", f"{thickness} m bending 0", f"elasticity {young} Pa  drag 6 N*s/m  damping 0.2", sides
    )
    x, ready = settled(text, 2.0)
    middle = int(np.linalg.norm(ready.models[0].frame.woven.place, axis=1).argmin())
    pressure = 1000.0 * G * thickness
    return -float(x[middle, 2]), _square_membrane() * 0.5 * size * (pressure * 0.5 * size / (young * thickness)) ** (1.0 / 3.0)


@lru_cache(maxsize=1)
def _square_membrane(terms: int = 4, points: int = 24) -> float:
    """Depth of a square membrane of half side 1, E t = 1, under a load of 1: the least of its energy among series of sines
    (Foeppl's membrane, Ritz), for Poisson's ratio 1/3."""
    from scipy.optimize import minimize

    node, weight = np.polynomial.legendre.leggauss(points)
    place, weight = 0.5 * (node + 1.0), 0.5 * weight  # a quarter of it
    k = 0.5 * np.pi * (2.0 * np.arange(terms) + 1.0)
    c, dc = np.cos(np.outer(place, k)), -k * np.sin(np.outer(place, k))
    q = np.pi * (np.arange(terms) + 1.0)
    s, ds = np.sin(np.outer(place, q)), q * np.cos(np.outer(place, q))
    area = np.outer(weight, weight)

    def energy(values: np.ndarray) -> float:
        w, u = values.reshape(2, terms, terms)
        wx, wy = dc @ w @ c.T, c @ w @ dc.T
        ux, uy, vx, vy = ds @ u @ c.T, s @ u @ dc.T, dc @ u.T @ s.T, c @ u.T @ ds.T
        ex, ey, g = ux + 0.5 * wx**2, vy + 0.5 * wy**2, uy + vx + wx * wy
        stored = 0.5 / (1.0 - NU**2) * (ex**2 + ey**2 + 2.0 * NU * ex * ey + 0.5 * (1.0 - NU) * g**2)
        return float((area * (stored - c @ w @ c.T)).sum())

    begin = np.zeros((2, terms, terms))
    begin[0, 0, 0] = 0.8
    found = minimize(energy, begin.ravel(), method="BFGS", options={"gtol": 1e-7})
    return float(found.x.reshape(2, terms, terms)[0].sum())


def ball_on_membrane(mass: float, a: float = 0.45, radius: float = 0.05) -> tuple[float, float]:
    """Depth at which a rigid ball rests on a round sheet that is held around, below its level, and that of the least energy."""
    young, thickness = 1e7, 1e-3
    rows = np.linspace(-0.5, 0.5, 41)
    holds = []
    for low, high in pairwise(rows.tolist()):
        x = math.sqrt(max(a**2 - (0.5 * (low + high)) ** 2, 0.0))
        holds += [f"hold within box ({p}, {low}, -1) m to ({q}, {high}, 1) m" for p, q in ((-0.6, -x), (x, 0.6))]
    cloth = sheet(
        "(1, 1)", f"{thickness} m bending 0", f"elasticity {young} Pa  drag 3 N*s/m  damping 0.2  resolution 2 cm", *holds
    )
    ball = f"shape sphere {radius} m  position (0, 0, {radius + 0.005}) m  mass {mass} kg  elasticity rigid  drag 30 N*s/m"
    x, ready = settled(f"{DOWN}{cloth}object ball {{ {ball} }}\n", 0.8)
    own = x[ready.system.first[1] :].mean(axis=0)
    return radius - float(own[2]), _ball_on_membrane(a, radius, mass * G / (young * thickness), 1000.0 * G / young)


def _ball_on_membrane(a: float, radius: float, load: float, weight: float, parts: int = 60) -> float:
    """Depth of the lowest place of a ball on a round membrane of the radius a, under F/E t and its own weight for each area over
    E t [1/m]: the least of the energy among surfaces of revolution, with the ball as a stiff penalty."""
    from scipy.optimize import minimize

    r = a * np.linspace(0.0, 1.0, parts + 1) ** 1.5
    step, middle = np.diff(r), 0.5 * (r[1:] + r[:-1])
    ring, hard = 2.0 * math.pi * middle * step, 300.0 / radius**2
    at = np.zeros(parts + 1)
    at[:-1] += 0.5 * ring
    at[1:] += 0.5 * ring

    def energy(values: np.ndarray) -> tuple[float, np.ndarray]:
        u, w, z = np.zeros(parts + 1), np.zeros(parts + 1), values[-1]
        u[1:-1], w[:-1] = values[: parts - 1], values[parts - 1 : -1]
        slope = np.diff(w) / step
        er, et = np.diff(u) / step + 0.5 * slope**2, 0.5 * (u[1:] + u[:-1]) / middle
        tr, tt = (er + NU * et) / (1.0 - NU**2) * ring, (et + NU * er) / (1.0 - NU**2) * ring
        side, away = r + u, np.hypot(r + u, w - z - radius)
        deep = np.maximum(radius - away, 0.0)
        push = hard * at * deep
        total = 0.5 * float(er @ tr + et @ tt) + load * z + weight * float(at @ w) + 0.5 * float(push @ deep)
        du, dw = -push * side / away, weight * at - push * (w - z - radius) / away
        for end, sign in ((slice(1, None), 1.0), (slice(None, -1), -1.0)):
            du[end] += sign * tr / step + 0.5 * tt / middle
            dw[end] += sign * tr * slope / step
        down = load + float((push * (w - z - radius) / away).sum())
        return total, np.concatenate([du[1:-1], dw[:-1], [down]])

    begin = np.zeros(2 * parts)
    begin[parts - 1 : -1] = -0.1 * (1.0 - (r[:-1] / a) ** (2.0 / 3.0))
    begin[-1] = -0.1

    def bend(values: np.ndarray) -> np.ndarray:
        rows = np.array([energy(values + 1e-6 * way)[1] - energy(values - 1e-6 * way)[1] for way in np.eye(len(values))])
        return 2.5e5 * (rows + rows.T)

    return -float(minimize(energy, begin, jac=True, hess=bend, method="trust-exact", options={"gtol": 1e-9}).x[-1])


def fall(friction: float, thickness: float = 2e-3) -> float:
    """Energy that a sheet has gained after it has fallen flat on the ground from 0.5 m, over that of the fall."""
    more = f"position (0, 0, {0.5 + thickness}) m  elasticity 1 MPa  friction {friction}"
    ready = made("ground z 0 m\n" + DOWN + sheet("(1, 0.8)", f"{thickness} m", more), 0.5)
    with Instance(ready.plan) as instance:
        instance.setup()
        begin = energies(instance, ready.system.center_of_mass(instance.array("x")))
        instance.run(round(0.45 / ready.certificate.timestep))
        end = energies(instance, ready.system.center_of_mass(instance.array("x")))
    return float(sum(end.values()) - sum(begin.values())) / (G * float(ready.system.mass.sum()) * 0.5)


BALL = "object ball {{ shape sphere 20 cm  position (0, 0, 0.25) m  density 500 kg/m^3  {what}  friction 0.4 }}\n"
TABLE = "object table {{ shape box (60, 60, 4) cm  position (0, 0, 0.4) m  density 500 kg/m^3  {what}  friction 0.4 }}\n"


def draped(over: str, what: str = "elasticity rigid  hold all", time: float = 1.5) -> tuple[float, float]:
    """How deep the deepest particle of a cloth is in what it lies on, beyond its radius, over the spacing; and 0."""
    text = DOWN + "ground z 0 m\n" + over.format(what=what)
    text += sheet("(1, 1)", "2 mm", "position (0.03, 0.02, 0.5) m  elasticity 1 MPa  damping 0.2  drag 0.3  friction 0.3")
    text = text.replace("1000 kg/m^3", "300 kg/m^3")
    x, ready = settled(text, time)
    own = x[ready.system.first[1] :]
    solid = ready.scene.solids[0]
    place = own - np.array(solid.position)
    inside = shapes.depth(solid.shape, place).max()
    return float(max(0.0, inside, -own[:, 2].min()) / ready.system.spacing[1]), 0.0


SIZES = {"1 m by 1 m": ((1.0, 1.0), 0.025), "1 m by 0.3 m": ((1.0, 0.3), 0.02), "0.3 m by 1 m, coarse": ((0.3, 1.0), 0.04)}
CASES: dict[str, tuple[Callable[[], tuple[float, float]], float]] = {
    **{
        f"pull along {'xy'[axis]}, {name}": (lambda size=size, h=h, axis=axis: (pulled(size, h, axis)[0], 1.0), 0.01)
        for name, (size, h) in SIZES.items()
        for axis in (0, 1)
    },
    **{
        f"modulus at {angle} degrees": (lambda angle=angle: (modulus((1.0, 1.0), 0.025, math.radians(angle))[0], 1.0), 0.01)
        for angle in (0, 15, 30, 45, 90)
    },
    "stretch by its weight, hangs from -x": (lambda: stretch("-x"), 0.01),
    "stretch by its weight, hangs from +y": (lambda: stretch("+y"), 0.01),
    **{
        f"cantilever of {length} m by {width} m along {'xy'[axis]}": (
            lambda length=length, width=width, axis=axis: cantilever(length, width, axis),
            0.02,
        )
        for length, width in ((0.5, 0.05), (0.5, 0.1))
        for axis in (0, 1)
    },
    **{
        f"elastica, P L^2/E I = {alpha:g}, {('deflection', 'shortening')[of]}": (
            lambda alpha=alpha, of=of: elastica(alpha, of),
            0.02,
        )
        for alpha in ELASTICA
        for of in (0, 1)
    },
    "square membrane held at its sides": (membrane, 0.05),
    "ball of 1 kg on a round membrane": (lambda: ball_on_membrane(1.0), 0.05),
    "ball of 5 kg on a round membrane": (lambda: ball_on_membrane(5.0), 0.06),
    "cloth over a held ball": (lambda: draped(BALL), 0.05),
    "cloth over a held table": (lambda: draped(TABLE, time=0.5), 0.05),
}
"""Cases and the largest error of each."""


# --- bending: rods, and the angle between triangles -----------------------------------------------------------------


def angles(woven, rigidity: float):
    """The matrix across the plane of an energy of the angle between each two triangles that share an edge, c (sum a_i w_i)^2/2,
    with c such that the sheet has this flexural rigidity [N m]; sparse, shape (N, N)."""
    from scipy.sparse import csr_matrix

    place, sides = woven.place, {}
    for triangle in woven.triangle.tolist():
        for _ in range(3):
            sides.setdefault(frozenset(triangle[:2]), []).append(triangle[2])
            triangle = triangle[1:] + triangle[:1]
    hinges = [(*sorted(edge), *ends) for edge, ends in sides.items() if len(ends) == 2]
    rows, values = [], []
    for p, q, r, s in hinges:
        way = place[[q, r, s]] - place[p]
        edge = math.hypot(*way[0])
        one, other = (abs(way[0, 0] * w[1] - way[0, 1] * w[0]) / edge for w in way[1:])  # heights of both triangles
        along = [w @ way[0] / edge**2 for w in way[1:]]
        slope = np.array([-(1 - along[0]) / one - (1 - along[1]) / other, -along[0] / one - along[1] / other, 1 / one, 1 / other])
        rows.append((p, q, r, s))
        values.append(math.sqrt(2.0 / math.sqrt(3.0) * rigidity * edge / (0.5 * (one + other)) * math.sqrt(0.75)) * slope)
    index = np.repeat(np.arange(len(rows)), 4)
    matrix = csr_matrix((np.concatenate(values), (index, np.concatenate(rows))), (len(rows), len(place)))
    return matrix.T @ matrix


def bends(kind: str, size: tuple[float, float] = (0.5, 0.1), h: float = 0.01) -> dict[str, float]:
    """How far the end of a strip along x yields to a force and to a couple about x, over P l^3/3 E I and M l/G J."""
    from scipy.sparse.linalg import spsolve

    young, thickness = 1e6, 2e-3
    woven = weave(Sheet(size, thickness), h)
    held = woven.place[:, 0] < 0.51 * woven.h - 0.5 * size[0]
    rigidity = young * thickness**3 / 12.0 / (1.0 - NU**2)
    rods = across(*woven.springs(young, thickness, 1.0, held), len(held))
    matrix = rods if kind == "rods" else angles(woven, rigidity).tocsr()
    tip = woven.sides["+x"]
    share, arm = woven.share[tip] / woven.share[tip].sum(), woven.place[tip, 1]
    free, found = size[0] - 0.25 * woven.h, {}
    for name, load in (("force", share), ("couple", share * arm / (share * arm**2).sum())):
        full = np.zeros(len(held))
        full[tip] = load
        moved = np.zeros(len(held))
        moved[~held] = spsolve(matrix[~held][:, ~held].tocsc(), full[~held])
        found[name] = float(load @ moved[tip])
    shear = young / (2.0 * (1.0 + NU))
    width = size[1]
    return {
        "force": found["force"] * 3.0 * young * width * thickness**3 / 12.0 / free**3,
        "couple": found["couple"] * shear * width * thickness**3 / 3.0 / free,
    }
