# SPDX-License-Identifier: GPL-2.0-only
"""Ctrl-C and SIGTERM: while the program is being loaded, while a command works, while a run goes on."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable

FIRST = "\nending after this frame, with a checkpoint; Ctrl-C once more ends at once\n"

PROGRAM = "mdanim-lammps"
heard: list[int] = []
"""Signals that have become a KeyboardInterrupt: an error that follows one is its consequence, as of a library half loaded."""


def end_at_once(*_) -> None:
    """End with 130 and a word: nothing has been begun yet, or all is done."""
    os.write(2, f"{PROGRAM}: interrupted\n".encode())
    os._exit(130)


def interrupt(number: int, _) -> None:
    """Raise KeyboardInterrupt, which ends a command with 130 and a word."""
    heard.append(number)
    raise KeyboardInterrupt


def on_signals(handler: Callable) -> None:
    """Let Ctrl-C and SIGTERM call a handler, unless they are ignored or another program has handlers of its own."""
    if threading.current_thread() is not threading.main_thread():
        return
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler, end_at_once, interrupt):
            signal.signal(number, handler)


class Interrupts:
    """Within it the first Ctrl-C or SIGTERM calls ``ask``, each later one ``insist``. Only the main thread of a program can have
    them; in others it does nothing. Signals that are ignored outside of it are ignored within it.
    """

    def __init__(self, ask: Callable[[], None], insist: Callable[[], None]):
        self._ask, self._insist = ask, insist
        self._before: dict[int, object] = {}
        self.asked = False
        """Whether one has come."""

    def __enter__(self) -> Interrupts:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                if signal.getsignal(number) is not signal.SIG_IGN:
                    self._before[number] = signal.signal(number, self._heard)
        return self

    def __exit__(self, *_) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _heard(self, *_) -> None:
        if self.asked:
            self._insist()
            return
        self.asked = True
        self._ask()
        if sys.stderr and sys.stderr.isatty():
            os.write(2, FIRST.encode())  # print cannot be called again while it is at work
