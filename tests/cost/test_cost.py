# SPDX-License-Identifier: GPL-2.0-only
"""Cost of a run by effect and scene line, and its forecast."""

import json
import os
import signal
import tempfile
import time
from dataclasses import replace
from types import SimpleNamespace

import pytest
from every_effect import ELSEWHERE, with_every_effect
from mdanim_lammps import features
from mdanim_lammps.cost import later as later_steps
from mdanim_lammps.cost import movie_forecast
from mdanim_lammps.cost.forecast import extrapolate, forecast
from mdanim_lammps.errors import DivergedError, SetupError
from mdanim_lammps.report import check_json, cost_line, forecast_line, quicker_line
from mdanim_lammps.results.cost import Cost, CostShare
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.frame_source import Account, add_clocks
from mdanim_lammps.run.loop import simulate
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene

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


@pytest.fixture(scope="module")
def pond(tmp_path_factory):
    """A scene with every effect, and the result of its run:
    so long that a few milliseconds that others take do not count."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import load_scene

    folder = tmp_path_factory.mktemp("pond")
    (folder / "pond.txt").write_text(with_every_effect(POND))
    started = time.perf_counter()
    ready = prepare(load_scene(folder / "pond.txt"))
    return ready, simulate(ready, folder, started=started)


# --- what it cost -------------------------------------------------------------------------------------------


def test_parts_add_up_to_the_wall_time(pond):
    """Leave less than a twentieth of the wall time, from the first word of the scene to the last frame, without an account."""
    cost = pond[1].cost
    assert 0.95 <= cost.covered <= 1.0 + 1e-9
    assert all(seconds >= 0.0 for seconds in cost.parts.values())
    assert cost.other["setup"] > 0.0 and cost.other["output"] > 0.0


def test_every_effect_has_its_seconds_and_its_line(pond):
    """Tell the seconds of each effect that is on, tied to the scene line that called for it."""
    ready, result = pond
    assert list(result.cost.effects) == [e.name for e in features.effects() if e.name not in ELSEWHERE]
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
        system=ready.system,
        context=ready.context,
        bond_seconds=lambda: 100.0,
        fix_seconds=lambda fix: 10.0 if fix == "leapfrog" else 0.0,
        fix_value=lambda fix, name: {"flow_seconds": 1.0, "occupancy_seconds": 2.0, "coupling_seconds": 4.0}[name],
        array=lambda name: ready.plan.columns["lambda"],
    )
    clocks = {e.name: e.of(ready.scene).clocks(instance) for e in features.effects() if e.name not in ELSEWHERE}
    account = Account()
    add_clocks(account, instance)
    assert account.effects == clocks
    assert sum(clocks["springs"].values()) + sum(clocks["damping"].values()) == pytest.approx(100.0)
    assert clocks["liquid"] == {"flow": 1.0, "occupancy": 2.0}
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
    assert set(data["effects"]["liquid"]["clocks"]) == {"flow", "occupancy"}
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
    told = forecast(ready)
    assert told.movie is None or told.movie > 0.0
    assert list(told.effects) == list(result.cost.effects)
    assert {"leap-frog", "rest of the step", "setup", "output"} == set(told.other) <= set(result.cost.other)
    assert [p.place for p in told.effects.values()] == [p.place for p in result.cost.effects.values()]
    assert (told.steps, told.particles) == (result.cost.steps, result.cost.particles)
    assert told.covered == pytest.approx(1.0) and min(told.parts.values()) >= 0.0
    assert told.effects["springs"].seconds > 0.0


@pytest.fixture
def clockwork(monkeypatch):
    """Runs that take 1 ms for a step, half of it for springs, 20 ms for a frame, 3 s for their start and 5 s for their end, on a
    processor of which other programs have a quarter; returns what is run: frames, and the certificate."""
    from mdanim_lammps.cost import forecast as forecasting
    from mdanim_lammps.run import loop

    clock, seen = SimpleNamespace(now=0.0), []

    def simulate(ready, folder, *, on_progress):
        c = ready.certificate
        clock.now += 3.0
        for frame in range(1, c.frames + 1):
            clock.now += 1e-3 * c.steps_per_frame + 0.02
            on_progress(SimpleNamespace(seconds=1e-3 * c.steps_per_frame * frame))
            if (folder / "stop").exists():
                break
        clock.now += 5.0
        steps = frame * c.steps_per_frame
        effects = {"springs": CostShare(0.5e-3 * steps, "here", {"a": 1.0})}
        other = {"leap-frog": 0.3e-3 * steps, "rest of the step": 0.2e-3 * steps, "setup": 3.0, "output": 9.0, "guard": 9.0}
        cost = Cost(99.0, steps, 250, effects, other)
        seen.append((frame, c))
        if frame == c.frames:
            return SimpleNamespace(cost=cost)
        stopped = loop.Interrupted("enough")
        stopped.cost = cost
        raise stopped

    monkeypatch.setattr(loop, "simulate", simulate)
    # With two threads an instance takes the processors for longer than it takes this thread.
    now = {"perf_counter": 1.0, "thread_time": 0.75, "process_time": 1.5}
    times = SimpleNamespace(**{name: lambda rate=rate: rate * clock.now for name, rate in now.items()})
    monkeypatch.setattr(forecasting, "time", times)
    return seen


@pytest.fixture
def fresh(tmp_path_factory):
    """Make an empty folder."""
    return lambda: tmp_path_factory.mktemp("steps")


def test_a_forecast_takes_what_is_later_for_as_long(pond, clockwork, fresh):
    """Take every step and every frame as those that were run, and what comes once as it was; twice the time is twice the work."""
    ready, _ = pond
    told, steps = extrapolate(ready, fresh(), setup=7.0), ready.certificate.steps
    assert told.effects == {"springs": CostShare(pytest.approx(0.75 * 0.5e-3 * steps), "here")}
    assert told.other == pytest.approx(
        {
            "leap-frog": 0.75 * 0.3e-3 * steps,
            "rest of the step": 0.75 * 0.2e-3 * steps,
            "setup": 7.0 + 2.25,
            "output": 7 * 0.015 + 3.75,
        }
    )
    assert told.wall == pytest.approx(sum(told.parts.values()))
    twice = extrapolate(replace(ready, certificate=replace(ready.certificate, frames=12)), fresh())
    assert twice.effects["springs"].seconds == pytest.approx(2 * told.effects["springs"].seconds)
    assert twice.other["output"] == pytest.approx(13 * 0.015 + 3.75)


@pytest.mark.parametrize(
    ("particles", "per_frame", "frames", "steps"),
    [
        pytest.param(250, 10, 19, 10, id="until it is enough"),
        pytest.param(250, 1, 27, 1, id="until it is enough, frames of a step"),
        pytest.param(250, 400, 3, 400, id="no fewer frames"),
        pytest.param(5000, 2000, 6, 100, id="parts of frames"),
        pytest.param(10_000_000, 2000, 19, 10, id="no fewer steps"),
    ],
)
def test_a_forecast_takes_tenths_of_a_second(pond, clockwork, fresh, particles, per_frame, frames, steps):
    """Run frames of some hundred thousand particle-steps until 0.4 s of processor time are over, and few at least."""
    ready = pond[0]
    many = SimpleNamespace(particles=particles)
    extrapolate(
        replace(
            ready,
            context=replace(ready.context, system=many),
            certificate=replace(ready.certificate, steps_per_frame=per_frame, frames=1000),
        ),
        fresh(),
    )
    run, certificate = clockwork[0]
    assert (run, certificate.steps_per_frame, certificate.last_steps) == (frames, steps, 0)


def test_a_forecast_runs_no_more_than_the_run(pond, clockwork, fresh):
    """Run all frames of a short scene, and three where it has fewer."""
    for frames, run in ((4, 4), (1, 3)):
        extrapolate(replace(pond[0], certificate=replace(pond[0].certificate, steps_per_frame=1, frames=frames)), fresh())
        assert clockwork[-1][0] == run


def test_a_forecast_counts_what_begins_later(pond, monkeypatch, fresh):
    """Effects at surfaces cost what they cost in a whole coarse run, times its steps and, by a power, its particles at surfaces;
    half a coarse run tells the half where its steps cost the same."""
    ready, _ = pond
    now = [0.0]  # of two programs on one processor
    clocks = SimpleNamespace(perf_counter=lambda: now[0], thread_time=lambda: 0.5 * now[0])
    monkeypatch.setattr(later_steps, "time", clocks)
    for done in (1.0, 0.5):

        def simulate(coarse, folder, *, on_progress, done=done):
            steps = coarse.certificate.steps
            now[0] += 1.0
            on_progress(SimpleNamespace(step=round(done * steps), steps=steps, seconds=8.0 * done))
            parts = {"springs": CostShare(3.0), "contact": CostShare(4.0 * done), "ground": CostShare(2.0 * done)}
            return SimpleNamespace(cost=Cost(9.0, steps, 1, parts, {}))

        monkeypatch.setattr("mdanim_lammps.run.loop.simulate", simulate)
        coarse = later_steps._coarser(ready)
        assert coarse.system.particles < ready.system.particles / 3
        found = later_steps.later(ready, fresh())
        surface = (ready.system.boundary.sum() / coarse.system.boundary.sum()) ** later_steps.POINTS
        steps = ready.certificate.steps / coarse.certificate.steps
        assert found == {
            "contact": pytest.approx(2.0 * surface * steps, rel=0.01),
            "ground": pytest.approx(surface * steps, rel=0.01),
        }


@pytest.mark.parametrize("grows", [1.0, 3.0])
def test_a_coarse_run_that_was_ended_goes_on_as_it_ended(pond, monkeypatch, fresh, grows):
    """Springs take 1 s of the whole run, contact 2 s of its first half and ``grows`` times that of its second, when all objects
    lie on each other; of the three quarters that are run, the last tells the one that is left."""
    ready, _ = pond
    now = [0.0]
    monkeypatch.setattr(later_steps, "time", SimpleNamespace(perf_counter=lambda: now[0], thread_time=lambda: now[0]))

    def contact(part):
        return 4.0 * (min(part, 0.5) + grows * max(0.0, part - 0.5))

    def simulate(coarse, folder, *, on_progress):
        steps = coarse.certificate.steps
        for part in (0.25, 0.5, 0.6, 0.75):
            now[0] = part + contact(part)
            on_progress(SimpleNamespace(step=part * steps, steps=steps, seconds=now[0]))
        return SimpleNamespace(cost=Cost(9.0, steps, 1, {"springs": CostShare(0.75), "contact": CostShare(contact(0.75))}, {}))

    monkeypatch.setattr("mdanim_lammps.run.loop.simulate", simulate)
    found = later_steps._whole(later_steps._coarser(ready), fresh() / "whole")
    assert found == {"springs": pytest.approx(1.0), "contact": pytest.approx(contact(1.0))}


def test_a_movie_is_forecast_from_some_pictures(pond, monkeypatch):
    """Take every picture for as long as those that were drawn, and what comes before the first one once."""
    clock = SimpleNamespace(now=0.0)

    class Painter:
        def __init__(self, trajectory, render):
            clock.now += 2.0

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def frame(self, k):
            clock.now += 0.3

    ready, result = pond
    monkeypatch.setattr("mdanim_lammps.picture.render.Painter", Painter)
    rates = {"perf_counter": 1.0, "process_time": 1.6}
    monkeypatch.setattr(movie_forecast, "time", SimpleNamespace(**{n: lambda r=r: r * clock.now for n, r in rates.items()}))
    wanted = movie_forecast.pictures(ready)
    assert wanted == len(Trajectory(result.folder))
    monkeypatch.setattr(movie_forecast, "processes_for", lambda pictures: 1)
    assert movie_forecast.movie_seconds(ready, result.folder) == pytest.approx(2.0 + 0.3 * wanted)
    monkeypatch.setattr(movie_forecast, "processes_for", lambda pictures: 4)
    assert movie_forecast.movie_seconds(ready, result.folder) == pytest.approx(2.0 + 1.6 * 0.3 / 4 * wanted)

    def blind(*_):
        raise SetupError("no OpenGL")

    monkeypatch.setattr("mdanim_lammps.picture.render.Painter", blind)
    assert movie_forecast.movie_seconds(ready, result.folder) is None


def test_drawing_that_ends_the_process_leaves_the_cost(pond, monkeypatch):
    """Libraries of OpenGL may end a process, as on hosts without a display; only the movie is not known then."""
    from mdanim_lammps.cost import forecast as forecasting

    cost = Cost(1.0, 1, 1, {}, {"setup": 0.0})
    monkeypatch.setattr(forecasting, "whole", lambda ready, folder, setup: cost)
    for ends in (lambda ready, folder: os._exit(9), lambda ready, folder: os.kill(os.getpid(), signal.SIGKILL)):
        monkeypatch.setattr(forecasting, "movie_seconds", ends)
        assert forecast(pond[0]) == cost and cost.movie is None


def test_first_steps_that_end_badly(pond, monkeypatch, tmp_path):
    """Tell where and why they are stopped, nothing where they take too long, pass on that LAMMPS cannot be used, and outlive an
    end of the process. No file stays."""
    from mdanim_lammps.cost import forecast as forecasting

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    def ends(what):
        monkeypatch.setattr(forecasting, "whole", what)
        return forecast(pond[0])

    def fail(error):
        def run(ready, folder, setup):
            raise error

        return run

    stopped = ends(fail(DivergedError("step 7: particles are lost", "the last good frame is in a folder that is gone")))
    assert forecast_line(stopped) == "stops    step 7: particles are lost"
    assert check_json(pond[0], stopped) | {"cost": None, "stops": "step 7: particles are lost"} == check_json(pond[0], stopped)
    with pytest.raises(SetupError, match="no plugin"):
        ends(fail(SetupError("no plugin")))
    with pytest.raises(SetupError, match="ended the process"):
        ends(lambda ready, folder, setup: os._exit(1))
    monkeypatch.setattr(forecasting, "PATIENCE", 0.5)
    start = time.perf_counter()
    assert ends(lambda ready, folder, setup: ((folder / "trajectory.h5").write_text("half"), time.sleep(60))) is None
    assert time.perf_counter() - start < 30.0
    assert not list(tmp_path.iterdir())
    assert forecast_line(None).startswith("cost     not known")
    assert check_json(pond[0], None) | {"cost": None, "stops": None} == check_json(pond[0], None)


def test_ctrl_c_ends_a_forecast(pond, monkeypatch, tmp_path):
    """A terminal sends it to both processes: the first steps leave it to the caller, which ends them. No file stays."""
    from mdanim_lammps.cost import forecast as forecasting

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    cost = Cost(1.0, 1, 1, {}, {})

    def signalled(ready, folder, setup):
        os.kill(os.getpid(), signal.SIGINT)
        return cost

    def endless(ready, folder, setup):
        time.sleep(0.5)  # Python drops an exception that comes while it ends a fork
        os.kill(os.getppid(), signal.SIGINT)
        time.sleep(60.0)

    monkeypatch.setattr(forecasting, "whole", signalled)
    monkeypatch.setattr(forecasting, "movie_seconds", lambda ready, folder: 2.0)
    assert forecast(pond[0]) == replace(cost, movie=2.0)
    monkeypatch.setattr(forecasting, "whole", endless)
    start = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        forecast(pond[0])
    assert time.perf_counter() - start < 30.0
    assert not list(tmp_path.iterdir())


def test_first_steps_that_are_ended_tell_nothing(pond, monkeypatch, fresh):
    """SIGTERM before there are frames enough is not an end that the forecast has asked for."""
    from mdanim_lammps.run import loop

    def ended(ready, folder, *, on_progress):
        on_progress(SimpleNamespace(seconds=1.0))
        raise loop.Interrupted("interrupted")

    monkeypatch.setattr(loop, "simulate", ended)
    with pytest.raises(loop.Interrupted):
        extrapolate(pond[0], fresh())


def test_a_long_run_is_told_how_it_gets_quicker(tmp_path):
    """Cost goes with the fourth power of the spacing: cells and steps."""
    path = tmp_path / "a.txt"
    cube = "object a { shape box (8, 8, 8) cm  position (0, 0, 0)  density 1000 kg/m^3  elasticity 1 MPa }\n"
    path.write_text(cube + "control { time 1 s }\n")
    ready, cost = prepare(load_scene(path)), Cost(960.0, 1, 1, {}, {})
    assert quicker_line(ready, cost) == (
        "quicker  --accuracy preview about 40 s, resolution 3 cm about 3 min; thin and stiff objects make small cells and short "
        "steps"
    )
    assert quicker_line(ready, replace(cost, wall=59.0)) is quicker_line(ready, None) is None
    path.write_text(cube + "control { time 1 s  resolution 4 cm }\n")
    assert quicker_line(prepare(load_scene(path)), cost).startswith("quicker  resolution 6 cm about 3 min;")


def test_forecast_is_printed(pond):
    """Say the time in few digits with its largest parts, and all of it in JSON."""
    cost = Cost(12.4, 1, 1, {"springs": CostShare(5.2), "walls": CostShare(0.01)}, {"setup": 1.4, "output": 5.8}, movie=43.0)
    assert forecast_line(cost) == "cost     about 60 s here: modelling 1.4 s, run 11 s (output 6 s, springs 5 s), movie 40 s"
    blind = forecast_line(replace(cost, wall=7300.0, effects={}, other={}, movie=None))
    assert blind == "cost     about 2 h here: modelling 0 ms, run 2 h, movie not known, as this host cannot draw"
    assert check_json(pond[0], cost)["cost"]["movie"] == 43.0
    assert check_json(pond[0], cost)["cost"]["wall"] == 12.4
    assert check_json(pond[0])["cost"] is None
