# SPDX-License-Identifier: GPL-2.0-only
"""run_style verlet/mdanim against run_style verlet, bit for bit: shapes, effects, widths, orders of particles, pieces, ranks."""

import ctypes
import re
from dataclasses import replace

import numpy as np
import plugin_lab as lab
import plugin_path
import pytest
from filming import BETWEEN, EFFECTS, END, FALL, LATER, OTHER_WALLS, POND, SHAPES, SOFT, WIDTHS, film, passes, supported
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene


def held_back(instance: Instance) -> int:
    """How many particles were moved one by one, all passes together."""
    instance.lammps.library.mdanim_held_back.restype = ctypes.c_longlong
    return instance.lammps.library.mdanim_held_back(instance.lammps.handle)


@pytest.mark.parametrize("name", [*SHAPES, *EFFECTS])
def test_blocks_give_the_bits_of_verlet(name):
    """Compare positions, velocities, forces and traces with those of the plain step, for all widths that run here."""
    text = (SHAPES | EFFECTS)[name]
    plain, energies, trace, none = film(text, "verlet")
    assert none == 0 and np.abs(plain[-1, 0] - plain[0, 0]).max() > 0.001
    widths = [w for w in WIDTHS if supported(w)]
    assert "common" in widths
    for width in widths:
        found, told, seen, taken = film(text, f"verlet/mdanim width {width}")
        assert taken > 200
        assert np.array_equal(found, plain), width
        assert np.array_equal(seen, trace), width
        # Losses are sums over particles, in another order where some are held back.
        np.testing.assert_allclose(told, energies, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    ("name", "fix", "entry"),
    [("contact", "contact", 3), ("ground", "ground", 5), ("walls and contact", "walls", 5), ("liquid", "liquid", None)],
)
def test_the_effects_of_these_scenes_wake_up(name, fix, entry):
    """See pairs in touch, walls that have been met, a liquid that lifts: else the comparison above would be one of sleepers."""
    ready = prepare(parse_scene(FALL + EFFECTS[name] + "\n" + END))
    with Instance(ready.plan) as instance:
        instance.setup()
        felt = []
        for _ in range(15):
            instance.run(20)
            felt.append(instance.fix_scalar(fix) if entry is None or fix == "liquid" else instance.fix_value(fix, entry - 1))
        assert np.abs(felt).max() > 0.0
        assert passes(instance) > 200


def test_forces_are_added_in_the_order_of_fixes():
    """Push particles by contact and walls, then by a liquid, then by other walls, all at once."""
    plain, _, trace, none = film(BETWEEN, "verlet", more=LATER)
    assert none == 0
    for width in [w for w in WIDTHS if supported(w)]:
        found, _, seen, taken = film(BETWEEN, f"verlet/mdanim width {width}", more=LATER)
        assert taken > 200
        assert np.array_equal(found, plain) and np.array_equal(seen, trace), width


@pytest.mark.parametrize(
    ("name", "more", "some"),
    [
        ("contact", (), False),
        ("beside each other", (), False),
        ("ground", (), False),
        ("damped walls", (), False),
        ("damped walls", POND, False),
        ("damped walls", LATER, True),
        ("damped walls", OTHER_WALLS, False),
        ("damped, all at once", (), False),
    ],
)
def test_no_particle_is_held_back_for_forces_of_places_alone(name, more, some):
    """Count particles that do not move in passes, while something pushes: those of fixes that ask for more than places."""
    ready = prepare(parse_scene(FALL + EFFECTS[name] + "\n" + END))
    with Instance(ready.plan) as instance:
        for command in more:
            instance.lammps.lmp.command(command)
        instance.setup()
        effects = {"contact", "walls", "ground"} & set(instance.lammps.lmp.available_ids("fix"))
        pushed = []
        for _ in range(15):
            instance.run(20)
            pushed += [instance.fix_scalar(fix) for fix in effects]
        assert passes(instance) > 200
        assert (held_back(instance) > 0) == some
        assert (np.abs(pushed).max() > 0.0) == (name != "beside each other")
        assert name != "beside each other" or instance.fix_value("contact", 1) > 0


SEA = (
    "region sea block -0.1 0.1 -0.1 0.1 0.0 0.4",
    "fix sea mobile mdanim/liquid sea 100 grid 20 20 160 level 0.12 gravity 9.81 buoyancy 1e-6",
)


@pytest.mark.parametrize(
    ("text", "more", "some"),
    [
        pytest.param(EFFECTS["damped in waves"], (), False, id="waves"),
        pytest.param(EFFECTS["damped in waves"], SEA, True, id="waves, with another liquid"),
        pytest.param(EFFECTS["damped in liquid"], (), False, id="a surface"),
        pytest.param(EFFECTS["liquid"].replace("drag 4", "drag 0"), (), False, id="a surface, drag of air alone"),
        pytest.param(EFFECTS["damped in liquid"].replace("drag 4", "drag 0"), (), False, id="a surface, no friction"),
        pytest.param(EFFECTS["damped in liquid"].replace("surface", "paper"), (), False, id="liquid of the paper"),
    ],
)
def test_what_a_liquid_acts_on_moves_in_passes(text, more, some):
    """Count particles that do not: those of fixes that need them. The bits are the same, energies but for rounding."""
    ready = prepare(parse_scene(FALL + text + "\n" + END))
    with Instance(ready.plan) as instance:
        for command in more:
            instance.lammps.lmp.command(command)
        instance.setup()
        instance.run(300)
        taken = passes(instance)
        assert taken > 280 and instance.fix_value("liquid", 4) > 0 and instance.fix_scalar("liquid") != 0.0
        assert (0 < held_back(instance) < 0.8 * taken * len(ready.system.mass)) if some else held_back(instance) == 0
    plain, by_passes = (film(text, style, more=more) for style in ("verlet", "verlet/mdanim"))
    assert np.array_equal(plain[0], by_passes[0])
    np.testing.assert_allclose(by_passes[1], plain[1], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("exponential", [False, True])
def test_friction_of_waves_is_told(exponential):
    """The largest phi and the bits are those of the plain step in either form of friction; so is what it takes."""
    plan = replace(prepare(parse_scene(FALL + EFFECTS["waves"] + "\n" + END)).plan, exponential=exponential)
    told = []
    for style in ("verlet", "verlet/mdanim"):
        with Instance(plan) as instance:
            instance.lammps.lmp.command(f"run_style {style}")
            instance.setup()
            instance.run(200)
            bits = instance.fix_value("leapfrog", 0), instance.array("x").tobytes()
            told.append((bits, [instance.fix_scalar("leapfrog"), instance.fix_value("liquid", 6), instance.fix_scalar("liquid")]))
            assert instance.fix_value("leapfrog", 0) > 0.0 and all(told[-1][1])
    assert told[0][0] == told[1][0]
    np.testing.assert_allclose(told[0][1], told[1][1], rtol=1e-12)


@pytest.mark.parametrize(
    ("ground", "least", "most"),
    [pytest.param("", 0, 2, id="alone"), pytest.param("ground z -4.1 cm\n", 20, 100, id="on the ground")],
)
def test_what_all_share_makes_no_lists(ground, least, most):
    """Let two bodies side by side fly a hundred times half the skin: contact alone needs no new lists, the ground does."""
    text = ground + EFFECTS["beside each other"].replace("(1, 0, 0)", "(20, 0, 0)")
    ready = prepare(parse_scene(text + "\n" + END))
    with Instance(ready.plan) as instance:
        instance.setup()
        instance.run(150)
        assert passes(instance) > 130
        assert instance.fix_value("contact", 1) > 0
        assert least <= instance.lammps.lmp.get_thermo("nbuild") <= most


def test_pieces_of_a_run_change_no_bit():
    """Cut a run with contact and air in pieces of 1, 2, 3 … steps."""
    text = EFFECTS["contact"] + EFFECTS["air"].replace("object a", "object c").replace("object b", "object d").replace(
        "(0, 0, 0)", "(0, 0, 1)"
    ).replace("(1, 0, 0)", "(1, 0, 1)")
    whole = film(text, "verlet/mdanim", (300,))[0][-1]
    assert np.array_equal(film(text, "verlet/mdanim", tuple(range(1, 25)))[0][-1], whole)


def lab_state(body, folder, commands, **options) -> tuple[np.ndarray, int]:
    """x, v and f in tag order after the commands, and how many passes were taken."""
    lmp = lab.load(body, folder, commands, **options)
    library = ctypes.CDLL(plugin_path.folder() + "/mdanimplugin.so")
    library.mdanim_passes.restype = ctypes.c_longlong
    try:
        return (
            np.concatenate([lab.by_tag(lmp, a) for a in "xvf"]),
            library.mdanim_passes(ctypes.c_void_p(getattr(lmp.lmp, "value", lmp.lmp))),
        )
    finally:
        lmp.close()


BODY = lab.shaken(lab.join(lab.block((4, 3, 2)), lab.block((2, 2, 2), (6.0, 0.0, 0.0))), 0.05)
MOVE = ["fix pull all mdanim/gravity 0.01 -0.02 0.03", "fix run all mdanim/leapfrog", "timestep 0.2"]


@pytest.mark.parametrize("drag", ["", " lambda 0.05", " lambda 0.4 drag exp"], ids=["free", "implicit", "exponential"])
def test_order_of_particles_changes_no_bit(tmp_path, drag):
    """Shuffle the data file: there are no blocks then, and the bits are those of blocks."""
    commands = [MOVE[0], MOVE[1] + drag, MOVE[2], "run_style verlet/mdanim", "run 300"]
    straight, taken = lab_state(BODY, tmp_path, commands)
    shuffled, none = lab_state(BODY, tmp_path, commands, order=np.random.default_rng(5).permutation(len(BODY.x)))
    assert (taken, none) == (299, 0)
    assert np.array_equal(straight, shuffled)


def test_steps_without_passes_are_computed_by_kernels_and_threads():
    """Contacts at surfaces and springs beside a fix that passes do not know: the bits of run_style verlet."""
    text = f"""air {{ }} ground z 0
object a {{ shape sphere 3 cm position (0, 0, 2.9) cm {SOFT} spin (0, 9, 0) friction 0.3 }}
object b {{ shape box (4, 4, 3) cm position (1, 0, 7.3) cm {SOFT} velocity (0, 0, -2) friction 0.3 }}"""
    end = "control { time 10 s resolution 1 cm }\n"
    plain, energies, trace, none = film(text, "verlet", (1, 40, 19), end=end)
    found, told, seen, taken = film(text, "verlet/mdanim threads 3", (1, 40, 19), end=end)
    assert none == taken == 0
    assert np.array_equal(found, plain) and np.array_equal(seen, trace)
    np.testing.assert_allclose(told, energies, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    "stranger", ["fix other all viscous 0.01", "fix other all gravity 0.1 vector 0 0 -1", "fix other all momentum 7 linear 1 1 1"]
)
def test_what_is_not_known_gets_the_plain_step(tmp_path, stranger):
    """Add a fix of LAMMPS's own that acts in steps: no passes, and the motion of run_style verlet."""
    found, none = lab_state(BODY, tmp_path, [stranger, *MOVE, "run_style verlet/mdanim", "run 50"])
    plain, _ = lab_state(BODY, tmp_path, [stranger, *MOVE, "run_style verlet", "run 50"])
    assert none == 0
    assert np.array_equal(found, plain)


def test_what_looks_at_a_run_sees_every_step_it_asks_for(tmp_path):
    """Dump every seventh step and rebuild by a fix of LAMMPS in between: all of every particle is the same to the last digit.

    The box is not: LAMMPS shrinks it when it makes lists, and passes need new ones at other steps. Neither is farther off than
    half the skin.
    """
    texts = []
    for style in ("verlet", "verlet/mdanim"):
        path = tmp_path / style.replace("/", "-")
        lab_state(
            BODY,
            tmp_path,
            [
                *MOVE,
                f"run_style {style}",
                f"dump d all custom 7 {path} id x y z vx vy vz fx",
                "dump_modify d sort id format float %.17g",
                "fix b all balance 10 1.0 shift x 5 1.1",
                "run 50",
            ],
        )
        texts.append(path.read_text())
    frames = [[part.partition("ITEM: ATOMS")[::2] for part in text.split("ITEM: TIMESTEP")[1:]] for text in texts]
    assert len(frames[0]) == len(frames[1]) == 8
    for (plain_head, plain), (head, found) in zip(*frames):
        assert found == plain
        box, plain_box = (np.array([line.split() for line in h.splitlines()[-3:]], float) for h in (head, plain_head))
        np.testing.assert_allclose(box, plain_box, rtol=0, atol=0.4)  # the skin: either is off by half of it at most


def test_lists_are_rebuilt_before_any_particle_has_gone_half_the_skin(tmp_path):
    """Let a fast body pass through a region watched by a wall: it is pushed back as with run_style verlet, bit for bit."""
    fast = lab.block((3, 3, 3), (0.0, 0.0, 0.0), (0.7, 0.0, 0.0))
    commands = [
        "region room block -5 9 -5 9 -5 9",
        "fix wall all mdanim/wall room 3.0",
        "fix run all mdanim/leapfrog",
        "timestep 0.1",
    ]
    found, taken = lab_state(fast, tmp_path, [*commands, "run_style verlet/mdanim", "run 200"])
    plain, _ = lab_state(fast, tmp_path, [*commands, "run_style verlet", "run 200"])
    assert taken > 100
    assert np.array_equal(found, plain)
    assert found[: len(fast.x), 0].max() < 9.5 and found[len(fast.x) : 2 * len(fast.x), 0].mean() < 0.0


@pytest.mark.parametrize(
    ("often", "wall", "least"),
    [
        ("check no", False, 49),
        ("every 7 delay 14 check no", False, 49),
        ("once yes check no", False, 49),
        ("once yes check yes", True, 1),
        ("once yes check no", True, 1),
        ("check no", True, 0),
    ],
)
def test_lists_are_made_when_lammps_is_told_to(tmp_path, often, wall, least):
    """Switch off the check of how far particles have gone, and rebuilding: passes where no lists are looked at,
    and the plain bits."""
    commands = [f"neigh_modify {often}", *MOVE]
    if wall:
        commands += ["region room block -10 10 -10 10 0.1 10", "fix wall all mdanim/wall room 3.0"]
    found, taken = lab_state(BODY, tmp_path, [*commands, "run_style verlet/mdanim", "run 50"])
    plain, none = lab_state(BODY, tmp_path, [*commands, "run_style verlet", "run 50"])
    assert np.array_equal(found, plain)
    assert none == 0 and taken >= least


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("c", [None, 0.05], ids=["springs", "dashpots"])
def test_an_object_that_overflows_leaves_others_alone(tmp_path, width, c):
    """Give the first of two objects springs too stiff for the time step, until it overflows: the second moves as by verlet.

    So it does when the run goes on from there.
    """
    if not supported(width):
        pytest.skip("this processor does not have it")
    commands = [*MOVE, "neigh_modify once yes"]
    second, whole = BODY.molecule == 2, len(BODY.x)
    stiff = replace(BODY, k=np.where(second[BODY.bond[:, 0]], BODY.k, 1e4 * BODY.k))
    for runs in (["run 30"], ["run 400", "run 5 pre no"]):
        found, taken = lab_state(stiff, tmp_path, [*commands, f"run_style verlet/mdanim width {width}", *runs], c=c)
        plain, _ = lab_state(stiff, tmp_path, [*commands, "run_style verlet", *runs], c=c)
        x, v, f = (found[k * whole : (k + 1) * whole] for k in range(3))
        assert taken > 20
        assert np.isfinite([x[second], v[second], f[second]]).all()
        if len(runs) > 1:
            assert not np.isfinite(v[~second]).all()
        kept = np.tile(second, 3)
        assert np.array_equal(found[kept], plain[kept])


def test_a_periodic_box_gets_the_plain_step(tmp_path):
    """Let a body cross the edge of a periodic box on one rank: no passes, and the bits of run_style verlet."""
    fast = lab.shaken(lab.block((4, 3, 2), (0.0, 0.0, 0.0), (0.3, 0.02, 0.01)), 0.03)
    commands = ["change_box all boundary p p p x final -6 12 y final -9 9 z final -9 9", MOVE[1], MOVE[2]]
    found, none = lab_state(fast, tmp_path, [*commands, "run_style verlet/mdanim", "run 200"])
    plain, _ = lab_state(fast, tmp_path, [*commands, "run_style verlet", "run 200"])
    assert none == 0
    assert np.array_equal(found, plain)


def test_blocks_far_from_the_origin_are_pushed_in_time(tmp_path):
    """Passes do not look at pairs as long as these cannot come into reach. Where places are rounded more, two blocks meet in the
    same step as without passes."""
    far = np.full(3, 1e4)
    pair = lab.join(lab.block((4, 3, 3), far, (0.1, 0.0, 0.0)), lab.block((3, 4, 3), far + (6.0, 0.0, 0.0), (-0.2, 0.0, 0.0)))
    commands = ["fix push all mdanim/barrier boundary inner 1.0 1.6", MOVE[1], "timestep 0.1"]
    found, taken = lab_state(pair, tmp_path, [*commands, "run_style verlet/mdanim", "run 300"])
    plain, none = lab_state(pair, tmp_path, [*commands, "run_style verlet", "run 300"])
    assert (taken, none) == (299, 0)
    assert np.array_equal(found, plain)
    n, first = len(pair.x), pair.molecule == 1
    assert found[n : 2 * n][first].mean(0)[0] < 0.05


def test_only_the_group_is_pushed(tmp_path):
    """Let contact push one of two bodies alone, the first: the other one flies on as if nothing was there."""
    pair = lab.join(lab.block((4, 3, 3)), lab.block((3, 4, 3), (4.8, 0.0, 0.0), (-0.2, 0.0, 0.0)))
    commands = [
        "group first molecule 1",
        "fix push first mdanim/barrier boundary inner 1.0 1.6",
        "fix run all mdanim/leapfrog",
        "timestep 0.2",
    ]
    found, taken = lab_state(pair, tmp_path, [*commands, "run_style verlet/mdanim", "run 60"])
    plain, none = lab_state(pair, tmp_path, [*commands, "run_style verlet", "run 60"])
    assert (taken, none) == (59, 0)
    assert np.array_equal(found, plain)
    n, first = len(pair.x), pair.molecule == 1
    np.testing.assert_allclose(found[n : 2 * n][~first], pair.v[~first], rtol=0, atol=1e-12)
    assert found[n : 2 * n][first].mean(0)[0] < -0.01


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("run_style verlet/mdanim fast", "unknown keyword fast; it knows width and threads"),
        ("run_style verlet/mdanim threads", "threads takes a number"),
        ("run_style verlet/mdanim threads 0", "threads is a number from 1 to 32, not 0"),
        ("run_style verlet/mdanim threads 33", "threads is a number from 1 to 32, not 33"),
        ("run_style verlet/mdanim width", "width takes one word"),
        ("run_style verlet/mdanim width avx1024", "width avx1024 is unknown or this processor does not have it"),
        ("fix g all mdanim/gravity 0 0", "fix mdanim/gravity"),
        ("fix g all mdanim/gravity 0 0 1 2", "gx gy gz are all it takes, got also 2"),
    ],
)
def test_mistakes_are_refused(tmp_path, command, message):
    """Give one wrong word."""
    with pytest.raises(Exception, match=re.escape(message)):
        lab.load(BODY, tmp_path, [command]).close()


def test_gravity_is_that_of_lammps_and_knows_its_energy(tmp_path):
    """Compare with fix gravity, and the energy with -sum m g x."""
    found = []
    for line in ("fix g all gravity 0.5 vector 3 0 -4", "fix g all mdanim/gravity 0.3 0 -0.4"):
        lmp = lab.load(BODY, tmp_path, [line, "fix run all mdanim/leapfrog", "run 0"])
        found.append((lab.by_tag(lmp, "f"), lmp.extract_fix("g", 0, 0)))
        lmp.close()
    np.testing.assert_allclose(found[1][0], found[0][0], rtol=0, atol=1e-15)
    assert found[1][1] == pytest.approx(found[0][1], rel=1e-12)
    assert found[1][1] == pytest.approx(-(BODY.mass * (BODY.x @ [0.3, 0.0, -0.4])).sum(), rel=1e-12)


def test_springs_with_and_without_dashpots_in_one_block(tmp_path):
    """Give dashpots to one type of springs alone, and other ones to the next."""
    damp = ["bond_coeff 1 0.2 1.0 0.1", "bond_coeff 2 0.3 1.4 0.02"]
    for some in (damp[:1], damp[1:], damp):
        found, taken = lab_state(BODY, tmp_path, [*some, *MOVE, "run_style verlet/mdanim", "run 100"])
        plain, _ = lab_state(BODY, tmp_path, [*some, *MOVE, "run_style verlet", "run 100"])
        assert taken == 99
        assert np.array_equal(found, plain)


@pytest.mark.parametrize(
    "change",
    [
        "bond_coeff * 0.3 1.1",
        "bond_coeff 1 0.2 1.0 0.1",
        "group second molecule 2\ndelete_bonds second multi remove",
        "set group all mass 2.0",
        "timestep 0.1",
    ],
)
def test_what_changes_between_two_runs_is_noticed(tmp_path, change):
    """Change springs, masses or the time step after a run: passes go on with what is there now."""
    found, plain = (
        lab_state(BODY, tmp_path, [*MOVE, f"run_style {style}", "run 40", *change.split("\n"), "run 40", "run 20 pre no"])
        for style in ("verlet/mdanim", "verlet")
    )
    assert found[1] == 97 and plain[1] == 0
    assert np.array_equal(found[0], plain[0])


@pytest.mark.parametrize("first", [[], ["run 3"]], ids=["from the start", "after a run without"])
def test_what_reads_the_list_of_bonds_finds_it(tmp_path, first):
    """Let stock fix bond/break, which knows springs by LAMMPS's list of bonds alone, take the longer of two."""
    chain = replace(
        lab.particles([[0.0, 0, 0], [1.5, 0, 0], [3.0, 0, 0], [6.0, 0, 0]], molecule=[1, 1, 1, 1]),
        bond=np.array([[0, 1], [2, 3]]),
        k=np.full(2, 0.1),
        r0=np.full(2, 1.0),
    )
    lmp = lab.load(
        chain,
        tmp_path,
        [
            "fix run all mdanim/leapfrog",
            "timestep 0.01",
            "run_style verlet/mdanim",
            *first,
            "fix break all bond/break 5 1 2.5",
            "run 7",
        ],
        special="0 1 1",
        cutoff=6.0,
    )
    force = lab.by_tag(lmp, "f")[:, 0]
    assert force[0] == -force[1] == pytest.approx(0.05, rel=1e-2)
    assert np.all(force[2:] == 0.0)
    lmp.close()
