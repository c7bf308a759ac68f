# SPDX-License-Identifier: GPL-2.0-only
"""The docs as a site: ``make docs`` without the notebooks, which a test of their own runs; and their spelling."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

from mdanim_lammps import Scene
from paths import REPOSITORY
from spellchecker import SpellChecker

DOCS = REPOSITORY / "docs"
PAGES = [
    *(DOCS / f"{name}.md" for name in ("index", "api", "gallery", "input-scripts")),
    DOCS / "notebooks" / "first-scene.ipynb",
]
DOWNLOAD = r'<a href="_static/([^"]+)" download'


def test_the_site_is_built_without_a_warning(tmp_path):
    """Links to pages and headings, the order of pages, docstrings: of all pages. One of each kind is written as HTML."""
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-D", "nb_execution_mode=off"]
    movies = sorted((DOCS / "movies").glob("*.mp4"))
    for builder, pages, words in (("dummy", [], ""), ("html", PAGES, "index will be incomplete")):
        places = ["-d", tmp_path / "doctrees", DOCS, tmp_path / builder]
        done = subprocess.run([*command, "-b", builder, *places, *pages], capture_output=True, text=True)
        assert [line for line in (done.stdout + done.stderr).splitlines() if line and not (words and words in line)] == []
    page = (tmp_path / "html" / "api.html").read_text()
    assert "center_of_mass" in page and "sweep" in page
    assert (tmp_path / "html" / "notebooks" / "first-scene.html").exists()
    shown = re.findall(r'<video src="_static/([^"]+)"', (tmp_path / "html" / "gallery.html").read_text())
    assert sorted(shown) == [movie.name for movie in movies] and len(shown) > 3
    assert all((tmp_path / "html" / "_static" / name).exists() for name in shown)
    check_gallery(tmp_path / "html", tmp_path / "saved")
    scripts = re.findall(DOWNLOAD, (tmp_path / "html" / "input-scripts.html").read_text())
    assert {path.name for path in (REPOSITORY / "scenes" / "lammps").iterdir()} == {
        name.removeprefix("lammps/") for name in scripts
    }
    assert all((tmp_path / "html" / "_static" / name).exists() for name in scripts)
    assert max(movie.stat().st_size for movie in movies) < 200_000


def check_gallery(site: Path, place: Path) -> None:
    """Every scene of the gallery is read in a folder that has nothing but the files linked in its cell of the table."""
    cells = re.findall(r"<td.*?</td>", (site / "gallery.html").read_text(), flags=re.S)
    linked = [names for cell in cells if (names := re.findall(DOWNLOAD, cell))]
    assert len(linked) > 20 and sum(len(names) > 1 for names in linked) >= 6
    for scene, *others in linked:
        for name in (scene, *others):
            file = place / scene.removesuffix(".txt") / name
            file.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(site / "_static" / name, file)
        assert Scene.load(place / scene.removesuffix(".txt") / scene).record.solids, scene


def words_of(page: Path) -> set[str]:
    """Words of a page as they are read, without code, formulas, addresses and names of files."""
    text = re.sub(r"^```.*?^```|<!--.*?-->", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    text = re.sub(r"``.*?``|`[^`]*`|\$[^$]*\$|\]\([^)]*\)|<[^>]+>|https?://\S+", " ", text)
    words = re.findall(r"(?<![\w./\\-])[A-Za-z][a-z]+(?:['’][a-z]+)?(?![\w/\\])", text)
    return {word.lower().replace("’", "'").removesuffix("'s") for word in words}


def test_words_are_spelled_right():
    """Each is in an English dictionary, or in docs/words.txt, which holds no word that no page needs."""
    dictionary = SpellChecker()
    found = {page: dictionary.unknown(words_of(page)) for page in (*REPOSITORY.glob("*.md"), *DOCS.rglob("*.md"))}
    own = (DOCS / "words.txt").read_text(encoding="utf-8").split()
    assert own == sorted(set(own))
    assert {str(page.relative_to(REPOSITORY)): wrong for page, words in found.items() if (wrong := words - {*own})} == {}
    assert {*own} - set().union(*found.values()) == set()
    assert dictionary.unknown(["colur", "reciept", "gravity"]) == {"colur", "reciept"}
