# SPDX-License-Identifier: GPL-2.0-only
"""Forms that are not English, in code, messages and docs: ``python tests/english.py`` prints each with a better one, and fails.

`make lint` runs it. A form gets here when it has been found often; spelling is the matter of tests/test_docs_site.py.
"""

import re
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
SUFFIXES = {".py", ".h", ".cpp", ".md", ".js", ".txt", ".toml", ".cmake"}
OTHERS = ("web/", "docs/words.txt", "tests/english.py", "tests/lab/meshes/", "python/mdanim_lammps/view/web/vendor.js")
"""Files that hold no sentences of ours begin so."""
BE = r"(?:is|are|was|were|be|been|being)"
PREDICATE = (
    r"(?<![Tt]here )(?<![Tt]here may )(?<![Tt]here can )(?<![Tt]here must )(?<![Tt]here will )(?<![Tt]here had )"
    rf"\b{BE} no (?!longer|more|less|fewer|better|worse|slower|faster|deeper|farther|smaller|larger|problem|use\b|matter\b)"
)
FORMS = {
    PREDICATE: "is not a ..., has no ..., or there is no ...",
    r"\b[Ww]hoever\b": "name who it is: the caller, a user, a rank",
    r"\bthat of which\b": "name the thing again",
    r"\bwhat is no\b": "what is not a ...",
    r"(?:^|[,;:] |\. )[Ff]or it is\b": "because it is",
    r"\bis no good\b": "is inaccurate, slow, wrong: which of them?",
}
"""Regular expression of a form, and what to write."""
FORMS_OF_PAGES = {
    rf"\b{BE} (?:not )?told\b(?! from| apart)": "reported, printed, given, computed",
    r"\b[Ww]hy so\b": "the reasons",
    r"\bgone on with\b": "continued",
    r"\b[Nn]ot drawn are\b": "the subject first: ... are not drawn",
}
"""Forms that only pages are searched for: README.md and docs/, which were read again."""
BEGINNINGS = re.compile(r'(?:^\s*(?:#|//+|\*)|""")\s*(?:What|Of|So many|Whoever|That|Those)\s')
"""Comments and docstrings begin with the thing or with a verb. Checked file by file as they are read again."""
READ_AGAIN = ("plugin/", "python/", "tests/", "bench/")
"""Folders and files whose comments all begin so."""


def ours() -> list[Path]:
    """The files of the repository that hold sentences of ours."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=REPOSITORY, capture_output=True, text=True, check=True).stdout.split(
        "\0"
    )
    return [REPOSITORY / name for name in listed if Path(name).suffix in SUFFIXES and not name.startswith(OTHERS)]


def found(path: Path) -> list[str]:
    """Lines of a file with a form that is not English, each with its place and the cure."""
    name = path.relative_to(REPOSITORY).as_posix()
    forms = FORMS | (FORMS_OF_PAGES if name == "README.md" or re.match(r"docs/(?!decisions/).*\.md$", name) else {})
    lines = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        for form, better in forms.items():
            if match := re.search(form, line):
                lines.append(f"{name}:{number}: '{match[0].strip()}': write {better}")
        if name.startswith(READ_AGAIN) and BEGINNINGS.search(line):
            lines.append(f"{name}:{number}: a comment begins with the thing or with a verb: {line.strip()[:60]}")
    return lines


def main() -> int:
    lines = [line for path in ours() for line in found(path)]
    print("\n".join(lines) or "English: no form of the list")
    return bool(lines)


if __name__ == "__main__":
    sys.exit(main())
