# SPDX-License-Identifier: GPL-2.0-only
"""Outputs of fixes have names, which are those of the lists on their pages."""

import re

import pytest
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.engine.outputs import output_names, output_place
from mdanim_lammps.errors import SetupError
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import parse_scene
from paths import REPOSITORY

SCENE = """
gravity (0, 0, -9.81)
walls from (-20, -20, -2) cm to (20, 20, 40) cm
object a {{ shape box (4, 4, 4) cm position (0, 0, 6) cm density 500 elasticity 0.2 MPa }}
object b {{ shape box (4, 4, 4) cm position (0, 0, 11) cm density 500 elasticity 0.2 MPa }}
liquid w {{ basin from (-10, -10, 0) cm to (10, 10, 20) cm density 1000 level 6 cm }}
control {{ time 1 s resolution 1 cm contact-model {} }}
"""


def on_page(style: str) -> list[str]:
    """Names on the page of a style, in their order."""
    text = (REPOSITORY / "docs" / f"fix_{style.replace('/', '_')}.md").read_text()
    if style == "mdanim/gravity":
        return ["work", "seconds"] if "two entries: `work`" in text and "and `seconds`" in text else []
    block = text[text.index("The vector has") :].split("\n\n")[1]
    found = re.findall(r"^\d+\. (?:– \d+\. )?((?:`\w+` ?)+):", block, re.M)
    return re.findall(r"\w+", " ".join(found))


@pytest.mark.parametrize("model", ["paper", "surface"])
def test_names_are_those_of_the_pages(model):
    """Names of each fix of a scene are in the order of its vector; a name finds its entry."""
    with Instance(prepare(parse_scene(SCENE.format(model))).plan) as instance:
        instance.setup()
        seen = set()
        for command in instance.lammps.lmp.available_ids("fix"):
            names = output_names(instance.lammps.library, instance.lammps.handle, command)
            if not names:
                continue
            place = output_place(instance.lammps.library, instance.lammps.handle, command, names[-1])
            assert place == len(names) - 1 == int(instance.lammps.lmp.extract_fix(command, 0, 3)) - 1
            assert instance.fix_value(command, "seconds") == instance.fix_value(command, names.index("seconds")) >= 0.0
            page = next(s for s in STYLES if names == on_page(s))
            seen.add(page)
        assert seen == STYLES - ({"mdanim/contact"} if model == "paper" else {"mdanim/wall"})
        with pytest.raises(SetupError, match="fix leapfrog has no output heat; it has phi, kinetic, seconds"):
            instance.fix_value("leapfrog", "heat")


STYLES = {f"mdanim/{name}" for name in ("barrier", "contact", "gravity", "leapfrog", "liquid", "wall")}
