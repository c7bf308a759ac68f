# SPDX-License-Identifier: GPL-2.0-only
"""The programs that the thread sanitizer runs keep up with what they include: `make sanitize` is run seldom."""

import subprocess
import sys

import pytest
from paths import REPOSITORY

sys.path.insert(0, str(REPOSITORY / "tests"))
import sanitize


@pytest.mark.parametrize("name", sanitize.THREADS)
def test_programs_of_threads_compile(name):
    """Each of them, as the sanitizer has it."""
    source = REPOSITORY / "tests" / "lab" / f"{name}.cpp"
    command = [sanitize.compiler(), "-std=c++17", "-fsyntax-only", *sanitize.SET, f"-I{REPOSITORY / 'plugin'}", source]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
