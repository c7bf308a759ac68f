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
from importlib import resources
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

from websockets.datastructures import Headers, MultipleValuesError
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import Server, ServerConnection, serve

from ..errors import MdanimError
from ..picture.textures import FLOORS, NOISE, OBJECTS
from .control import COMMANDS, command
from .edit import LONGEST_TEXT, Editor
from .feed import LAYERS, packed
from .listener import HOST, Listener
from .pull import Puller
from .tail import Known, Tail

KINDS = {"html": "text/html; charset=utf-8", "css": "text/css; charset=utf-8", "js": "text/javascript; charset=utf-8"}
PAGES = 16
"""Open at once at most."""
LONGEST_MESSAGE = 4096
"""Bytes of a message from a page at most."""
MOST_ESCAPED = 6
"""Bytes of JSON for a byte of text."""
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
        puller: of objects, where pages may pull at them; None where they may not.
        linger: seconds that the server waits for a page once the run has ended and no page is open; None waits for ever.
    """

    def __init__(
        self,
        tail: Tail,
        *,
        port: int = 0,
        linger: float | None = None,
        editor: Editor | None = None,
        puller: Puller | None = None,
    ):
        self.tail, self.linger, self.editor, self.puller = tail, linger, editor, puller
        self.token = secrets.token_urlsafe(24)
        self.files = packaged_files()
        self._pages: set[ServerConnection] = set()
        self._ended = threading.Event()
        self._needed = time.monotonic()
        self._listener = Listener(port)
        self._server: Server = serve(
            self._talk,
            sock=self._listener,
            process_request=self._gate,
            compression=None,
            max_size=MOST_ESCAPED * LONGEST_TEXT if editor else LONGEST_MESSAGE,
            server_header=None,
            open_timeout=5.0,
            logger=_quiet(),
        )
        self.port = self._server.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """The address that opens the page: it holds the token, and works in any browser on this machine."""
        return f"http://{HOST}:{self.port}/?t={self.token}"

    def _admits(self, given: str) -> bool:
        return hmac.compare_digest(given.encode(), self.token.encode())

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
            if self.editor:  # first: pages may wait for it
                self.editor.end()
            self._server.shutdown()
            for page in self._pages.copy():
                with suppress(OSError):
                    page.close(1001, "the server ends")

    # --- requests -------------------------------------------------------------------------------------------------

    def _gate(self, connection: ServerConnection, request: Request) -> Response | None:
        """Answer what is not a WebSocket; refuse what does not come from this machine's own page."""
        try:
            answer = self._answer(request)
        except (ValueError, KeyError, MultipleValuesError):
            return _response(http.HTTPStatus.BAD_REQUEST)
        if answer is None:
            self._listener.admit(connection.socket)
        return answer

    def _answer(self, request: Request) -> Response | None:
        headers, url = request.headers, urlsplit(request.path)
        if getattr(request, "method", "GET") != "GET":  # older websockets refuse other methods themselves
            return _response(http.HTTPStatus.METHOD_NOT_ALLOWED, more=[("Allow", "GET")])
        known = self._admits(parse_qs(url.query).get("t", [""])[0])
        if headers.get("Host") not in (f"{HOST}:{self.port}", f"localhost:{self.port}") or not self._is_from_here(headers, known):
            return _response(http.HTTPStatus.FORBIDDEN)
        if url.path == "/socket":
            if not known or headers.get("Origin") != f"http://{headers['Host']}":
                return _response(http.HTTPStatus.FORBIDDEN)
            return _response(http.HTTPStatus.SERVICE_UNAVAILABLE) if len(self._pages) >= PAGES else None
        if "Upgrade" in headers or url.path not in self.files:
            return _response(http.HTTPStatus.NOT_FOUND)
        return _response(http.HTTPStatus.OK, *self.files[url.path])

    @staticmethod
    def _is_from_here(headers: Headers, known: bool) -> bool:
        """Whether our own page asks, or the user; a file that leads the browser to the page counts as another site."""
        if headers.get("Sec-Fetch-Site", "none") in ("none", "same-origin"):
            return True
        return known and (headers.get("Sec-Fetch-Mode"), headers.get("Sec-Fetch-Dest")) == ("navigate", "document")

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
            if self.puller:
                self.puller.gone(page)

    def _push(self, page: ServerConnection, gone: threading.Event) -> None:
        known = Known()
        with suppress(ConnectionClosed):
            while not gone.is_set():
                seen = self.tail.changes
                if news := self.tail.news(known):
                    news["edit"] = LONGEST_TEXT if self.editor else False
                    news["hands"] = self.puller is not None
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
            elif "track" in asked:
                feed = self.tail.feed()
                page.send(feed.track(whole(asked["track"], len(feed.first)), self.tail.count))
            elif "told" in asked:
                page.send(json.dumps(self.tail.told().head()))
            elif "curve" in asked:
                page.send(packed(*self.tail.told().curve(asked["curve"])))
            elif "arrows" in asked:
                page.send(packed({}, {"vector": self.tail.told().vectors(asked["arrows"])}))
            elif self.puller and "hand" in asked:
                self._pull(page, asked["hand"])
            elif asked.get("do") in COMMANDS:
                self._command(page, asked["do"])
            else:
                raise ValueError("nothing that is known")
        except MdanimError as error:
            page.send(json.dumps({"error": str(error)}))
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            page.close(1008, "what a page sends is JSON that asks for what there is")

    def _command(self, page: ServerConnection, what: str) -> None:
        """Tell the run. No answer is due: why it cannot be told is said without being asked for."""
        try:
            if self.tail.live:
                command(self.tail.folder, what)
        except MdanimError as error:
            page.send(json.dumps({"refused": str(error)}))

    def _pull(self, page: ServerConnection, asked: dict | None) -> None:
        """Move the hand of a page. No answer is due, as to a command."""
        try:
            self.puller.pull(page, asked)
        except MdanimError as error:
            page.send(json.dumps({"refused": str(error)}))

    def _edit(self, asked: dict) -> dict:
        """The answer to a page that edits: the text, its problems; without any, a run may begin."""
        if asked["edit"] is None:
            return {"text": self.editor.text}
        if not isinstance(asked["edit"], str) or len(asked["edit"].encode("utf-8", "surrogatepass")) >= LONGEST_TEXT:
            raise ValueError("no text, or one that is too long")
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
    """Contents and kind of each file of a page, by its path in an address; patterns.js has the shaders of pictures."""
    patterns = f"export const OBJECTS = {json.dumps(OBJECTS)}, NOISE = {json.dumps(NOISE)}, FLOORS = {json.dumps(FLOORS)};\n"
    found = {"/patterns.js": (patterns.encode(), KINDS["js"])}
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
