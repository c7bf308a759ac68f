# SPDX-License-Identifier: GPL-2.0-only
"""The docs as a site: ``make docs`` (Sphinx, MyST, furo). The pages are plain Markdown; their order is in toc.yml."""

import re
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "python"))

project = "mdanim-lammps"
author = "the authors of mdanim-lammps"
release = re.search(r'__version__ = "(.*)"', (HERE.parent / "python/mdanim_lammps/__init__.py").read_text())[1]
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_external_toc"]
external_toc_path = "toc.yml"
exclude_patterns = ["images/*.py", "_build", "*.out"]
html_theme = "furo"
html_title = f"{project} {release}"
html_logo = None
html_static_path = ["movies", "../scenes"]
html_theme_options = {"source_repository": "", "top_of_page_buttons": []}
templates_path = []

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 180

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True, "show-inheritance": False}

# Colours of code that Pygments does not know: scenes, and input scripts of LAMMPS.
highlight_language = "text"

REPOSITORY = HERE.parent


SCENES = REPOSITORY / "scenes"


def download(docname, path, shown):
    """A link of a page to a file of scenes/, which the site holds in _static."""
    return f'<a href="{"../" * docname.count("/")}_static/{path}" download><code>{shown}</code></a>'


def files_of(path):
    """Files that a scene reads, as paths from scenes/: what its text and its included files name."""
    named = re.findall(r'^[^#\n]*?\b(?:mesh|include)\s+"([^"]+)"', (SCENES / path).read_text(encoding="utf-8"), flags=re.M)
    return list(dict.fromkeys(f for name in named for f in (name, *(files_of(name) if name.endswith(".txt") else ()))))


def lead_outside(app, docname, source):
    """Links to scenes become downloads; those to other files of the repository become names: the site does not hold them."""
    pattern = re.compile(r"(?<![!`])\[([^\]`]*(?:`[^`]*`[^\]`]*)*)\]\((\.\./[^)\s]+)\)")
    page = HERE / f"{docname}.md"

    def replace(match):
        target = (page.parent / match[2].partition("#")[0]).resolve()
        if target.is_relative_to(SCENES) and target.is_file():
            return download(docname, target.relative_to(SCENES), match[1].strip("`"))
        return match[0] if target.is_relative_to(HERE) else f"{match[1]} (`{target.relative_to(REPOSITORY)}`)"

    source[0] = pattern.sub(replace, source[0])


def show_movies(app, docname, source):
    """A picture of which there is a movie becomes the movie on the site; names of scenes in the gallery lead to them
    and to the files that they read."""

    def replace(match):
        if not (HERE / "movies" / f"{match[1]}.mp4").exists():
            return match[0]
        place = "../" * docname.count("/") + f"_static/{match[1]}.mp4"
        return f'<video src="{place}" width="100%" controls loop muted playsinline preload="metadata"></video>'

    source[0] = re.sub(r"!\[[^\]]*\]\(images/([\w-]+)\.png\)", replace, source[0])
    if docname == "gallery":
        source[0] = re.sub(r"`(\w+\.txt)`", lead_to_scenes, source[0])


def lead_to_scenes(match):
    """A scene of the gallery with the files that it reads."""
    links = [download("gallery", path, path) for path in (match[1], *files_of(match[1]))]
    return links[0] + (f" (with {', '.join(links[1:])})" if links[1:] else "")


def setup(app):
    app.connect("source-read", lead_outside)
    app.connect("source-read", show_movies)
