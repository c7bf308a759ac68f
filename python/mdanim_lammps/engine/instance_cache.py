# SPDX-License-Identifier: GPL-2.0-only
"""Instances that no bundle needs any more, kept to be filled anew, which takes a fifth of the time of making one."""

from __future__ import annotations

from .instance import SMALL, Instance
from .plan import Plan

MOST_INSTANCES = 6
"""Instances that are kept, of 3 MB or less each."""


class InstanceCache:
    """Unused instances, each of which may be taken out again for another plan."""

    def __init__(self):
        self.idle: list[Instance] = []

    def stock(self, plan: Plan) -> None:
        """Have as many as are kept, of a plan like those that will be asked for."""
        for _ in range(MOST_INSTANCES - len(self.idle) if plan.system.particles <= SMALL else 0):
            self.keep(Instance(plan))

    def instance(self, plan: Plan, comm=None) -> Instance:
        """An instance of a plan; arguments and errors as of `Instance`."""
        for instance in self.idle if comm is None else ():
            if instance.refill(plan):
                self.idle.remove(instance)
                return instance
        return Instance(plan, comm)

    def keep(self, instance: Instance) -> None:
        """Take one; it is closed if it cannot be filled anew, and the oldest beyond `MOST_INSTANCES` is."""
        if not instance.refillable:
            instance.close()
            return
        self.idle.append(instance)
        if len(self.idle) > MOST_INSTANCES:
            self.idle.pop(0).close()

    def close(self) -> None:
        """Close all."""
        while self.idle:
            self.idle.pop().close()
