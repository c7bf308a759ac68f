# SPDX-License-Identifier: GPL-2.0-only
"""Make the stored states: ``python tests/plugin/records/make_states.py [SCENE ...]``, all without names.

Each scene is run into the middle of what happens in it, and positions, velocities, forces and all records of fixes are stored in
states.npz. Make them again only when the contents of a record are meant to change, and only the scenes that hold such a record:
its version has to change too, as checkpoints and restart files of users hold the same bytes.
"""

import sys
from pathlib import Path

import numpy as np

FILE = Path(__file__).parent / "states.npz"
SOLIDS = """
gravity (0, 0, -9.81)
ground z 0 m
object a {
  shape box (3, 3, 2) cm position (0, 0, 1.05) cm density 1000 elasticity 0.2 MPa damping 0.1 friction 0.3 velocity (0.2, 0, -1)
}
object b { shape box (2, 2, 2) cm position (0.3, 0, 3.1) cm density 900 elasticity 0.2 MPa friction 0.3 velocity (0, 0.1, -2) }
object c { shape box (2, 2, 2) cm position (0.3, 0, 6.1) cm density 600 elasticity 0.2 MPa velocity (0, 0, -8) }
"""
LIQUID = """
liquid w { basin from (-5, -4, 0) cm to (5, 4, 12) cm density 1000 level 5 cm MODEL }
"""
END = "control { time 1 s resolution 1 cm }\n"
WAVES = "drag 1 model waves drops 1 wave -x amplitude 1 cm period 0.4 s"
PRESSED, SPLASHED = 0.005, 0.03
"""Seconds: the lowest box is pressed to the ground, the second one to it; drops of the third one fly."""
SCENES = {
    "solids": (SOLIDS + END, PRESSED),
    "waves": (SOLIDS + LIQUID.replace("MODEL", WAVES) + END, PRESSED),
    "drops": (SOLIDS + LIQUID.replace("MODEL", WAVES) + END, SPLASHED),
    "surface": (SOLIDS + LIQUID.replace("MODEL", "drag 1 model surface") + END, PRESSED),
    "paper": (SOLIDS + LIQUID.replace("MODEL", "model paper") + END, PRESSED),
}


def plan_of(name: str):
    """The plan of a scene."""
    from mdanim_lammps.run.prepare import prepare
    from mdanim_lammps.scene.parse import parse_scene

    return prepare(parse_scene(SCENES[name][0])).plan


def main(names: list[str]) -> None:
    """Run these scenes and store their states; those of others stay as they are."""
    from mdanim_lammps.engine.instance import Instance

    stored = {key: array for key, array in np.load(FILE).items() if key.split()[0] not in names} if FILE.exists() else {}
    for name in names:
        seconds = SCENES[name][1]
        with Instance(plan := plan_of(name)) as instance:
            instance.setup()
            instance.run(round(seconds / plan.certificate.timestep))
            state = instance.state()
            stored |= {f"{name} step": instance.step} | {f"{name} {what}": getattr(state, what) for what in "xvf"}
            for fix, records in state.records.items():
                stored |= {f"{name} {fix} {what}": getattr(records, what) for what in ("keys", "first", "data")}
    np.savez_compressed(FILE, **stored)


if __name__ == "__main__":
    main(sys.argv[1:] or list(SCENES))
