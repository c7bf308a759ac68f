# SPDX-License-Identifier: GPL-2.0-only
"""The server of a view in a process of its own, beside a run, and the browser that shows it."""

from __future__ import annotations

import os
import shutil
import sys
import threading
from functools import partial
from pathlib import Path

from ..children import DEVNULL, PIPE, Child, command, start
from ..errors import MdanimError
from ..terminal import error_line

OPENING = 60.0
"""Seconds for which the file is there that leads a browser to a view."""
LINGER = 60.0
"""Seconds for which the view of a run waits for a page when the run is over and no page is open."""


class Viewer:
    """The server of a view beside a run, in a process of its own; a context manager around the run.

    At the end it waits until the view is no longer needed: until a minute has passed without a page, or Ctrl-C. An error of the
    run is printed before that. ``edit`` is the file of the scene if pages may edit it; with ``hands`` they may pull at objects.
    """

    def __init__(self, wanted: bool, edit: Path | None = None, hands: bool = False):
        self._wanted, self._edit, self._hands = wanted or hands or edit is not None, edit, hands
        self._process: Child | None = None

    def start(self, folder: Path) -> None:
        """Serve the folder of a run that begins, if that is wanted; returns at once."""
        if not self._wanted:
            return
        server = command("mdanim_lammps.view.__main__", folder, "--linger", f"{LINGER:g}")
        if self._edit:
            server += ["--edit", "--scene", str(self._edit)]
        if self._hands:
            server += ["--hands"]
        # In a session of its own: the Ctrl-C that stops the run is not for the view.
        self._process = start(server, stdin=DEVNULL, stdout=PIPE, start_new_session=True)
        threading.Thread(target=self._announce, args=(self._process,), daemon=True).start()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, kind, error, traceback) -> None:
        process = self._process
        if process is None:
            return
        try:
            if isinstance(error, MdanimError):
                print(error_line(error), file=sys.stderr, flush=True)
            if (error is None or isinstance(error, (MdanimError, SystemExit))) and process.poll() is None:
                print("view     stays until its pages are closed; Ctrl-C ends it", flush=True)
                process.wait()
        except KeyboardInterrupt:
            pass
        finally:
            process.terminate()
            process.wait()
        if isinstance(error, MdanimError):
            raise SystemExit(error.exit_code) from error

    @staticmethod
    def _announce(process: Child) -> None:
        if line := process.stdout.readline():
            show_address(line.strip())


def show_address(address: str, *, browser: bool = True) -> None:
    """Print where a view is to be seen; where there is a display, and ``browser`` is wanted, open one."""
    print(f"view     {address}", flush=True)
    if browser and (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        open_browser(address)


def open_browser(address: str) -> None:
    """Open a browser by a file that leads to an address, and that its owner alone can read for a minute: every user of this
    machine can read the arguments of a browser."""
    import atexit
    import html
    import tempfile
    import webbrowser

    folder = Path(tempfile.mkdtemp(prefix="mdanim-view-"))
    forget = partial(shutil.rmtree, folder, ignore_errors=True)
    atexit.register(forget)
    timer = threading.Timer(OPENING, forget)
    timer.daemon = True
    timer.start()
    place = html.escape(address)
    with open(os.open(folder / "open.html", os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as file:
        file.write(
            f'<!DOCTYPE html>\n<meta charset="utf-8">\n<meta name="referrer" content="no-referrer">\n'
            f'<meta http-equiv="refresh" content="0; url={place}">\n<a href="{place}">the view</a>\n'
        )
    webbrowser.open((folder / "open.html").as_uri())
