# SPDX-License-Identifier: GPL-2.0-only
"""The server behind the page: packaged files over HTTP, everything else over one WebSocket, on this machine only
(docs/view.md, docs/security.md)."""

from __future__ import annotations

import hmac
import http
import json
import secrets
import threading
import time
from contextlib import suppress
from http.cookies import CookieError, SimpleCookie
from importlib import resources
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

from websockets.datastructures import Headers, MultipleValuesError
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import Server, ServerConnection, serve

from ..errors import MdanimError
from .control import COMMANDS, command
from .edit import LONGEST_TEXT, Editor
from .feed import LAYERS
from .tail import Known, Tail

HOST = "127.0.0.1"
KINDS = {"html": "text/html; charset=utf-8", "css": "text/css; charset=utf-8", "js": "text/javascript; charset=utf-8"}
PAGES = 16
"""Open at once at most."""
LONGEST_MESSAGE = 4096
"""Bytes of a message from a page at most."""
TICKET = 30.0
"""Seconds within which the address that a browser is started with must be used."""
LOT = 0.05
"""Wall time between two lots of news for a page [s]."""
POLICY = (
    "default-src 'none'; script-src 'self'; connect-src 'self'; img-src 'self' blob: data:; style-src 'self'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)


class ViewServer:
    """Serves one output folder, from now on until it is told to end or is no longer needed.

    Args:
        tail: of the folder.
        port: 0 takes a free one.
        editor: of the scene's text, where pages may edit it and run it again; None where they may not.
        linger: seconds that the server waits for a page once the run has ended and no page is open; None waits for ever.
    """

    def __init__(self, tail: Tail, *, port: int = 0, linger: float | None = None, editor: Editor | None = None):
        self.tail, self.linger, self.editor = tail, linger, editor
        self.token = secrets.token_urlsafe(24)
        self._tickets: dict[str, float] = {}
        self.files = packaged_files()
        self._pages: set[ServerConnection] = set()
        self._ended = threading.Event()
        self._needed = time.monotonic()
        self._server: Server = serve(
            self._talk,
            HOST,
            port,
            process_request=self._gate,
            compression=None,
            max_size=LONGEST_TEXT if editor else LONGEST_MESSAGE,
            server_header=None,
            open_timeout=5.0,
            logger=_quiet(),
        )
        self.port = self._server.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """What opens the page: it holds the token, and works in any browser on this machine."""
        return self._with(self.token)

    def address_once(self) -> str:
        """What opens the page one time within `TICKET` seconds: for argument lists, which every user of this machine can read."""
        ticket = secrets.token_urlsafe(24)
        self._tickets[ticket] = time.monotonic() + TICKET
        return self._with(ticket)

    def _with(self, secret: str) -> str:
        return f"http://{HOST}:{self.port}/?t={secret}"

    def _admits(self, given: str) -> bool:
        until = self._tickets.pop(given, 0.0)
        return hmac.compare_digest(given.encode(), self.token.encode()) or time.monotonic() < until

    def wait(self) -> None:
        """Return when `end` was called, or when `linger` is over."""
        while not self._ended.wait(None if self.linger is None else min(0.2, self.linger)):
            if self._pages or self.tail.live:
                self._needed = time.monotonic()
            elif time.monotonic() - self._needed > self.linger:
                return

    def end(self) -> None:
        """Answer no more; pages lose their connection."""
        if not self._ended.is_set():
            self._ended.set()
            self._server.shutdown()
            for page in self._pages.copy():
                with suppress(OSError):
                    page.close(1001, "the server ends")
            if self.editor:
                self.editor.end()

    # --- requests -------------------------------------------------------------------------------------------------

    def _gate(self, connection: ServerConnection, request: Request) -> Response | None:
        """Answer what is no WebSocket; refuse what does not come from this machine's own page."""
        try:
            return self._answer(request)
        except (ValueError, KeyError, MultipleValuesError, CookieError):
            return _response(http.HTTPStatus.BAD_REQUEST)

    def _answer(self, request: Request) -> Response | None:
        headers, url = request.headers, urlsplit(request.path)
        here = (f"{HOST}:{self.port}", f"localhost:{self.port}")
        cookie = SimpleCookie(headers.get("Cookie", "")).get(self._cookie)
        given = parse_qs(url.query).get("t", [cookie.value if cookie else ""])[0]
        if (
            headers.get("Host") not in here
            or headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin")
            or not self._admits(given)
        ):
            return _response(http.HTTPStatus.FORBIDDEN)
        if url.path == "/socket":
            own = headers.get("Origin") == f"http://{headers['Host']}"
            if own and len(self._pages) >= PAGES:
                return _response(http.HTTPStatus.SERVICE_UNAVAILABLE)
            return None if own else _response(http.HTTPStatus.FORBIDDEN)
        if "Upgrade" in headers or url.path not in self.files:
            return _response(http.HTTPStatus.NOT_FOUND)
        body, kind = self.files[url.path]
        token = f"{self._cookie}={self.token}; HttpOnly; SameSite=Strict; Path=/"
        return _response(http.HTTPStatus.OK, body, kind, [("Set-Cookie", token)])

    @property
    def _cookie(self) -> str:
        return f"mdanim-{self.port}"

    # --- one page -------------------------------------------------------------------------------------------------

    def _talk(self, page: ServerConnection) -> None:
        self._pages.add(page)
        gone = threading.Event()
        threading.Thread(target=self._push, args=(page, gone), daemon=True).start()
        try:
            for text in page:
                self._obey(page, text)
        except ConnectionClosed:
            pass
        finally:
            gone.set()
            self._pages.discard(page)

    def _push(self, page: ServerConnection, gone: threading.Event) -> None:
        known = Known()
        with suppress(ConnectionClosed):
            while not gone.is_set():
                seen = self.tail.changes
                if news := self.tail.news(known):
                    news["edit"] = self.editor is not None
                    page.send(json.dumps({"news": news}, allow_nan=False))
                    gone.wait(LOT)
                with self.tail.changed:
                    self.tail.changed.wait_for(lambda seen=seen: self.tail.changes != seen, 1.0)

    def _obey(self, page: ServerConnection, text: str | bytes) -> None:
        """One message of a page; a wrong one closes the page."""
        try:
            asked = json.loads(text)
            if self.editor and "edit" in asked:
                page.send(json.dumps(self._edit(asked)))
            elif len(text) > LONGEST_MESSAGE:
                raise ValueError("too long")
            elif "get" in asked:
                page.send(self.tail.feed().frame(whole(asked["get"], self.tail.count), whole(asked["layers"], LAYERS + 1)))
            elif "scene" in asked:
                page.send(self.tail.feed().scene())
            elif "springs" in asked:
                page.send(self.tail.feed().springs())
            elif "heights" in asked:
                feed = self.tail.feed()
                page.send(json.dumps({"heights": feed.heights(whole(asked["heights"], len(feed.first)), self.tail.count)}))
            elif asked.get("do") in COMMANDS:
                if self.tail.live:
                    command(self.tail.folder, asked["do"])
            else:
                raise ValueError("nothing that is known")
        except MdanimError as error:
            page.send(json.dumps({"error": str(error)}))
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            page.close(1008, "what a page sends is JSON that asks for what there is")

    def _edit(self, asked: dict) -> dict:
        """The answer to a page that edits: the text, its problems; without any, a run may begin."""
        if asked["edit"] is None:
            return {"text": self.editor.text}
        if not isinstance(asked["edit"], str):
            raise ValueError("no text")
        problems = self.editor.problems(asked["edit"])
        started = asked.get("run") is True and not [p for p in problems if p["severity"] == "error"]
        if started:
            self.editor.run(asked["edit"], self.tail)
        return {"problems": problems, "started": started}


def whole(value: object, below: int) -> int:
    """A whole number from 0 to below a bound. Raises ValueError."""
    if type(value) is not int or not 0 <= value < below:
        raise ValueError(value)
    return value


def packaged_files() -> dict[str, tuple[bytes, str]]:
    """Contents and kind of each file of a page, by its path in an address."""
    found = {}
    for file in resources.files(__package__).joinpath("web").iterdir():
        if (kind := KINDS.get(Path(file.name).suffix[1:])) is not None:
            found["/" if file.name == "index.html" else f"/{file.name}"] = (file.read_bytes(), kind)
    return found


def _response(status: http.HTTPStatus, body: bytes | None = None, kind: str = "text/plain", more: list | None = None) -> Response:
    body = f"{status.value} {status.phrase}\n".encode() if body is None else body
    headers = [
        ("Content-Type", kind),
        ("Content-Length", str(len(body))),
        ("Content-Security-Policy", POLICY),
        ("X-Content-Type-Options", "nosniff"),
        ("Referrer-Policy", "no-referrer"),
        ("Cache-Control", "no-store"),
        ("Cross-Origin-Resource-Policy", "same-origin"),
        ("Connection", "close"),
    ]
    return Response(status.value, status.phrase, Headers([*headers, *(more or [])]), body)


def _quiet():
    """A logger that says nothing: what strangers send is not printed in the user's terminal."""
    import logging

    logger = logging.getLogger(f"{__name__}.websockets")
    logger.disabled = True
    return logger
