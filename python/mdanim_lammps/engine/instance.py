# SPDX-License-Identifier: GPL-2.0-only
"""A live LAMMPS instance of a plan: particles put in as arrays, state and energies read back as arrays."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

import numpy as np

from ..effects.fields import Field
from ..errors import SetupError
from .c_arrays import body_arguments
from .columns import from_records, spread, to_records, values_of_pairs
from .commands import BALANCE, SKIN, bond_coeffs, box, physics, prelude, table_file
from .cut import box_to_cut, shorter_along_rows
from .lines_of_scene import run_lines_of_scene
from .opened_lammps import OpenedLammps
from .outputs import output_place, output_rows
from .particle_arrays import ParticleArrays
from .plan import Ends, Plan
from .state import NO_RECORDS, Records, State, StateRecords
from .threads import asked_threads, choose_threads, share_of_cores
from .trace import Trace

MANY = 20_000
"""Particles from which on what making them has left free in the heap goes back to the system: 100 to 400 bytes each."""
GLOBAL, SCALAR, VECTOR = 0, 0, 1  # LAMMPS's constants for extract_fix


class Instance:
    """LAMMPS holding all particles of a plan, in tag order where it runs on one process. Use as a context manager.

    On a communicator of several ranks all of them call all methods together, with the same arguments, and all get the same
    answers; each holds the particles of its part of space. Every number of a State is the same on any number of ranks, to the
    last bit; energies are sums over particles and agree but for rounding, those that dashpots take to about 1e-3
    (plugin/passes/loss.h). When LAMMPS stops on one rank only, the error is raised there alone, and the other ranks wait for
    ever: the caller must abort them.
    """

    context = property(lambda self: self.plan.context)
    system = property(lambda self: self.plan.system)

    def __init__(self, plan: Plan, comm=None):
        """``comm`` is an mpi4py communicator; None is this process alone. Raises SetupError."""
        self.plan = plan
        if comm is not None and comm.Get_size() > 1 and not plan.system.particles:
            raise SetupError("ranks share space by its particles, and the plan has none: run it on one process")
        self.lammps = OpenedLammps(comm)
        self._comm = self.lammps.comm
        self.particles = ParticleArrays(self.lammps, plan)
        self.trace = Trace(self.lammps, len(plan.system.names))
        try:
            self._fill()
        except BaseException as error:
            self.close()
            if type(error).__name__ in ("Exception", "MPIAbortException"):  # of LAMMPS
                raise SetupError(f"LAMMPS does not take this scene: {error}") from error
            raise
        if plan.system.particles >= MANY:
            self.lammps.lmp.lib.malloc_trim(ctypes.c_size_t(0))  # of the C library, among the symbols that come with LAMMPS

    def __enter__(self) -> Instance:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def close(self) -> None:
        """End the instance; harmless when called twice."""
        self.lammps.close()

    def _fill(self) -> None:
        plan, lmp = self.plan, self.lammps.lmp
        places = shorter_along_rows(plan.system.position) if self._comm else plan.system.position
        low, high = (box_to_cut(places, plan.spacing) if self._comm else box(plan)).tolist()
        # property/atom must exist before the particles, and a box before both.
        ends = self._ends()
        room = f" extra/bond/per/atom {max(plan.slots, np.diff(ends.first).max())}" if ends else ""
        bounds = " ".join(f"{a!r} {b!r}" for a, b in zip(low, high))
        lmp.commands_list(
            [
                *prelude(plan),
                f"region box block {bounds}",
                f"create_box 8 box bond/types {len(plan.coefficients)}{room}" if len(plan.bonds) else "create_box 8 box",
            ]
        )
        self.particles.insert(ends, places)
        if len(plan.bonds):
            if not ends:
                springs = [np.ascontiguousarray(a, np.int32) for a in (plan.bonds, plan.bond_kind)]
                what, count = f"take {len(plan.bonds)} springs", ctypes.c_int(len(plan.bonds))
                self.lammps.call(what, "mdanim_give_springs", count, *springs)
            lmp.commands_list([f"bond_coeff {row}" for row in bond_coeffs(plan)])
        if self._comm:  # before there are fixes, which would take what is shorter along rows for the places of objects
            self.particles.cut_space(plan.system.position)
        threads = asked_threads() or choose_threads(plan, share_of_cores(self._comm)).threads
        with tempfile.TemporaryDirectory(prefix="mdanim-") if plan.tables else nullcontext("") as folder:
            for name, text in plan.tables.items():  # the first rank reads them for all
                Path(folder, table_file(plan, name)).write_text(text, encoding="ascii")
            lmp.commands_list(physics(plan, threads, f"{folder}/"))
        for fix in plan.body_fixes:
            for kind, body in plan.contact_bodies.items():
                self.lammps.call(f"give body {kind} to fix {fix}", "mdanim_contact_body", fix, *body_arguments(kind, body))
        if self._comm:
            lmp.command(BALANCE[1])
        # The springs' energy is all that is asked for; while there is a compute of the pressure, their virial is worked
        # out with it.
        lmp.commands_list(
            [
                f"thermo {max(1, plan.certificate.steps_per_frame)}",
                f"thermo_style custom step{' ebond' if len(plan.bonds) else ''}",
                "thermo_modify norm no",
                "uncompute thermo_press",
            ]
        )
        if plan.scene.lammps:
            run_lines_of_scene(self.lammps, plan)

    def _ends(self) -> Ends | None:
        """Springs for particles to have: None on one process, where the bond style takes them as they are; of several, each needs
        those of its own particles at both ends, and so do columns of springs."""
        plan = self.plan
        return plan.ends() if (self._comm or plan.slots) and len(plan.bonds) else None

    # --- running --------------------------------------------------------------------------------------------------

    def setup(self) -> None:
        """Compute the forces of the state as it is; to be called once before `run`."""
        self._command("run 0 post no")
        if not self._comm and not np.array_equal(self.particles.local("id", 1), np.arange(1, self.plan.system.particles + 1)):
            raise SetupError("LAMMPS reordered the particles; 'atom_modify sort 0 0' was not obeyed")

    def run(self, steps: int) -> None:
        """Advance by this many steps without recomputing forces: pieces of any length give the bits of one long run.

        Raises DivergedError with LAMMPS's own words when a run breaks down.
        """
        self.lammps.command(f"thermo {steps}")
        self._command(f"run {steps} pre no post no")

    def _command(self, command: str) -> None:
        self.particles.forget()
        self.lammps.command(command)

    # --- state ----------------------------------------------------------------------------------------------------

    @property
    def step(self) -> int:
        """Number of the step."""
        return self.lammps.step

    def array(self, name: str) -> np.ndarray:
        """`ParticleArrays.array`."""
        return self.particles.array(name)

    def column(self, name: str) -> np.ndarray:
        """`ParticleArrays.column`."""
        return self.particles.column(name)

    def pairs(self, fix: str, field: Field) -> np.ndarray:
        """Values that a fix keeps for pairs of objects, see `values_of_pairs`. Raises SetupError."""
        return values_of_pairs(self.lammps.records_of(fix), field)

    def state(self) -> State:
        """A copy of the state."""
        x, v, f = (a.copy() for a in map(self.array, "xvf"))
        return State(x, v, f, self.records())

    def records(self) -> dict[str, StateRecords]:
        """Records of fixes, by the ID of the fix; objects are numbered as in the plan."""
        found = {fix: self.lammps.records_of(fix) for fix in self.lammps.stateful()}
        if states := self.plan.states:
            found |= to_records(self.plan, {name: self.column(name) for name in states})
        return found

    def _put_records(self, records: Records) -> None:
        for name in self.plan.states:
            self.particles.put_column(name, spread(self.plan, name, from_records(self.plan, name, records)))
        for fix in self.lammps.stateful():
            self.lammps.put_records(fix, records.get(fix, NO_RECORDS))

    def put(self, step: int, state: State) -> None:
        """Take up a state bit for bit, at any time and as often as wanted; then `run` goes on from it.

        Energies that were lost before stay in their accounts: a caller that takes back steps must compare them from here on.
        Raises SetupError when a fix refuses its records, as the liquid does those of another grid, ValueError when the number of
        particles is another.
        """
        n = self.plan.system.particles
        for name, array in (("x", state.x), ("v", state.v), ("f", state.f)):
            if array.shape != (n, 3):
                raise ValueError(f"{name} of the state has the shape {array.shape}, the plan has {n} particles")
        self._command(f"reset_timestep {step}")
        if self._comm:
            # A particle may be far from the rank that holds it now, farther than LAMMPS's own exchange reaches.
            self._command("delete_atoms group all compress no")
            places = shorter_along_rows(state.x)
            sides = zip("xyz", *box_to_cut(places, self.plan.spacing).tolist())
            self._command("change_box all " + " ".join(f"{d} final {low!r} {high!r}" for d, low, high in sides) + " units box")
            self.particles.insert(self._ends(), places)
            for command in physics(self.plan):
                if command.startswith("group "):  # the new particles are in none yet
                    self._command(command)
            self.particles.cut_space(state.x)
        else:
            self.array("x")[:] = state.x
        self.particles.write("v", state.v)
        self._put_records(state.records)
        self.setup()
        self.particles.write("v", state.v)
        self.particles.write("f", state.f)

    def lay_aside(self, solids: Sequence[int]) -> None:
        """Take these solids of the plan out of the simulation, without a new setup: from now on they stand as in the plan, at
        rest; they exert no forces and feel none. This cannot be undone, and works only on one process."""
        system = self.plan.system
        # No fix acts on atoms that are in group "all" only. Their springs are as long as in the plan and hold no energy. A
        # displacement of more than the skin makes LAMMPS build its neighbour lists anew before the next forces.
        (x, v, f), mask = map(self.array, "xvf"), self.particles.local("mask", 1)
        for rows in system.stretches(solids):
            place = system.position[rows]
            if (np.abs(place - x[rows]).max(1) < 2.0 * SKIN * self.plan.spacing).any():
                place = place + 4.0 * SKIN * self.plan.spacing
            x[rows], v[rows], f[rows], mask[rows] = place, 0.0, 0.0, 1

    def call(self, what: str, function: str, fix: str, *arguments) -> None:
        """Call a C function of the plugin that asks a fix; arrays are given as pointers. Raises SetupError with its message."""
        self.lammps.call(what, function, fix, *arguments)

    def fix_scalar(self, fix: str) -> float:
        """Energy of a fix [J]."""
        return float(self.lammps.lmp.extract_fix(fix, GLOBAL, SCALAR))

    def fix_value(self, fix: str, entry: str | int) -> float:
        """Entry of a fix's vector, by its name on the page of the fix or its place from 0. Raises SetupError for another name."""
        place = entry if isinstance(entry, int) else output_place(self.lammps.library, self.lammps.handle, fix, entry)
        return float(self.lammps.lmp.extract_fix(fix, GLOBAL, VECTOR, place))

    def fix_rows(self, fix: str, rows: int, columns: int) -> np.ndarray:
        """The first rows of a fix's array, shape (rows, columns). Raises SetupError where it has no such array."""
        return output_rows(self.lammps.library, self.lammps.handle, fix, rows, columns)

    def elastic_energy(self) -> float:
        """Energy of all springs [J], at the last step of a `run` or after `setup`."""
        return float(self.lammps.lmp.get_thermo("ebond")) if len(self.plan.bonds) else 0.0

    def kinetic_energy(self) -> float:
        """Kinetic energy of all that can move [J], at the last step; corrected as docs/fix_mdanim_leapfrog.md says."""
        return self.fix_value("leapfrog", "kinetic")

    def fix_seconds(self, fix: str) -> float:
        """Wall seconds of one of our fixes so far."""
        return self.fix_value(fix, "seconds")

    def bond_seconds(self) -> float:
        """Wall seconds of the springs so far, of the slowest rank."""
        here = float(self.lammps.library.mdanim_bond_seconds(self.lammps.handle))
        return max(self._comm.allgather(here)) if self._comm else here

    def damping_loss(self) -> float:
        """Energy that dashpots have taken so far [J]."""
        return self.lammps.total(float(self.lammps.library.mdanim_bond_lost(self.lammps.handle)))
