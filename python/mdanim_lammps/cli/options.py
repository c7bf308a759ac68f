# SPDX-License-Identifier: GPL-2.0-only
"""Options that several commands share: records of them, whose fields are options of each command that takes the record."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from ..engine.threads import check_threads
from ..errors import UsageError
from ..records import dataclass

if TYPE_CHECKING:
    from ..scene.scene import SceneRecord


def whole_number(_, tokens) -> int:
    """cyclopts would round a number with a point."""
    if not re.fullmatch(r"[+-]?[0-9]+", tokens[0].value):
        raise ValueError(f"{tokens[0].value} is not a whole number")
    return int(tokens[0].value)


def thread_count(_, tokens) -> int:
    """As `check_threads` takes it."""
    try:
        return check_threads(tokens[0].value)
    except UsageError as error:
        raise ValueError(error) from None


SceneFile = Annotated[Path, Parameter(help="The scene file.")]
RunFolder = Annotated[Path, Parameter(help="The output folder of a run.")]
Quiet = Annotated[bool, Parameter(alias="-q", help="Print errors only.")]
Verbose = Annotated[bool, Parameter(alias="-v", help="Print every effect with its reason.")]
AllowUnstable = Annotated[bool, Parameter(help="Insist on a time step above the certified bound.")]
Executors = Annotated[
    int, Parameter(alias="-n", converter=whole_number, help="Processes that simulate; one more supervises them.")
]
View = Annotated[bool, Parameter(help="Show the run in a browser while it goes on.")]
HandsOn = Annotated[bool, Parameter(name="--hands", help="Let the page pull at objects of the run; implies --view.")]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Reading:
    """How a scene is read."""

    set: Annotated[tuple[str, ...], Parameter(consume_multiple=False)] = ()
    """Override a 'let': --set NAME=VALUE."""
    accuracy: Literal["preview", "balanced", "reference"] | None = None
    """Cells across the thinnest part: 2, 4, 8; time step 0.7, 0.5, 0.25 of the bound."""

    trust: bool = False
    """Run the commands for LAMMPS that the scene has."""

    def overrides(self) -> dict[str, str]:
        """Values of `let` by name. Raises UsageError."""
        pairs = {}
        for text in self.set:
            name, equals, value = text.partition("=")
            if not equals or not name.strip():
                raise UsageError(f"--set {text}: expected NAME=VALUE, e.g. --set rho=0.8")
            pairs[name.strip()] = value.strip()
        return pairs

    def load(self, path: Path, *, strict: bool = False) -> SceneRecord:
        """The scene of a file. Raises SceneError, UsageError."""
        from ..scene.parse import load_scene
        from ..scene.scene import Accuracy

        scene = load_scene(path, overrides=self.overrides(), strict=strict, trust=self.trust)
        return replace(scene, control=replace(scene.control, accuracy=Accuracy(self.accuracy))) if self.accuracy else scene


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Executing:
    """Options for executors."""

    executors: Executors = 1
    threads: Annotated[int | None, Parameter(converter=thread_count)] = None
    """Threads of each process that simulates; if left out, as many as pay of all cores divided by executors."""
    control: Literal["central", "peers"] | None = None
    """The process that assigns objects to executors: the supervisor, or each executor alike."""

    def check(self) -> Executing:
        """Raises UsageError for a number of executors that cannot be, or that this machine cannot hold."""
        from ..parallel import limits

        limits.check_executors(self.executors)
        return self


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class OutFolder:
    """Where a command puts its folder."""

    out: Annotated[Path | None, Parameter(alias="-o")] = None
    """Output folder; if left out, SCENE.out beside the scene."""
    force: bool = False
    """Overwrite an output folder of an earlier run."""


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class OutFile:
    """Where a command puts its file."""

    out: Annotated[Path | None, Parameter(alias="-o")] = None
    """The file, or a folder for it."""
    force: bool = False
    """Overwrite an export, or a file that this program has not made."""

    def place(self, default: Path) -> Path:
        """Where it goes. Raises UsageError, OutputError."""
        from ..results.overwriting import output_file

        return output_file(default, self.out, force=self.force)


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Look:
    """How pictures look."""

    size: tuple[int, int] | None = None
    """Width and height in pixels."""
    quality: Literal["draft", "final"] | None = None
    """draft is fast; final has smooth edges and ambient occlusion. If left out, that of the scene."""

    def check(self) -> None:
        """Raises UsageError for a picture that is too small or too large."""
        if self.size is not None and not all(2 <= n <= 8192 for n in self.size):
            width, height = self.size
            raise UsageError(f"--size {width} {height}: width and height must lie between 2 and 8192, e.g. --size 1280 720")

    def of(self, scene: SceneRecord) -> SceneRecord:
        """The scene with this quality."""
        from ..scene.render import Quality

        return replace(scene, render=replace(scene.render, quality=Quality(self.quality))) if self.quality else scene
