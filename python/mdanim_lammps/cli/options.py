# SPDX-License-Identifier: GPL-2.0-only
"""Options that several commands of the command line share."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from ..engine.threads import check_threads
from ..errors import UsageError

Set = Annotated[
    tuple[str, ...], Parameter(name="--set", help="Override a 'let': --set NAME=VALUE.", negative=(), consume_multiple=False)
]
Accuracy = Annotated[
    Literal["preview", "balanced", "reference"] | None,
    Parameter(help="Cells across the thinnest part: 2, 4, 8; time step 0.7, 0.5, 0.25 of the bound."),
]
Strict = Annotated[bool, Parameter(negative=(), help="Bare numbers need a unit.")]
AllowUnstable = Annotated[bool, Parameter(negative=(), help="Insist on a time step above the certified bound.")]
Quiet = Annotated[bool, Parameter(name=["-q", "--quiet"], negative=(), help="Print errors only.")]
Verbose = Annotated[bool, Parameter(name=["-v", "--verbose"], negative=(), help="Print every effect with its reason.")]
Out = Annotated[Path | None, Parameter(name=["-o", "--out"], help="Output folder; default SCENE.out beside the scene.")]


def whole_number(_, tokens) -> int:
    """cyclopts would round a number with a point."""
    if not re.fullmatch(r"[+-]?[0-9]+", tokens[0].value):
        raise ValueError(f"{tokens[0].value} is not a whole number")
    return int(tokens[0].value)


Executors = Annotated[
    int, Parameter(name=["-n", "--executors"], converter=whole_number, help="Processes that simulate; one more supervises them.")
]


def thread_count(_, tokens) -> int:
    """As `check_threads` takes it."""
    try:
        return check_threads(tokens[0].value)
    except UsageError as error:
        raise ValueError(error) from None


Threads = Annotated[
    int | None,
    Parameter(
        converter=thread_count,
        help="Threads of each process that simulates; if left out, as many as pay of all cores divided by executors.",
    ),
]
Control = Annotated[
    Literal["central", "peers"] | None,
    Parameter(help="What assigns objects to executors: the supervisor, or each executor alike."),
]
Size = Annotated[tuple[int, int] | None, Parameter(help="Width and height in pixels.")]
Quality = Annotated[
    Literal["draft", "final"] | None,
    Parameter(help="draft is fast; final has smooth edges and ambient occlusion. Default: that of the scene."),
]
View = Annotated[bool, Parameter(name="--view", negative=(), help="Show the run in a browser while it goes on.")]
Edit = Annotated[bool, Parameter(negative=(), help="Let the page change the scene's text and run it again; implies --view.")]
Overwrite = Annotated[bool, Parameter(name="--force", negative=(), help="Overwrite a file that this program has not made.")]
Force = Annotated[bool, Parameter(negative=(), help="Overwrite an output folder of an earlier run.")]
