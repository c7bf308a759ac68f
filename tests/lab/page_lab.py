# SPDX-License-Identifier: GPL-2.0-only
"""Steps that tests take with the page in a browser."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

SHOWN = "window.mdanim && mdanim.shown"


def open_page(browser, address: str) -> None:
    """Load a page and wait for its first picture, with the film at rest."""
    browser.go(address)
    browser.until(SHOWN)
    show(browser, 0)


def show(browser, frame: int) -> None:
    """See a frame, drawn in full."""
    browser.js("mdanim.player.go(arguments[0])", frame)
    browser.until(f"mdanim.shown.frame == {frame} && !mdanim.stage.changed && mdanim.stage.level == 0")


def colors(browser) -> np.ndarray:
    """Pixels of the canvas, shape (height, width, 3)."""
    box = browser.js(
        "const b = document.getElementById('stage').getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]"
    )
    picture = Image.open(io.BytesIO(browser.picture())).convert("RGB").crop([round(x) for x in box])
    return np.asarray(picture).astype(int)


def center_of(browser, k: int) -> tuple[float, float]:
    """Where on the page the centre of an object is seen."""
    return browser.js(
        """const o = mdanim.shown.object.subarray(12 * arguments[0] + 6), stage = mdanim.stage, c = stage.renderer.domElement,
        p = stage.camera.position.clone().set(o[0], o[1], o[2]).project(stage.camera), b = c.getBoundingClientRect();
        return [b.left + (p.x + 1) / 2 * b.width, b.top + (1 - p.y) / 2 * b.height];""",
        k,
    )


def text(browser, name: str) -> str:
    return browser.js("return document.getElementById(arguments[0]).innerText", name)


def press(browser, name: str) -> None:
    browser.js("document.getElementById(arguments[0]).click()", name)


def choose(browser, name: str, value: str) -> None:
    browser.js(
        "const e = document.getElementById(arguments[0]); e.value = arguments[1]; e.dispatchEvent(new Event('change'))",
        name,
        value,
    )
