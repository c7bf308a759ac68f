# SPDX-License-Identifier: GPL-2.0-only
"""The computing parts of the page under node, where there is one; and the bundle of others' code."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import mdanim_lammps
import pytest
from mdanim_lammps.view.server import packaged_files

HERE, ROOT = Path(__file__).parent, Path(__file__).parents[2]
WEB = Path(mdanim_lammps.__file__).parent / "view" / "web"
OWN = [p for p in sorted(WEB.glob("*.js")) if p.name != "vendor.js"]


@pytest.mark.skipif(shutil.which("node") is None, reason="no node: apt-get install --no-install-recommends nodejs")
@pytest.mark.parametrize("tests", sorted(HERE.glob("*.test.mjs")), ids=lambda path: path.name)
def test_in_node(tests):
    """All of a file's tests pass."""
    done = subprocess.run(["node", "--test", "--test-reporter=tap", str(tests)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout
    assert int(re.search(r"^# pass (\d+)$", done.stdout, re.M)[1]) >= 5


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.name)
def test_modules_are_small_and_our_own(path):
    """Under 300 lines, with a licence; what a module imports is a packaged file."""
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) < 300 and text.startswith("// SPDX-License-Identifier: GPL-2.0-only")
    for name in re.findall(r"from \"([^\"]+)\"", text):
        assert name.startswith("./") and name[1:] in packaged_files(), name


def test_others_code_has_its_licences():
    """LICENSES.txt names the versions and hashes of the lock, with the licence of each."""
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text())["packages"]
    said = (WEB / "LICENSES.txt").read_text(encoding="utf-8")
    for name in ("three", "uplot"):
        package = lock[f"node_modules/{name}"]
        assert f"{name} {package['version']}\n{package['integrity']}\n" in said
    assert said.count("Permission is hereby granted, free of charge") == 2
    assert lock["node_modules/three"]["version"].split(".")[1] in re.findall(r"\"(\d{3})\"", (WEB / "vendor.js").read_text())


def test_the_page_is_small():
    """Size that others' code and ours add to the wheel."""
    assert sum(p.stat().st_size for p in WEB.iterdir()) < 800_000


@pytest.mark.soak
@pytest.mark.skipif(shutil.which("npm") is None, reason="no npm")
def test_the_bundle_can_be_made_again(tmp_path):
    """web/build.sh makes the same bytes; it fetches packages from the registry."""
    shutil.copytree(ROOT / "web", tmp_path / "web", ignore=shutil.ignore_patterns("node_modules"))
    made = tmp_path / "made"
    made.mkdir()
    subprocess.run([tmp_path / "web" / "build.sh", made], check=True, timeout=200)
    for name in ("vendor.js", "vendor.css", "LICENSES.txt"):
        assert (made / name).read_bytes() == (WEB / name).read_bytes(), name
