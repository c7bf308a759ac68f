# SPDX-License-Identifier: GPL-2.0-only
"""Objects that start within reach of each other: the energy of the start, and the gap that leaves none."""

import math
import re

import numpy as np
import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.contact.touching import REACH, THIN, touching, touching_pairs

STUFF = "density 1000 kg/m^3 elasticity 1 MPa"
WORLD = "gravity (0, 0, -9.81) m/s^2\nground z 0 m\n"
END = "\ncontrol {{ time 1 s contact-model paper }}\n"
STACK = (
    WORLD
    + "repeat k in 0 .. 5 {{ object cube[k] {{ shape box (10, 10, 10) cm position (0, 0, 5 + {each}*k) cm {stuff} }} }}"
    + END
)
DOMINOES = (
    WORLD + "repeat k in 0 .. 5 {{ object piece[k] {{ shape box (2, 5, 10) cm position ({each}*k, 0, 5) cm {stuff} }} }}" + END
)
BALL = WORLD + "object ball {{ shape sphere 10 cm position (0, 0, {each}) cm {stuff} }}" + END
SHEETS = (
    "object low { shape box (6, 6, 1) cm position (0, 0, 5) cm STUFF }\n"
    "object high { shape box (6, 6, 1) cm position (2, 0, 6) cm orientation axis (0, 0, 1) angle 20 deg STUFF }\n"
    "object block { shape box (4, 4, 5) cm position (0, 0, 9.5) cm STUFF hold face -y }\n"
    "object stone { shape box (4, 4, 4) cm position (30, 0, 12) cm STUFF hold all }\n"
    "object chip { shape box (3, 2, 2) cm position (30, 0, 15.2) cm STUFF }\n"
    "control { time 1 s resolution 1 cm contact-model paper }"
).replace("STUFF", STUFF)


def start_warnings(ready):
    """The warnings about energy at the start."""
    return [w for w in ready.warnings if "at the start and pushes" in w.message]


def stiffness(system):
    """E h, less where few cells stand behind a particle [N/m]."""
    return (system.young * np.cbrt(system.cell_volume))[system.object] * np.minimum(1.0, 2.0 * system.share)


def naive(system):
    """Energy of each pair of objects [J] by a loop over all pairs of particles."""
    energy = {}
    layer, owner, x = (a.tolist() for a in (system.layer, system.object, system.position))
    k = stiffness(system).tolist()
    for i in range(system.particles):
        for j in range(i + 1, system.particles):
            if owner[i] == owner[j] or (system.held[i] and system.held[j]):
                continue
            on_surface = system.boundary[i], system.boundary[j]
            factor = 1.0 if on_surface[0] != on_surface[1] else THIN if all(on_surface) and 4 in (layer[i], layer[j]) else 0.0
            reach = factor * REACH * max(system.spacing[owner[i]], system.spacing[owner[j]])
            r = math.dist(x[i], x[j])
            if r < reach:
                u = 2 * k[i] * k[j] / (k[i] + k[j]) * reach**2 / 3 * (1 - r / reach) ** 3
                energy[owner[i], owner[j]] = energy.get((owner[i], owner[j]), 0.0) + u
    return energy


def test_energies_are_those_of_a_loop_over_all_pairs_and_of_lammps(prepared):
    """Thin sheets, a block that rests on them, one that is held in part, and a chip above a stone that never moves."""
    ready = prepared(SHEETS)
    system = ready.system
    assert (system.layer == 4).any() and system.still.sum() == 1
    found = {tuple(sorted((t.first, t.second))): t.energy for t in touching(system, stiffness(system))}
    expected = naive(system)
    assert found.keys() == expected.keys() and len(found) >= 3
    for pair, energy in expected.items():
        assert found[pair] == pytest.approx(energy, rel=1e-12)
    with Instance(ready.plan) as instance:
        instance.setup()
        assert instance.fix_scalar("contact") == pytest.approx(sum(found.values()), rel=1e-12)


def test_each_pair_of_particles_counts_once(prepared):
    """Two thin particles are boundary and barrier of each other."""
    system = prepared(SHEETS).system
    one, other, _, _ = touching_pairs(system, stiffness(system))
    pairs = np.sort(np.stack([one, other], axis=1), axis=1)
    assert len(np.unique(pairs, axis=0)) == len(pairs)


def test_the_move_is_the_least_that_leaves_no_energy(prepared):
    """Moved by the whole of it no pair is within reach; by a part of it some are."""
    ready = prepared(SHEETS)
    system = ready.system
    ways = np.concatenate([np.eye(3), -np.eye(3)])
    for t in touching(system, stiffness(system)):
        moved = slice(system.first[t.second], system.first[t.second + 1])
        for part, parted in ((1.0, True), (0.98, False)):
            position = system.position.copy()
            position[moved] += part * t.move * ways[t.way]
            left = touching(type(system)(**{**vars_of(system), "position": position}), stiffness(system))
            assert ({t.first, t.second} not in [{u.first, u.second} for u in left]) == parted
        assert not system.still[t.second]


def vars_of(system) -> dict:
    """The fields of a system."""
    from dataclasses import fields

    return {f.name: getattr(system, f.name) for f in fields(system)}


@pytest.mark.parametrize(
    ("text", "each", "names", "joules"),
    [
        pytest.param(STACK, 10, ("cube[1]", "cube[0]", "5 pairs"), 14.0, id="a stack of six cubes that touch"),
        pytest.param(DOMINOES, 2, ("piece[1]", "piece[0]", "5 pairs"), 2.15, id="dominoes side by side"),
        pytest.param(BALL, 10, ("ball", "the ground"), 0.408, id="a ball at the height of its radius"),
    ],
)
def test_what_a_newcomer_writes_is_told(prepared, text, each, names, joules):
    """Name the pair, the energy and the gap; with that gap between all, there is nothing to tell."""
    (warning,) = start_warnings(prepared(text.format(each=each, stuff=STUFF)))
    assert all(re.sub(r"\d", "", name) in re.sub(r"\d", "", warning.message) for name in names)
    told = float(re.search(r"holds ([\d.]+) J", warning.message)[1])
    assert told == pytest.approx(joules, rel=0.1)
    assert warning.span is not None
    by = re.search(r"by ([\d.]+) (mm|cm); or write (contact-model surface) in control", warning.hint)
    gap = float(by[1]) / (10 if by[2] == "mm" else 1)
    assert not start_warnings(prepared(text.format(each=each + gap, stuff=STUFF)))
    assert not start_warnings(prepared(text.format(each=each, stuff=STUFF).replace("contact-model paper", by[3])))


def test_the_way_out_of_what_lies_askew_is_a_move(prepared):
    """Boxes around two turned cubes overlap though the cubes do not: there is no gap to be told, and the move is enough."""
    cube = "object {} {{ shape box (10, 10, 10) cm position ({}, {!r}, 0) cm orientation axis (0, 0, 1) angle 45 deg {} }}\n"
    text = lambda y: cube.format("a", 0, 0.0, STUFF) + cube.format("b", 7.35, y, STUFF) + END.format()
    (warning,) = start_warnings(prepared(text(7.35)))
    by = re.match(r"move b to \+y by ([\d.]+) cm;", warning.hint)
    assert not start_warnings(prepared(text(7.35 + float(by[1]))))


@pytest.mark.parametrize("model", ["paper", "surface"])
def test_after_the_way_out_of_an_overlap_contact_holds_no_energy(prepared, model):
    """Make the move that the message about an overlap names."""
    from mdanim_lammps.errors import SceneError

    text = (
        "object a {{ shape box (10, 10, 10) cm position (0, 0, 5) cm STUFF }}\n"
        "object b {{ shape sphere 6 cm position (1, 0, {z}) cm STUFF }}" + END
    )
    text = text.replace("STUFF", STUFF).replace("paper", model)
    with pytest.raises(SceneError) as error:
        prepared(text.format(z=12))
    (problem,) = error.value.problems
    step = re.fullmatch(r"move it up by ([\d.]+) cm", problem.hint)
    assert not prepared(text.format(z=12 + float(step[1]))).warnings


def test_a_crowd_is_culled_by_boxes(prepared):
    """512 cubes that stand apart have no pair to look at; one that touches is found among them."""
    crowd = "".join(
        f"object c{k} {{ shape box (2, 2, 2) m position ({6 * (k % 8)}, {6 * (k // 8 % 8)}, {6 * (k // 64)}) m {STUFF} }}\n"
        for k in range(511)
    )
    more = "object last {{ shape box (2, 2, 2) m position (0, 0, {z}) m {stuff} }}\ncontrol {{ time 1 s resolution 1 m }}"
    apart = prepared(crowd + more.format(z=-3.5, stuff=STUFF)).system
    assert touching(apart, stiffness(apart)) == []
    close = prepared(crowd + more.format(z=-2, stuff=STUFF)).system
    (found,) = touching(close, stiffness(close))
    assert {found.first, found.second} == {0, 511}
