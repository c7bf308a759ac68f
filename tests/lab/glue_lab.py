# SPDX-License-Identifier: GPL-2.0-only
"""Bars of cubes that are glued together in fix mdanim/rigid."""

from itertools import pairwise

import numpy as np
import rigid_lab as lab

DENSITY, EDGE = 600.0, 0.1


def bar(pieces, spin=(0, 0, 0), v=(0, 0, 0), at=(0, 0, 0), q=(1, 0, 0, 0)):
    """Cubes in a row along the first axis, which move as one body."""
    turn, found = lab.matrix(np.asarray(q, float)), []
    for n in range(pieces):
        arm = turn @ ((n - (pieces - 1) / 2) * EDGE, 0.0, 0.0)
        place = {"at": np.add(at, arm), "q": q, "v": np.asarray(v) + np.cross(spin, arm), "spin": spin}
        found.append(lab.box((EDGE,) * 3, DENSITY, **place))
    return found


def glue_file(folder, bodies, strength):
    """Glues each cube to the next one; the sides -x and +x of a box are the first two."""
    second, section = EDGE**4 / 12, EDGE**3 / 6
    lines = []
    for n, (a, b) in enumerate(pairwise(bodies), 1):
        turn, middle = lab.matrix(a.q), (a.at + b.at) / 2
        numbers = [strength, EDGE**2, second, second, section, section, 2 * section, *middle, *turn[:, 0], *turn[:, 1]]
        lines.append(f"{n} {n + 1} 1 0 " + " ".join(repr(float(x)) for x in numbers))
    (folder / "glue").write_text("\n".join(lines) + "\n")
    return f"glue {folder}/glue"


def world(folder, bodies, strength, beside=(), **more):
    """An instance with these cubes, and other bodies beside them."""
    more = {"planes": [], "gravity": (0, 0, 0), "frequency": 2e3} | more
    return lab.World(folder, [*bodies, *beside], words=glue_file(folder, bodies, strength), **more)
