# SPDX-License-Identifier: GPL-2.0-only
"""Commands of bench/ that tests would not notice to be broken."""

import subprocess
import sys

from paths import REPOSITORY


def test_the_start_of_a_run_can_be_measured():
    """What bench/around.py runs in a process of its own goes through."""
    code = "import around; print(around.start_up('float', None))"
    done = subprocess.run([sys.executable, "-c", code], cwd=REPOSITORY / "bench", check=True, capture_output=True, text=True)
    assert float(done.stdout) > 0.0
