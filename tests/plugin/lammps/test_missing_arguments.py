# SPDX-License-Identifier: GPL-2.0-only
"""A command with too few words is told how it is written and what is missing; a word that is not known, which ones are."""

import re

import plugin_lab as lab
import pytest

BASIN = "region basin block 0 8 0 8 0 8"
LIQUID = "fix a all mdanim/liquid basin 1.0 grid 4 4 4 level 4 gravity 1"
CONTACT = "fix a all mdanim/contact 1 1e6 0.5"
BARRIER = "fix a all mdanim/barrier all all 1.0 1.0"


@pytest.mark.parametrize(
    ("command", "form", "missing"),
    [
        ("bond_coeff 1 0.2", "bond_coeff TYPE K r0 [c]", "got 1 of them, r0 is missing"),
        ("bond_coeff 1", "bond_coeff TYPE K r0 [c]", "got 0 of them, K and r0 are missing"),
        ("fix a all mdanim/wall r", "fix ID group mdanim/wall REGION k", "got 1 of them, k is missing"),
        ("fix a all mdanim/gravity 0 0", "fix ID group mdanim/gravity gx gy gz", "got 2 of them, gz is missing"),
        (
            "fix a all mdanim/barrier boundary",
            "fix ID group mdanim/barrier BOUNDARY BARRIER k rc",
            "got 1 of them, BARRIER, k and rc are missing",
        ),
        ("fix a all mdanim/contact", "fix ID group mdanim/contact BODY YOUNG FRICTION", "got 0 of them, BODY, YOUNG"),
        (
            "fix a all mdanim/liquid basin 1.0 grid 4",
            "fix ID group mdanim/liquid REGION rho grid NX NY NZ",
            "got 4 of them, NY and NZ are missing",
        ),
        (f"{BARRIER} thin all", "thin GROUP ratio", "got 1 of them, ratio is missing"),
        (f"{CONTACT} plane z lo", "plane x|y|z lo|hi at", "got 2 of them, at is missing"),
        (f"{CONTACT} objects pair 1 2", "pair MOL1 MOL2 mu beta", "got 2 of them, mu and beta are missing"),
        (f"{CONTACT} stiffness", "stiffness f", "got 0 of them, f is missing"),
        (f"{CONTACT} damping", "damping beta", "got 0 of them, beta is missing"),
        (f"{CONTACT} among", "among GROUP", "got 0 of them, GROUP is missing"),
        (f"{CONTACT} bodies", "bodies FILE", "got 0 of them, FILE is missing"),
        ("fix a all mdanim/leapfrog lambda", "lambda L|d_NAME", "got 0 of them, L|d_NAME is missing"),
        ("fix a all mdanim/leapfrog drag", "drag implicit|exp", "got 0 of them, implicit|exp is missing"),
        (f"{LIQUID} wave -x 0.1", "wave SIDE a T", "got 2 of them, T is missing"),
        (f"{LIQUID} current", "current SIDE u", "got 0 of them, SIDE and u are missing"),
        (f"{LIQUID} inflow basin 1.0", "inflow REGION2 q ux uy", "got 2 of them, ux and uy are missing"),
        (f"{LIQUID} drain basin", "drain REGION2 q", "got 1 of them, q is missing"),
        *(
            (f"{LIQUID} {word}", f"{word} {value}", f"got 0 of them, {value} is missing")
            for word, value in (
                ("volume", "V"),
                ("level", "Z"),
                ("fill", "REGION2"),
                ("gravity", "G"),
                ("model", "surface|paper|waves"),
                ("calm", "T"),
                ("manning", "n"),
                ("drops", "share"),
                ("vertical", "lower|any"),
                ("seed", "N"),
                ("buoyancy", "V|d_NAME"),
                ("drag", "gamma|d_NAME"),
                ("lambda", "d_NAME"),
                ("base", "d_NAME"),
                ("cells", "i2_NAME"),
                ("softness", "d_NAME"),
                ("still", "GROUP"),
                ("sweeps", "auto|N"),
                ("every", "N"),
                ("stride", "s"),
                ("period", "p"),
            )
        ),
        (f"{LIQUID}\nfix_modify a drag", "drag gamma|d_NAME", "got 0 of them, gamma|d_NAME is missing"),
    ],
)
def test_what_is_missing_is_named(tmp_path, command, form, missing):
    """With the form of the command or keyword, how much of it was found, and what is not there."""
    with pytest.raises(Exception, match=re.escape(f"missing arguments, it is written as '{form}'; {missing}")):
        lab.load(lab.block((1, 1, 1)), tmp_path, [BASIN, *command.split("\n")]).close()


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (f"{BARRIER} thik", "unknown keyword thik; it knows thin"),
        (
            f"{CONTACT} plain",
            "unknown keyword plain; it knows objects, plane, moving, stiffness, damping, pair, exclude, belt, "
            "among, except and bodies",
        ),
        ("fix a all mdanim/leapfrog lamda", "unknown keyword lamda; it knows lambda and drag"),
        (f"{LIQUID} wawe", "unknown keyword wawe; it knows volume, level, fill"),
        (f"{LIQUID}\nfix_modify a level 3", "unknown keyword level; it knows buoyancy, drag, quadratic, lambda, base, cells"),
        ("run_style verlet/mdanim thread", "unknown keyword thread; it knows width and threads"),
        ("run_style verlet/mdanim threads", "threads takes a number, e.g. threads 4"),
        ("run_style verlet/mdanim width", "width takes one word, common, avx2 or avx512"),
        ("compute a all mdanim/timestep 0.5", "takes no arguments, got 0.5"),
        ("fix a all mdanim/gravity 0 0 1 2", "gx gy gz are all it takes, got also 2"),
        ("fix a all mdanim/wall basin 1 2", "region and k are all it takes, got also 2"),
        ("bond_coeff 1 1 1 1 1", "coefficients are K r0 [c], got 4 words"),
        ("fix a all mdanim/liquid basin 1.0 grid 4 4 4 level 4", "gravity G is missing"),
        ("fix a all mdanim/liquid basin 1.0 grid 4 4 4 gravity 1", "write either volume V or level Z"),
        (CONTACT, "nothing can touch; write objects, or plane x|y|z lo|hi and its place"),
    ],
)
def test_what_is_known_is_named(tmp_path, command, words):
    """A word that is not known, even without a value after it; words that are too many; a part that is not there."""
    with pytest.raises(Exception, match=re.escape(words)):
        lab.load(lab.block((1, 1, 1)), tmp_path, [BASIN, *command.split("\n")]).close()
