# SPDX-License-Identifier: GPL-2.0-only
"""The feature of tests/lab/features/remembers, with the plugin that it needs: to be imported before LAMMPS is."""

import os
from pathlib import Path

import plugin_library
from mdanim_lammps import features
from mdanim_lammps.engine.plugin import folder

features.add(Path(__file__).parents[1] / "features" / "remembers")
os.environ["LAMMPS_PLUGIN_PATH"] = ":".join([folder(), str(plugin_library.build().parent)])
