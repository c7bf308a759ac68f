# SPDX-License-Identifier: GPL-2.0-only
"""A run that pauses itself; a view of a folder, served by a thread of this process, and plain requests to it."""

from __future__ import annotations

import http.client
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

from mdanim_lammps import Scene
from mdanim_lammps.results.files import PAUSE
from mdanim_lammps.results.progress import ProgressTail
from mdanim_lammps.run.loop import Interrupted
from mdanim_lammps.view.server import ViewServer
from mdanim_lammps.view.tail import Tail
from websockets.sync.client import ClientConnection, connect

HOLD = 5
"""Frame after which a `Held` run pauses."""


class Held:
    """A run in a thread that pauses itself after frame `HOLD`."""

    def __init__(self, scene: Path, folder: Path, **options):
        self.folder, self.words, self.error = folder, [], None

        def at(progress):
            self.words.append(progress)
            if progress.frame == HOLD and not progress.paused:
                (folder / PAUSE).touch()

        def run():
            try:
                Scene.load(scene).run(folder, on_progress=at, **options)
            except Interrupted as error:
                self.error = error

        self.thread = threading.Thread(target=run)
        self.thread.start()

    def wait_for(self, state: str) -> ProgressTail:
        """The line of progress.jsonl with this state, once there."""
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            tail = ProgressTail(self.folder)
            tail.read()
            tail.close()
            if tail.state == state:
                return tail
            time.sleep(0.01)
        raise TimeoutError(state)


@contextmanager
def served(folder: Path, **options) -> Iterator[ViewServer]:
    """The view of a folder."""
    with Tail(folder) as tail:
        view = ViewServer(tail, **options)
        try:
            yield view
        finally:
            view.end()


def token(view: ViewServer) -> str:
    """The secret of an address."""
    return parse_qs(urlsplit(view.address).query)["t"][0]


def ask(
    view: ViewServer, path: str = "/", *, secret: bool = True, cookie: str = "", method: str = "GET", **headers: str
) -> http.client.HTTPResponse:
    """The answer to a request, read; header names with _ for -. ``Host`` is right unless given."""
    link = http.client.HTTPConnection("127.0.0.1", view.port, timeout=10)
    link.putrequest(method, path + (f"?t={token(view)}" if secret else ""), skip_host=True)
    sent = {"Host": f"127.0.0.1:{view.port}"} | {name.replace("_", "-"): value for name, value in headers.items()}
    if cookie:
        sent["Cookie"] = cookie
    for name, value in sent.items():
        if value:
            link.putheader(name, value)
    link.endheaders()
    answer = link.getresponse()
    answer.body = answer.read() if answer.status != 101 else b""
    link.close()
    return answer


def page(view: ViewServer, **options) -> ClientConnection:
    """A socket as the page opens it."""
    origin = options.pop("origin", f"http://127.0.0.1:{view.port}")
    return connect(f"ws://127.0.0.1:{view.port}/socket?t={token(view)}", origin=origin, compression=None, **options)
