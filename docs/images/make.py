# SPDX-License-Identifier: GPL-2.0-only
"""Make the pictures of README and docs: ``python docs/images/make.py [SCENE ...]`` (runs the scenes; default all); with the name
``tutorial`` those of docs/tutorial.md, with ``view`` that of the page, which needs Chromium."""

import io
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from mdanim_lammps import Scene, Trajectory
from mdanim_lammps.picture.movie import render_still
from mdanim_lammps.scene.render import Quality
from PIL import Image

HERE = Path(__file__).parent
SCENES = HERE.parent.parent / "scenes"
PICTURES = {
    "beam": 0.33,
    "drop": 0.5,
    "duck": 0.3,
    "crowd": 0.48,
    "float": 5.0,
    "densities": 4.0,
    "vessels": 0.3,
    "splash": 0.45,
    "cork": 0.45,
    "boat": 0.6,
    "dominoes": 1.1,
    "race": 1.4,
    "stairs": 0.88,
    "tower": 1.1,
    "cards": 1.0,
    "plates": 0.0,
    "billiard": 0.5,
    "cradle": 0.8,
    "pile": 1.2,
    "dam": 1.0,
    "ripples": 0.67,
    "slosh": 0.5,
    "swell": 3.0,
    "utube": 0.6,
    "wake": 0.8,
    "bottle": 0.9,
    "weir": 4.6,
    "henge": 0.5,
    "quake": 1.2,
    "spiral": 4.0,
    "bowling": 0.4,
    "jenga": 0.7,
    "arch": 2.4,
    "blocks": 1.0,
    "barge": 4.5,
    "tops": 0.5,
    "marbles": 1.6,
    "helter": 3.35,
    "shaker": 1.34,
    "conveyor": 1.7,
    "paddle": 1.67,
    "pegs": 0.7,
    "hammock": 2.0,
    "cloth": 0.9,
    "towel": 1.2,
    "rack": 0.8,
    "coil": 0.54,
    "hollow": 0.4,
    "hats": 0.4,
    "trampoline": 1.2,
    "bridge": 2.0,
    "pendulums": 1.4,
    "double": 1.1,
    "newton": 0.62,
    "crank": 0.3,
    "seesaw": 0.7,
    "buggy": 1.9,
    "van": 1.6,
    "basin": 3.3,
    "wrecking": 1.2,
    "windmill": 3.9,
    "parachute": 1.1,
    "glide": 0.55,
    "fall": 0.5,
    "slope": 0.7,
    "pendulum": 2.1,
    "chairs": 0.6,
    "catapult": 1.1,
    "swing": 7.8,
    "tackle": 0.8,
    "merry": 5.0,
    "drawbridge": 2.5,
    "marble_lift": 2.3,
    "flag": 0.5,
    "tumblers": 1.0,
    "buoys": 4.0,
    "balls": 0.4,
    "mattress": 0.27,
    "pop": 0.2,
    "paper": 0.3,
    "biscuit": 0.26,
    "wall": 0.36,
    "shatter": 0.5,
}
"""Scene and the moment to show [s]."""
STEPS = {"falls": 0.0, "stands": 1.0, "pushed": 0.27, "rolls": 0.5, "splashes": 0.4, "show": 0.3}
"""Scene of each step of the tutorial and the moment to show [s]."""
SIZE = (720, 405)
"""Two beside each other in the gallery; no file is larger than 210 kB."""
PAGE = (1280, 940)
"""Of the browser's window."""


def view() -> None:
    """Write the picture of the page: beam.txt with the cube picked."""
    sys.path.insert(0, str(SCENES.parent / "tests" / "lab"))
    from browser import Browser

    with tempfile.TemporaryDirectory() as folder:
        Scene.load(SCENES / "beam.txt").run(folder, force=True)
        server = subprocess.Popen([sys.executable, "-m", "mdanim_lammps.view", folder], stdout=subprocess.PIPE, text=True)
        browser = Browser(*PAGE)
        try:
            browser.go(server.stdout.readline().split()[0])
            browser.until("window.mdanim && mdanim.shown")
            browser.js("mdanim.player.go(25)")
            browser.until("mdanim.shown.frame == 25 && !mdanim.stage.changed && mdanim.stage.level == 0")
            box = browser.js("const b = document.getElementById('stage').getBoundingClientRect(); return [b.left, b.top]")
            x, y = browser.js(
                "const o = mdanim.shown.object.subarray(18), p = mdanim.stage.camera.position.clone().set(o[0], o[1], o[2])"
                ".project(mdanim.stage.camera), c = mdanim.stage.renderer.domElement;"
                "return [(p.x + 1) / 2 * c.clientWidth, (1 - p.y) / 2 * c.clientHeight]"
            )
            browser.click(box[0] + x, box[1] + y)
            browser.until("document.querySelector('#height-line canvas')")
            time.sleep(1.0)  # until the picture is drawn in full
            picture = Image.open(io.BytesIO(browser.picture())).convert("RGB")
        finally:
            browser.close()
            server.terminate()
            server.wait()
    picture.save(HERE / "view.png", optimize=True)
    print(HERE / "view.png")


def tutorial() -> None:
    """Write the pictures of docs/tutorial.md from the scenes that stand there."""
    page = (HERE.parent / "tutorial.md").read_text(encoding="utf-8")
    found = re.findall(r"^```\n((?:(?!```).)*?control \{.*?)^```.*?[Ss]ave it as `(\w+)\.txt`", page, flags=re.S | re.M)
    for step, (text, name) in enumerate(found, 1):
        picture(Scene.from_text(text, name), STEPS[name], HERE / f"tutorial-{step}.webp", (480, 270))


def picture(scene: Scene, moment: float, path: Path, size: tuple[int, int]) -> None:
    """Run a scene and write a picture (PNG, or WebP, which is a tenth as large) of the frame that is nearest to a moment [s]."""
    with tempfile.TemporaryDirectory() as folder:
        scene.run(folder, force=True)
        with Trajectory(folder) as trajectory:
            frame = int(abs(trajectory.times - moment).argmin())
            drawn, render = Path(folder) / "picture.png", replace(scene.record.render, quality=Quality.FINAL)
            render_still(trajectory, frame, drawn, render, size=size)
        Image.open(drawn).save(path, optimize=True, quality=85)
    print(path, flush=True)


def main(names: list[str]) -> None:
    """Write one picture per scene beside this file."""
    pages = {"view": view, "tutorial": tutorial}
    if len(names) == 1 and names[0] in pages:
        pages[names[0]]()
        return
    for name in names or PICTURES:
        picture(Scene.load(SCENES / f"{name}.txt"), PICTURES[name], HERE / f"{name}.png", SIZE)


if __name__ == "__main__":
    main(sys.argv[1:])
