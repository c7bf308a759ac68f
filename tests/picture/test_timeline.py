# SPDX-License-Identifier: GPL-2.0-only
"""The log of a run on executors, its picture, and the command that draws it."""

import numpy as np
import pytest
from command_line import GOOD, run
from mdanim_lammps.errors import OutputError
from mdanim_lammps.picture.palette import rgb
from mdanim_lammps.picture.timeline import (
    COLUMNS,
    DOING,
    NO_OWNER,
    ROWS,
    SINGLE,
    bars,
    draw,
    edges,
    executor_colors,
    headline,
    ownership,
    shares,
)
from mdanim_lammps.results.timeline import KINDS, Timeline


def log(executors=2, objects=3, frames=4):
    """A run in which object 0 is held, object 1 stays with executor 0, and the others go to the next executor in every frame."""
    timeline = Timeline(executors, "central", tuple(f"o[{m}]" for m in range(objects)))
    for frame in range(frames + 1):
        of = np.where(np.arange(objects) == 1, 0, (np.arange(objects) + frame) % executors)
        timeline.add(frame, [np.flatnonzero((of == e) & (np.arange(objects) > 0)) for e in range(executors)], 1, int(frame == 2))
        for e in range(executors if frame else 0):
            timeline.spans += [
                (e, "moving", frame, frame - 1.0, frame - 0.9),
                (e, "simulating", frame, frame - 0.9, frame - 0.4),
                (e, "frozen" if frame == 2 else "waiting", frame, frame - 0.4, frame - 0.1 * e),
            ]
    return timeline


def test_owners_are_those_of_every_frame(tmp_path):
    """Give the owner of every object in every frame, also after the log was written and read."""
    timeline = log()
    timeline.write(tmp_path)
    for t in (timeline, Timeline.read(tmp_path)):
        assert t.owner().tolist() == [[-1, 0, 0], [-1, 0, 1], [-1, 0, 0], [-1, 0, 1], [-1, 0, 0]]
        assert t.cpu == [0.0, 0.0] and t.seconds == 4.0


def test_time_is_shared_out():
    """Every executor's time by kind, how busy it was, and when each frame ended."""
    timeline = log()
    spent = dict(zip(KINDS, timeline.spent().T))
    assert spent["simulating"] == pytest.approx([2.0, 2.0]) and spent["moving"] == pytest.approx([0.4, 0.4])
    assert spent["waiting"] == pytest.approx([1.2, 0.9]) and spent["frozen"] == pytest.approx([0.4, 0.3])
    assert timeline.busy() == pytest.approx([0.5, 0.5])
    assert timeline.frame_ends() == pytest.approx({1: 1.0, 2: 2.0, 3: 3.0, 4: 4.0})


@pytest.mark.parametrize("columns", [1, 3, 7, 40, 999])
def test_pieces_of_time_add_up(columns):
    """Whatever the pieces are, each kind has as much of them as of the time."""
    timeline = log(executors=3, objects=5)
    share = shares(timeline, columns)
    assert share.sum(axis=2) * timeline.seconds / columns == pytest.approx(timeline.spent())
    assert share.min() > -1e-9 and share.sum(axis=1).max() < 1.0 + 1e-9


def test_bars_are_filled_in_proportion():
    """A piece that is half simulating and a quarter waiting is half dark, a quarter pale, and else white."""
    share = np.zeros((1, len(KINDS), 1))
    share[0, KINDS.index("simulating")], share[0, KINDS.index("waiting")] = 0.5, 0.25
    column = bars(share, 8)[1:-1, 0]
    colors = [rgb(DOING["simulating"])] * 4 + [rgb(DOING["waiting"])] * 2 + [np.ones(3)] * 2
    assert column[::-1] == pytest.approx(np.array(colors))


def test_every_object_has_its_row():
    """Up to `SINGLE` objects have a row each, in the colour of their executor; what never moves has none."""
    colors = executor_colors(2)
    picture = ownership(log(frames=4).owner(), colors)
    assert picture.shape == (3, 5, 3)
    assert (picture[0] == rgb(NO_OWNER)).all() and (picture[1] == colors[0]).all()
    assert (picture[2] == colors[[0, 1, 0, 1, 0]]).all()


@pytest.mark.parametrize("objects", [SINGLE + 1, 1000, 10_000])
def test_groups_show_how_many_each_has(objects):
    """In a group the part of the rows that an executor has is its part of the objects, within a row."""
    owner = np.random.default_rng(objects).integers(0, 3, (2, objects))
    colors = executor_colors(3)
    picture = ownership(owner, colors)
    rows = len(picture)
    assert rows == min(objects, ROWS)
    for a, b in zip(edges(objects), edges(objects)[1:]):
        mine = picture[-(-a * rows // objects) : b * rows // objects, 1]
        for e in range(3):
            found = (mine == colors[e]).all(axis=1).sum()
            assert abs(found - (owner[1, a:b] == e).sum() * rows / objects) <= 2.0


def test_colours_differ():
    """Sixteen executors have sixteen colours; the first eight are far from each other in lightness or hue."""
    colors = executor_colors(16)
    apart = np.linalg.norm(colors[:, None] - colors[None], axis=2) + 9.0 * np.eye(16)
    assert apart[:8, :8].min() > 0.25 and apart.min() > 0.1


@pytest.mark.parametrize(("executors", "objects", "frames"), [(1, 1, 1), (2, 3, 4), (16, 10_000, 3), (3, 200, 2 * COLUMNS)])
def test_a_picture_of_any_size(tmp_path, executors, objects, frames):
    """Draw small and large logs without a warning."""
    draw(log(executors, objects, frames), tmp_path / "t.png", "Title")
    assert (tmp_path / "t.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.parametrize(
    ("title", "executors", "line"),
    [
        pytest.param(
            "Which of them float?", 2, "Which of them float? – 2 executors, owners decided by the supervisor", id="a question"
        ),
        pytest.param("", 1, "Run – 1 executor, owners decided by the supervisor", id="no title"),
    ],
)
def test_the_headline_reads_well_after_any_title(title, executors, line):
    """Put nothing behind a title that would follow its question mark as a second mark."""
    assert headline(log(executors), title) == line


def test_a_log_without_spans_is_drawn(tmp_path):
    """Executors that were stopped at once have told nothing; owners are known all the same."""
    timeline = log()
    timeline.spans.clear()
    draw(timeline, tmp_path / "t.png")
    assert (tmp_path / "t.png").exists()
    with pytest.raises(OutputError, match="before its first frame"):
        draw(Timeline(2, "central", ("a",)), tmp_path / "none.png")


def test_the_command_line_tells_and_draws(tmp_path):
    """A run on executors says how many there are, what they did, and how to see it; one process has no timeline."""
    (tmp_path / "cube.txt").write_text(GOOD)
    done = run("cube.txt", "-n", "2", "--no-movie", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stdout.splitlines() if line.startswith("spread")]
    assert lines[0].startswith("spread   over 2 executors and a supervisor; the supervisor decides")
    assert lines[1].startswith("spread   2 executors, central: 0 objects moved, 0 windows begun again, busy ")
    assert lines[1].endswith(f"mdanim-lammps timeline {tmp_path / 'cube.out'}")
    drawn = run("timeline", "cube.out", cwd=tmp_path)
    assert drawn.stdout == "picture  cube.out/timeline.png\n", drawn.stderr
    assert (tmp_path / "cube.out" / "timeline.png").stat().st_size > 5000

    assert "spread" not in run("cube.txt", "--force", "--no-movie", cwd=tmp_path).stdout
    refused = run("timeline", "cube.out", cwd=tmp_path)
    assert refused.returncode == 4 and "by one process" in refused.stderr and "-n" in refused.stderr
    assert run("timeline", "nowhere", cwd=tmp_path).returncode == 7


def test_a_title_is_no_formula(tmp_path):
    """Signs that mark formulas for matplotlib stand in a title as they are, also where no formula could be read."""
    draw(log(), tmp_path / "a.png", "costs $3 and \\frac{$")
    assert (tmp_path / "a.png").stat().st_size > 1000
