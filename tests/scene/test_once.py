# SPDX-License-Identifier: GPL-2.0-only
"""Results that are found once for each scene."""

import gc
import weakref
from dataclasses import replace

from mdanim_lammps.scene.once import once_for
from mdanim_lammps.scene.parse import parse_scene

TEXT = "object ball { shape sphere 5 cm  position (0, 0, 1) m  mass 1 kg  elasticity 1 MPa }\ncontrol { time 1 s }\n"


def test_a_result_is_found_once_for_each_owner_and_goes_with_it():
    """An equal scene is another owner, further arguments count by their values, and nothing keeps a scene alive."""
    asked = []

    @once_for(lambda scene, plane="": scene)
    def names(scene, plane=""):
        """Names with a plane."""
        asked.append(plane)
        return [solid.name + plane for solid in scene.solids]

    scene = parse_scene(TEXT)
    other = replace(scene)
    assert scene == other and names(scene) is names(scene) and names(scene) is not names(other)
    assert names(scene, "ground") == ["ballground"] and names.__doc__ == "Names with a plane."
    assert asked == ["", "", "ground"]
    gone = weakref.ref(scene)
    del scene
    gc.collect()
    assert gone() is None and names(other) == ["ball"] and len(asked) == 3
