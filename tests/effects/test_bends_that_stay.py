# SPDX-License-Identifier: GPL-2.0-only
"""Sheets and ropes that yield, against closed forms: what stays of a bend and of a pull, energies, the bound."""

import numpy as np
import pytest
from bend_cases import by_law, by_section, kept, plastic, strip
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.features.yielding import bends
from mdanim_lammps.model.bends import BLUNT
from mdanim_lammps.run.energy import energies, least_energy


@pytest.mark.parametrize("axis", [0, 1])
def test_a_strip_springs_back_by_its_plastic_moment(axis):
    """Bent to a curvature and not across it has the moment of a section that yields all through, E e t^2/4 for each width: of it
    stays where its energy is least."""
    e = 0.003
    k = 2.0 * plastic(e)
    found = kept(strip(e, axis), k, axis)
    assert found == pytest.approx(by_law(k, plastic(e), axis), rel=0.02)
    assert found == pytest.approx(by_section(k, plastic(e), axis), rel=0.05)


def test_energies_of_a_crease():
    """A strip that is folded all at once: all energies and what is gone add up, and it stays bent."""
    ready = strip(0.01, 0, damping=0.3)
    x = ready.system.position - ready.system.position.mean(0)
    told = []
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.array("v")[:, 2] = 3.0 * np.sign(np.abs(x[:, 0]) - 0.01)
        for _ in range(12):
            instance.run(100)
            told.append(energies(instance, ready.system.center_of_mass(instance.array("x"))))
        bent = instance.column("bent")
    sums = [sum(one.values()) for one in told]
    assert told[-1]["yielding"] > 0.1 * told[0]["kinetic"]
    assert np.ptp(sums[1:]) < 1e-3 * told[-1]["yielding"]
    assert min(one["elastic"] for one in told) > 0.0 and np.abs(bent).max() > 10.0


@pytest.mark.parametrize(
    "shape", ["sheet (4, 1.5) cm thickness 1 mm", "rope from (-0.02, 0, 1) m to (0.02, 0, 1) m thickness 2 mm"]
)
def test_what_is_pulled_stays_longer(prepared, shape):
    """By three times its yield-strain, and narrower by a third of that: it comes to rest at twice its yield-strain."""
    e = 0.01
    place = "" if shape.startswith("rope") else "position (0, 0, 1) m"
    text = (
        f"object a {{ shape {shape}  {place}  resolution 2.5 mm  density 1000  elasticity 10 MPa  damping 1  yield-strain {e} }}"
    )
    ready = prepared(text + "\ncontrol { time 0.1 s }\n")
    start = ready.system.position
    with Instance(ready.plan) as instance:
        instance.setup()
        middle = start.mean(0)
        instance.array("x")[:] = middle + (start - middle) * np.array([1.0 + 3.0 * e, 1.0 - e / 3.0, 1.0])
        instance.run(1500)
        x = instance.array("x").copy()
    assert np.ptp(x[:, 0]) / np.ptp(start[:, 0]) - 1.0 == pytest.approx(2.0 * e, rel=0.03)


def test_what_a_rope_does_not_do_is_told(prepared):
    """It stays longer, and not bent."""
    text = (
        "object a { shape rope from (0, 0, 1) m to (1, 0, 1) m thickness 1 cm  density 1000  elasticity 1 MPa  yield-strain 0.1 }"
    )
    (note,) = [one for one in prepared(text + "\ncontrol { time 0.1 s }\n").certificate.notes if "bent" in one.message]
    assert "a keeps what it is pulled to" in note.message and "shape sheet" in note.hint


@pytest.mark.soak
def test_a_curved_sheet_that_yields_stays_as_it_is_drawn(prepared):
    """It is free of stress: one without yield-strain opens."""
    shape = "cylinder 3 cm 5 cm sheet thickness 0.5 mm"
    text = f"object a {{{{ shape {shape}  position (0, 0, 1) m  resolution 1.2 cm  density 1000  elasticity 10 MPa  {{}} }}}}\n"
    moved = []
    for word in ("", "yield-strain 0.02"):
        ready = prepared(text.format(word) + "control { time 0.1 s }\n")
        with Instance(ready.plan) as instance:
            instance.setup()
            instance.run(300)
            moved.append(np.abs(instance.array("x") - ready.system.position).max())
    assert moved[1] < 0.02 * moved[0]


def test_the_stiffness_of_rings():
    """The bound is above the largest one of random rings of six, flat to folded flat."""
    chance, angle = np.random.default_rng(2), np.arange(6) * np.pi / 3.0
    flat = np.vstack([np.zeros(3), np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])])
    weight = np.zeros((3, 7))
    for line in range(3):
        weight[line, [0, 1 + line, 4 + line]] = -2.0, 1.0, 1.0
    area = 3.0 * np.sqrt(3.0)

    def energy(x, bend):
        arm = x[..., 1:, :] - x[..., :1, :]
        normal = np.cross(arm, np.roll(arm, -1, axis=-2)).sum(axis=-2)
        normal /= np.sqrt((normal**2).sum(-1, keepdims=True) + (BLUNT * area) ** 2) / np.sqrt(1.0 + BLUNT**2)
        return -np.einsum("l,lk,...ka,...a->...", bend, weight, x, normal)

    step = 1e-4 * np.eye(21).reshape(21, 7, 3)
    signs = np.array([(1, 1), (1, -1), (-1, 1), (-1, -1)], float)
    most = 0.0
    for fold in np.linspace(0.0, 3.1, 12):
        x = flat.copy()
        turn = chance.uniform(0.0, np.pi)
        along, across = flat[:, :2] @ [np.cos(turn), np.sin(turn)], flat[:, :2] @ [-np.sin(turn), np.cos(turn)]
        x = np.column_stack([along, across * np.cos(fold / 2), -np.abs(across) * np.sin(fold / 2)])
        x += chance.normal(0.0, chance.choice([0.0, 0.1, 0.3]), x.shape)
        bend = chance.choice([-1.0, 1.0], 3)
        both = x + signs[:, 0, None, None, None, None] * step[:, None] + signs[:, 1, None, None, None, None] * step[None]
        found = np.einsum("s,sij->ij", signs.prod(axis=1), energy(both, bend)) / 4e-8
        most = max(most, float(np.abs(np.linalg.eigvalsh(found)).max()))
    # c, b and l are 1, w is 2.
    assert 5.0 < most < bends.STIFFEST * 3.0 * 2.0 / area


def test_rounding_of_a_sheet_at_rest_is_no_residual(prepared):
    """Where nothing happens: its springs over two links store more than any strain of it."""
    text = (
        "object a { shape sheet (20, 2) cm thickness 1.5 mm  position (0, 0, 1) m  resolution 5 mm  density 1  elasticity 10 MPa"
    )
    ready = prepared(text + " }\ncontrol { time 0.05 s }\n")
    assert least_energy(ready.scene, ready.system) > 1e3 * np.spacing(ready.system.preload_energy.sum())
