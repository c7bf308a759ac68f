# SPDX-License-Identifier: GPL-2.0-only
"""Who bears what: the force that each fix of contact exerts on an object, from what is missing without it."""

from __future__ import annotations

import numpy as np
from mdanim_lammps.engine.instance import Instance


def borne(instance: Instance, solid: int) -> dict[str, np.ndarray]:
    """Force of each fix of the plan's effects that push back on a solid as it is now [N], by the fix's ID, each of shape (3,).

    Dashpots of contact are left out, as at every setup. The instance is of no use afterwards: its fixes are gone.
    """
    system = instance.plan.system
    mine = slice(system.first[solid], system.first[solid + 1])

    def force() -> np.ndarray:
        instance.setup()
        return np.where(system.held[mine, None], 0.0, instance.array("f")[mine]).sum(0)

    found, before = {}, force()
    for fix in (fix for effect in instance.plan.effects if effect.ledger in ("contact", "wall") for fix in effect.fixes):
        instance._command(f"unfix {fix}")
        after = force()
        found[fix], before = before - after, after
    return found
