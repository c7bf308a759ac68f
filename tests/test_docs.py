# SPDX-License-Identifier: GPL-2.0-only
"""The pages of the docs: links lead somewhere, every page is found from the index."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
LINK = re.compile(r"(?<!`)\[[^\]`]*(?:`[^`]*`[^\]`]*)*\]\(([^)\s]+)\)")


def text_of(page: Path) -> str:
    """A page without its code blocks."""
    return re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)


def links(page: Path) -> list[str]:
    """Addresses of a page that lead to files of the repository."""
    return [address for address in LINK.findall(text_of(page)) if "://" not in address]


def anchors(page: Path) -> set[str]:
    """Anchors of a page's headings, as GitHub makes them."""
    heads = re.findall(r"^#+ +(.*)$", text_of(page), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", head.replace("`", "").lower()).replace(" ", "-") for head in heads}


def test_links_lead_somewhere():
    """Every link of a page names a file of the repository, and a heading that is there."""
    for page in PAGES:
        for address in links(page):
            name, _, anchor = address.partition("#")
            target = (page.parent / name).resolve() if name else page
            assert target.is_relative_to(ROOT) and target.exists(), f"{page}: {address}"
            assert not anchor or anchor in anchors(target), f"{page}: {address}: headings are {sorted(anchors(target))}"


def test_promises_have_their_tests():
    """Every test that docs/security.md names is there."""
    named = 0
    for line in (ROOT / "docs" / "security.md").read_text(encoding="utf-8").splitlines():
        file = None
        for name, test in re.findall(r"`([\w/]*test_\w+\.py)?::(test_\w+)", line):
            file, named = name or file, named + 1
            assert re.search(rf"^def {test}\(", (ROOT / "tests" / file).read_text(encoding="utf-8"), flags=re.M), (
                f"{file}::{test}"
            )
    assert named > 30


def test_contributing_names_files_that_are_there():
    """Every file and folder that CONTRIBUTING.md names is where it says; names without a folder lie in the package."""
    text = re.sub(r"^```.*?^```", "", (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"), flags=re.S | re.M)
    package = ROOT / "python" / "mdanim_lammps"
    named = set(re.findall(r"`([\w*./]+(?:/|\.py|\.h|\.md|\.cpp|\.txt))`", text))
    assert len(named) > 40
    assert not [
        name for name in named if "NAME" not in name and not any(any(folder.glob(name.rstrip("/"))) for folder in (ROOT, package))
    ]


def test_architecture_names_modules_that_are_there():
    """Every module and folder that the table of rooms names lies in its room."""
    table = re.findall(r"^\| ((?:`[\w./]+` )+)(?:\(C\+\+\) )?\| (.*) \|$", text_of(ROOT / "docs" / "architecture.md"), flags=re.M)
    bases = [ROOT, ROOT / "python" / "mdanim_lammps", ROOT / "plugin"]
    named = 0
    for rooms, about in table:
        rooms = re.findall(r"`([^`]+)`", rooms)
        assert all(any((base / room).exists() for base in bases) for room in rooms), rooms
        homes = [*bases, *(base / room for base in bases for room in rooms if room.endswith("/"))]
        for name in re.findall(r"`([\w./]+(?:/|\.py|\.js|\.txt))`", about):
            named += 1
            assert any((home / name).exists() for home in homes), f"{rooms}: {name}"
    assert len(table) > 15 and named > 50


def test_every_page_is_found():
    """Every page of the docs can be reached from docs/index.md by links."""
    index = ROOT / "docs" / "index.md"
    found, waiting = {index}, [index]
    while waiting:
        page = waiting.pop()
        for address in links(page):
            target = (page.parent / address.partition("#")[0]).resolve()
            if target.suffix == ".md" and target not in found:
                found.add(target)
                waiting.append(target)
    assert {p for p in PAGES if p.is_relative_to(ROOT / "docs")} <= found


def test_the_check_sees_links_and_anchors():
    """Find links beside code, and anchors of headings with signs."""
    assert "quickstart.md" in links(ROOT / "docs" / "index.md")
    assert "on-several-executors" in anchors(ROOT / "docs" / "command-line.md")


@pytest.mark.parametrize("room", ["engine", "run", "parallel", "parallel/plan", "parallel/runtime", "cost", "view"])
def test_architecture_names_every_module(room):
    """The table of rooms names all modules of the rooms whose modules it names one by one."""
    table = text_of(ROOT / "docs" / "architecture.md")
    modules = [m for m in (ROOT / "python" / "mdanim_lammps" / room).glob("*.py") if not m.name.startswith("__")]
    assert modules
    assert not [m.name for m in modules if f"`{m.name}`" not in table and f"`{room}/{m.name}`" not in table]
