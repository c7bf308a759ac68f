# SPDX-License-Identifier: GPL-2.0-only
"""Arrows, curves, films and a second run in a real browser."""

import base64
import io

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.view.export import write_report
from page_lab import choose, colors, open_page, press, show, text
from PIL import Image
from scene_texts import FALL
from view_lab import served

pytestmark = [pytest.mark.timeout(240), pytest.mark.usefixtures("quiet")]
SHOWN_THERE = """render {
  arrows velocity  arrows weight of cube scale 0.01
  plot cube.speed  plot plate.contact.z
  trail cube  label cube "falls"  caption "look"  floor wood
  camera 0 s from (0, -1, 0.5) m look cube
}
"""


def test_arrows_curves_a_second_run_and_a_film(browser, tmp_path):
    """The page shows what the scene shows; curves are added and hidden; a report is seen beside it, and both are in the GIF."""
    browser.messages()
    scene = tmp_path / "fall.txt"
    scene.write_text(
        FALL.replace("time 0.3 s", "time 0.04 s").split("expect")[0].replace("object cube {", "object cube { texture brick")
        + SHOWN_THERE
    )
    folder = Scene.load(scene).run(tmp_path / "fall.out").folder
    write_report(folder, tmp_path / "second.html")
    with served(folder) as view:
        open_page(browser, view.address)
        browser.until("document.querySelectorAll('#curves canvas').length == 2 && mdanim.shows.overlay.trails.size == 1")
        show(browser, 2)
        assert browser.js("return mdanim.shows.overlay.arrows.map((a) => [a.word, a.objects, Boolean(a.vectors)])") == [
            ["velocity", None, True], ["weight", [0], True]]  # fmt: skip
        look = np.subtract(
            browser.js("return mdanim.stage.orbit.target.toArray()"), browser.js("return [...mdanim.shown.object.slice(6, 9)]")
        )
        assert np.abs(look).max() < 1e-5  # as the movie's camera
        legend = lambda: (np.diff(colors(browser)[5:40, 5:200][..., [0, 2]]) > 100).sum()  # pixels as blue as its velocities
        assert legend() > 100
        press(browser, "arrows-velocity")
        press(browser, "arrows-weight")
        browser.until("!mdanim.shows.overlay.arrows.length && !mdanim.stage.changed")
        assert legend() == 0
        choose(browser, "curve-of", "")
        choose(browser, "curve-what", "energy.work")
        press(browser, "add-curve")
        browser.until("document.querySelectorAll('#curves canvas').length == 3")
        assert "plate.contact.z" in text(browser, "curves")
        browser.js("document.querySelector('#curves .away').click()")
        browser.until("document.querySelectorAll('#curves canvas').length == 2")
        browser.js("document.querySelector('#curves .legend-key').click()")
        assert browser.js("return mdanim.shows.curves.panels[0].plot.series[1].show") is False

        file = browser.ask("POST", "/element", {"using": "css selector", "value": "#report-file"})
        send = lambda path: browser.ask("POST", f"/element/{next(iter(file.values()))}/value", {"text": str(path)})
        (tmp_path / "evil.html").write_text('<script>window.evil = 1</script><script type="text/plain" id="replay">AAAA</script>')
        for path in (scene, tmp_path / "evil.html"):
            browser.js("document.getElementById('message').hidden = true")
            send(path)
            browser.until("!document.getElementById('message').hidden")
            assert browser.js("return !window.evil && !mdanim.second")
        send(tmp_path / "second.html")
        browser.until("mdanim.second && mdanim.second.frame && mdanim.second.frame.frame == 2")
        assert browser.js("return mdanim.second.stage.camera.position.distanceTo(mdanim.stage.camera.position)") < 1e-6
        browser.until("mdanim.shows.curves.panels[0].plot.series.length == 3")
        browser.js(
            """HTMLAnchorElement.prototype.click = function () { window.saved = this.download; };
            URL.createObjectURL = (blob) => {
                const r = new FileReader(); r.onload = () => (window.bytes = r.result); r.readAsDataURL(blob); return ""; }"""
        )
        press(browser, "show-shadows")  # they take most of the time
        browser.js("mdanim.second.stage.sun.castShadow = false")
        press(browser, "gif")
        browser.until("window.bytes")
        film = Image.open(io.BytesIO(base64.b64decode(browser.js("return bytes").partition(",")[2])))
        assert browser.js("return saved") == "film.gif" and film.n_frames == 2 and film.size[0] == 640
        seen = np.asarray(film.convert("RGB")).astype(int)
        assert np.abs(seen[:, :320].mean(axis=(0, 1)) - seen[:, 320:].mean(axis=(0, 1))).max() < 20 and np.ptp(seen) > 100
        press(browser, "beside")
        browser.until("!mdanim.second")
