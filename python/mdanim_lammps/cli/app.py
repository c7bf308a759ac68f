# SPDX-License-Identifier: GPL-2.0-only
"""The program: all commands, and how it ends."""

from __future__ import annotations

import difflib
import sys
from pathlib import Path
from typing import Literal

from cyclopts import App, CycloptsError, Parameter

from .. import __version__
from ..errors import ExitCode, UsageError
from ..terminal import PROGRAM, documented_exit, open_streams, stop_on_sigterm
from . import help_commands, run_commands, scene_commands

app = App(
    name=PROGRAM,
    help="Physically simulated animation of elastic objects, on top of LAMMPS.",
    version=__version__,
    version_flags=["--version"],
    suppress_keyboard_interrupt=False,
    default_parameter=Parameter(negative=(), show_default=False),
)


def completion(shell: Literal["bash", "zsh", "fish"], /) -> None:
    """Print a script that completes commands and options in a shell.

    Parameters
    ----------
    shell
        bash: put  eval "$(mdanim-lammps completion bash)"  into ~/.bashrc; zsh and fish alike in their files.
    """
    print(app.generate_completion(shell=shell))


app.default(scene_commands.run)
for command in (*scene_commands.COMMANDS, completion, *run_commands.COMMANDS, *help_commands.COMMANDS):
    app.command(command)
app.command(help_commands.gallery, show=False)


def main(argv: list[str] | None = None) -> None:
    """Run the command line and exit with one of the documented codes."""
    open_streams()
    stop_on_sigterm()
    arguments = list(sys.argv[1:] if argv is None else argv)
    debug = "--debug" in arguments
    arguments = [a for a in arguments if a != "--debug"]
    with documented_exit(debug=debug):
        refuse_mistyped(arguments, [name for name in app if not name.startswith("-")])
        if not arguments:
            app.help_print([])
            raise SystemExit(ExitCode.USAGE)
        try:
            app(arguments, exit_on_error=False, print_error=False)
        except CycloptsError as error:
            raise UsageError(f"{' '.join(str(error).split())} (see '{PROGRAM} --help')") from None


def refuse_mistyped(arguments: list[str], commands: list[str]) -> None:
    """Raise UsageError for a mistyped command: a first word that is neither a file nor a command, but close to one."""
    word = arguments[0] if arguments else "-"
    if word.startswith("-") or word in commands or Path(word).exists():
        return
    if close := difflib.get_close_matches(word, commands, n=1):
        raise UsageError(f"no scene file and no command is called '{word}'; did you mean '{close[0]}'?")
