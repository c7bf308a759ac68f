# SPDX-License-Identifier: GPL-2.0-only
"""The page in a real browser: what is seen, pressed and said. Without Chromium these tests are skipped, or fail where the
environment says MDANIM_BROWSER=required."""

import contextlib
import io
import shutil
import subprocess
import sys

import numpy as np
import pytest
from mdanim_lammps import Scene
from mdanim_lammps.errors import OutputError
from mdanim_lammps.results.compare import compare
from mdanim_lammps.results.progress import PROGRESS
from mdanim_lammps.scene.parse import load_scene
from mdanim_lammps.view import server
from mdanim_lammps.view.beside import show_address
from mdanim_lammps.view.edit import Editor
from mdanim_lammps.view.export import write_report
from mdanim_lammps.view.tail import Tail
from page_lab import SHOWN, center_of, choose, colors, open_page, press, show, text
from PIL import Image
from scene_texts import FALL, MEETING
from view_lab import HOLD, Held, served

pytestmark = [pytest.mark.timeout(240), pytest.mark.usefixtures("quiet")]


@pytest.fixture(scope="module")
def beam(scenes, tmp_path_factory):
    """The run of scenes/beam.txt."""
    return Scene.load(scenes / "beam.txt").run(tmp_path_factory.mktemp("beam") / "beam.out").folder


@pytest.mark.parametrize("floor", ["plain", "checker", "none"])
def test_the_floor_of_the_scene(browser, tmp_path, floor):
    """Squares of two shades, one shade, or none, and no shadow where the scene asks for none."""
    path = tmp_path / "fall.txt"
    path.write_text(FALL + f"render {{ floor {floor}  shadows 0  light from (1, 0, 1) }}\n")
    with served(Scene.load(path).run(tmp_path / "fall.out").folder) as view:
        open_page(browser, view.address)
        beside = colors(browser)[-150:-50, 20:200].mean(axis=2)
        assert (np.ptp(beside) > 15) == (floor == "checker")
        assert browser.js("return mdanim.stage.sun.shadow.intensity") == 0
        assert text(browser, "scale").startswith("checker" if floor == "checker" else "")


def test_a_finished_run(browser, beam):
    """Both objects in their colours; frames differ; slider, keys, picking, camera line, energies, cost, expectations, strain."""
    with served(beam) as view:
        open_page(browser, view.address)
        assert "?" not in browser.js("return location.href") and text(browser, "state") == "done"
        show(browser, 19)
        seen = colors(browser)
        orange = (seen[..., 0] - seen[..., 2] > 90).mean()
        blue = (seen[..., 2] - seen[..., 0] > 60).mean()
        assert orange > 0.025 and blue > 0.02 and orange + blue < 0.5

        browser.press("Right")
        browser.until("mdanim.shown.frame == 20")
        browser.press("Home")
        browser.until("mdanim.shown.frame == 0")
        browser.js("const s = document.getElementById('slider'); s.value = 29; s.dispatchEvent(new Event('input'))")
        browser.until("mdanim.shown.frame == 29")
        assert text(browser, "clock").startswith("frame 29/90")
        show(browser, 29)
        assert (np.abs(colors(browser) - seen).sum(axis=2) > 60).mean() > 0.01

        browser.click(*center_of(browser, 1))
        browser.until("document.getElementById('object').innerText.includes('cube')")
        assert "8 kg" in text(browser, "object")
        browser.js("mdanim.stage.orbit.target.set(0, 0, 90)")  # the line tells where the camera looks, not what was picked
        browser.js("mdanim.stage.look()")
        browser.until("!document.getElementById('camera').textContent.includes('cube')")
        press(browser, "see")
        browser.until("document.getElementById('camera').textContent.includes('look cube')")
        press(browser, "follow")
        before = browser.js(place := "return [...mdanim.stage.orbit.target.toArray(), ...mdanim.shown.object.subarray(18, 21)]")
        show(browser, 0)
        gone = np.subtract(browser.js(place), before)  # of the camera's aim, and of the cube
        assert np.abs(gone[3:]).max() > 0.05 and np.abs(gone[:3] - gone[3:]).max() < 1e-6
        press(browser, "follow")
        show(browser, 29)
        browser.until("document.querySelector('#height-line canvas')")
        assert "height of the centre" in text(browser, "height")
        browser.until("document.querySelector('#height-line .now').style.left > '0px'")
        browser.press("Escape")
        browser.until("document.getElementById('object').innerText.includes('click')")
        assert browser.js("return document.getElementById('height').hidden && !document.querySelector('#height-line canvas')")
        assert browser.js("return document.querySelectorAll('#energies canvas').length") == 1
        assert "springs" in text(browser, "cost") and text(browser, "expects").count("met") == 5

        choose(browser, "colour", "strain")
        browser.until("mdanim.shown.strain")
        assert "%" in text(browser, "legend")
        press(browser, "show-springs")
        browser.until("mdanim.shown.particles && mdanim.run.bond && mdanim.run.bond.length == 2 * mdanim.scene.springs")

        browser.js("mdanim.player.play(true)")
        browser.until("mdanim.shown.frame > 35")
        browser.press(" ")
        browser.until("!mdanim.player.playing")


def test_a_narrow_window(browser, beam):
    """The panels stand below the picture, which is as wide as the window, and every button is in it."""
    window = browser.ask("GET", "/window/rect")
    try:
        browser.ask("POST", "/window/rect", {"width": 500, "height": 800})
        with served(beam) as view:
            open_page(browser, view.address)
            wide, canvas = browser.js("return [innerWidth, document.getElementById('stage').clientWidth]")
            right = (
                "[...document.querySelectorAll('header button, footer button, select')].map(e => e.getBoundingClientRect().right)"
            )
            assert wide < 600 and canvas == wide and max(browser.js(f"return {right}")) <= wide
    finally:
        browser.ask("POST", "/window/rect", {"width": window["width"], "height": window["height"]})


def test_a_processor_draws_fine_pictures_at_rest_only(browser, beam):
    """While the film plays a picture has fewer pixels than the page, from the first one on; at rest it has more."""
    share = "mdanim.stage.renderer.domElement.width / document.getElementById('stage').clientWidth"
    with served(beam) as view:
        browser.go(view.address)
        browser.until("window.mdanim && mdanim.drawn")
        assert browser.js(f"return mdanim.stage.slow && mdanim.ease == 2 && {share}") <= 0.5
        show(browser, 3)
        assert 1.5 < browser.js(f"return {share}") <= 2.0


def test_a_stranger_is_told_what_to_do(browser, beam):
    """Until the picture is first touched; a choice that this run does not have says where it is."""
    with served(beam) as view:
        open_page(browser, view.address)
        assert "drag to turn" in text(browser, "hello")
        browser.drag(300, 250, 20, 10)
        assert browser.js("return document.getElementById('hello').hidden")
        assert "(of a run with -n)" in text(browser, "colour") and text(browser, "help") == "help"


def test_a_message_does_not_squash_the_picture(browser, beam):
    """Where a message takes room above the picture the drawn picture keeps the shape of its place."""
    with served(beam) as view:
        open_page(browser, view.address)
        show(browser, 0)
        browser.js("const m = document.getElementById('message'); m.textContent = 'word '.repeat(400); m.hidden = false")
        shape = "(({ clientWidth: w, clientHeight: h }) => w / h)(document.getElementById('stage'))"
        browser.until(f"Math.abs(mdanim.stage.camera.aspect - {shape}) < 0.01")
        assert browser.js(f"return {shape}") > 1.7


def test_a_drag_ends_above_the_floor(browser, tmp_path):
    """The floor is not seen from below, where nothing stands on it."""
    scene = tmp_path / "ball.txt"
    scene.write_text(
        "gravity (0, 0, -9.81)\nground z 0\n"
        "object a { shape sphere 10 cm position (0, 0, 0.2) density 1000 elasticity 1 MPa }\ncontrol { time 0.1 s }\n"
    )
    Scene.load(scene).run(tmp_path / "out")
    with served(tmp_path / "out") as view:
        open_page(browser, view.address)
        show(browser, 0)
        browser.js("const o = mdanim.stage.orbit; o.object.position.set(o.target.x + 1, o.target.y, o.target.z - 3); o.update()")
        assert browser.js("return mdanim.stage.camera.position.z > mdanim.stage.orbit.target.z")


def test_the_camera_line_is_of_the_language(browser, beam, tmp_path):
    """After the camera was moved, the line in a scene's render block gives the same eye and look."""
    with served(beam) as view:
        open_page(browser, view.address)
        browser.drag(300, 250, 60, -30)
        line = text(browser, "camera")
        eye = browser.js("return mdanim.stage.camera.position.toArray()")
    scene = tmp_path / "scene.txt"
    scene.write_text(f"{FALL}\nrender {{\n  {line}\n}}\n")
    (camera,) = load_scene(scene).render.camera
    np.testing.assert_allclose(camera.eye, eye, atol=1e-4)


def test_liquid_is_seen_through(browser, scenes, tmp_path):
    """A body behind it turns blue; without the liquid it does not."""
    (tmp_path / "float.txt").write_text(
        (scenes / "float.txt").read_text().replace("time 6 s", "time 0.2 s").replace(" at 6 s", "")
    )
    folder = Scene.load(tmp_path / "float.txt").run().folder
    with served(folder) as view:
        open_page(browser, view.address)
        wet = colors(browser)
        press(browser, "show-liquid")
        browser.until("!mdanim.stage.changed && mdanim.stage.level == 0")
        dry = colors(browser)
    changed = np.abs(wet - dry).sum(axis=2) > 30
    assert 0.1 < changed.mean() < 0.8
    assert ((wet - dry)[changed] @ [-1, 0, 1]).mean() > 20


def test_a_live_run_is_let_go_and_stopped(browser, tmp_path):
    """The page shows a paused run and lets it go; it stops another, which goes on later with the bits of a run left alone."""
    (tmp_path / "fall.txt").write_text(FALL)
    Scene.load(tmp_path / "fall.txt").run(tmp_path / "alone")
    run = Held(tmp_path / "fall.txt", tmp_path / "go")
    run.wait_for("paused")
    with served(tmp_path / "go") as view:
        browser.go(view.address)
        browser.until(SHOWN)
        browser.until("document.getElementById('state').innerText == 'paused'")
        assert browser.js("return mdanim.run.count") == HOLD + 1 and text(browser, "pause") == "go on"
        press(browser, "arrows-contact")
        for word in ("strain.max", "contact.z"):
            choose(browser, "curve-what", word)
            press(browser, "add-curve")
            browser.until(f"mdanim.shows.curves.names.includes('cube.{word}')")
        so_far = "return [...mdanim.shows.curves.chosen.values()].map(({ curve }) => curve.value.length)"
        assert browser.js(so_far) == [HOLD + 1] * 2 and browser.js("return mdanim.shows.overlay.arrows.length") == 1
        told = "const e = document.getElementById('pause'); e.click(); return [e.textContent, e.disabled]"
        assert browser.js(told) == ["after this frame …", True]
        browser.until("document.getElementById('state').innerText == 'done'")
        browser.until("mdanim.shown.frame == 15 && document.getElementById('pause').hidden")
        browser.until("[...mdanim.shows.curves.chosen.values()].every(({ curve }) => curve.value.length == 16)")
    run.thread.join()
    assert compare(tmp_path / "alone", tmp_path / "go").equal
    run = Held(tmp_path / "fall.txt", tmp_path / "stop")
    run.wait_for("paused")
    with served(tmp_path / "stop") as view:
        browser.go(view.address)
        browser.until(SHOWN)
        press(browser, "stop")
        browser.until("document.getElementById('state').innerText == 'stopped'")
        assert "mdanim-lammps resume" in text(browser, "message")
        run.thread.join()
        command = [sys.executable, "-m", "mdanim_lammps", "resume", str(tmp_path / "stop"), "--no-movie", "-q"]
        assert subprocess.run(command, timeout=100).returncode == 0
        browser.until("document.getElementById('state').innerText == 'done' && mdanim.run.count == 16")
    assert compare(tmp_path / "alone", tmp_path / "stop").equal


@pytest.mark.mpi
def test_executors_have_their_colours(browser, tmp_path):
    """By executor, objects of two executors have two colours, and what never moves is grey."""
    (tmp_path / "meeting.txt").write_text(MEETING)
    folder = Scene.load(tmp_path / "meeting.txt").run(tmp_path / "two", executors=2).folder
    with served(folder) as view:
        open_page(browser, view.address)
        before = browser.js(
            "return [...mdanim.scene.objects.keys()].map(k => mdanim.stage.tint[3 * mdanim.scene.objects[k].first])"
        )
        choose(browser, "colour", "executor")
        browser.until("document.getElementById('legend').innerText.includes('executor')")
        show(browser, 1)
        code = "return mdanim.scene.objects.map(({ first }) => [...mdanim.stage.tint.subarray(3 * first, 3 * first + 3)].join())"
        assert len(set(browser.js(code))) == len({executor for _, _, executor in view.tail._progress.owners})
        choose(browser, "colour", "object")
        show(browser, 2)
        assert browser.js("return mdanim.scene.objects.map(({ first }) => mdanim.stage.tint[3 * first])") == before


def test_a_killed_run(browser, beam, tmp_path):
    """The page says that it was killed and how to go on; its frames stay."""
    folder = tmp_path / "killed.out"
    shutil.copytree(beam, folder)
    text_of_run = (folder / PROGRESS).read_text()
    (folder / PROGRESS).write_text(text_of_run[: text_of_run.index('{"frame": 25,')])
    (folder / "summary.json").unlink()
    with served(folder) as view:
        open_page(browser, view.address)
        assert text(browser, "state") == "killed" and "resume" in text(browser, "message")
        show(browser, 20)


def test_a_server_that_ends(browser, beam):
    """The page says so; what it has stays."""
    with served(beam) as view:
        open_page(browser, view.address)
    browser.until("document.getElementById('message').innerText.includes('The server has ended')")
    assert browser.js("return mdanim.shown.frame") == 0


def test_a_report_from_disk(browser, beam, tmp_path):
    """At most 2 MB; opened as a file it replays, picks and tells, and asks for nothing."""
    write_report(beam, tmp_path / "beam.html")
    assert (tmp_path / "beam.html").stat().st_size <= 2_000_000
    open_page(browser, f"file://{tmp_path / 'beam.html'}")
    assert browser.js(
        "const a = document.querySelector('aside'); return a.scrollHeight == a.clientHeight"
    )  # the page alone scrolls
    assert browser.js("return document.getElementById('cost-panel').hidden")  # a table below has it
    show(browser, 40)
    browser.click(*center_of(browser, 1))
    browser.until("document.getElementById('object').innerText.includes('8 kg')")
    browser.until("document.querySelector('#height-line canvas')")
    assert browser.js("return document.querySelector('article').innerText").count("met") >= 5
    requests = browser.js("return performance.getEntriesByType('resource').map((entry) => entry.name)")
    assert not [name for name in requests if not name.startswith(("blob:", "data:"))]


def test_the_picture_can_be_saved(browser, beam):
    """The screenshot is a PNG in full, with its background, also while a slow machine sees fewer pixels."""
    with served(beam) as view:
        open_page(browser, view.address)
        browser.js("HTMLAnchorElement.prototype.click = function () { window.saved = [this.href, this.download]; }")
        press(browser, "shot")
        name = browser.until("window.saved")[1]
        size = browser.js(
            """const image = new Image(); image.src = saved[0]; await image.decode();
            const c = Object.assign(document.createElement('canvas'), { width: image.width, height: image.height });
            c.getContext('2d').drawImage(image, 0, 0);
            return [image.width, image.height, [...c.getContext('2d').getImageData(0, 0, 1, 1).data]]"""
        )
        seen = browser.js("const c = mdanim.stage.renderer.domElement; return [c.clientWidth, c.clientHeight]")
        finer = round(size[0] / seen[0])
        assert name == "frame-0.png" and finer >= 1 and size[:2] == [finer * n for n in seen]
        assert size[2][3] == 255


def test_a_text_is_edited_and_run(browser, tmp_path):
    """A problem is shown at its line and nothing can be run; mended, the run is seen in the page, with its text."""
    (tmp_path / "fall.txt").write_text(FALL)
    folder = Scene.load(tmp_path / "fall.txt").run().folder
    write = "const t = document.querySelector('#editor textarea'); t.value = arguments[0]; t.dispatchEvent(new Event('input'))"
    with served(folder, editor=Editor(folder, tmp_path / "fall.txt")) as view:
        open_page(browser, view.address)
        assert browser.until("document.querySelector('#editor textarea').value") == FALL
        browser.js(write, FALL.replace("frames", "fraems"))
        browser.until("document.getElementById('again').disabled")
        assert "line 7" in text(browser, "problems") and "did you mean 'frames'?" in text(browser, "problems")
        browser.js("document.querySelector('#problems button').click()")
        marked = "const t = document.querySelector('#editor textarea'); return t.value.slice(t.selectionStart, t.selectionEnd)"
        assert browser.js(marked) == "  fraems 50 fps"
        shorter = FALL.replace("time 0.3 s", "time 0.1 s").split("expect")[0]
        browser.js(write, f"let n = 8\n{shorter}")
        browser.js("mdanim.before = true; const s = document.querySelector('#lets input'); s.value = 9; "
                   "s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change'))")  # fmt: skip
        shorter = f"let n = 9\n{shorter}"
        browser.until("window.mdanim && !mdanim.before && mdanim.shown && mdanim.run.state == 'done' && mdanim.run.count == 6")
        assert browser.until("document.querySelector('#editor textarea').value") == shorter
        show(browser, 5)


def test_a_file_leads_to_the_page(browser, beam, tmp_path, monkeypatch):
    """The address opens a browser; the page keeps its token when it is loaded again, and says what to do without one."""
    opened = []
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr("webbrowser.open", opened.append)
    with served(beam) as view:
        show_address(view.address)
        browser.go(opened[0])
        browser.until(SHOWN)
        assert browser.js("return location.href") == f"http://127.0.0.1:{view.port}/"
        browser.js("window.mdanim = null; location.reload()")
        browser.until(SHOWN)
        browser.js("sessionStorage.clear(); window.mdanim = null; location.reload()")
        browser.until("document.getElementById('message').textContent.includes('open the address')")
        browser.messages()  # of the refused socket


def test_a_refused_command_is_told(browser, beam, monkeypatch):
    """While the film plays: the reason is seen, and each frame that was asked for still comes in its place."""

    def refuse(folder, what):
        raise OutputError("the folder is read-only")

    monkeypatch.setattr(server, "command", refuse)
    monkeypatch.setattr(Tail, "live", True)
    with served(beam) as view:
        open_page(browser, view.address)
        browser.js("for (let n = 0; n < 9; n++) { mdanim.source.frame(n, 0).then((f) => (window.got ??= []).push([n, f.frame])); "
                   "if (n % 3 == 0) mdanim.source.tell('pause') }")  # fmt: skip
        browser.until("window.got && got.length == 9 && got.every(([asked, came]) => asked == came)")
        browser.until("document.getElementById('message').textContent == 'the folder is read-only'")


def test_curves_after_a_resume(browser, beam):
    """Rows that are computed again take the place of those that were there, however thin these have become."""
    with served(beam) as view:
        open_page(browser, view.address)
        kept = browser.js(
            """return import("./panel.js").then(({ Energies }) => {
            const e = new Energies(), rows = (a, b) => Array.from({ length: b - a }, (_, k) => [a + k, 1, 0]);
            e.draw = () => {};
            e.begin(["time", "kinetic", "residual"], 1, 0); e.add(rows(0, 9000));
            e.begin(["time", "kinetic", "residual"], 1, 6000); e.add(rows(6000, 6010));
            return e.rows.map(([t]) => t); })"""
        )
        assert kept == sorted(set(kept)) and kept[-11:] == [5998, *range(6000, 6010)]


def test_a_run_begun_anew_is_shown_anew(browser, tmp_path):
    """Where --force has replaced the run, the page loads the new one, once."""
    (tmp_path / "fall.txt").write_text(FALL)
    scene = Scene.load(tmp_path / "fall.txt")
    folder = scene.run().folder
    with served(folder) as view:
        open_page(browser, view.address)
        browser.js("mdanim.before = true")
        (tmp_path / "fall.txt").write_text(FALL.replace("time 0.3 s", "time 0.1 s").split("expect")[0])
        Scene.load(tmp_path / "fall.txt").run(force=True)
        browser.until("window.mdanim && !mdanim.before && mdanim.shown && mdanim.run.state == 'done' && mdanim.run.count == 6")
        browser.js("mdanim.once = true")
        show(browser, 5)
        assert browser.js("return mdanim.once")


def test_an_object_is_pulled_by_the_mouse(browser, tmp_path):
    """The run waits for the page; a drag of an object lifts it, shown by a line, and beside it the camera turns."""
    (tmp_path / "fall.txt").write_text(FALL.replace("time 0.3 s", "time 9 s").replace(" at 0.3 s", ""))
    command = [sys.executable, "-m", "mdanim_lammps", str(tmp_path / "fall.txt"), "--hands", "--accuracy", "preview"]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    eye = lambda: browser.js("return mdanim.stage.camera.position.toArray()")
    try:
        browser.go(next(line for line in run.stdout if line.startswith("view ")).split()[1])
        browser.until(f"{SHOWN} && mdanim.run.state == 'paused' && Boolean(mdanim.hand)")
        press(browser, "pause")
        (x, y), before = map(int, center_of(browser, 1)), eye()
        down = {"type": "pointerDown", "button": 0}, {"type": "pointerMove", "x": x + 40, "y": y - 160, "duration": 100}
        browser._mouse({"type": "pointerMove", "x": x, "y": y}, *down)
        assert browser.js("return mdanim.stage.extras.hand.visible && mdanim.hand.held.object") == 1
        browser.until("mdanim.shown.object[12 + 8] > 0.08")  # it stood at 0.025 m
        browser._mouse({"type": "pointerUp", "button": 0})
        assert not browser.js("return mdanim.stage.extras.hand.visible || Boolean(mdanim.hand.held)") and eye() == before
        browser.drag(20, 200, 60, 20)
        assert eye() != before
        assert (tmp_path / "fall.out" / "hands.txt").read_text().count("hand plate {") == 1
    finally:
        while run.poll() is None:  # the run ends, then the view
            run.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                run.wait(0.5)
        run.stdout.close()


def test_the_page_in_a_cell_of_a_notebook(browser, tmp_path):
    """It plays there, and the notebook is out of its reach."""
    (tmp_path / "fall.txt").write_text(FALL)
    shown = Scene.load(tmp_path / "fall.txt").run(tmp_path / "fall.out").show(height=400)
    (tmp_path / "notebook.html").write_text(f"<!doctype html><title>mine</title>{shown._repr_html_()}")
    browser.go((tmp_path / "notebook.html").as_uri())
    browser.ask("POST", "/frame", {"id": 0})
    browser.until(f"{SHOWN} && mdanim.shown.frame > 2")
    assert browser.js("try { return parent.document.title } catch { return 'closed' }") == "closed"
    browser.ask("POST", "/frame", {"id": None})
    assert np.ptp(np.asarray(Image.open(io.BytesIO(browser.picture())).convert("L"))[50:350, 50:500]) > 60
