# SPDX-License-Identifier: GPL-2.0-only
"""compute mdanim/timestep against the bound that scenes are certified with, and against motion that blows up."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import plugin_lab as lab
import pytest
from mdanim_lammps.certificate import stable_step
from mdanim_lammps.features.springs.effect import block_norm

BODY = lab.shaken(lab.join(lab.block((4, 3, 2)), lab.block((2, 2, 2), (6.0, 0.0, 0.0))), 0.05)
RUN = ["compute step all mdanim/timestep", "fix run all mdanim/leapfrog", "thermo_style custom step c_step c_step[*]"]


def values(lmp) -> list[float]:
    """Scalar, then the vector."""
    return [float(lmp.extract_compute("step", 0, 0)), *lmp.numpy.extract_compute("step", 0, 1).tolist()]


def bounds(body, c=0.0, walls=0.0):
    """Largest stable step of each particle, as scenes are certified."""
    n = body.x[body.bond[:, 0]] - body.x[body.bond[:, 1]]
    n /= np.linalg.norm(n, axis=1)[:, None]
    norm = lambda weight: 2.0 * block_norm(body.bond, np.broadcast_to(weight, len(body.bond)), n, len(body.x)) / body.mass
    return stable_step(norm(body.k) + walls / body.mass, norm(c))


@pytest.mark.parametrize("order", [None, np.random.default_rng(3).permutation(len(BODY.x))], ids=["in tag order", "shuffled"])
def test_is_the_bound_that_scenes_are_certified_with(tmp_path, order):
    """Springs, dashpots and walls, of shaken blocks; the last number is the tag of the particle that sets it."""
    walls = ["region floor plane 0 0 0.5 0 0 1", "fix floor all mdanim/wall floor 3.0"]
    lmp = lab.load(BODY, tmp_path, [*walls, *RUN, "run 0"], c=0.05, order=order)
    everything = bounds(BODY, 0.05, 3.0)
    expected = [everything.min(), bounds(BODY).min(), bounds(BODY, 0.05).min(), everything.min(), everything.argmin() + 1]
    assert len(set(expected[1:4])) == 3  # each of them tells
    assert values(lmp) == pytest.approx(expected, rel=1e-7)
    lmp.close()


def test_of_a_group_and_of_loose_particles(tmp_path):
    """Only particles of the group count; what has no springs is stable with any step."""
    lmp = lab.load(BODY, tmp_path, ["group some id 1:20", RUN[0].replace("all", "some"), *RUN[1:], "run 0"])
    assert values(lmp)[0] == pytest.approx(bounds(BODY)[:20].min(), rel=1e-7)
    lmp.close()
    loose = lab.particles([(0.0, 0.0, 0.0), (5.0, 0.0, 0.0)])
    lmp = lab.load(loose, tmp_path, [*RUN, "run 0"])
    assert values(lmp) == [np.inf] * 4 + [0.0]
    lmp.close()


def test_a_longer_step_blows_up_and_a_shorter_one_does_not(tmp_path):
    """Two particles on a spring: there the bound is sharp."""
    pair = lab.Body(
        np.array([(0.0, 0.0, 0.0), (1.01, 0.0, 0.0)]),
        np.zeros((2, 3)),
        np.ones(2),
        np.ones(2, int),
        np.ones(2, bool),
        np.array([(0, 1)]),
        np.array([0.7]),
        np.array([1.0]),
    )
    lengths = []
    for share in (0.99, 1.01):
        lmp = lab.load(pair, tmp_path, [*RUN, "run 0"])
        bound = values(lmp)[0]
        lmp.commands_list([f"timestep {share * bound!r}", "run 16"])
        x = lab.by_tag(lmp, "x")
        lengths.append(np.linalg.norm(x[0] - x[1]))
        lmp.close()
    assert bound == pytest.approx(2.0 / np.sqrt(4.0 * 0.7 / 2.0), rel=1e-7)
    assert abs(lengths[0] - 1.0) < 0.1 < 0.3 < abs(lengths[1] - 1.0)


@pytest.mark.mpi
def test_on_several_ranks(tmp_path):
    """The same numbers, whichever rank has the particle."""
    body = lab.join(BODY, lab.block((3, 3, 3), (0.0, 6.0, 0.0)))
    place = ["variable s equal c_step", "variable t equal c_step[4]", 'print "$(v_s:%.15g) $(v_t)" file bound']
    found = []
    for ranks in (1, 3):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        lab.in_child(body, folder, [*RUN, "run 0", *place], ranks=ranks)
        found.append((folder / "bound").read_text().split())
    assert found[0] == found[1]
    assert float(found[0][0]) == pytest.approx(bounds(body).min(), rel=1e-7)


def test_says_what_is_not_in_it(tmp_path, capfd):
    """It warns by name of fixes whose forces it does not know; it refuses other springs, and arguments."""
    barrier = ["group inner type 1", "group boundary type 2", "fix touch all mdanim/barrier boundary inner 1.0 1.6"]
    lmp = lab.load(BODY, tmp_path, [f"log {tmp_path}/log", *barrier, *RUN, "run 0"])
    lmp.close()
    log = (tmp_path / "log").read_text()
    assert "not in it: fix touch mdanim/barrier. Take half of it" in log
    with pytest.raises(Exception, match="knows the springs of bond_style mdanim/harmonic only, not of harmonic"):
        lab.load(BODY, tmp_path, [*RUN, "run 0"], style="harmonic")
    with pytest.raises(Exception, match="takes no arguments, got half"):
        lab.load(BODY, tmp_path, [RUN[0] + " half"])


def test_is_the_certificate_of_a_scene(tmp_path):
    """In the input of a scene that was built, of its moving particles, with its walls and dashpots."""
    from mdanim_lammps import Scene

    text = """
    gravity (0, 0, -9.81) m/s^2
    object bar { shape box (40, 10, 10) cm position (0, 0, 1) m mass 2 kg elasticity 300 kPa damping 0.2 hold face -x }
    object ball { shape sphere 6 cm position (1, 0, 1) m mass 0.5 kg elasticity 800 kPa }
    walls from (-2, -2, 0) m to (2, 2, 4) m
    effects { contact off }
    control { time 0.1 s  frames 10 fps  resolution 5 cm  contact-model paper }
    """
    path = tmp_path / "two.txt"
    path.write_text(text)
    scene = Scene.load(path)
    subprocess.run([sys.executable, "-m", "mdanim_lammps", "build", path, "-o", tmp_path / "out", "-q"], check=True)
    script = (tmp_path / "out" / "in.two").read_text().replace("thermo ", "compute step mobile mdanim/timestep\nthermo ", 1)
    script = script.replace("thermo_style custom step", "thermo_style custom step c_step", 1)
    script += '\nprint "$(c_step:%.15g)" file bound\n'
    script = script[: script.index("\nrun ")] + "\nrun 0\n" + 'print "$(c_step:%.15g)" file bound\n'
    (tmp_path / "out" / "in.two").write_text(script)
    lmp = Path(sys.executable).parent / "lmp"
    subprocess.run([lmp, "-in", "in.two"], cwd=tmp_path / "out", check=True, capture_output=True)
    assert float((tmp_path / "out" / "bound").read_text()) == pytest.approx(scene.certificate.bound, rel=1e-7)
