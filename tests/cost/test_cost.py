# SPDX-License-Identifier: GPL-2.0-only
"""What a run cost, by effect and scene line; what it will cost, told before; and the calibration that this needs."""

import json
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from mdanim_lammps.cost import calibration as calibrating
from mdanim_lammps.cost.calibration import RATES, calibration, stored_at
from mdanim_lammps.cost.forecast import fastest, forecast, moves, rebuilds
from mdanim_lammps.cost.meetings import meetings
from mdanim_lammps.effects import EFFECTS, springs
from mdanim_lammps.effects.springs import fullness
from mdanim_lammps.report import check_json, cost_line, forecast_line
from mdanim_lammps.results.cost import Cost, CostShare
from mdanim_lammps.run.frame_source import Account, add_clocks
from mdanim_lammps.run.loop import simulate

POND = """gravity (0, 0, -9.81) m/s^2
walls from (-1, -1, 0) m to (1, 1, 3) m
ground z 0 m
object duck {
  shape box (20, 20, 20) cm
  position (0, 0, 60) cm
  density 500
  elasticity 200 kPa
  damping 0.1
  drag 0.5
}
object stone {
  shape box (20, 20, 20) cm
  position (0.1, 0, 0.85) m
  density 2000
  elasticity 200 kPa
}
liquid water {
  basin from (-0.5, -0.5, 0) m to (0.5, 0.5, 1) m
  density 1000
  level 0.4 m
}
control {
  time 3 s
  frames 2 fps
  resolution 5 cm
}
"""
RATE = dict.fromkeys(RATES, 1.0)


@pytest.fixture(scope="module")
def pond(tmp_path_factory):
    """A scene with every effect, and the result of its run:
    so long that a few milliseconds that others take are no share of it."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    folder = tmp_path_factory.mktemp("pond")
    (folder / "pond.txt").write_text(POND)
    started = time.perf_counter()
    ready = prepare(load_scene(folder / "pond.txt"))
    return ready, simulate(ready, folder, started=started)


# --- what it cost -------------------------------------------------------------------------------------------


def test_parts_add_up_to_the_wall_time(pond):
    """Leave less than a twentieth of the wall time, from the first word of the scene to the last frame, to nobody."""
    cost = pond[1].cost
    assert 0.95 <= cost.covered <= 1.0 + 1e-9
    assert all(seconds >= 0.0 for seconds in cost.parts.values())
    assert cost.other["setup"] > 0.0 and cost.other["output"] > 0.0


def test_every_effect_has_its_seconds_and_its_line(pond):
    """Tell the seconds of each effect that is on, tied to the scene line that called for it."""
    ready, result = pond
    assert list(result.cost.effects) == [e.name for e in EFFECTS]  # all of them are on
    for name, part in result.cost.effects.items():
        assert part.seconds > 0.0 or name in ("walls", "contact"), name
        assert part.place == str(ready.verdicts[name].span)
        assert not part.clocks or part.seconds == pytest.approx(sum(part.clocks.values()))
    assert result.cost.effects["damping"].place.endswith("pond.txt:9:11")


def test_no_second_is_counted_twice(pond):
    """Share the clocks of springs, leap-frog and coupling among all that run under them."""
    ready, _ = pond
    instance = SimpleNamespace(
        plan=ready.plan,
        bond_seconds=lambda: 100.0,
        fix_seconds=lambda fix: 10.0 if fix == "leapfrog" else 0.0,
        fix_value=lambda fix, k: {7: 1.0, 8: 2.0, 9: 4.0}[k],
        array=lambda name: ready.plan.columns["lambda"],
    )
    clocks = {e.name: e.clocks(instance) for e in EFFECTS}
    account = Account()
    add_clocks(account, instance)
    assert account.effects == clocks
    assert sum(clocks["springs"].values()) + sum(clocks["damping"].values()) == pytest.approx(100.0)
    assert clocks["liquid"] == {"automaton": 1.0, "occupancy": 2.0}
    assert clocks["buoyancy"]["coupling"] + clocks["liquid-drag"]["coupling"] == pytest.approx(4.0)
    # Half of the particles have drag of air: each costs the leap-frog 1/(1 - 0.3) = 10/7 times as much as one without.
    assert sum(c.get("leap-frog", 0.0) for c in clocks.values()) == pytest.approx(10.0 * 3.0 / 17.0)
    assert account.leapfrog == pytest.approx(10.0 * 14.0 / 17.0)


def test_cost_json_is_the_cost(pond):
    """Write what the result holds, with shares of the wall time, and read it back."""
    _, result = pond
    data = json.loads((result.folder / "cost.json").read_text())
    assert Cost.read(result.folder / "cost.json") == result.cost
    assert data["effects"]["springs"]["share"] == pytest.approx(data["effects"]["springs"]["seconds"] / data["wall"])
    assert set(data["effects"]["liquid"]["clocks"]) == {"automaton", "occupancy"}
    assert data["particles"] == 250 and data["steps"] == pond[0].certificate.steps


def test_cost_line_has_the_largest_first():
    """Order the parts by their share and leave out what is nothing."""
    cost = Cost(10.0, 1, 1, {"springs": CostShare(6.0), "walls": CostShare(0.01)}, {"output": 3.9})
    line = cost_line(SimpleNamespace(cost=cost), 5.0)
    assert line == "cost     springs 60%  output 39%   total 10.0 s, 2 s of computing per second of film"


# --- what it will cost --------------------------------------------------------------------------------------


def test_a_forecast_has_the_parts_of_a_cost(pond):
    """Name the same effects and lines as the run does, and work of the same names, with the same steps and particles."""
    ready, result = pond
    told = forecast(ready, RATE)
    assert list(told.effects) == list(result.cost.effects)
    assert {"leap-frog", "rest of the step", "setup", "output"} == set(told.other) <= set(result.cost.other)
    assert [p.place for p in told.effects.values()] == [p.place for p in result.cost.effects.values()]
    assert (told.steps, told.particles) == (result.cost.steps, result.cost.particles)
    assert told.covered == pytest.approx(1.0) and min(told.parts.values()) > 0.0


def test_a_forecast_counts_the_work(pond):
    """Take steps times springs, steps times particles, and frames; twice the time is twice the work."""
    ready, _ = pond
    told, steps = forecast(ready, RATE, setup=7.0), ready.certificate.steps
    full = fullness(ready.system.spring, calibrating.lanes(damped=True))  # one of the two objects is
    assert told.effects["springs"].seconds == steps * len(ready.system.spring) / full
    assert told.effects["damping"].seconds == steps * 0.5 * len(ready.system.spring) / full
    assert told.other["leap-frog"] == steps * 250
    assert forecast(ready, RATE | {"lone leap-frog": 2.0}).other["leap-frog"] == 2 * steps * 250  # all of it may get wet
    assert forecast(ready, RATE | {"leap-frog": 2.0}).other["leap-frog"] == steps * 250
    assert told.other["setup"] == 7.0 + 1.0 + 250
    assert forecast(ready, RATE | {"spring": 3.0}).effects["springs"].seconds == 3 * told.effects["springs"].seconds
    assert forecast(ready, RATE | {"frame": 11.0}).other["output"] - told.other["output"] == pytest.approx(10 * 7)
    long = replace(ready.scene, control=replace(ready.scene.control, time=6.0))
    twice = replace(ready, scene=long, certificate=replace(ready.certificate, frames=12))
    assert rebuilds(twice) == pytest.approx(2 * rebuilds(ready))
    assert forecast(twice, RATE).effects["buoyancy"].seconds == 2 * told.effects["buoyancy"].seconds
    assert forecast(twice, RATE).effects["liquid"].seconds == pytest.approx(2 * told.effects["liquid"].seconds)


def test_lanes_have_work_where_springs_are_alike():
    """Count vectors of springs: two for each block, and one for each length of springs in it."""
    chain = np.stack([np.arange(7), np.arange(1, 8)], axis=1)
    assert fullness(chain, 4) == 7 / (4 * (2 * 2 + 2))
    uneven = np.array([[0, 1], [1, 3], [2, 5], [3, 7]])  # each of another length
    assert fullness(uneven, 4) == 4 / (4 * (2 + 4))
    assert fullness(np.zeros((0, 2), np.int32), 4) == 1.0


def test_balls_leave_lanes_idle(prepared):
    """Expect more of each spring of a ball than of a cube, and more again where vectors are wide."""
    text = "object a {{ shape {} position (0, 0, 0) mass 1 elasticity 1e6 }}\ncontrol {{ time 1 s resolution 4 cm }}\n"
    cube, ball = (prepared(text.format(shape)).system.spring for shape in ("box (0.6, 0.6, 0.6)", "sphere 20 cm"))
    assert fullness(ball, 8) < fullness(ball, 4) < 0.9 * fullness(cube, 4)


def test_some_of_many_springs_tell_of_all(monkeypatch):
    """Find in stretches of a long body what all of it would tell, within a hundredth, though it changes along the way."""
    first = np.repeat(np.arange(200_000), 3)
    length = np.tile([1, 20, 400], 200_000) + (first > 120_000) * (first % 3)
    many = np.stack([first, first + length], axis=1).astype(np.int32)
    assert len(many) > springs.SAMPLE
    found = fullness(many, 4)
    monkeypatch.setattr(springs, "SAMPLE", len(many))
    assert found == pytest.approx(fullness(many, 4), rel=0.01)
    assert fullness(many[:300_000], 4) > 1.2 * fullness(many[-200_000:], 4)


def test_speeds_come_from_falls(prepared):
    """Take the fall to the ground for the speed that rebuilds lists, and the mean of the free flight where there is none."""
    text = (
        "gravity (0, 0, -9.81)\n{}\nobject a {{ shape box (0.1, 0.1, 0.1) position (0, 0, 1.05) mass 1 elasticity 1e6 }}\n"
        "control {{ time 1 }}\n"
    )
    assert fastest(prepared(text.format("ground z 0"))) == pytest.approx(2.5 * (2 * 9.81) ** 0.5)
    assert fastest(prepared(text.format(""))) == pytest.approx(0.5 * 9.81, rel=1e-3)


STACK = """gravity (0, 0, -9.81)
ground z 0
repeat k in 0 .. 2 {{
  object cube[k] {{
    shape {shape}
    position ({apart}*k, 0, 0.1 + {step}*k)
    density 1000
    elasticity 1 MPa
  }}
}}
control {{ time {time} resolution 5 cm friction 0.5 }}
"""
BOX, BALL = "box (0.2, 0.2, 0.2)", "sphere 0.1"


def surfaces(prepared, **text):
    """What is near in a stack of three, and the forecast with a rate of 1 for everything."""
    ready = prepared(STACK.format(**{"shape": BOX, "apart": 0.0, "step": 0.2, "time": 1} | text))
    return meetings(ready), forecast(ready, RATE), ready


def test_what_lies_on_another_touches(prepared):
    """Count a side of both for each pair of cubes that lie on each other, and one for the plane; count particles once."""
    met, _, _ = surfaces(prepared)
    side = 6 * 5**2 / 6
    assert met["contact"].touching == pytest.approx(4 * side)
    assert met["ground"].touching == pytest.approx(side)
    assert met["contact"].handed == 3 * 125
    assert 0.5 * 6 * 150 < met["contact"].near <= 6 * 150
    balls, _, _ = surfaces(prepared, shape=BALL)
    assert balls["contact"].touching < 0.3 * balls["contact"].near


def test_what_is_far_away_is_not_watched(prepared):
    """Watch nothing where gaps are ten spacings; expect that two sides touch for a fifth of the time nevertheless."""
    met, _, _ = surfaces(prepared, step=0.7, time=0.3)
    assert met["contact"].touching == pytest.approx(0.2 * 2 * 2 * 25)
    near, _, _ = surfaces(prepared, step=0.3, time=0.3)
    assert met["contact"].near < 0.1 * near["contact"].near
    assert met["contact"].handed < 3 * 125


def test_forecast_of_surfaces_counts_what_is_near(prepared):
    """Multiply what touches and what is handed by steps, and what is near by how far objects move."""
    met, told, ready = surfaces(prepared)
    steps, m = ready.certificate.steps, met["ground"]
    assert told.effects["ground"].seconds == pytest.approx(steps * (m.touching + m.handed) + moves(ready) * m.near)
    assert forecast(ready, RATE | {"near point": 2.0}).effects["contact"].seconds - told.effects["contact"].seconds == (
        pytest.approx(moves(ready) * met["contact"].near)
    )
    assert (
        meetings(prepared(STACK.replace("friction 0.5", "contact-model paper").format(shape=BOX, apart=0, step=0.23, time=1)))
        == {}
    )


def test_forecast_is_printed(pond):
    """Say the time in few digits with its largest parts, and all of it in JSON."""
    cost = Cost(12.4, 1, 1, {"springs": CostShare(5.2), "walls": CostShare(0.01)}, {"setup": 1.4, "output": 5.8})
    assert forecast_line(cost) == "cost     about 12 s here: output 6 s, springs 5 s, setup 1.4 s"
    assert forecast_line(replace(cost, wall=7300.0, effects={}, other={})) == "cost     about 2 h here: "
    assert check_json(pond[0], cost)["cost"]["wall"] == 12.4
    assert check_json(pond[0])["cost"] is None


# --- calibration --------------------------------------------------------------------------------------------


@pytest.fixture
def machine(monkeypatch, tmp_path):
    """A machine that can be calibrated in no time; returns how often that was done, and what was told."""
    seen = SimpleNamespace(measured=0, told=[])

    class Measured:
        def __call__(self):
            seen.measured += 1
            return dict.fromkeys(RATES, 0.5)

        def cache_info(self):
            return SimpleNamespace(currsize=0)

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(calibrating, "_rates_here", Measured())
    seen.ask = lambda: calibration(seen.told.append)
    return seen


def test_a_machine_is_calibrated_once(machine):
    """Measure at first need, say so, keep it with the processor's name, and be silent from then on."""
    assert machine.ask().rates == dict.fromkeys(RATES, 0.5)
    assert machine.ask().stored and machine.measured == 1
    assert len(machine.told) == 1 and "calibrating" in machine.told[0]
    assert json.loads(stored_at().read_text())["processor"] == calibrating.processor()


@pytest.mark.parametrize(
    "spoil",
    [
        pytest.param(lambda d: "{ not json", id="broken"),
        pytest.param(lambda d: json.dumps(d | {"processor": "another"}), id="of another processor"),
        pytest.param(lambda d: json.dumps(d | {"skin": 0.75}), id="with another skin of lists"),
        pytest.param(lambda d: json.dumps(d | {"method": calibrating.METHOD - 1}), id="measured in another way"),
        pytest.param(lambda d: json.dumps({k: d[k] for k in ("processor", "rates")}), id="of a time when none of this was kept"),
        pytest.param(lambda d: json.dumps(d | {"rates": {"spring": 1e-9}}), id="a rate is missing"),
        pytest.param(lambda d: json.dumps(d | {"rates": d["rates"] | {"spring": 0.0}}), id="a rate is nothing"),
        pytest.param(lambda d: json.dumps(d | {"rates": d["rates"] | {"spring": float("nan")}}), id="a rate is no number"),
        pytest.param(lambda d: json.dumps([1, 2]), id="something else"),
    ],
)
def test_a_file_that_will_not_do_is_measured_again(machine, spoil):
    """Replace what is broken or foreign."""
    machine.ask()
    stored_at().write_text(spoil(json.loads(stored_at().read_text())))
    assert machine.ask().rates == dict.fromkeys(RATES, 0.5) and machine.measured == 2
    assert machine.ask().stored and machine.measured == 2


def test_where_nothing_can_be_written(machine, tmp_path):
    """Calibrate for this time only, and say why."""
    (tmp_path / "cache").write_text("a file where a folder should be")
    found = machine.ask()
    assert not found.stored and found.rates["spring"] == 0.5
    assert "cannot be kept" in machine.told[-1] and "XDG_CACHE_HOME" in machine.told[-1]


def test_a_real_calibration(monkeypatch, tmp_path):
    """Measure every rate of this machine: all positive and below seconds, most above the least that is taken for one."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    rates = calibration().rates
    assert list(rates) == list(RATES)
    assert all(0.0 < r < 5.0 for r in rates.values())
    assert np.median(list(rates.values())) > 1e-9, "a busy machine may hide one, not half of them"
