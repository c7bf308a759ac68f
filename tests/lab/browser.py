# SPDX-License-Identifier: GPL-2.0-only
"""A real Chromium, driven through chromedriver of Debian's packages; nothing from PyPI."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
import time
import urllib.error
import urllib.request

INSTALL = "apt-get install --no-install-recommends chromium chromium-driver fonts-dejavu-core"
SOFTWARE_GL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
KEYS = {"End": "\ue010", "Home": "\ue011", "Left": "\ue012", "Right": "\ue014", "Escape": "\ue00c"}


def missing() -> str:
    """Missing programs for a browser, with the way to get them; empty if there are none."""
    absent = [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]
    return f"no {' and no '.join(absent)}: {INSTALL}" if absent else ""


class Browser:
    """One headless browser with one page; lengths in pixels. To be closed."""

    def __init__(self, width: int = 1100, height: int = 680):
        self.process = subprocess.Popen(
            ["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        for line in self.process.stdout:
            if found := re.search(r"started successfully on port (\d+)", line):
                self.address = f"http://127.0.0.1:{found[1]}/session"
                break
        flags = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", *SOFTWARE_GL]
        chrome = {"args": [*flags, f"--window-size={width},{height}"]}
        wanted = {"browserName": "chrome", "goog:chromeOptions": chrome, "goog:loggingPrefs": {"browser": "ALL"}}
        self.address += "/" + self.ask("POST", "", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]

    def ask(self, method: str, path: str, body: dict | None = None):
        """One command of WebDriver. Raises RuntimeError with what the browser says."""
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.address + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=90) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(f"{path}: {error.read()[:500]!r}") from None

    def go(self, address: str) -> None:
        self.ask("POST", "/url", {"url": address})

    def js(self, code: str, *arguments):
        """Result of a function body; for a promise, its value."""
        return self.ask("POST", "/execute/sync", {"script": code, "args": list(arguments)})

    def until(self, expression: str, seconds: float = 60.0):
        """Wait until an expression is true, and return it. Raises TimeoutError with the browser's messages."""
        end = time.monotonic() + seconds
        while not (found := self.js(f"return {expression}")):
            if time.monotonic() > end:
                raise TimeoutError(f"{expression}: {self.messages()}")
            time.sleep(0.03)
        return found

    def messages(self) -> list[str]:
        """Messages of the console since the last call."""
        return [entry["message"] for entry in self.ask("POST", "/se/log", {"type": "browser"})]

    def click(self, x: float, y: float) -> None:
        self._mouse(
            {"type": "pointerMove", "x": int(x), "y": int(y)},
            {"type": "pointerDown", "button": 0},
            {"type": "pointerUp", "button": 0},
        )

    def drag(self, x: float, y: float, dx: float, dy: float) -> None:
        self._mouse(
            {"type": "pointerMove", "x": int(x), "y": int(y)},
            {"type": "pointerDown", "button": 0},
            {"type": "pointerMove", "x": int(x + dx), "y": int(y + dy), "duration": 100},
            {"type": "pointerUp", "button": 0},
        )

    def _mouse(self, *actions: dict) -> None:
        self.ask("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": list(actions)}]})

    def press(self, key: str) -> None:
        """A key: a character, or a name of `KEYS`."""
        value = KEYS.get(key, key)
        both = [{"type": "keyDown", "value": value}, {"type": "keyUp", "value": value}]
        self.ask("POST", "/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": both}]})

    def picture(self) -> bytes:
        """The page as PNG."""
        return base64.b64decode(self.ask("GET", "/screenshot"))

    def close(self) -> None:
        try:
            self.ask("DELETE", "")
        finally:
            self.process.terminate()
            self.process.wait()
