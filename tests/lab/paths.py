# SPDX-License-Identifier: GPL-2.0-only
"""Folders that tests use."""

from pathlib import Path

LAB = Path(__file__).resolve().parent
"""Helpers of the tests: samples, twins (slow forms of what is tested), programs for several ranks (``mpi/``)."""
TESTS = LAB.parent
REPOSITORY = TESTS.parent
SCENES = REPOSITORY / "scenes"
MESHES = LAB / "meshes"
MPI = LAB / "mpi"
"""Programs that tests run on several ranks."""
