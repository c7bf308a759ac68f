# SPDX-License-Identifier: GPL-2.0-only
"""Limits of a scene: a value beyond one is refused at its line, with the limit and a way out."""

import math
import os
import time

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene.forms import slots
from mdanim_lammps.scene.keywords import all_keywords
from mdanim_lammps.scene.parse import load_scene, parse_scene
from mdanim_lammps.scene.schema import limit_of
from scene_parts import CONTROL, pool, text


def problems(scene: str, **options) -> list:
    """The problems of a bad scene."""
    with pytest.raises(SceneError) as error:
        parse_scene(scene, **options)
    return error.value.problems


# --- values -----------------------------------------------------------------------------------------------

TOO_MUCH = [
    ("sphere of 1e308 m", text(shape="sphere 1e308 m"), 2, 16, "r of sphere is too large", "1e9 m, found 1e308 m"),
    ("sphere of 1e-300 m", text(shape="sphere 1e-300 m"), 2, 16, "r of sphere is too small", "from 1e-9 m"),
    ("thin cylinder", text(shape="cylinder 1e-10 m 10 cm"), 2, 18, "r of cylinder is too small", "1e-9 m"),
    ("box of 1e300 m", text(shape="box (1, 1e300, 1) m"), 2, 13, "ly of shape box is too large", "1e300 m"),
    ("position of 1e18 m", text(position="(0, 0, 1e18) m"), 3, 12, "z of position is too large", "1e9 m"),
    ("position through a let", text("let z = -1e18 m\n", position="(0, 0, z)"), 4, 12, "z of position is too small", "1e9 m"),
    ("mass of 5e-324 kg", text(mass="5e-324 kg"), 4, 8, "mass is too small", "1e-18 kg"),
    ("density", text(mass=None, density="1e300"), 5, 11, "density is too large", "kg/m^3"),
    ("elasticity", text(elasticity="1e200 Pa"), 5, 14, "elasticity is too large", "GPa"),
    ("spring", text(elasticity="spring 1e200 N/m"), 5, 21, "is too large", "N/m"),
    ("damping of 1e9", text(damping="1e9"), 6, 11, "damping is too large: it goes up to 100", ""),
    ("velocity", text(velocity="(0, 0, -1e200) m/s"), 6, 12, "vz of velocity is too small", "1e9 m/s"),
    ("spin", text(spin="(0, 0, 1e200) rpm"), 6, 8, "wz of spin is too large", "rad/s"),
    ("drag", text(drag="1e200 N*s/m"), 6, 8, "drag is too large", "N*s/m"),
    ("gravity", text("gravity (0, 0, -1e200)\n"), 1, 9, "gz of gravity is too small", "m/s^2"),
    ("ground", text("ground z 1e10 m\n"), 1, 10, "h of ground is too large", "1e9 m"),
    ("walls", text("walls from (-1e10, 0, 0) m to (1, 1, 1) m\n"), 1, 12, "in walls is too small", "1e9 m"),
    ("time of 1e12 s", text().replace("3 s", "1e12 s"), 7, 16, "time is too large", "1e9 s"),
    ("time of 1e18 s", text().replace("3 s", "1e18 s"), 7, 16, "time is too large", "1e9 s"),
    ("frames of 1e300 fps", text().replace("3 s", "3 s frames 1e300 fps"), 7, 27, "frames is too large", "1e9 1/s"),
    ("frames of 0.00001/year", text().replace("3 s", "3 s frames 1e-30 fps"), 7, 27, "frames is too small", "1/s"),
    ("a run of 3e9 frames", text().replace("3 s", "1e8 s"), 7, 16, "the most is 10 000 000", ""),
    ("resolution of 1e-300 m", text().replace("3 s", "3 s resolution 1e-300 m"), 7, 31, "resolution is too small", "1e-9 m"),
    ("timestep", text().replace("3 s", "3 s timestep 1e-30 s"), 7, 29, "timestep is too small", "1e-15 s"),
    ("mesh scale", text(shape='mesh "a.stl" scale 1e300'), 2, 28, "s of mesh is too large", ""),
    ("tiny mesh scale", text(shape='mesh "a.stl" scale 1e-300'), 2, 28, "s of mesh is too small", ""),
    ("basin", pool("volume 1 l basin from (0, 0, 0) m to (1, 1, 1e300) m"), 3, 40, "in basin is too large", "1e9 m"),
    ("sweeps", pool("volume 1 l sweeps 5000"), 3, 21, "sweeps is too large: it goes up to 4096", ""),
    ("picture", text() + "render { size (1, 99999) }", 8, 15, "h of size is too large", "16384"),
]


@pytest.mark.parametrize(("scene", "line", "column", "words", "limit"), [t[1:] for t in TOO_MUCH], ids=[t[0] for t in TOO_MUCH])
def test_value_beyond_its_limit(scene, line, column, words, limit):
    """One problem, at the value, with the limit and a way out."""
    (problem,) = problems(scene)
    assert words in problem.message
    assert limit in problem.message
    assert problem.hint
    assert (problem.line, problem.column) == (line, column), str(problem)


def test_every_number_has_a_limit():
    """No number of any keyword is without bounds: the keyword or its unit has a limit."""
    for keyword in all_keywords():
        for slot in slots(keyword.form):
            if slot.kind in ("number", "vector", "place") and slot.unit != "?":
                assert limit_of(keyword, slot).most < math.inf, keyword.name


# --- names of files -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "cause"), [
    ("/tmp/a.mp4", "lies outside of the output folder"), ("../a.mp4", "lies outside of the output folder"),
    ("a/../../b.mp4", "lies outside of the output folder"), ("a/..", "lies outside"), ("..", "lies outside"),
    ("a\x07b.mp4", "cannot be printed"), ("a\x1b[2Jb.mp4", "cannot be printed"), ("", "is written as .mp4"),
    ("trajectory.h5", "is written as .mp4"), ("scene.lock.txt", "is written as .mp4"),
    (".mp4", "is written as .mp4"), ("a" * 300 + ".mp4", "is written as .mp4"), ("/", "lies outside"),
])  # fmt: skip
def test_movie_stays_in_the_output_folder(name, cause):
    """A scene cannot name a file outside of the output folder, nor one of the run's own."""
    (problem,) = problems(text() + f'render {{ movie "{name}" }}')
    assert cause in problem.message
    assert (problem.line, problem.column) == (8, 16)
    assert 'movie "ball.mp4"' in problem.hint
    assert problem.message.isprintable()


def test_movie_in_a_subfolder():
    """A plain name, or one below a folder, is taken as it is."""
    for name in ("a.mp4", "films/b c.MP4", "...mp4"):
        assert parse_scene(text() + f'render {{ movie "{name}" }}').render.movie == name


@pytest.fixture
def strange(tmp_path):
    """Paths that are not files on a disk, and links to them."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "huge").touch()
    os.truncate(tmp_path / "huge", 20 * 2**30)
    paths = [
        "/dev/zero",
        "/dev/tty",
        "/proc/kmsg",
        "/proc/self/environ",
        "/sys/kernel/notes",
        "pipe",
        "folder",
        "huge",
        "/proc/self/mem",
    ]
    for n, path in enumerate(paths):
        (tmp_path / f"link{n}").symlink_to(path)
    (tmp_path / "round").symlink_to("round")
    return tmp_path, [*paths, *(f"link{n}" for n in range(len(paths))), "round"]


def test_include_of_no_file(strange):
    """Devices, pipes, folders, huge files and what the kernel shows are refused unread, through links too."""
    folder, names = strange
    for name in names:
        begin = time.perf_counter()
        (problem,) = problems(f'include "{name}"\n' + text(), folder=folder)
        assert (problem.line, problem.column) == (1, 9), name
        assert "cannot include" in problem.message
        assert "environ" not in problem.message or "ordinary" in problem.message
        assert time.perf_counter() - begin < 10.0


def test_mesh_of_no_file(strange):
    """The same for meshes: a name with the right ending may lead anywhere."""
    folder, names = strange
    for n, name in enumerate(names):
        (folder / f"m{n}.stl").symlink_to(name)
        begin = time.perf_counter()
        (problem,) = problems(text(shape=f'mesh "m{n}.stl"'), folder=folder)
        assert (problem.line, problem.column) == (2, 14), name
        assert "mesh file" in problem.message
        assert time.perf_counter() - begin < 10.0


def test_scene_file_that_is_no_file(strange):
    """The same for the scene itself."""
    folder, names = strange
    for name in names:
        with pytest.raises(SceneError):
            load_scene(folder / name)


def test_bytes_of_all_includes_are_counted(tmp_path, monkeypatch):
    """A large file that is included often is read only as often as the bytes of a scene allow."""
    monkeypatch.setattr("mdanim_lammps.scene.statements.MOST_BYTES", 10_000)
    (tmp_path / "a.txt").write_text("#" * 4000 + "\n")
    include = 'include "a.txt"\n'
    assert parse_scene(include * 2 + text(), folder=tmp_path).solids
    (problem,) = problems(include * 3 + text(), folder=tmp_path)
    assert problem.line == 3


@pytest.mark.parametrize(("content", "line", "column"), [
    pytest.param(b"", 1, 1, id="empty"), pytest.param(b"  \n", 1, 1, id="blank"),
    pytest.param(b'title "\xff"\n', 1, 8, id="latin"), pytest.param("title \"é\"\n# ".encode() + b"\xe9", 2, 3, id="second line"),
    pytest.param(b"object\0a", 1, 7, id="NUL"), pytest.param(b"a\n\nobject a\0", 3, 9, id="NUL below"),
    pytest.param("title".encode("utf-16"), 1, 1, id="UTF-16"),
])  # fmt: skip
def test_place_in_a_file_that_is_no_text(tmp_path, content, line, column):
    """Name line and column of the first byte that is not text; say so in an include too."""
    path = tmp_path / "bad.txt"
    path.write_bytes(content)
    with pytest.raises(SceneError) as error:
        load_scene(path)
    (problem,) = error.value.problems
    assert (problem.file, problem.line, problem.column) == (str(path), line, column)
    assert str(problem).startswith(f"{path}:{line}:{column}: error: ")


# --- expressions, repeats -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("exponent", "good"), [("0.5", True), ("1/2", True), ("1/3", False), ("0.51", False), ("0.49999", False)]
)
def test_power_of_a_quantity_is_exact(exponent, good):
    """(4 m^2)^0.51 is not a length."""
    scene = text(shape=f"sphere (4 m^2)^({exponent})")
    if good:
        assert parse_scene(scene).solids[0].shape.radius == 2.0
    else:
        (problem,) = problems(scene)
        assert "power" in problem.message or "must be a length" in problem.message
    assert parse_scene(text(mass=f"4^{exponent} kg")).solids


def test_units_have_no_endless_powers():
    """A chain of lets cannot make a unit whose power has a million digits."""
    chain = "let a0 = 1 m\n" + "".join(f"let a{n + 1} = a{n}*a{n}\n" for n in range(40))
    found = problems(chain + text())
    assert "has a power above 100" in found[0].message
    assert len(found) == 1
    assert "power above 100" in problems("let a = (1 m)^(10^9)\n" + text())[0].message


def test_eight_thousand_objects_with_checks_are_quick():
    """8 000 objects with 8 000 expect lines take not much longer than without: names are looked up, not searched."""
    row = "object b[i] { shape sphere 1 cm position (0, 0, i) m mass 1 kg elasticity 1 MPa }"

    def seconds(more: str) -> float:
        begin = time.process_time()
        parse_scene(f"repeat i in 1 .. 8000 {{\n{row}\n{more}\n}}\n" + CONTROL)
        return time.process_time() - begin

    assert seconds("expect b[i].position.z at 1 s = 1 m +- 1 cm") < 3.0 * seconds("")


# --- words that are not there ---------------------------------------------------------------------------------

WORDS = [
    ("two indices", text().replace("ball", "ball[1, 2]"), 1, 14, "has one index, found ','", "ball[100*i + j]"),
    ("restitution", text(restitution="0.5"), 6, 15, "ball is elastic: waves in it take part of a blow", "set damping in it"),
    *((word, f"{word} r {{ }}\n" + text(), 1, 1, f"{word} is a shape of an object", f"write object NAME {{ shape {word} ... }}")
      for word in ("rope", "chain", "sphere")),
    ("ball", text(shape="ball 10 cm"), 2, 9, "shape cannot be followed by 'ball'", "did you mean 'sphere'?"),
    ("cube", text(shape="cube 10 cm"), 2, 9, "shape cannot be followed by 'cube'", "did you mean 'box'?"),
]  # fmt: skip


@pytest.mark.parametrize(("scene", "line", "column", "words", "hint"), [w[1:] for w in WORDS], ids=[w[0] for w in WORDS])
def test_word_that_the_language_lacks(scene, line, column, words, hint):
    """One problem, at the word, with what to write instead."""
    (problem,) = problems(scene)
    assert words in problem.message
    assert hint in problem.hint
    assert (problem.line, problem.column) == (line, column), str(problem)


def test_settings_behind_a_bad_one_are_read():
    """On one line, a bad shape hides neither the settings that follow it nor what is wrong with them."""
    one = "object a { shape ball 10 cm position (0, 0, 0) m mass 1 kg elasticity 1 MPa }\n"
    assert len(problems(one + CONTROL)) == 1
    found = problems(one.replace("1 kg", "1 m") + CONTROL)
    assert [p.column for p in found] == [18, 55]
