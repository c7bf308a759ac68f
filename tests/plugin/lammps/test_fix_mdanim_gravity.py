# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/gravity with a path: force at a time and work from step to step, both against numpy."""

import numpy as np
import plugin_lab as lab
import pytest
from filming import WIDTHS, supported

BLOCK = lab.block((3, 3, 3), velocity=(0.3, 0.0, -0.2))
DT, STEPS = 0.005, 60
TIMES = (0.01, 0.05, 0.2)
VALUES = ((1.0, 0.0, 0.0), (-1.0, 2.0, 0.5), (0.0, 0.0, -3.0))
PATH = "fix g all mdanim/gravity path " + " ".join(f"{t} {x} {y} {z}" for t, (x, y, z) in zip(TIMES, VALUES))


def acceleration(time: float) -> np.ndarray:
    """The path by numpy's interpolation."""
    return np.array([np.interp(time, TIMES, [v[d] for v in VALUES]) for d in range(3)])


@pytest.mark.parametrize("time", [0.0, 0.01, 0.03, 0.05, 0.125, 0.3])
def test_force_at_a_time(tmp_path, time):
    """m g(t), whatever the steps before were."""
    commands = ["bond_coeff * 0.0 1.0", PATH, f"timestep {DT}", f"reset_timestep {round(time / DT)}", "run 0"]
    lmp = lab.load(BLOCK, tmp_path, commands)
    forces = lab.by_tag(lmp, "f")
    lmp.close()
    np.testing.assert_allclose(forces, BLOCK.mass[:, None] * acceleration(time), rtol=1e-12, atol=1e-15)


def test_work_is_what_the_motion_has_gained(tmp_path):
    """Without springs a block flies: its kinetic energy grows by the work, to the second order of the step."""
    commands = ["bond_coeff * 0.0 1.0", PATH, "fix run all mdanim/leapfrog", f"timestep {DT}", "run 0"]
    lmp = lab.load(BLOCK, tmp_path, commands)
    before = lab.kinetic(BLOCK, lab.by_tag(lmp, "v"))
    lmp.commands_list([f"run {STEPS // 2}", f"run {STEPS - STEPS // 2} pre no post no"])
    gained = lab.kinetic(BLOCK, lab.by_tag(lmp, "v")) - before
    work = lmp.extract_fix("g", 0, 1, 0)
    lmp.close()
    assert work == pytest.approx(gained, rel=2e-3)  # dt^2/8 of the squares of g at both ends
    times = DT * np.arange(STEPS + 1)
    g = np.array([acceleration(t) for t in times])
    v = np.array([0.3, 0.0, -0.2]) + np.concatenate([np.zeros((1, 3)), np.cumsum(0.5 * DT * (g[1:] + g[:-1]), axis=0)])
    assert gained == pytest.approx(0.5 * BLOCK.mass.sum() * ((v[-1] ** 2) - v[0] ** 2).sum(), rel=1e-9)


@pytest.mark.parametrize("width", [w for w in WIDTHS if supported(w)])
def test_passes_take_an_acceleration_that_changes(tmp_path, width):
    """The same motion as in plain steps, bit for bit, and the same work, also where outputs come between passes."""
    found = []
    for style in ("verlet", f"verlet/mdanim width {width}"):
        log = tmp_path / "log"
        commands = [f"log {log}", PATH, "fix run all mdanim/leapfrog", f"timestep {DT}", f"run_style {style}"]
        lmp = lab.load(BLOCK, tmp_path, [*commands, "thermo 7", f"run {STEPS}", f"run {STEPS} pre no post no"])
        found.append((lab.by_tag(lmp, "x"), lab.by_tag(lmp, "v"), lmp.extract_fix("g", 0, 1, 0)))
        lmp.close()
        assert "no passes" not in log.read_text()
    (x, v, work), (x_of_passes, v_of_passes, work_of_passes) = found
    assert x.tobytes() == x_of_passes.tobytes() and v.tobytes() == v_of_passes.tobytes()
    assert work != 0.0 and work_of_passes == pytest.approx(work, rel=1e-12)  # sums of a few dozen particles in another order


@pytest.mark.parametrize(("words", "told"), [
    ("path", "path T gx gy gz"), ("path 0 1 2", "path T gx gy gz"), ("path 0 1 2 3 4", "1 words are too many"),
    ("path 1 0 0 0 1 0 0 0", "times of a path ascend, got 1 behind 1"), ("path a 0 0 0", "Expected floating point"),
])  # fmt: skip
def test_words(tmp_path, words, told):
    """Missing words, a point too short, times that do not ascend, words that are not numbers."""
    with pytest.raises(Exception, match=told):
        lab.load(BLOCK, tmp_path, [f"fix g all mdanim/gravity {words}"])
