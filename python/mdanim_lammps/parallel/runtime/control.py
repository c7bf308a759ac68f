# SPDX-License-Identifier: GPL-2.0-only
"""Control of a run: by the supervisor for all executors (central control), or by every executor alike (peers). Wcislo 1999, sec.
6.2 and 6.3."""

from __future__ import annotations

from typing import Protocol

from mpi4py import MPI

from ...engine.sub_plan import SubPlans
from ..plan.orders import Order, Report
from ..plan.planner import Planner
from .messages import SUPERVISOR, Job, Mail, Tag


class Controller(Protocol):
    """How an executor learns what to do next."""

    def decide(self, report: Report) -> Order:
        """Tell what has been, and wait for what is to come. Raises Aborted, DivergedError."""


class Central:
    """Reports go to the supervisor, which orders."""

    def __init__(self, mail: Mail):
        self.mail = mail

    def decide(self, report):
        self.mail.send(SUPERVISOR, Tag.REPORT, report)
        return self.mail.take(Tag.ORDER)


class Peers:
    """Reports go to all executors, and each decides; that they decide alike is checked with the next reports."""

    def __init__(self, mail: Mail, comm: MPI.Comm, planner: Planner):
        self.mail, self.comm, self.planner = mail, comm, planner

    def decide(self, report):
        return self.planner.decide(self.mail.exchange(self.comm, report))


def make_control(job: Job, parts: SubPlans, mail: Mail, comm: MPI.Comm) -> Controller:
    """The control that a job asks for, on the communicator of its executors."""
    return Central(mail) if job.control == "central" else Peers(mail, comm, planner_of(job, parts, comm.size))


def planner_of(job: Job, parts: SubPlans, executors: int) -> Planner:
    """The planner with which a job begins, or goes on."""
    return Planner(parts, executors, job.lengths, job.settings, job.resume.frame if job.resume else 0)
