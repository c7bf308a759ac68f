# SPDX-License-Identifier: GPL-2.0-only
"""One-way flow: a module imports only from rooms above its own; files are short, and a class has a name of its own."""

import ast
import re
from collections import Counter
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import mdanim_lammps
import pytest

ROOT = Path(mdanim_lammps.__file__).parent
SCRIPTS = sorted(p for folder in ("bench", "docs") for p in (Path(__file__).parents[1] / folder).rglob("*.py"))
ROOMS = [
    "records",
    "errors",
    "deprecated",
    "safe_start",
    "children",
    "processes",
    "interrupts",
    "terminal",
    "registry",
    "language",
    "words",
    "scene",
    "bodies",
    "model",
    "reach",
    "effects",
    "features",
    "certificate",
    "engine",
    "results",
    "picture",
    "drawings",
    "export",
    "run",
    "parallel",
    "cost",
    "study",
    "report",
    "view",
    "api",
    "cli",
    "__main__",
]


LANGUAGE = {
    "curve",
    "formatting",
    "forms",
    "holding",
    "in_time",
    "limits",
    "naming",
    "rollers",
    "rotation",
    "schema",
    "shapes",
    "units",
}
"""Modules of scene/ that know no word of a scene: words of features are written with them."""


def room_of(*parts: str) -> str:
    """The room of a module, given by its names below the package."""
    if parts[0] == "scene" and len(parts) > 1 and parts[1] in LANGUAGE:
        return "language"
    if parts[0] == "features":  # what finds them, their words, and all the rest
        facet = parts[2] if len(parts) > 2 else ""
        return {"": "registry", "words": "words", "record": "words", "picture": "drawings"}.get(facet, "features")
    return parts[0]


def room(path: Path) -> str:
    """The room a file belongs to."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return room_of(*(part for part in parts if part != "__init__"))


def imported_rooms(path: Path) -> set[str]:
    """Rooms that a file imports from, relative and absolute imports alike."""
    found = set()
    package = ("mdanim_lammps", *path.relative_to(ROOT).parts[:-1])
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = []
        if isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            target = (*base, *(node.module or "").split("."))
            names = [
                ".".join(filter(None, (*target, *([a.name] if len(target) == 1 or not node.module else [])))) for a in node.names
            ]
        elif isinstance(node, ast.Import):
            names = [a.name for a in node.names]
        for name in names:
            parts = name.split(".")
            if parts[0] == "mdanim_lammps" and len(parts) > 1:
                found.add(room_of(*parts[1:]))
    return found - {"__version__"}


FRONT_DOOR = ROOT / "__init__.py"  # names every room, lazily


def test_imports_point_up_the_list():
    """Each module may use only its own room and the rooms listed before it."""
    found = {}
    for path in sorted({*ROOT.rglob("*.py")} - {FRONT_DOOR}):
        own = room(path)
        assert own in ROOMS, f"{own} is not in the list of rooms (docs/architecture.md)"
        found[str(path.relative_to(ROOT))] = imported_rooms(path) - {*ROOMS[: ROOMS.index(own) + 1]}
    assert found and {path: later for path, later in found.items() if later} == {}


PLAN = ROOT / "parallel" / "plan"


@pytest.mark.parametrize("path", sorted(PLAN.glob("*.py")), ids=lambda p: p.name)
def test_the_planner_knows_no_messages(path):
    """The pure part of the distribution uses neither MPI nor the part that runs processes."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom):
            names = [f"{node.module or ''}.{a.name}" for a in node.names]
        assert not [n for n in names if {"mpi4py", "runtime"} & set(n.split("."))], f"line {node.lineno}"


def test_the_check_sees_imports():
    """Find the rooms that a file with every kind of import uses."""
    assert {"errors", "scene", "model"} <= imported_rooms(ROOT / "run" / "prepare.py")


def test_scripts_import_what_there_is():
    """Whatever prints the figures of the docs finds in the package what it looks for, also where it looks late."""
    for path in SCRIPTS:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "mdanim_lammps":
                module = import_module(node.module)
                for name in node.names:
                    found = hasattr(module, name.name) or (
                        hasattr(module, "__path__") and find_spec(f"{node.module}.{name.name}")
                    )
                    assert found, f"{path}:{node.lineno}: {name.name}"


def test_there_are_scripts():
    """Benchmarks and the makers of pictures."""
    assert {p.name for p in SCRIPTS} >= {"accuracy.py", "scaling.py", "make.py"}


PLUGIN = Path(__file__).parents[1] / "plugin"
FOLDERS = [
    *("numbers", "simd", "threads", "geometry", "records"),  # plain floors
    # effects; passes know those before them
    *("springs", "leapfrog", "gravity", "buoyancy", "barrier", "contact", "passes", "wall", "rigid", "joints", "drives"),
    *("forces", "hands", "air", "inflate", "tearing", "folds"),
    *("liquid", "liquid/automaton", "liquid/waves"),
    *("lammps", "c_api"),
]
WITH_LAMMPS = ("lammps", "c_api")
CPP_FILES = sorted(p for p in PLUGIN.rglob("*.[hc]*") if p.suffix in (".h", ".cpp"))


def test_plugin_includes_point_up_the_list():
    """A file of the plugin includes its own folder and those before it; LAMMPS and MPI are for the last two folders."""
    wrong = []
    for path in CPP_FILES:
        own = str(path.parent.relative_to(PLUGIN))
        allowed = FOLDERS[: FOLDERS.index(own) + 1]
        for quote, name in re.findall(r'^#include (["<])([^">]+)', path.read_text(encoding="utf-8"), re.MULTILINE):
            folder, slash, _ = name.rpartition("/")
            if quote == '"' and slash and folder in FOLDERS:
                fits = folder in allowed
            else:
                fits = own in WITH_LAMMPS or (quote == "<" and name not in ("mpi.h", "lammps.h"))
            if not fits:
                wrong.append(f"{path}: {name}")
    assert CPP_FILES and not wrong


def test_the_plugin_has_its_folders():
    """None is missing from the list, and each has files."""
    assert {str(p.parent.relative_to(PLUGIN)) for p in CPP_FILES if p.suffix == ".h"} == set(FOLDERS)


SHIPPED_C = [p for p in sorted(PLUGIN.glob("c_api/*.cpp")) if p.name != "planted_c.cpp"]  # that one fails on purpose


@pytest.mark.parametrize("path", SHIPPED_C, ids=lambda p: p.name)
def test_no_exception_leaves_a_c_function(path):
    """Each that Python calls does its work inside of guarded(), or is declared noexcept: ctypes cannot pass an exception on."""
    functions = re.findall(r"^MDANIM_EXPORT ([^{;]*)\{\s*(.*)", path.read_text(encoding="utf-8"), re.MULTILINE)
    assert functions
    for head, body in functions:
        assert "noexcept" in head or re.match(r"return (mdanim::)?guarded\(", body), head


OWN = [p for folder in (ROOT, PLUGIN, *(PLUGIN.parent / n for n in ("tests", "bench", "docs"))) for p in folder.rglob("*")]
SOURCES = sorted(p for p in OWN if p.suffix in {".py", ".h", ".cpp", ".js", ".mjs"} and p.name != "vendor.js")


def test_no_file_is_too_long_to_be_read():
    """A newcomer reads each file top to bottom: none has more than 500 lines."""
    assert {"validate.py", "fix_mdanim_liquid.cpp", "main.js", "test_parse.py"} <= {p.name for p in SOURCES}
    lines = {str(p): len(p.read_text(encoding="utf-8").splitlines()) for p in SOURCES}
    assert not {p: n for p, n in lines.items() if n > 500}


CPP_CLASS = (
    r"^ *(?:template <.*> )?(?:class|struct|union|enum(?: class)?) (?:alignas\((?:[^()]|\([^()]*\))*\) )?"
    r"(\w+)\b(?!::|<)[^;(){]*\{"  # neither a member that is defined outside nor a specialization
)


MOST_MEMBERS, MOST_LINES = 30, 400


def test_no_class_is_too_large():
    """Each has few members in its own body, and few lines."""
    found = {}
    for path in ROOT.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                members = sum(isinstance(n, ast.FunctionDef | ast.Assign | ast.AnnAssign) for n in node.body)
                found[node.name] = members > MOST_MEMBERS or node.end_lineno - node.lineno > MOST_LINES - 1
    assert found and not [name for name, large in found.items() if large]


@pytest.mark.parametrize(
    ("folder", "pattern", "known"),
    [
        pytest.param(ROOT, r"^class (\w+)", {"Scene", "SceneRecord"}, id="Python"),
        pytest.param(PLUGIN, CPP_CLASS, {"Automaton", "Stateful", "DistinctRows", "PaddedVec3", "PointKind"}, id="C++"),
    ],
)
def test_no_two_classes_have_one_name(folder, pattern, known):
    """A name of a class means one thing in the whole package, and one in the whole plugin."""
    sources = (p for p in SOURCES if folder in p.parents)
    names = Counter(name for p in sources for name in re.findall(pattern, p.read_text(encoding="utf-8"), re.MULTILINE))
    assert known <= names.keys()
    assert not [name for name, times in names.items() if times > 1]
