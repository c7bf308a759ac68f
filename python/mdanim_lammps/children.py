# SPDX-License-Identifier: GPL-2.0-only
"""Child processes: the one place that starts them.

They run modules of this package and none of the current folder, speak UTF-8 where this process reads them, and inherit the
environment without what would lead Python to the current folder.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future
from contextlib import suppress
from pathlib import Path
from typing import Any

Child = subprocess.Popen
PIPE, DEVNULL = subprocess.PIPE, subprocess.DEVNULL
TimeoutExpired = subprocess.TimeoutExpired
START = Path(__file__).absolute().with_name("safe_start.py")
ENDING = 10.0
"""Seconds that a child has to end after SIGTERM: a run finishes its frame and writes a checkpoint."""


def command(module: str, *arguments: object) -> list[str]:
    """The command that calls ``main`` of a module in a Python of its own, with these arguments in ``sys.argv[1:]``."""
    return [sys.executable, str(START), module, *map(str, arguments)]


def environment(more: Mapping[str, str] = {}) -> dict[str, str]:
    """Environment of this process and ``more``; children of children take no modules from the current folder either."""
    found = os.environ | {"PYTHONSAFEPATH": "1"} | more
    if "PYTHONPATH" in found:  # an empty part, as of "$UNSET:/opt/lib", names the current folder
        found["PYTHONPATH"] = os.pathsep.join(filter(None, found["PYTHONPATH"].split(os.pathsep)))
    return found


def start(arguments: Sequence[str], *, text: bool = True, more: Mapping[str, str] = {}, **options: Any) -> Child:
    """A process that goes on. ``more`` is added to its environment, ``options`` are those of Popen. Its pipes carry UTF-8 with
    ``text``, else bytes. Raises OSError."""
    return Child(arguments, **_settings(text, more, options), **options)


def run(arguments: Sequence[str], *, text: bool = True, more: Mapping[str, str] = {}, **options: Any):
    """Wait for a process, as `subprocess.run` does; arguments are those of `start`, and ``timeout`` [s]. Raises OSError and
    TimeoutExpired."""
    return subprocess.run(arguments, **_settings(text, more, options), stdin=DEVNULL, **options)


def _settings(text: bool, more: Mapping[str, str], options: Mapping[str, Any]) -> dict[str, Any]:
    read = text and (options.get("stderr") == PIPE or options.get("capture_output"))
    # Text for the terminal has the terminal's encoding.
    encoded = {"PYTHONIOENCODING": "utf-8:backslashreplace"} if read else {}
    return {"env": environment({**encoded, **more}), **({"encoding": "utf-8", "errors": "replace"} if text else {})}


# --- processes that share work --------------------------------------------------------------------------------------


class ChildLost(Exception):
    """A process that shares work has ended before its answer came."""


class Workers(Executor):
    """Processes that share work, an executor as those of `concurrent.futures`. They are there for this process only: they end
    with it, however it ends, and Ctrl-C is for it alone.

    Functions, arguments and results are pickled. What a function raises is raised by its future, ChildLost where its process was
    killed. What it prints goes to stderr.

    Args:
        processes: how many.
        begin: a function and its arguments that each process calls first.
        more: added to their environment.
    """

    def __init__(self, processes: int, begin: tuple[Callable, ...] = (), more: Mapping[str, str] = {}):
        self._tasks: queue.SimpleQueue = queue.SimpleQueue()
        self._begin, self._ended = begin, False
        self.children = [
            start(command(__name__), text=False, more=more, stdin=PIPE, stdout=PIPE, start_new_session=True)
            for _ in range(processes)
        ]
        self._threads = [threading.Thread(target=self._serve, args=(child,), daemon=True) for child in self.children]
        for thread in self._threads:
            thread.start()

    def submit(self, fn: Callable, /, *args: Any, **kwargs: Any) -> Future:
        """See `concurrent.futures.Executor.submit`."""
        future: Future = Future()
        self._tasks.put((future, (fn, args, kwargs)))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all processes: what they have begun is broken off, after its frame where it is a run. ``cancel_futures`` changes
        nothing: what has not begun is cancelled."""
        self._ended = True
        for _ in self._threads:
            self._tasks.put(None)
        try:
            for child in self.children:
                child.terminate()
            deadline = time.monotonic() + (ENDING if wait else 0.0)
            for child in self.children:
                with suppress(TimeoutExpired):
                    child.wait(max(0.0, deadline - time.monotonic()))
        finally:  # also where Ctrl-C comes once more
            for child in self.children:
                child.kill()
        for thread in self._threads:
            thread.join()

    def _serve(self, child: Child) -> None:
        """Give one process its tasks, one after the other."""
        with suppress(BrokenPipeError), child:
            begun = not self._begin
            while found := self._tasks.get():
                future, task = found
                if self._ended or not future.set_running_or_notify_cancel():
                    future.cancel()
                    continue
                try:
                    if not begun:
                        self._ask(child, (self._begin[0], self._begin[1:], {}))
                        begun = True
                    future.set_result(self._ask(child, task))
                except BaseException as error:
                    future.set_exception(error)

    @staticmethod
    def _ask(child: Child, task: tuple) -> Any:
        """The result of a task. Raises what it raises, and ChildLost."""
        packed = pickle.dumps(task, protocol=pickle.HIGHEST_PROTOCOL)
        try:
            child.stdin.write(packed)
            child.stdin.flush()
            good, found, words = pickle.load(child.stdout)
        except (EOFError, OSError, pickle.UnpicklingError) as error:
            raise ChildLost("a process that shares work has ended") from error
        if not good:
            raise found from RuntimeError(words)
        return found


def main() -> None:
    """Be a process that shares work: take tasks from stdin, and put what comes of them on what was stdout."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with open(os.dup(0), "rb") as ask, open(os.dup(1), "wb") as tell:
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(2, 1)
        tasks: queue.SimpleQueue = queue.SimpleQueue()
        threading.Thread(target=_listen, args=(ask, tasks), daemon=True).start()
        while True:
            tell.write(_done(tasks.get()))
            tell.flush()


def _listen(ask, tasks: queue.SimpleQueue) -> None:
    """Take tasks until the parent has ended, which ends this process at once."""
    try:
        while True:
            tasks.put(pickle.load(ask))
    finally:
        os._exit(1)


def _done(task: tuple) -> bytes:
    """Whether a task was done, what came of it, and where it failed."""
    fn, args, kwargs = task
    try:
        return pickle.dumps((True, fn(*args, **kwargs), ""), protocol=pickle.HIGHEST_PROTOCOL)
    except BaseException as error:
        try:
            packed = pickle.dumps((False, error, traceback.format_exc()))
            pickle.loads(packed)
            return packed
        except Exception:  # an error that cannot be sent
            return pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}"), traceback.format_exc()))
