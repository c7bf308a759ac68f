# SPDX-License-Identifier: GPL-2.0-only
"""The docs as a site: ``make docs`` without the notebooks, which a test of their own runs."""

import subprocess
import sys

from paths import REPOSITORY

DOCS = REPOSITORY / "docs"
PAGES = [DOCS / "index.md", DOCS / "api.md", DOCS / "gallery.md", DOCS / "notebooks" / "first-scene.ipynb"]


def test_the_site_is_built_without_a_warning(tmp_path):
    """Links to pages and headings, the order of pages, docstrings: of all pages. One of each kind is written as HTML."""
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-D", "nb_execution_mode=off"]
    for builder, pages, words in (("dummy", [], ""), ("html", PAGES, "index will be incomplete")):
        places = ["-d", tmp_path / "doctrees", DOCS, tmp_path / builder]
        done = subprocess.run([*command, "-b", builder, *places, *pages], capture_output=True, text=True)
        assert [line for line in (done.stdout + done.stderr).splitlines() if line and not (words and words in line)] == []
    page = (tmp_path / "html" / "api.html").read_text()
    assert "center_of_mass" in page and "sweep" in page
    assert (tmp_path / "html" / "notebooks" / "first-scene.html").exists()
