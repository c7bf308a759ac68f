# SPDX-License-Identifier: GPL-2.0-only
"""The program from its first instruction: ``mdanim-lammps`` and ``python -m mdanim_lammps``."""

import os
import sys

from .safe_start import is_safe

# A module that lies beside a scene is not a part of this program.
if __name__ == "__main__" and not is_safe():
    del sys.path[0]  # the current folder, which -m puts there
named = os.environ.get("PYTHONPATH", "")
if named and "" in named.split(os.pathsep) and os.getcwd() in sys.path:
    sys.path.remove(os.getcwd())  # an empty part, as of "$UNSET:/opt/lib", is the current folder

import signal  # noqa: E402 - not before: it may be found in the current folder


def main() -> None:
    """Run the command line. Ctrl-C and SIGTERM end it with 130 and a word, also while it is being loaded."""
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):  # else it is to be ignored
            signal.signal(number, _end)
    from .cli import main as command_line

    command_line()


def _end(*_) -> None:
    """End at once: no file has been opened yet."""
    os.write(2, b"mdanim-lammps: interrupted\n")
    os._exit(130)


if __name__ == "__main__":
    main()
