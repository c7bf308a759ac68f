# SPDX-License-Identifier: GPL-2.0-only
"""Waves: the kernels, the general form and the naive twin find the same in random basins."""

import numpy as np
import pytest
import waves_lab as lab
from twin.waves import Twin


def basin(seed, shape=(9, 6, 8)):
    """Random solid parts: a bed, shelves and roofs, porous cells; and a surface that is far from level."""
    random = np.random.default_rng(seed)
    nz, ny, nx = shape
    part = np.zeros(shape, int)
    bed = random.uniform(0, 2.5, (ny, nx)) * (random.random((ny, nx)) < 0.5)
    part += np.round(np.clip(bed - np.arange(nz)[:, None, None], 0, 1) * 4096).astype(int)
    for _ in range(2):
        z, y, x = random.integers(2, nz - 2), random.integers(0, ny - 2), random.integers(0, nx - 3)
        part[z : z + random.integers(1, 3), y : y + random.integers(1, 4), x : x + random.integers(1, 5)] = 4096
    for _ in range(6):
        z, y, x = (random.integers(0, n) for n in shape)
        part[z, y, x] = random.integers(1, 4097)
    return part, random.uniform(0.0, 7.5, (ny, nx))


def waves(part, height, **settings):
    """Waves in such a basin."""
    w = lab.Waves(part.shape, **settings)
    w.solids(part)
    w.pour(height)
    return w


def set_velocities(w, twin, u):
    """The same ones in both."""
    links = w.links
    w.set_velocities(u)
    found = {(id(link.a), id(link.b)): link for link in twin.links}
    for a, b, speed in zip(links.a, links.b, u):
        link = found[id(twin.spans[a]), id(twin.spans[b])]
        upwind = link.a if speed > 0 else link.b
        link.u, link.q = speed, speed * link.opening(max(link.edge, upwind.surface()[0]))


def assert_same(w, twin):
    """But for rounding: solvers differ by it, so that now and then a flux is rounded to the next unit."""
    spans, content = w.spans, np.array([s.content for s in twin.spans])
    assert np.abs(spans.content - content).max() <= 8
    assert np.allclose(np.sort(w.links.u), np.sort([link.u for link in twin.links]), atol=2e-5)
    assert np.allclose(spans.phi, [s.phi for s in twin.spans], atol=1e-3)
    assert spans.full.tolist() == [s.full for s in twin.spans]
    assert w.total == content.sum()


@pytest.mark.parametrize(("speed", "bed"), [(0, 0.0), (4, 0.0), (4, 0.1)])
@pytest.mark.parametrize("seed", range(4))
def test_waves_do_what_the_equations_say(seed, speed, bed):
    """Follow the twin for 12 updates in a basin with bed, shelves, roofs and porous cells, at rest in the beginning or wild, on
    smooth and on rough ground."""
    part, height = basin(seed)
    w, twin = waves(part, height, tolerance=1e-14, bed=bed), Twin(part, height, bed)
    total = w.total
    assert w.spans.column.tolist() == [s.y * part.shape[2] + s.x for s in twin.spans]
    assert len(w.links.u) == len(twin.links)
    set_velocities(w, twin, np.random.default_rng(seed).normal(0, speed, len(twin.links)))
    for _ in range(12):
        w.update()
        twin.update()
        assert_same(w, twin)
    assert w.total == total and w.counts.solutions > w.counts.sub_updates
    if speed:
        assert w.counts.sub_updates > w.counts.updates and w.counts.limited > 0


@pytest.mark.parametrize("closed", [True, False])
def test_what_is_poured_under_a_wall_begins_at_rest(closed):
    """A wall up to the top of the basin, over a duct: its spans let out nothing in the first update, as in the twin."""
    part = np.zeros((12, 2, 9), int)
    part[2:, : 2 if closed else 1, 3:6] = 4096
    height = np.broadcast_to(np.where(np.arange(9) < 3, 8.3, 7.0), (2, 9))
    w, twin = waves(part, height, tolerance=1e-14), Twin(part, height)
    for _ in range(10):
        w.update()
        twin.update()
        assert_same(w, twin)


@pytest.mark.parametrize("seed", range(4))
def test_a_moving_roof_pushes_as_the_equations_say(seed):
    """Press a lid down on the liquid and lift it again, as the twin."""
    random = np.random.default_rng(seed)
    shape = (10, 5, 7)
    height = np.full(shape[1:], 5.0) + random.uniform(0, 0.5, shape[1:])

    def lid(bottom):
        z = np.arange(shape[0])[:, None, None]
        part = np.zeros(shape)
        part[:, 1:4, 2:5] = np.clip(np.minimum(z + 1, bottom + 2) - np.maximum(z, bottom), 0, 1)
        return np.round(part * 4096).astype(int)

    bottoms = 4.7 + np.cumsum(np.concatenate([np.full(5, -0.05), np.full(8, 0.06)]))
    part = lid(bottoms[0])
    w, twin = waves(part, height, tolerance=1e-14), Twin(part, height)
    for bottom in bottoms:
        w.solids(lid(bottom))
        twin.move_roofs(lid(bottom))
        w.update()
        twin.update()
        assert_same(w, twin)


@pytest.mark.parametrize("obstacles", [False, True])
@pytest.mark.parametrize("shape", [(9, 6, 8), (9, 1, 37), (12, 23, 16), (7, 5, 5)], ids=str)
def test_every_instruction_set_and_the_general_form_give_the_same_bits(shape, obstacles):
    """Contents, heads and velocities agree to the last bit for 40 updates, on a bed with pools and among obstacles."""
    random = np.random.default_rng(1)
    nz, ny, nx = shape
    bed = random.uniform(0, 2.5, (ny, nx))
    part = np.round(np.clip(bed - np.arange(nz)[:, None, None], 0, 1) * 4096).astype(int)
    if obstacles:
        part[3:5, : max(1, ny // 2), 1:4] = 4096
        part[random.random(shape) < 0.02] = 1500
    height = random.uniform(-1.0, nz, (ny, nx))
    kinds = [waves(part, height, bed=0.02 if obstacles else 0.0) for _ in range(4)]
    here = [kind.use(number) for number, kind in enumerate(kinds[:3])]
    kinds[3].use_general_form()
    assert here[0]
    for kind in kinds:
        kind.set_velocities(np.random.default_rng(2).normal(0, 6, len(kind.links.u)))
    kinds = [kind for kind, runs in zip(kinds, [*here, True]) if runs]
    for _ in range(40):
        for kind in kinds:
            kind.update()
        assert len({b"".join(a.tobytes() for a in (*kind.spans, *kind.links)) for kind in kinds}) == 1
    counts = kinds[0].counts
    assert (counts.limited > 0 or not obstacles) and counts.sub_updates > counts.updates and counts.iterations > counts.solutions


def test_pressure_below_a_roof_takes_as_few_steps_in_a_large_basin():
    """Blocks of columns carry it: without them these basins take 28 and 50 steps of the solver."""
    for edge in (16, 64):
        part = np.zeros((20, edge, edge), int)
        part[10:, edge // 4 : 3 * edge // 4, edge // 4 : 3 * edge // 4] = 4096
        w = waves(part, np.where(np.arange(edge) < edge // 8, 16.0, 15.0) * np.ones((edge, 1)))
        w.update(10)
        assert w.counts.iterations / w.counts.solutions < 14, edge
