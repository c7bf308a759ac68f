# SPDX-License-Identifier: GPL-2.0-only
"""All that the program says and does about the feature of features/windy: ``python windy.py FOLDER`` prints it as JSON.

A program of its own, as features are found when the package is imported.
"""

import json
import os
import sys
from pathlib import Path

os.environ["MDANIM_FEATURES"] = str(Path(__file__).parent / "features" / "windy")

import numpy as np
from mdanim_lammps.engine.commands import input_script
from mdanim_lammps.engine.data_file import data_text
from mdanim_lammps.errors import DivergedError
from mdanim_lammps.report import check_json, scene_lines
from mdanim_lammps.results.trajectory import Trajectory
from mdanim_lammps.run.guard import Guard
from mdanim_lammps.run.loop import simulate, write_inputs
from mdanim_lammps.run.observe import Observer
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.explain import explain
from mdanim_lammps.scene.keywords import KEYWORDS
from mdanim_lammps.scene.lock import lock_text
from mdanim_lammps.scene.page import language_page
from mdanim_lammps.scene.parse import parse_scene
from mdanim_lammps.study.setting import ladders, own_setting, scene_hash, with_setting

SCENE = """
{words}
object a {{ shape box (30, 30, 30) cm position (-2, 0, 0) m density 1000 elasticity 1 MPa velocity ({v}, 0, 0) m/s }}
object b {{ shape box (30, 30, 30) cm position (2, 0, 0) m density 1000 elasticity 1 MPa hold all }}
control {{ time 0.2 s frames 100 fps resolution 10 cm }}
"""
WIND = "wind (3, 0, 0) m/s\nexpect wind.work = 4.86 J +- 0.001 J"


def ready(words: str = WIND, v: float = 0.0):
    """A scene that is prepared."""
    return prepare(parse_scene(SCENE.format(words=words, v=v)))


def words() -> dict:
    """Words of the language."""
    scene = ready().scene
    return {
        "page": language_page(),
        "explained": [explain(word) for word in ("wind", "wind.work", "gust")],
        "of objects": list(KEYWORDS["object"]),
        "read back": parse_scene(lock_text(scene), scene.name).wind,
    }


def told() -> dict:
    """By check, and to LAMMPS."""
    here, off, calm = ready(), ready(WIND.partition("\n")[0] + "\neffects { wind off }"), ready("", v=-20)
    c = here.certificate
    return {
        "check": check_json(here)["effects"]["wind"],
        "lines": scene_lines(here),
        "certificate": {"cause": c.cause, "share": c.share, "bound": c.bound, "timestep": c.timestep},
        "margins": [m.name for m in c.margins],
        "warnings": [w.message for w in here.warnings],
        "script": input_script(here.plan),
        "data": "".join(data_text(here.plan)),
        "unit": here.plan.fields["sail"].unit,
        "off": [off.verdicts["wind"].on, off.verdicts["wind"].reason, [w.message for w in off.warnings]],
        "calm": [calm.verdicts["wind"].on, calm.verdicts["contact"].on, calm.certificate.cause, "sail" in calm.plan.columns],
        "may come back": ready(v=-20).verdicts["contact"].on,
    }


def run(folder: Path) -> dict:
    """Its account, its quantity and its field."""
    here = ready()
    folder.mkdir()
    write_inputs(here, folder)
    result = simulate(here, folder)
    wind, row = result.ledger.array("wind"), result.ledger.rows[0]
    with Trajectory(folder) as trajectory:
        force = [trajectory.field("wind_force", frame).tolist() for frame in (0, len(trajectory) - 1)]
        (field,) = trajectory.metadata.fields
        kept = trajectory.wind
    return {
        "terms": result.ledger.terms,
        "residual": result.ledger.residual,
        "potential": np.ptp(wind),
        "mass": here.system.mass_of[0],
        # A joule too much.
        "joule": result.ledger.weigh(0.2, row | {"kinetic": row["kinetic"] + 1.0})["residual"],
        "kinetic": row["kinetic"],
        "expect": [[o.found, bool(o.met)] for o in result.outcomes],
        "force": force,
        "unit": field.unit,
        "kept": kept,
        "summary": json.loads((folder / "summary.json").read_text())["effects"],
        "cost": list(result.cost.effects),
    }


def drawn(folder: Path) -> dict:
    """Its pictures of the first and the last frame, and where its arrow is in exports."""
    from mdanim_lammps.export.cut import Cut
    from mdanim_lammps.export.write import export
    from mdanim_lammps.picture.render import Painter
    from picture_measures import SIZE, project
    from PIL import Image

    found = {"seen": [], "size": SIZE}
    with Trajectory(folder) as trajectory, Painter(trajectory, size=SIZE) as painter:
        middle, cut = trajectory.centers[:, 0], Cut(trajectory, (), 1, slice(None))
        for frame in (0, len(trajectory) - 1):
            Image.fromarray(painter.frame(frame)).save(folder / f"wind-{frame}.png")
            pole = middle[frame] + np.array([(0.0, 0.0, 0.15), (0.0, 0.0, 0.5)])
            places = [project(painter.view(0.0), of, SIZE[0] / SIZE[1])[0].tolist() for of in (cut.surfaces(frame)[-1][0], pole)]
            found["seen"].append([str(folder / f"wind-{frame}.png"), *places])
        found["bodies"] = [body.name for body in cut.bodies]
        found["arrow"] = [(cut.surfaces(frame)[-1][0] - middle[frame]).max(axis=0).tolist() for frame in (0, len(trajectory) - 1)]
        found["some"] = [body.name for body in Cut(trajectory, ("b",), 1, slice(None)).bodies]
    found["files"] = [export(folder, to).files[0].name for to in ("usd", "gltf", "vtk")]
    return found


def varied() -> dict:
    """By a study."""
    here = ready(WIND + "\nlulls 2")
    own = own_setting(here.scene, here)
    found, _ = ladders(here.scene, here, own)
    return {
        "ladders": {ladder.name: [str(s) for s in ladder.settings] for ladder in found},
        "sizes": [ladder.step(s) for ladder in found if ladder.name == "lulls" for s in ladder.settings],
        "key": own.key,
        "put": [with_setting(here.scene, s).lulls for ladder in found if ladder.name == "lulls" for s in ladder.settings],
        "same": scene_hash(here.scene) == scene_hash(ready().scene),
        "calm": ladders(ready("").scene, ready(""), own)[1]["lulls"],
    }


def left(folder: Path) -> str:
    """Message of the guard for an object beyond the fence."""
    guard = Guard(ready(), folder)
    x = guard.ready.system.position.copy()
    x[guard.ready.system.object == 0, 0] -= 10.0
    try:
        guard.check(1, Observer(guard.ready.plan, ()).observe(np.arange(2), np.arange(2), x, np.zeros_like(x)))
    except DivergedError as error:
        return str(error)
    return ""


if __name__ == "__main__":
    home = Path(sys.argv[1])
    made = {"words": words(), "told": told(), "run": run(home / "windy.out"), "left": left(home), "varied": varied()}
    print(json.dumps(made | {"drawn": drawn(home / "windy.out")}))
