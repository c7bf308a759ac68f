# SPDX-License-Identifier: GPL-2.0-only
"""Waves: exact volume, rest, closed forms, and solids that move in them. The twin is in test_waves_twin.py."""

import numpy as np
import pytest
import waves_forms as forms
import waves_lab as lab

UNIT = lab.UNIT


def obstacles(seed, shape=(24, 32, 32)):
    """A block on the floor, a shelf, a porous patch, and random solid parts here and there."""
    random = np.random.default_rng(seed)
    part = np.zeros(shape, int)
    part[:6, 10:20, 10:30] = 4096
    part[12:16, 20:30, 5:20] = 4096
    part[7, 24:30, 24:30] = 2600
    where = tuple(random.integers(0, n, 250) for n in shape)
    part[where] = random.integers(1, 4097, 250)
    return part


# --- at rest ---


@pytest.mark.parametrize("level", [14.5, 14.0, 9.25])
@pytest.mark.parametrize("seed", range(3))
def test_level_liquid_stays_to_the_unit(seed, level):
    """Nothing moves over obstacles, shelves and random solid parts: no unit, no velocity; and then nothing is computed."""
    part = obstacles(seed)
    w = lab.Waves(part.shape, rest=0)  # without the rule that stops it
    w.solids(part)
    w.pour(level)
    content = w.spans.content
    w.update(100)
    assert (w.spans.content == content).all() and w.fastest == 0.0 and not w.at_rest
    w.set(rest=2**-10)
    w.update()
    assert w.at_rest
    before = w.counts
    w.update(1000)
    assert w.counts == before and w.total == content.sum()


def test_level_liquid_with_heads_that_units_do_not_divide_comes_to_rest():
    """A level between the units of partly solid cells is levelled out and stays."""
    part = obstacles(5)
    w = lab.Waves(part.shape)
    w.solids(part)
    w.pour(14 + 1 / 3)
    total = w.total
    w.update(3)
    assert w.at_rest and w.total == total and w.fastest == 0.0


@pytest.mark.parametrize("seed", range(2))
def test_liquid_comes_to_rest_by_itself(seed):
    """From random heights each pool gets its one level to the unit, exactly, and wakes only when a solid moves."""
    random = np.random.default_rng(seed)
    shape = (14, 16, 20)
    part = np.zeros(shape, int)
    part[:10, :, 9:11] = 4096  # parts two pools
    part[:4, 4:8, 2:6] = 4096
    part[7:9, 10:14, 12:16] = 4096
    part[:3, 3:9, 14:18] = 1700
    w = lab.Waves(shape, calm=0.2)
    w.solids(part)
    w.pour(np.where(np.arange(20) < 10, 6.0, 8.0) + random.uniform(-1, 1, shape[1:]))
    total = w.total
    spans = w.spans
    west = (spans.column % 20 < 9).nonzero()[0]
    in_west = spans.content[west].sum()
    for _ in range(60):
        w.update(20)
        if w.at_rest:
            break
    assert w.at_rest and w.total == total and w.fastest == 0.0
    spans = w.spans
    assert spans.content[west].sum() == in_west
    for side in (spans.column % 20 < 9, spans.column % 20 > 10):
        wet = side & (spans.content > UNIT // 1024)
        free = wet & (spans.full == 0)
        assert np.ptp(spans.phi[wet]) <= 2.0**-20 and np.ptp(spans.head[free]) <= 4.0 * 2.0**-20
    w.solids(part)
    assert w.at_rest
    part[9:11, 2:4, 2:4] = 4096  # in the air: the liquid looks, and rests again
    w.solids(part)
    assert not w.at_rest
    w.update(2)
    assert w.at_rest and w.total == total
    part[4:6, 2:4, 2:4] = 4096
    w.solids(part)
    w.update(5)
    assert not w.at_rest and w.fastest > 0.0 and w.total == total


def test_liquid_below_nearly_shut_cells_comes_to_rest():
    """A block of cells that are just not shut, across the surface: little volume moves the surface in it by cells."""
    shape = (12, 6, 10)
    part = np.zeros(shape, int)
    part[5:10, 2:5, 3:7] = np.array([3675, 3967, 3967, 3967, 1939])[:, None, None]
    w = lab.Waves(shape, calm=0.3)
    w.solids(part)
    w.pour(7.3 + np.random.default_rng(0).uniform(-1, 1, shape[1:]))
    total = w.total
    w.update(1000)
    assert w.at_rest and w.total == total


def test_a_puddle_comes_to_rest():
    """A film on a block, in which a velocity stands that passes less than half a unit."""
    part = np.zeros((6, 3, 6), int)
    part[3, :, :] = 4096
    w = lab.Waves(part.shape, calm=0.3)
    w.solids(part)
    w.pour(4 + np.array([850, 850, 1743, 1620, 850, 850]) / UNIT)
    total = w.total
    w.update(400)
    assert w.at_rest and w.total == total


def test_a_pool_whose_rim_lets_nothing_pass_comes_to_rest():
    """A pool on a block, a layer on its rim that passes less than half a unit.

    The layer's velocity must neither hold up the pool's levelling by viscosity nor keep the liquid awake.
    """
    shape = (8, 7, 8)
    part = np.zeros(shape, int)
    part[:3, 2:5, 2:6] = 4096
    part[3, 1:6, 1:7] = 1400
    part[3, 2:5, 2:6] = 3463
    part[4, 2:5, 3:6] = np.array([0, 1306, 300])
    w = lab.Waves(shape, calm=0.3, rest=2**-14)
    w.solids(part)
    inside = part[0] > 0
    height = 2.5 + np.zeros(shape[1:])
    height[inside] = 4.0 + np.random.default_rng(0).uniform(0.0012, 0.0018, inside.sum())
    w.pour(height)
    total = w.total
    w.update(3000)
    assert w.at_rest and w.total == total
    assert np.ptp(w.surface[2:5, 2]) < 2.0**-19


def test_pools_that_a_ridge_parts_but_for_a_layer_come_to_rest():
    """Each at its own level: what stands on the ridge passes less than half a unit."""
    part = np.zeros((7, 2, 9), int)
    part[:3, :, 4] = 4096
    part[3, :, 3:6] = 500
    part[3:5, :, 4] = np.array([3600, 3686])[:, None]
    w = lab.Waves(part.shape, calm=0.3)
    w.solids(part)
    w.pour(np.where(np.arange(9) < 5, 4.0035, 4.0005))
    total = w.total
    w.update(500)
    assert w.at_rest and w.total == total
    assert w.surface[0, 0] > w.surface[0, -1] + 0.001


def test_a_film_above_does_not_push_what_stands_below():
    """On a block that ends inside a cell, beside a partly solid column whose liquid stands in the same cell, but lower."""
    part = np.zeros((10, 3, 8), int)
    part[:7, :, :4] = 4096
    part[7, :, :4] = 3265
    part[5:8, :, 4] = np.array([194, 217, 173])[:, None]
    w = lab.Waves(part.shape, rest=0)
    w.solids(part)
    w.pour(np.where(np.arange(8) < 4, 7 + 3265 / 4096 + 0.0007, 7.4))
    w.update(20)
    spans = w.spans
    assert np.abs(spans.phi - spans.head).max() < 1e-6 and w.fastest < 1e-6


@pytest.mark.parametrize(("cells", "depth"), [(64, 4), (64, 20)])
def test_waves_die_in_the_calm_time(cells, depth):
    """To 1/e, whatever the depth."""
    time = 50 * np.sqrt(depth)
    exact = 2 * np.pi / np.sqrt(np.pi / cells * np.tanh(np.pi / cells * depth))
    periods = int(time / exact)
    left = forms.standing(cells, depth, 1, periods=periods, calm_time=time, viscosity=0).left
    assert left == pytest.approx(np.exp(-periods * exact / time), rel=0.1)


def test_a_large_basin_comes_to_rest():
    """A hump runs to and fro for seven calm times: it is down to a thousandth of a cell, and the liquid sleeps."""
    w = lab.Waves((12, 64, 64), calm_time=50 * np.sqrt(5))
    x = np.arange(64) - 20.0
    w.pour(5 + 3 * np.exp(-(x[None, :] ** 2 + x[:, None] ** 2) / 30))
    total = w.total
    w.update(int(5 * 50 * np.sqrt(5) / 0.1))
    assert not w.at_rest
    w.update(int(3 * 50 * np.sqrt(5) / 0.1))
    assert w.at_rest and w.total == total and np.ptp(w.surface) <= 2.0**-20


def test_a_floating_cube_at_its_draft_stays():
    """Neither the cube nor the liquid moves in 300 updates; the liquid sleeps from the start."""
    w = lab.Waves((28, 24, 24))
    body = forms.Body((6, 6, 6), (12, 12, 12), 0.5)
    body.solids(w)
    w.pour(12)
    path = body.move(w, 300)
    assert np.abs(path - [12, 12, 12]).max() == 0.0
    assert w.at_rest and w.counts.sub_updates <= 2


# --- closed forms; bench/waves.py prints more of them ---


@pytest.mark.parametrize(
    ("cells", "depth", "mode"), [(64, 4, 1), (64, 10, 1), (64, 20, 2), (64, 20, 4), (40, 20, 1), (32, 3, 4)], ids=str
)  # kh = 0.2, 0.5, 2, 3.9, 1.6, 1.2
def test_standing_waves_have_their_period(cells, depth, mode):
    """Within 1.5 % of 2 pi/sqrt(k tanh kh), and most of the swing is left after six periods."""
    found = forms.standing(cells, depth, mode)
    assert found.period == pytest.approx(1.0, abs=0.015)
    assert found.left > 0.85


def test_a_standing_wave_loses_little_to_the_scheme():
    """Without viscosity a wave 128 cells long keeps 95 % in six periods, with it 90 %."""
    assert forms.standing(64, 10, 1, viscosity=0).left > 0.98
    assert forms.standing(64, 10, 1).left > 0.97


@pytest.mark.parametrize(("depth", "error", "front"), [(8, 0.016, 0.11), (16, 0.01, 0.07)])
def test_a_dam_breaks_as_ritter_says(depth, error, front):
    """Depths, the front on dry ground (first order: late), and 4/9 of the depth at the dam.

    The front is where the depth is 1 % of that of the dam: at 0.85 of 2 sqrt(depth) in Ritter's solution.
    """
    found = forms.dam_on_dry_ground(depth)
    assert found.error < error and 0.85 - front < found.front < 0.85
    assert found.at_dam == pytest.approx(4 / 9, abs=0.01)


def test_a_bore_runs_as_stoker_says():
    """Speed within 1 %, plateau within 4 % (dispersion: an undular bore), 1 % without dispersion."""
    found = forms.dam_on_wet_ground(16)
    assert found.speed == pytest.approx(1.0, abs=0.01) and found.plateau == pytest.approx(1.0, abs=0.04)
    assert found.highest < 1.2
    assert forms.dam_on_wet_ground(16, inertia=0).plateau == pytest.approx(1.0, abs=0.01)


def test_liquid_sloshes_in_a_dish_as_thacker_says():
    """The period of the planar mode within 4 %, over a shore that falls dry and is wetted again."""
    found = forms.dish(20, 6, periods=3)
    assert found.period == pytest.approx(1.0, abs=0.04) and 0.75 < found.left < 1.0


@pytest.mark.parametrize(
    ("arm", "wall", "gap", "depth", "error"),
    [(8, 16, 4, 16, 0.01), (8, 32, 4, 16, 0.01), (16, 8, 4, 16, 0.02), (4, 48, 4, 12, 0.01), (1, 64, 1, 12, 0.01)],
    ids=str,
)
def test_vessels_swing_through_an_opening(arm, wall, gap, depth, error):
    """The period of a U-tube, as of potential flow, whether its arms are narrower than deep or not."""
    assert forms.vessels(arm, wall, gap, depth, periods=2).period == pytest.approx(1.0, abs=error)


def test_vessels_come_to_one_level():
    """12 against 4 cells through an opening: 8 on both sides, at rest."""
    part = np.zeros((20, 1, 24), int)
    part[4:, :, 8:16] = 4096
    w = lab.Waves(part.shape, calm=0.2)
    w.solids(part)
    w.pour(np.where(np.arange(24) < 8, 12.0, 4.0))
    w.update(2500)
    assert w.at_rest
    assert w.surface[0, 0] == pytest.approx(8.0, abs=1e-5) and w.surface[0, -1] == pytest.approx(8.0, abs=1e-5)


def test_a_hull_stays_dry_and_is_lifted_by_its_depth():
    """Water outside, none inside: Archimedes' lift of the whole hull."""
    lift, inside = forms.hull(200)
    assert lift == pytest.approx(1.0, abs=1e-4) and inside == 0.0


@pytest.mark.parametrize(("density", "at"), [(0.3, (16.3, 16.1)), (0.9, (16, 16))], ids=str)
def test_a_cube_comes_to_float_at_its_draft(density, at):
    """Within 0.2 % of its side, on the grid and off it."""
    assert forms.draft(density, at, updates=500) == pytest.approx(density, abs=0.004)


@pytest.mark.parametrize(
    ("size", "density", "above"), [((6, 6, 6), 0.05, -1.3), ((16, 16, 2), 0.05, -0.05), ((16, 16, 2), 0.1, -0.15)], ids=str
)
def test_light_bodies_are_stable(size, density, above):
    """Let go next to their draft, bodies bob and stay where they are; pressure does not hammer them.

    The liquid that moves along with a wide plate has a hundred times its mass. If the roof of a full span did not yield by the
    mass above it, the plate would be thrown about with eight times its weight.
    """
    w = lab.Waves((24, 32, 32), calm=0.05)
    rest = 12 + size[2] * (0.5 - density)
    body = forms.Body(size, (16.2, 16.1, rest + above), density, free=(0, 0, 1))
    body.solids(w)
    w.pour(12)
    speeds = []
    path = body.move(w, 300, lambda _: speeds.append(body.v[2]))[:, 2] - rest
    assert np.abs(path).max() <= np.abs(above) and np.abs(path[-50:]).max() < 0.4 * np.abs(above)
    assert np.abs(np.diff(speeds)).max() / forms.DT < max(0.3, 3.0 * np.abs(above))


def test_a_bore_carries_a_float():
    """Flow pushes a body along, and not aside."""
    along, aside = forms.carried(201)
    assert 4.0 < along < 6.0 and aside < 0.055


# --- solids that move ---


@pytest.mark.parametrize(("seed", "jumps"), [(0, False), (1, True)])
def test_random_bodies_lose_no_liquid(seed, jumps):
    """300 updates with four bodies at random speeds among walls: exact, not negative, finite, bounded; then level again."""
    check_random_bodies(seed, jumps, updates=300)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(20))
def test_random_bodies_lose_no_liquid_for_long(seed):
    """The same for 10 000 updates."""
    check_random_bodies(seed, seed % 2 == 1, updates=10_000)


def check_random_bodies(seed, jumps, updates):
    """Shake a basin, take the bodies out, and wait for rest."""
    random = np.random.default_rng(seed)
    shape = (16, 16, 20)
    edges = np.array(shape[::-1])
    held = np.zeros(shape)
    for _ in range(3):
        low = random.uniform(0, 12, 3)
        held = np.maximum(held, forms.box(shape, low, low + random.uniform(1, 6, 3)))
    w = lab.Waves(shape)
    w.solids(forms.parts(held))
    w.pour(7.5)
    total = w.total
    bodies = [
        forms.Body((random.uniform(1, 6, 3) if n % 2 else random.uniform(1, 3)), random.uniform(4, 12, 3), random.uniform(0.1, 4))
        for n in range(4)
    ]
    for body in bodies:
        body.v = random.normal(0, 2, 3)
    for _ in range(updates):
        share, mass = held.copy(), np.zeros(shape[1:])
        for body in bodies:
            body.x += forms.DT * body.v
            out = (body.x < 0) | (body.x > edges)
            body.v[out] *= -1
            body.x = np.clip(body.x, 0, edges)
            if random.random() < 0.02:
                body.v = random.normal(0, 3, 3)
            if jumps and random.random() < 0.02:
                body.x = random.uniform(0, edges)
            own = body.share(shape)
            share = np.maximum(share, own)
            mass += own.sum(0) * body.density
        w.solids(forms.parts(share), mass)
        w.update()
        spans = w.spans
        assert w.total == total
        assert (spans.content >= 0).all() and np.isfinite(spans.phi).all()
        assert np.abs(spans.phi).max() <= shape[0] + 100 and w.fastest <= 4 * np.sqrt(shape[0])
    assert w.counts.displaced > 0
    w.solids(forms.parts(held))
    w.set(calm=0.3)
    for _ in range(200):
        w.update(20)
        if w.at_rest:
            break
    assert w.at_rest and w.total == total


def test_a_lid_that_comes_down_parts_a_column_and_loses_nothing():
    """A plate sinks through the surface to the floor and up again: liquid under it, over it, and beside it."""
    shape = (16, 12, 12)
    w = lab.Waves(shape, calm=0.1)
    w.pour(8)
    total = w.total
    for bottom in np.concatenate([np.linspace(12, 0, 60), np.linspace(0, 12, 60)]):
        w.solids(forms.parts(forms.box(shape, (3, 3, bottom), (9, 9, bottom + 2.5))))
        w.update()
        assert w.total == total and w.spans.content.min() >= 0
    spans = w.spans
    assert (spans.content[(spans.low > 10)] < UNIT).all()


# --- state ---


def splash(updates):
    """A cube in the middle of its plunge, and the liquid."""
    w = lab.Waves((24, 20, 20))
    body = forms.Body((5, 5, 5), (10.2, 9.7, 15), 0.6, velocity=(0.1, 0, -2))
    w.pour(10)
    body.move(w, updates)
    return w, body


def test_waves_go_on_from_a_state_to_the_last_bit():
    """Other waves that take the state up in the middle of a splash, before or after a splash of their own, go on alike."""
    w, body = splash(25)
    other, _ = splash(7)
    for fresh in (lab.Waves(w.shape), other):
        fresh.state = w.state
        assert (fresh.state == w.state).all()
    alike = [w, fresh, lab.Waves(w.shape)]
    alike[2].state = w.state
    for _ in range(20):
        body.x[2] -= 0.05
        share = forms.parts(body.share(w.shape))
        for one in alike:
            one.solids(share, share.sum(0) / 4096 * body.density)
            one.update()
        assert (alike[1].state == w.state).all() and (alike[2].state == w.state).all()


def test_the_way_of_solids_leaves_no_trace():
    """A shelf that grows and shrinks, and so needs more and fewer spans, leaves the same as one that was there from the start."""
    shape = (12, 9, 11)
    w = lab.Waves(shape)
    w.pour(8 + np.random.default_rng(1).uniform(-1, 1, shape[1:]))
    total = w.total
    for width in (1, 3, 2, 7, 11, 5, 11, 9, 0, 10):
        part = np.zeros(shape, int)
        part[5:7, 1:8, :width] = 4096
        w.solids(part)
        fresh = lab.Waves(shape)
        fresh.state = w.state
        for _ in range(2):
            w.update()
            fresh.update()
            assert w.total == total and (fresh.state == w.state).all()


def test_rest_is_part_of_the_state():
    """Sleeping liquid stays asleep."""
    w = lab.Waves((8, 5, 6))
    w.pour(4)
    w.update()
    other = lab.Waves(w.shape)
    other.state = w.state
    assert w.at_rest and other.at_rest
    other.update(10)
    assert other.counts.sub_updates == 0


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda state: state[:40], "too few"),
        (lambda state: state[:-8], "spans and"),
        (lambda state: np.concatenate([[9], state[1:]]), "another version"),
        (lambda state: np.concatenate([state[:8], [7], state[9:]]), "a grid of 7 x 20 x 24 cells, this one has 20 x 20 x 24"),
        (lambda state: np.concatenate([state[:48], [state[48] ^ 1], state[49:]]), "units of liquid, not"),
        (lambda state: np.concatenate([state[:64], np.full(24 * 800, 16), state[64 + 24 * 800 :]]), "spans and"),
        (lambda state: np.concatenate([state[:-8], np.array([np.nan]).view(np.uint8)]), "not a number"),
        (lambda state: np.concatenate([state[:-16], np.array([1e9]).view(np.uint8), state[-8:]]), "faster than 19.59"),
    ],
)
def test_a_damaged_state_is_refused_and_changes_nothing(damage, message):
    """Too short, of another version or grid, with other solids or another sum, or with a value that is not a number."""
    w, _ = splash(12)
    before = w.state
    with pytest.raises(RuntimeError, match=message):
        w.state = damage(before)
    assert (w.state == before).all()


def test_no_room_is_an_error():
    """A solid that fills what liquid needs stops with the cell and a way out."""
    part = np.zeros((4, 3, 3), int)
    w = lab.Waves(part.shape)
    w.pour(3)
    part[:, :, :] = 4096
    part[:2, 0, 0] = 0
    with pytest.raises(RuntimeError, match=r"closes cell \(\d, \d, \d\) .* no room for the \d+ units .*; enlarge the basin"):
        w.solids(part)


@pytest.mark.no_memory
def test_a_basin_without_memory_is_told():
    """An absurd size raises an error with its reason instead of ending the process."""
    with pytest.raises(MemoryError, match="out of memory"):
        lab.Waves((2**10, 2**15 - 8, 2**15 - 8))


def test_energy_of_height_counts_liquid_beside_solids_where_it_is():
    """A solid fills half of the third cell of a column: 0.5 + 1.5 + 2.5/2 cells^2 are left of three cells; beside it 4.5."""
    w = lab.Waves((4, 1, 2))
    part = np.zeros((4, 1, 2), int)
    part[2, 0, 0] = 2048
    w.solids(part)
    w.pour(3)
    assert w.energy[0] == pytest.approx(3.25 + 4.5, abs=1e-6)
