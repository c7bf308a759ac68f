# SPDX-License-Identifier: GPL-2.0-only
"""Records behave as dataclasses of the standard library, and compile nothing before they are used."""

import dataclasses
import inspect
import pickle
import re
from pathlib import Path
from typing import Any, get_type_hints

import mdanim_lammps
import numpy as np
import pytest
from mdanim_lammps import records
from mdanim_lammps.cli.options import Executing

ROOT = Path(mdanim_lammps.__file__).parent


def kinds(decorate: Any) -> list[type]:
    """Records of all kinds, by one decorator or the other."""

    @decorate(frozen=True, slots=True)
    class Point:
        """Two fields."""

        x: float
        y: float = 2.0

        def __post_init__(self) -> None:
            if self.x < 0.0:
                raise ValueError("negative")

    @decorate(frozen=True, slots=True)
    class Named(Point):
        """With further fields."""

        names: list = dataclasses.field(default_factory=list)
        mark: int = dataclasses.field(default=3, compare=False, kw_only=True)
        secret: int = dataclasses.field(default=0, repr=False, hash=False)

    @decorate(frozen=True, kw_only=True)
    class Words:
        """By name alone."""

        a: int
        b: tuple = ()

    @decorate
    class Changing:
        """Not frozen, with a field that is not given."""

        a: int
        b: list = dataclasses.field(init=False, default_factory=list)
        c: int = dataclasses.field(init=False)

    @decorate(frozen=True, slots=True, eq=False)
    class Same:
        """Equal to itself alone."""

        a: int

    @decorate(frozen=True)
    class Own:
        """With methods of its own."""

        a: int

        def __repr__(self) -> str:
            return "own"

        def __eq__(self, other: object) -> bool:
            return isinstance(other, Own)

        def __hash__(self) -> int:
            return 7

    return [Point, Named, Words, Changing, Same, Own]


MADE = {
    "Point": [((1.0,), {}), ((1.0, 3.0), {}), ((), {"y": 1, "x": 0}), ((-1.0,), {}), ((), {}), ((1, 2, 3), {}), ((1,), {"z": 0})],
    "Named": [((1.0,), {}), ((1.0, 2.0, [3]), {"mark": 5, "secret": 6}), ((1.0, 2.0), {"mark": 4}), ((1, 2, 3, 4, 5), {})],
    "Words": [((), {"a": 1}), ((), {"a": 1, "b": (2,)}), ((1,), {})],
    "Changing": [((1,), {}), ((1, []), {})],
    "Same": [((1,), {}), ((1,), {})],
    "Own": [((1,), {}), ((2,), {})],
}


def told(call: Any) -> Any:
    """The value that a call gives, or the type and the words of its error."""
    try:
        return call()
    except Exception as error:
        return type(error), re.sub(r"<locals>\.|\w+\.<", "", str(error))


@pytest.mark.parametrize(("ours", "standard"), [*zip(kinds(records.dataclass), kinds(dataclasses.dataclass))], ids=list(MADE))
def test_records_are_as_the_standard_librarys(ours, standard):
    assert str(inspect.signature(ours)) == str(inspect.signature(standard))
    assert [f.name for f in dataclasses.fields(ours)] == [f.name for f in dataclasses.fields(standard)]
    found = []
    for of in (ours, standard):
        made = [told(lambda a=args, k=named, of=of: of(*a, **k)) for args, named in MADE[of.__name__]]
        of_kind = [r for r in made if isinstance(r, of)]
        found.append(
            (
                [told(lambda r=r: repr(r)) for r in made],
                [told(lambda a=a, b=b: a == b) for b in of_kind for a in of_kind],
                [told(lambda r=r: hash(r)) for r in of_kind if of.__name__ != "Same"],
                [told(lambda r=r: setattr(r, dataclasses.fields(r)[0].name, 1)) for r in of_kind],
                [told(lambda r=r: delattr(r, dataclasses.fields(r)[0].name)) for r in of_kind],
                [told(lambda r=r: repr(dataclasses.replace(r))) for r in of_kind],
                getattr(of, "__match_args__", None),
                [hasattr(r, "__dict__") for r in of_kind],
            )
        )
    assert found[0] == found[1]


@records.dataclass(frozen=True, slots=True)
class Kept:
    """A record that pickle finds, with an array."""

    values: np.ndarray
    name: str = "a"


def test_records_are_pickled_and_compare_their_fields_by_identity_first():
    kept = Kept(np.arange(3.0))
    again = pickle.loads(pickle.dumps(kept))
    assert again.name == "a" and (again.values == kept.values).all()
    assert kept == Kept(kept.values)  # as tuples do: arrays are not compared


def test_types_of_a_record_are_found_in_its_module():
    assert get_type_hints(Executing.__init__, include_extras=True).keys() == {f.name for f in dataclasses.fields(Executing)} | {
        "return"
    }


def test_nothing_is_compiled_before_the_first_record():
    @records.dataclass(frozen=True, slots=True)
    class Late:
        """One field."""

        a: int

    first = vars(Late)["__init__"]
    assert not inspect.isfunction(first)
    assert Late(1).a == 1 and inspect.isfunction(vars(Late)["__init__"])


def test_an_init_of_ones_own_is_refused():
    """The standard library keeps it; here it would be written over."""
    with pytest.raises(TypeError, match="Own has an __init__ of its own"):

        @records.dataclass
        class Own:
            a: int

            def __init__(self):
                self.a = 1


def test_the_package_makes_records_by_its_own_decorator():
    by_standard = re.compile(
        r"^from dataclasses import [^#\n]*\b(dataclass|make_dataclass)\b|dataclasses\.(make_)?dataclass\(", re.M
    )
    others = [p.name for p in ROOT.rglob("*.py") if by_standard.search(p.read_text())]
    assert others in ([], ["records.py"])
