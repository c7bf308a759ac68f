# SPDX-License-Identifier: GPL-2.0-only
"""Elastic objects that `check` and the end of a run propose as rigid: how strains are measured, who is named, who is not."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from mdanim_lammps.effects.envelope import Envelope
from mdanim_lammps.features.contact.rigid_surfaces import loads
from mdanim_lammps.features.rigid import proposal
from mdanim_lammps.features.rigid.strains import Strains
from mdanim_lammps.features.rigid.words import Rigid
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.naming import told_together
from mdanim_lammps.scene.parse import load_scene, parse_scene


def before(ready):
    """Names of the groups that are proposed before the run."""
    found = proposal.before(Envelope(ready.context, {}, ready.certificate.timestep))
    return [] if found is None else [name for name, _ in found.groups]


# --- figures ----------------------------------------------------------------------------------------------------------


def turn(about, angle):
    """Rotation matrix about an axis, by the series of the exponential."""
    x, y, z = angle * np.array(about) / np.linalg.norm(about)
    k = np.array([(0, -z, y), (z, 0, -x), (-y, x, 0)])
    term, found = np.eye(3), np.eye(3)
    for n in range(1, 30):
        term = term @ k / n
        found = found + term
    return found


class Told:
    """A trajectory of two bars of 1 m, of which the second one has these places in the last of its frames."""

    def __init__(self, last, frames=3):
        n = np.arange(21) / 20.0
        x, y, z = np.meshgrid(n, (0.0, 0.1), (0.0, 0.1), indexing="ij")
        self.bar = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
        size = len(self.bar)
        pairs = np.array(
            [(i, j) for i in range(size) for j in range(i + 1, size) if np.sum((self.bar[i] - self.bar[j]) ** 2) < 0.012]
        )
        ids = np.arange(1, 2 * size + 1)
        self.metadata = SimpleNamespace(
            first=np.array([0, size, 2 * size]), id=ids, bond=np.concatenate([pairs, pairs + size]) + 1
        )
        self.frames = [np.concatenate([self.bar, self.bar + 3.0])] * (frames - 1) + [np.concatenate([self.bar, last(self.bar)])]

    def __len__(self):
        return len(self.frames)

    def position(self, frame):
        return self.frames[frame]


def strains(last, frames=3):
    """Largest strain of the second bar, and its distance from a rigid motion."""
    found = Strains(Told(last, frames), np.array([1]))
    return found.largest()[0], found.strays()[0]


@pytest.mark.parametrize("angle", [0.0, 1.0, 3.1])
def test_a_rigid_motion_is_no_strain(angle):
    """Whatever its angle, to rounding: 2e-15 m of places of 10 m, over springs of 5 cm; distances are roots of differences."""
    largest, stray = strains(lambda x: x @ turn((1, 2, 3), angle).T + (5, -4, 3))
    assert largest < 1e-13 and stray < 1e-7


def test_a_bar_that_is_stretched():
    """By e along itself while it turns: the strain of its springs along x is e, and particles are e x off, over two frames."""
    e = 0.03
    largest, stray = strains(lambda x: (x * (1.0 + e, 1.0, 1.0)) @ turn((0, 1, 0), 2.0).T)
    along = Told(lambda x: x).bar[:, 0] - 0.5
    assert largest == pytest.approx(e, rel=1e-12)
    assert stray == pytest.approx(e * np.sqrt((along**2).mean() / 2.0), rel=1e-6)


def test_a_bar_that_sags_by_the_limit():
    """A parabola of SAG is as far off as the limit of a run: STRAY, within a tenth; the bar has a size of 1."""
    _, stray = strains(lambda x: x - np.outer(4.0 * proposal.SAG * x[:, 0] * (1.0 - x[:, 0]), (0, 0, 1)), frames=2)
    assert stray == pytest.approx(proposal.STRAY, rel=0.1)


def test_loads_are_what_is_above(prepared):
    """Against all pairs, to the bit: the strength of all contacts depends on it."""
    rng = np.random.default_rng(3)
    boxes = "".join(
        f"object b{n} {{ shape box ({', '.join(f'{s:.3f}' for s in rng.uniform(5, 9, 3))}) cm  density {100 + 7 * n}  "
        f"position ({rng.uniform(0, 40):.3f}, {rng.uniform(0, 40):.3f}, {10 + 12 * n}) cm  elasticity rigid }}\n"
        for n in range(40)
    )
    held = "object slab { shape box (1, 1, 0.1) m  density 1000  elasticity rigid  hold all  position (0, 0, 6) m }\n"
    system = prepared(f"gravity (0, 0, -9.81)\nground z 0\n{boxes}{held}control {{ time 0.1 s }}").system
    low, high = system.bounds(system.position)
    weight = np.where(system.still, 0.0, system.mass_of)
    wanted = []
    for m in range(40):
        over = ((low[:, :2] < high[m, :2]) & (high[:, :2] > low[m, :2])).all(axis=1)
        over &= low[:, 2] + high[:, 2] > low[m, 2] + high[m, 2]
        wanted.append(1.0 + weight[over].sum() / weight[m])
    body = np.arange(len(system.names))
    assert loads(system, np.arange(40), body).tolist() == wanted
    assert max(wanted) > 2.0 and loads(system, np.array([7]), body).tolist() == [wanted[7]]


# --- who is named -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "named"),
    [
        ("dominoes", ["domino[1...15]", "ball"]),
        ("tower", ["cube[1...10]", "ball"]),
        ("quake", ["low.block[1...3]", "slim.block[1...4]"]),
        ("henge", ["gate.post (12 objects)", "gate.lintel (6 objects)", "ball"]),
        ("cards", ["card[0...3]", "upper[0...1]"]),  # the bridge sags
        ("cradle", ["ball[1...4]", "first"]),
        ("stairs", []),  # jelly
        ("crowd", []),  # rubber
        ("drop", []),
        ("beam", []),  # the beam is held, the cube lands on an edge
        ("densities", []),
        ("cantilever", []),
    ],
)
def test_who_is_named_before_the_run(scenes, name, named):
    """Bricks, dominoes, stones and billiard balls of scenes/, and nothing that is seen to bend."""
    assert before(prepare(load_scene(scenes / f"{name}.txt"))) == named


BRICK = "object brick[{n}] {{ shape box (20, 10, 6) cm  position (0, 0, {z}) cm  density 800  elasticity 20 MPa  {more} }}\n"
SCENE = "gravity (0, 0, -9.81)\nground z 0\n{objects}control {{ time 0.2 s  friction {mu}  {control} }}\n{expect}"


def wall(more="", mu=0.5, control="", expect="", of_last=""):
    """Three bricks on each other."""
    bricks = (BRICK.format(n=n, z=3 + 6 * n, more=of_last if of_last and n == 2 else more) for n in range(3))
    return SCENE.format(objects="".join(bricks), mu=mu, control=control, expect=expect)


@pytest.mark.parametrize(
    ("words", "is_named"),
    [
        ({}, True),
        ({"more": "damping 0.1"}, True),  # contacts with friction have a dashpot
        ({"more": "damping 0.1", "mu": 0}, False),
        ({"more": "damping 0.1", "control": "contact-damping 0"}, False),
        ({"more": "", "mu": 0}, True),
        ({"more": "hold faces z"}, False),
        ({"of_last": "damping 0.1 hold faces z"}, False),  # one of a repeat: the text of all
        ({"expect": "expect brick[1].strain.max < 0.1"}, False),
        ({"expect": "expect brick[1].position.z > 0 m"}, True),
        ({"control": "contact-model paper", "mu": 0}, False),
    ],
    ids=str,
)
def test_words_that_need_springs(prepared, words, is_named):
    """Parts that are held, an `expect` on strains, damping that nothing replaces, and the contact of the paper."""
    assert before(prepared(wall(**words))) == (["brick[0...2]"] if is_named else [])


def test_a_rope_is_not_named(prepared):
    """It is there to bend; the weight on it may be rigid."""
    rope = "object rope { shape rope from (0, 0, 1) m to (0, 0, 0.5) m thickness 2 cm  density 900  elasticity 5 MPa }\n"
    ready = prepared(SCENE.format(objects=rope + BRICK.format(n=1, z=3, more=""), mu=0.5, control="", expect=""))
    assert "rope" in ready.system.names and list(proposal.groups(ready.scene)) == ["brick"] and before(ready) == ["brick[1]"]


def test_a_plank_that_sags_is_not_named(prepared):
    """A plank of 2 m, thin or soft enough to sag by more than a twentieth of its length between its ends."""
    plank = "object plank {{ shape box (200, {w}, {t}) cm  position (0, 0, {z}) cm  density 600  elasticity {E} MPa }}\n"
    block = "object block[{n}] {{ resolution 5 cm  shape box (10, 20, 40) cm  position ({x}, 0, 20) cm  density 600  "
    blocks = "".join((block + "elasticity 50 MPa }}\n").format(n=n, x=180 * n - 90) for n in (0, 1))
    for t, young in ((2, 30), (4, 8), (8, 30)):
        objects = plank.format(t=t, w=2 * t, z=40 + t / 2, E=young) + blocks
        ready = prepared(SCENE.format(objects=objects, mu=0.5, control=f"resolution {t / 2} cm", expect=""))
        sag = proposal.BAR * 600 * 9.81 * 2.0 / (young * 1e6) * (200.0 / t) ** 2
        assert ("plank" in before(ready)) == (sag < proposal.SAG) == (t == 8)


@pytest.mark.parametrize(
    ("shape", "beneath", "named"),
    [
        ("box (48, 8, 4) cm", "box (60, 8, 8) cm", ["plate[0...2]"]),
        ("box (48, 8, 4) cm", "box (24, 8, 8) cm", []),  # its ends are free
        ("cylinder 24 cm 4 cm", "box (60, 60, 8) cm", ["plate[0...2]"]),
    ],
)
def test_what_lies_flat_is_not_bent_by_what_is_above(prepared, shape, beneath, named):
    """Three plates on each other that bear a weight; as a bar between its ends the lowest would sag by a seventh and more."""
    plate = "object plate[{n}] {{ shape {shape}  position (0, 0, {z}) cm  density 1000  elasticity 3 MPa }}\n"
    objects = "".join(plate.format(n=n, shape=shape, z=10 + 4 * n) for n in range(3))
    objects += f"object foot {{ shape {beneath}  position (0, 0, 4) cm  hold all }}\n"
    objects += "object weight { shape box (8, 8, 4) cm  position (0, 0, 22) cm  density 30000  elasticity rigid }\n"
    assert before(prepared(SCENE.format(objects=objects, mu=0.5, control="resolution 4 cm", expect=""))) == named


def test_the_scene_as_it_is_proposed(prepared):
    """Rigid, without damping, and all else as it was; it can be prepared."""
    ready = prepared(wall(more="damping 0.1"))
    found = proposal.before(Envelope(ready.context, {}, ready.certificate.timestep))
    assert all(isinstance(s.elasticity, Rigid) and s.damping == 0.0 for s in found.scene.solids)
    again = prepare(found.scene)
    assert again.system.rigid.all() and again.system.names == ready.system.names


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (["ball"], "ball"),
        (["domino[1]", "domino[2]", "domino[3]"], "domino[1...3]"),
        (["a[-1]", "a[0]"], "a[-1...0]"),
        (["a[1]", "a[3]"], "a (2 objects)"),
        (["gate[1].post[1]", "gate[1].post[2]"], "gate.post (2 objects)"),
        (["g.block[1]", "g.block[2]"], "g.block[1...2]"),
        (["lid", "biscuit.piece[1]", "biscuit.piece[2]"], "lid and 2 more"),
    ],
)
def test_names_of_like_objects(names, told):
    """As short as a message needs them."""
    assert told_together(names) == told


# --- what the choice costs: study -------------------------------------------------------------------------------------

SLIDE = """gravity (0, 0, -9.81)
ground z 0
object cube { shape box (12, 10, 8) cm  position (0, 0, 4) cm  density 1000  elasticity 1 MPa  damping 0.1
  velocity (1.5, 0, 0) m/s }
control { time 0.1 s  frames 50 fps  friction 0.4  accuracy preview }
"""


def test_a_study_rates_rigid_against_elastic(tmp_path, monkeypatch):
    """Both have errors against the limit of elastic runs; the choice has no order, and adds nothing to the doubt of that limit.
    A cube that slides by friction goes as far as the rigid one."""
    from mdanim_lammps.study import bench
    from mdanim_lammps.study.report import order_lines
    from mdanim_lammps.study.setting import scene_hash
    from mdanim_lammps.study.store import Store
    from mdanim_lammps.study.study import run_study

    monkeypatch.setattr(bench, "REPEATS", 1)
    study = run_study(parse_scene(SLIDE), tmp_path / "study", budget=60.0, only=["time step", "rigid"])
    a = study.analysis
    rigid, elastic = a.measured["rigid"]
    assert elastic == a.own and rigid.key == f"{elastic.key}-r1" and str(rigid) == f"{elastic}, elasticity rigid"
    assert study.points[rigid.key].particles < study.points[elastic.key].particles
    assert set(a.ladders) == {"time step"} and a.finest in a.measured["time step"]
    assert a.rated[rigid.key].error.middle < 0.02
    (line,) = (line for line in order_lines(study) if line.startswith("rigid: "))
    apart = study.points[rigid.key].tracks[0] - study.points[elastic.key].tracks[0]
    apart = 100.0 * np.sqrt((apart**2).sum(-1).mean()) / a.scale
    assert re.search(r"rigid is .* off and takes .*; elastic is .* off and takes", line)
    assert float(re.search(r", (\S+) % from the scene's own", line)[1]) == pytest.approx(apart, rel=0.06)
    assert Store(tmp_path / "study", scene_hash(parse_scene(SLIDE))).points.keys() == study.points.keys()


@pytest.mark.parametrize(("words", "why"), [("hold all", "no elastic object may be rigid as its words are"), ("", "")])
def test_when_a_study_has_the_choice(prepared, words, why):
    """Where something elastic may be rigid."""
    from mdanim_lammps.features.rigid.vary import AsRigid

    free = "object ball { shape sphere 5 cm  position (0, 0, 1) m  density 1000  elasticity rigid }\n"
    ready = prepared(SLIDE.replace("damping 0.1", f"damping 0.1 {words}") + free)
    assert AsRigid().why_not(ready.context) == why
    assert AsRigid().put(ready.scene, None) is ready.scene
