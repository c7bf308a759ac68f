# SPDX-License-Identifier: GPL-2.0-only
"""Writes a run as files of another program, which appear when they are whole."""

from __future__ import annotations

import errno
import os
import re
import resource
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path

from ..errors import OutputError, SetupError, UsageError
from ..records import dataclass
from ..results.files import disk_errors, scratch, sync
from ..results.overwriting import place_of
from ..results.trajectory import Trajectory
from ..results.untrusted import check_folder
from ..scene.keywords import did_you_mean
from . import FORMATS
from .cut import Cut

SPARE = 1 << 20
"""Bytes: where less is free a library may have failed for want of room, as libraries write in pieces."""


@dataclass(frozen=True, slots=True)
class Exported:
    """The result of `export`."""

    files: tuple[Path, ...]
    frames: int
    notes: tuple[str, ...]
    """Data that the format cannot hold, or holds otherwise: a scale, a quantity that was left out and why."""


def export(
    run: Trajectory | str | Path,
    to: str,
    path: str | Path | None = None,
    *,
    objects: Sequence[str] = (),
    every: int = 1,
    frames: slice = slice(None),
    force: bool = False,
    on_progress: Callable[[int, int], None] = lambda done, total: None,
) -> Exported:
    """Write a run as a file of another program, frame by frame; it appears when it is whole.

    Args:
        run: output folder, or an open trajectory; of a run that was stopped what is there.
        to: a name in `FORMATS`.
        path: the file, or a folder for it; None is ``NAME.SUFFIX`` in the output folder.
        objects: names of those that are wanted; none for all. Liquid is written only with all objects.
        every: only every n-th frame.
        frames: only these, before ``every`` counts.
        force: replace files of an earlier export.
        on_progress: called with (frames done, frames in all).

    Raises:
        UsageError: a format, an object or a range that is not there; a format of objects for a run without any.
        SetupError: the library of the format is not installed.
        OutputError: no frames, a file in the way, a full disk.
    """
    if to not in FORMATS:
        raise UsageError(f"no format is called '{to}'; {did_you_mean(to, FORMATS)}")
    kind = FORMATS[to]
    if not isinstance(run, Trajectory):
        if Path(run).is_dir():
            check_folder(Path(run))
        with Trajectory(run) as opened:
            return export(opened, to, path, objects=objects, every=every, frames=frames, force=force, on_progress=on_progress)
    cut = Cut(run, objects, every, frames)
    if not run.names and not kind.liquid:
        others = ", ".join(name for name, other in FORMATS.items() if other.liquid)
        raise UsageError(f"--to {to}: the run has a liquid and no object, and {to} is of objects; its surface is in {others}")
    home = run.path.parent.resolve()
    path = place_of(home / f"{home.stem}{kind.suffixes[0]}", path, to)
    try:
        if kind.needs:
            import_module(kind.needs)
    except ImportError:
        raise SetupError(f"--to {to} needs a library that is not installed: pip install 'mdanim-lammps[export]'") from None
    targets = [path.with_suffix(suffix) for suffix in kind.suffixes]
    _make_way(targets, kind.pieces, force=force, delete=False)
    write = import_module(f".{kind.module}", __package__).write
    total = len(cut.frames)
    with disk_errors(path), scratch(path.parent, "export") as part:
        with _errors_of_libraries(part):
            notes = write(cut, part, path.stem, lambda done: on_progress(done, total))
        for made in (p for p in part.rglob("*") if p.is_file()):
            sync(made)
        _make_way(targets, kind.pieces, force=force, delete=True)
        for target in reversed(targets):  # the name that was asked for comes last
            os.replace(part / target.name, target)
        sync(path.parent)
    return Exported(tuple(targets), total, tuple(notes))


@contextmanager
def _errors_of_libraries(folder: Path) -> Iterator[None]:
    """Turn errors of libraries that write files themselves into OSError of a full disk where there is no room: libraries say that
    something is corrupt, or does not compress."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        largest = max((made.stat().st_size for made in folder.rglob("*") if made.is_file()), default=0)
        limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
        if limit != resource.RLIM_INFINITY and largest > limit - SPARE:
            raise OSError(errno.EFBIG, os.strerror(errno.EFBIG)) from error
        if shutil.disk_usage(folder).free < SPARE:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)) from error
        raise


def _make_way(targets: Sequence[Path], pieces: str, *, force: bool, delete: bool) -> None:
    """Raises OutputError where something stands in the way that is not an export, or ``force`` is missing. Of a folder no more is
    deleted than files with the names of ``pieces``."""
    for target in targets:
        if not os.path.lexists(target):
            continue
        if not force:
            raise OutputError(f"{target} exists; overwrite it with --force, or write elsewhere with -o FILE")
        if target.is_dir() and not target.is_symlink():
            found = list(target.iterdir())
            if not pieces or not all(re.fullmatch(pieces, p.name) and p.is_file() and not p.is_symlink() for p in found):
                raise OutputError(
                    f"{target} holds files that are not of an export; --force does not delete them: name another with -o"
                )
            if delete:
                for piece in found:
                    piece.unlink()
                target.rmdir()
