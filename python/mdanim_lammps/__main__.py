# SPDX-License-Identifier: GPL-2.0-only
"""The program from its first instruction: ``mdanim-lammps`` and ``python -m mdanim_lammps``."""

import os
import sys

from .safe_start import few_collections, is_safe

# A module that lies beside a scene is not a part of this program.
if __name__ == "__main__" and not is_safe():
    del sys.path[0]  # the current folder, which -m puts there
named = os.environ.get("PYTHONPATH", "")
if named and "" in named.split(os.pathsep) and os.getcwd() in sys.path:
    sys.path.remove(os.getcwd())  # an empty part, as of "$UNSET:/opt/lib", is the current folder

from .interrupts import end_at_once, on_signals  # noqa: E402 - what it imports may be found in the current folder before


def main() -> None:
    """Run the command line. Ctrl-C and SIGTERM end it with 130 and a word, also while it is being loaded and when it is done."""
    on_signals(end_at_once)
    few_collections()
    from .cli import main as command_line

    try:
        command_line()
    finally:
        on_signals(end_at_once)


if __name__ == "__main__":
    main()
