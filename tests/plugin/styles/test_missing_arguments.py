# SPDX-License-Identifier: GPL-2.0-only
"""A command with too few words is told how it is written."""

import plugin_lab as lab
import pytest


@pytest.mark.parametrize(
    ("command", "form"),
    [
        ("bond_coeff 1 0.2", r"bond_coeff TYPE K r0 \[c\]'; got 1 of them"),
        ("fix a all mdanim/wall r", "fix ID group mdanim/wall REGION k'; got 1 of them"),
        ("fix a all mdanim/gravity 0 0", "fix ID group mdanim/gravity gx gy gz'; got 2 of them"),
        ("fix a all mdanim/barrier boundary", "fix ID group mdanim/barrier BOUNDARY BARRIER k rc'; got 1 of them"),
        ("fix a all mdanim/contact", "fix ID group mdanim/contact BODY YOUNG FRICTION'; got 0 of them"),
    ],
)
def test_the_form_of_the_command_is_named(tmp_path, command, form):
    """With all that it needs, and how much of it was found."""
    with pytest.raises(Exception, match=f"missing arguments, it is written as '{form}"):
        lab.load(lab.block((1, 1, 1)), tmp_path, [command]).close()
