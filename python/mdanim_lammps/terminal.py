# SPDX-License-Identifier: GPL-2.0-only
"""The terminal: the standard streams, a progress bar, and how a command ends."""

from __future__ import annotations

import errno
import os
import re
import select
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, NoReturn, TextIO

from .errors import CONTROL, ExitCode, MdanimError, SceneError, for_a_shell, out_of_files, out_of_memory
from .interrupts import PROGRAM, heard, interrupt, on_signals
from .processes import available_memory

LONGEST_NAME = 120
"""Signs of the name of a file in a message at most."""


def open_streams() -> None:
    """Make stdin, stdout and stderr usable, whatever this process was started with.

    A closed stream (``>&-``) becomes /dev/null: otherwise the next file that is opened gets its number, and what LAMMPS or MPI
    print goes into that file. Characters that the encoding of a stream lacks are printed as escapes.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest free number, which is this one
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "w" if number else "r", encoding="utf-8", closefd=False))
        if number and hasattr(getattr(sys, name), "reconfigure"):
            getattr(sys, name).reconfigure(errors="backslashreplace")
        if number and getattr(sys, name).isatty() and not isinstance(getattr(sys, name), Printable):
            setattr(sys, name, Printable(getattr(sys, name)))
    if sys.stderr is sys.__stderr__ and not sys.stderr.isatty():
        sys.stderr = Unfailing(sys.stderr)


_CONTROL = re.compile(f"[{CONTROL}]")


class Printable:
    """A stream to a terminal: signs that command it, as a file's name may have, are written as escapes. rich, whose own signs
    colour text and move the cursor, takes the stream itself, by the name that it looks for."""

    def __init__(self, raw: TextIO):
        self.rich_proxied_file = self.raw = raw

    def write(self, text: str) -> int:
        """Write a text, and return its length."""
        self.raw.write(_CONTROL.sub(lambda found: found[0].encode("unicode_escape").decode(), text))
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.raw, name)


class Unfailing:
    """stderr, where progress goes: a run does not end because its disk is full. ``raw`` is the stream itself."""

    def __init__(self, raw: TextIO):
        self.raw = raw

    def write(self, text: str) -> int:
        """Write a text, if that is possible, and return its length."""
        with suppress(OSError):
            self.raw.write(text)
        return len(text)

    def flush(self) -> None:
        """Write what is held back, if that is possible."""
        with suppress(OSError):
            self.raw.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.raw, name)


def stop_on_sigterm() -> None:
    """Let Ctrl-C and SIGTERM end the program with a message; a run has handlers of its own while it simulates."""
    on_signals(interrupt)


def stdout_is_closed() -> bool:
    """Whether stdout is a pipe that nothing reads any more, as of ``mdanim-lammps check SCENE | head -1``."""
    try:
        poll = select.poll()
        poll.register(sys.stdout.fileno(), 0)
        return any(events & select.POLLERR for _, events in poll.poll(0))
    except (OSError, ValueError):
        return False


def error_line(error: object) -> str:
    """An error as it is printed: with the name of the program, unless it is made of problems, which say how grave they are."""
    text = str(error)
    placed = isinstance(error, SceneError) or text.startswith("error: ") or ": error: " in text.split("\n")[0]
    return text if placed else f"{PROGRAM}: error: {text}"


@contextmanager
def documented_exit(*, debug: bool) -> Iterator[None]:
    """End the program with one message and a documented exit code for whatever is raised inside.

    ``debug`` lets errors through, for their traceback. Raises SystemExit.
    """
    heard.clear()
    before = for_a_shell()
    try:
        yield
        sys.stdout.flush()
    except KeyboardInterrupt:
        _interrupted()
    except MdanimError as error:
        if debug:
            raise
        if heard:
            _interrupted()
        if not isinstance(error, SceneError):
            _end_where_short(error)
        print(error_line(error), file=sys.stderr)
        raise SystemExit(error.exit_code) from None
    except OSError as error:
        if isinstance(error, BrokenPipeError) and stdout_is_closed():
            # The rest in the buffer of stdout must not fail a second time when Python ends.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise SystemExit(ExitCode.DONE) from None
        if debug:
            raise
        if heard:
            _interrupted()
        _end_where_short(error)
        print(error_line(_of_a_file(error)), file=sys.stderr)
        raise SystemExit(ExitCode.IO) from None
    except Exception as error:
        if heard and not debug:
            _interrupted()
        if not debug:
            _end_where_short(error)
        raise
    finally:
        for_a_shell(before)


def _of_a_file(error: OSError) -> str:
    """The words of the system on a file, with a way out."""
    if not error.filename:
        return f"stdout, or a file, cannot be written: {error.strerror or error}; write it elsewhere"
    name = str(error.filename)
    name = name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME // 2]}...{name[-LONGEST_NAME // 4 :]}"
    way_out = {errno.ENAMETOOLONG: "; write a shorter name", errno.EACCES: "; look at its permissions"}
    return f"{name}: {(error.strerror or str(error)).lower()}{way_out.get(error.errno or 0, '')}"


def _end_where_short(error: Exception) -> None:
    """End the program with a way out where memory or open files have run out. Raises SystemExit."""
    words = str(error).strip().split("\n")[0]
    if out_of_files(error):
        told = f"this needs more open files than the limit of the shell allows: {words}\n  raise the limit: ulimit -n 1024"
    elif out_of_memory(error):
        told = (
            f"this would not fit in memory: {words or 'memory ran out'}; {available_memory() * 1e-9:.1f} GB are free\n"
            "  write a larger `resolution`, fewer objects or smaller pictures, or allow more memory (ulimit -v, the container)"
        )
    else:
        return
    print(error_line(told), file=sys.stderr)
    raise SystemExit(ExitCode.ENVIRONMENT) from None


def _interrupted() -> NoReturn:
    print(f"{PROGRAM}: interrupted", file=sys.stderr)
    raise SystemExit(ExitCode.INTERRUPTED) from None


def in_notebook() -> bool:
    """Whether this is the kernel of a notebook."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    return getattr(shell, "kernel", None) is not None


def _notebook_bar(name: str) -> Callable[[int, int, str], None]:
    """A bar below the cell that is moved in place, at most ten times a second."""
    from html import escape

    from IPython.display import HTML, display

    handle, last = display(HTML(""), display_id=True), [0.0]

    def move(done: int, total: int, text: str) -> None:
        now = time.monotonic()
        if now - last[0] > 0.1 or done >= total:
            last[0] = now
            handle.update(HTML(f'{escape(name)} <progress value="{done}" max="{total}"></progress> {escape(text)}'))

    return move


@contextmanager
def progress_bar(name: str, *, quiet: bool) -> Iterator[Callable[[int, int, str], None]]:
    """A progress bar on stderr: moving on a terminal, a line for each tenth elsewhere.

    Gives a function of (pieces done, pieces in all, text).
    """
    if quiet:
        yield lambda done, total, text: None
        return
    if in_notebook():
        yield _notebook_bar(name)
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn
    from rich.table import Column

    def line(done: int, total: int, text: str) -> None:
        if done * 10 // total != (done - 1) * 10 // total:
            print(f"{name:<8} {100 * done // total:3d}%  {text}", file=sys.stderr, flush=True)

    console = Console(stderr=True)
    if not console.is_terminal:
        yield line
        return
    bar = 10 if console.width < 120 else 24  # the text is cut off where it does not fit, not the bar
    columns = [Column(no_wrap=True, min_width=width) for width in (8, bar, 4)]
    with Progress(
        TextColumn(f"{name:<8}", table_column=columns[0]),
        BarColumn(bar_width=bar, table_column=columns[1]),
        TaskProgressColumn(table_column=columns[2]),
        TextColumn("{task.description}", table_column=Column(no_wrap=True, overflow="ellipsis")),
        console=console,
    ) as progress:
        task = progress.add_task("", total=None)
        yield lambda done, total, text: progress.update(task, completed=done, total=total, description=text)
