# SPDX-License-Identifier: GPL-2.0-only
"""fix mdanim/liquid with model waves: its clock is that of the run, whatever the words for its pace."""

import numpy as np
import plugin_lab as lab
import pytest
from liquid_lab import BASIN, POOL, lattice

CLOCK = 21
PERIOD = 60.0
LOOK = 10 * 0.4
"""Steps between two looks, at most, times their longest: part of a wait that is told by the step of now."""
PADDLE = f"{POOL} model waves wave -x 0.2 {PERIOD}"


def pool(tmp_path, command=PADDLE, dt=0.3):
    """A basin with a block that is held at its middle, ready to run."""
    block = lab.block((2, 2, 2), (-1.0, -1.0, 12.0))
    return lab.load(
        block,
        tmp_path,
        [
            "fix table all property/atom i2_cell 7 ghost yes",
            *lattice(block, (2, 2, 2)),
            *BASIN,
            f"{command} cells i2_cell still all",
            f"timestep {dt}",
        ],
    )


def clock(lmp) -> float:
    """Time that the liquid has gone through."""
    return lmp.extract_fix("water", 0, 1, CLOCK)


def period_of(times, volume) -> float:
    """Period of the sine that fits a volume best."""

    def missed(period):
        base = np.stack([np.sin(2 * np.pi * times / period), np.cos(2 * np.pi * times / period), np.ones_like(times)], axis=1)
        return np.linalg.lstsq(base, volume, rcond=None)[1][0]

    trial = np.arange(0.6, 1.8, 2e-3) * PERIOD
    return float(trial[np.argmin([missed(period) for period in trial])])


@pytest.mark.parametrize("dt", [0.1, 0.3, 0.37, 0.45])
@pytest.mark.parametrize(
    "pace", ["every 1", "every 2", "every 4", "every 8", "every 40", "every 4 period 1", "every 4 period 100"]
)
def test_the_pace_changes_no_frequency(tmp_path, dt, pace):
    """Times between looks from a hundredth to 1.8 of sqrt(cell/g), and periods that are longer than liquid goes on at once: the
    clock is that of the run, and what a paddle pushes in comes and goes with its period, within 1 %."""
    lmp, volume = pool(tmp_path, f"{PADDLE} {pace}", dt), []
    steps = int(2.0 / dt)
    for _ in range(150):
        lmp.command(f"run {steps} post no")
        volume.append(lmp.extract_fix("water", 0, 1, 0))
    times = np.arange(1, 151) * steps * dt
    assert clock(lmp) == pytest.approx(times[-1], rel=1e-12)
    assert period_of(times[times > PERIOD], np.array(volume)[times > PERIOD]) == pytest.approx(PERIOD, rel=0.01)
    lmp.close()


def test_another_step_or_pace_between_runs_leaves_out_no_time(tmp_path):
    """Neither a new time step in the middle of a wait, nor other looks, nor steps numbered anew."""
    lmp, time = pool(tmp_path), 0.0
    lmp.command("run 0")
    for command, dt, steps in [
        ("timestep 0.3", 0.3, 101), ("timestep 0.11", 0.11, 103), ("fix_modify water every 10", 0.11, 37),
        ("timestep 0.4", 0.4, 50), ("fix_modify water every 3", 0.4, 100),
    ]:  # fmt: skip
        lmp.command(command)
        lmp.command(f"run {steps}")
        time += steps * dt
        assert clock(lmp) == pytest.approx(time, abs=LOOK)
    lmp.command("reset_timestep 0")
    lmp.command("run 30")
    assert clock(lmp) == pytest.approx(time + 12.0, abs=LOOK)
    lmp.close()
