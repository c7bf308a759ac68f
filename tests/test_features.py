# SPDX-License-Identifier: GPL-2.0-only
"""Features are folders: no module outside of features/ names one, and only rooms that draw know the liquid."""

import ast
import re
from importlib import import_module
from pathlib import Path

import mdanim_lammps
import pytest
from mdanim_lammps import features

ROOT = Path(mdanim_lammps.__file__).parent
DRAWN = ("picture", "view", "export")
"""Rooms that may draw what there is."""
FIELDS = {name for words in features.facets("words") if hasattr(words, "SCENE") for name in words.SCENE.__annotations__}
"""Fields of a scene that are of one feature."""
SETTINGS = {
    name
    for words in features.facets("words")
    for kind in ("SCENE", "OBJECT", "CONTROL", "RENDER")
    if hasattr(words, kind)
    for name in getattr(words, kind).__annotations__
}
"""Settings that features own."""
RECORDS = {"scene", "solid", "s", "control", "render"}
"""Names of what has settings."""
LIQUID = re.compile(r"liquid|pool")
ELEMENTS = {"springs"}
"""Names of effects that are also what bodies are made of (model/): as the key of a count they name no effect."""


def outside() -> dict[str, ast.Module]:
    """Modules that may know no feature, by their paths."""
    paths = (p for p in sorted(ROOT.rglob("*.py")) if p.relative_to(ROOT).parts[0] not in ("features", *DRAWN))
    return {p.relative_to(ROOT).as_posix(): ast.parse(p.read_text(encoding="utf-8")) for p in paths}


def strings(tree: ast.AST) -> set[str]:
    """Texts that are not docstrings."""
    bodies = (n.body for n in ast.walk(tree) if isinstance(n, ast.Module | ast.ClassDef | ast.FunctionDef))
    docs = {id(s.value) for body in bodies for s in body if isinstance(s, ast.Expr)}
    return {n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str) and id(n) not in docs}


def counts(tree: ast.AST) -> set[str]:
    """Keys of what is written of a scene that are names of elements."""
    keys = [k for n in ast.walk(tree) if isinstance(n, ast.Dict) for k in n.keys]
    return {k.value for k in keys if isinstance(k, ast.Constant)} & ELEMENTS


def names_a_feature(tree: ast.AST) -> bool:
    """By the name of an effect, by a field of the scene, or by its folder."""
    nodes = list(ast.walk(tree))
    folders = set(features.names())
    imports = {part for n in nodes if isinstance(n, ast.ImportFrom) for part in (n.module or "").split(".")[1:]}
    fields = {n.attr for n in nodes if isinstance(n, ast.Attribute)} & FIELDS
    of_features = any(
        "features" in (n.module or "") and n.module.split("features")[1] for n in nodes if isinstance(n, ast.ImportFrom)
    )
    named = strings(tree) & {e.name for e in features.effects()} - counts(tree)
    return bool(named or fields or (of_features and imports & folders))


def reads_a_setting(tree: ast.AST) -> bool:
    """Whether a module reads a setting that a feature has added to scenes, objects, control or pictures: ``solid.drag``."""
    found = ((n.attr, n.value) for n in ast.walk(tree) if isinstance(n, ast.Attribute))
    return any(name in SETTINGS and getattr(of, "attr", getattr(of, "id", "")) in RECORDS for name, of in found)


def knows_the_liquid(tree: ast.AST) -> bool:
    """By anything that is called after it."""
    names = (getattr(n, kind, None) for n in ast.walk(tree) for kind in ("id", "attr", "arg", "name"))
    return "liquid" in strings(tree) or any(LIQUID.search(name.lower()) for name in names if isinstance(name, str))


@pytest.mark.parametrize("sees", [names_a_feature, reads_a_setting, knows_the_liquid])
def test_modules_outside_know_no_feature(sees):
    """A new feature touches no file outside of its folder, but pictures of it."""
    assert {"gravity", "ground", "walls", "liquid", "contacts"} <= FIELDS
    assert {"damping", "drag", "contact_model", "contact_stiffness", "friction"} <= SETTINGS
    assert reads_a_setting(ast.parse("d = solid.drag")) and reads_a_setting(ast.parse("self.scene.control.contact_model"))
    assert not [path for path, tree in outside().items() if sees(tree)], (
        "a feature owns what it is about: see features/__init__.py"
    )


def test_every_feature_says_what_it_is():
    """Its folder has effects or words, and a sentence."""
    assert {"gravity", "contact", "liquid"} <= set(features.names())
    for name in features.names():
        assert import_module(f"mdanim_lammps.features.{name}").__doc__
    for effect in (form for e in features.effects() for form in e.forms):
        assert "docs/physics-" in type(effect).__doc__ or "eq. (" in type(effect).__doc__, (
            f"the docstring of {type(effect).__name__} gives its law, unit, and eq. (N) or docs/physics-..."
        )
    assert len({e.name for e in features.effects()}) == len(features.effects()) >= 11
