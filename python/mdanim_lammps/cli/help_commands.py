# SPDX-License-Identifier: GPL-2.0-only
"""Commands that help: begin a scene, explain a word, run a folder of scenes, look at this machine."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..errors import ExitCode, OutputError, UsageError
from ..terminal import PROGRAM

SCENE = """\
# {name}.txt - a soft cube falls onto the floor. Every setting: {program} explain WORD
title "A soft cube"

let h = 50 cm                        # try: {program} {name}.txt --set h="1 m" --force

gravity (0, 0, -9.81) m/s^2          # leave it out, and nothing falls
ground z 0 m                         # a floor; objects also touch each other, walls and the basin of a liquid

object cube {{
  shape       box (20, 20, 20) cm    # or sphere, ellipsoid, cylinder, cone, torus, rope, sheet, mesh "file.stl"
  position    (0 m, 0 m, h)          # of its centre
  orientation axis (0, 1, 0) angle 40 deg
  density     1000 kg/m^3            # or mass 8 kg
  elasticity  500 kPa                # Young's modulus: 300 kPa is soft rubber, 100 MPa is hard and costs more steps
  damping     0.5                    # part of critical damping; without it the cube never comes to rest
  color       "#3b8fc4"
}}

# A liquid is one more block (take out the marks, and the ground above):
# liquid water {{
#   basin   from (-50, -50, 0) cm to (50, 50, 80) cm
#   density 1000 kg/m^3
#   level   30 cm
# }}

control {{
  time     2.5 s                     # how long; frames 30 fps unless it says otherwise
  friction 0.5                       # without it objects slide as on ice
}}

# Results that the run must reach, measured at its end:
expect energy.residual = 0 +- 1e-3
"""


def init(name: str, /, *, force: bool = False) -> None:
    """Write NAME.txt, a scene with remarks, to begin with.

    Parameters
    ----------
    name
        Of the scene, e.g. first; or the file, e.g. scenes/first.txt.
    force
        Overwrite the file.
    """
    from ..results.files import write_whole

    path = Path(name) if name.endswith(".txt") else Path(f"{name}.txt")
    if path.exists() and not force:
        raise OutputError(f"{path} exists; overwrite it with --force, or take another name")
    if not path.parent.is_dir():
        raise OutputError(f"there is no folder {path.parent}; make it first")
    write_whole(path, SCENE.format(name=path.stem, program=PROGRAM))
    file = shlex.quote(str(path))
    print(f"scene    {path}")
    print(f"next     {PROGRAM} picture {file}    what it looks like, before the run")
    print(f"         {PROGRAM} check {file}      its effects with reasons, and the time step")
    print(f"         {PROGRAM} {file}            the movie")


def explain(*word: str) -> None:
    """Explain a word of the scene language: a setting, block, shape, effect, quantity, unit or limit; without a word, list them.

    Parameters
    ----------
    word
        E.g. elasticity, liquid, torus, draft, kPa, "time step".
    """
    from ..scene.explain import explain as meaning
    from ..scene.explain import words

    if not word:
        print(", ".join(words()))
        return
    try:
        print(meaning(" ".join(word)))
    except KeyError as error:
        raise UsageError(error.args[0]) from None


def gallery(*_: Annotated[str, Parameter(allow_leading_hyphen=True)]) -> None:
    """Was a command: ``python docs/gallery.py DIR``."""
    raise UsageError("gallery is now a script of the repository: python docs/gallery.py DIR -o gallery")


def doctor() -> None:
    """Look at what the program needs on this machine, and say what to do where something is missing."""
    from .doctor import examine

    worst = 0
    for finding in examine():
        mark = ("ok", "note", "FAIL")[finding.severity]
        print(f"{mark:<5}{finding.what:<10} {finding.found}", flush=True)
        if finding.cure:
            print(f"{'':16}cure: {finding.cure}", flush=True)
        worst = max(worst, finding.severity)
    if worst == 2:
        raise SystemExit(ExitCode.ENVIRONMENT)


COMMANDS = (init, explain, doctor)
"""Commands of the command line, in the order of its help."""
