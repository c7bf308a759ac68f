# SPDX-License-Identifier: GPL-2.0-only
"""Scene files on disk: includes, circles, meshes, and files that are not scenes."""

import os

import pytest
from mdanim_lammps.errors import SceneError
from mdanim_lammps.scene import scene as records
from mdanim_lammps.scene.parse import load_scene, parse_scene

CONTROL = "control { time 1 s }\n"
BALL = "object ball { shape sphere r position (0, 0, 0) m mass 1 kg elasticity 1 MPa }\n"


@pytest.fixture
def write(tmp_path):
    """Write files below a folder; returns the path of the first."""

    def make(**files: str):
        for name, text in files.items():
            path = tmp_path / f"{name.replace('__', '/')}.txt"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return tmp_path / f"{next(iter(files))}.txt"

    return make


def problems(path) -> list:
    """The problems of a bad scene file."""
    with pytest.raises(SceneError) as error:
        load_scene(path)
    return error.value.problems


def test_include_is_relative_to_its_file(write):
    """Read a file beside the one that includes it, in its place."""
    path = write(main='include "parts/a.txt"\n' + CONTROL, parts__a='include "b.txt"\n' + BALL, parts__b="let r = 2 m\n")
    assert load_scene(path).solids[0].shape == records.Sphere(2.0)


def test_include_inside_a_block(write):
    """PlannerOptions may come from another file."""
    path = write(
        main='object a { shape sphere 1 m position (0, 0, 0) m\n include "rubber.txt"\n }\n' + CONTROL,
        rubber="mass 1 kg\nelasticity 3 MPa\n",
    )
    assert load_scene(path).solids[0].elasticity == records.Young(3e6)


def test_problem_in_an_included_file_shows_the_chain(write, tmp_path):
    """Point at the line in the included file, and at the includes that lead there."""
    (problem,) = problems(write(main='\ninclude "a.txt"\n' + BALL + CONTROL, a='include "b.txt"\n', b="\nlet r = 2 mn\n"))
    assert problem.file == str(tmp_path / "b.txt")
    assert (problem.line, problem.column) == (2, 11)
    assert str(problem).endswith(f"included from {tmp_path}/a.txt:1:1\n        included from {tmp_path}/main.txt:2:1")


def test_problems_are_in_the_order_of_the_text(write):
    """Problems of an included file come where it is included."""
    found = problems(write(main='let a = 1 mn\ninclude "a.txt"\nlet b = 1 mn\n' + BALL + CONTROL, a="\n\n\nlet r = 2 mn\n"))
    assert [problem.line for problem in found] == [1, 4, 3]


def test_circle_of_includes_is_shown(write):
    """Refuse a file that includes itself through others, and show the round."""
    path = write(main='include "a.txt"\n' + CONTROL, a='include "b.txt"\n', b='include "a.txt"\n' + BALL)
    assert "goes round in a circle: a.txt -> b.txt -> a.txt" in problems(path)[0].message
    alone = problems(write(own='include "own.txt"\n'))[0]
    assert "goes round in a circle: own.txt -> own.txt" in alone.message


def test_sixteen_levels_of_includes(write):
    """Read sixteen levels, refuse seventeen."""
    files = {f"f{n}": f'include "f{n + 1}.txt"\n' for n in range(16)} | {"f16": "let r = 1\n" + BALL + CONTROL}
    assert len(load_scene(write(**files)).solids) == 1
    files = {f"f{n}": f'include "f{n + 1}.txt"\n' for n in range(17)} | {"f17": "let r = 1\n" + BALL + CONTROL}
    assert "more than 16 levels deep: f0.txt -> f1.txt" in problems(write(**files))[0].message


def test_flood_of_includes_is_stopped(write):
    """Files that include each other twice would be read 2^16 times."""
    path = write(**{f"f{n}": f'include "f{n + 1}.txt"\n' * 2 for n in range(16)}, f16="# end\n")
    assert "more than 1000 files are included" in problems(path)[0].message


@pytest.mark.parametrize(("content", "words"), [
    (b"", "is empty"), (b" \n\t\n", "is empty"), (b"object\0a", "is a binary file"),
    (b"title \"\xff\"\n", "is not UTF-8 text (byte 0xff in line 1)"),
    ("title".encode("utf-16"), "is UTF-16 text; save it as UTF-8"),
    (b"\x89PNG\r\n\x1a\n\0\0", "is a binary file"),
])  # fmt: skip
def test_file_that_is_no_scene(tmp_path, content, words):
    """Say what is wrong with a file that cannot be read as text."""
    path = tmp_path / "bad.txt"
    path.write_bytes(content)
    assert words in problems(path)[0].message
    assert "bad.txt" in problems(path)[0].message


@pytest.mark.parametrize(
    "text",
    ["-----BEGIN PRIVATE KEY-----\nhunter2\n", "# mine\npassword = hunter2\n", "machine a.b login c password hunter2\n",
     '{"token": "hunter2"}\n', "root:hunter2:0:0\n"],
)  # fmt: skip
@pytest.mark.parametrize("within", ["{}", "object a {{ {}\n }}"], ids=["outside", "in a block"])
def test_what_is_no_scene_is_not_quoted(write, text, within):
    """No message shows a word of a file that a scene names and that is none: it may be private, and who asks another."""
    path = write(main=within.format('include "secret.txt"') + "\n" + BALL + CONTROL, secret=text)
    said = "\n".join(map(str, problems(path)))
    assert "secret.txt is not a part of a scene" in said and "hunter2" not in said and "BEGIN" not in said


def test_missing_file_and_folder(tmp_path):
    """Name a path that is not there, or is not a file."""
    assert "gone.txt is not there" in problems(tmp_path / "gone.txt")[0].message
    assert "is a folder" in problems(tmp_path)[0].message
    assert "is not an ordinary file" in problems(os.devnull)[0].message


def test_missing_include(write):
    """Point at the name of the file that is not there, and at nothing that follows from it."""
    (problem,) = problems(write(main=CONTROL + 'include "gone.txt"\n' + BALL + "expect b.position.z = 1 m\n"))
    assert (problem.line, problem.column) == (2, 9)
    assert "is not there" in problem.message


def test_mesh_is_found_beside_its_scene(write, tmp_path):
    """Store the absolute path of a mesh; the scale is metres per unit."""
    path = write(
        main='include "parts/a.txt"\nlet r = 1\n' + CONTROL,
        parts__a='object m { shape mesh "duck.STL" scale 1/1000\nposition (0, 0, 0) m mass 1 kg elasticity 1 MPa }\n',
    )
    (tmp_path / "parts" / "duck.STL").write_bytes(b"solid")
    assert load_scene(path).solids[0].shape == records.Mesh((tmp_path / "parts" / "duck.STL").resolve(), 0.001)


def test_text_finds_its_files_in_a_folder(write, tmp_path):
    """A scene from a text reads its includes from a folder that is told."""
    write(size="let r = 3 m\n")
    assert parse_scene('include "size.txt"\n' + BALL + CONTROL, folder=tmp_path).solids[0].shape == records.Sphere(3.0)
    with pytest.raises(SceneError, match="is not there"):
        parse_scene('include "size.txt"\n' + BALL + CONTROL, folder=tmp_path / "other")


def test_messages_of_a_scene_full_of_mistakes(scenes_bad):
    """Print every problem of a scene as a user sees it."""
    with pytest.raises(SceneError) as error:
        parse_scene((scenes_bad / "many.txt").read_text(encoding="utf-8"), "many.txt")
    assert str(error.value) + "\n" == (scenes_bad / "many.expected").read_text(encoding="utf-8")


@pytest.fixture
def scenes_bad(request):
    """The folder of scenes full of mistakes."""
    return request.path.parent / "scenes_bad"
