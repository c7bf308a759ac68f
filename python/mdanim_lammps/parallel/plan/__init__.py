# SPDX-License-Identifier: GPL-2.0-only
"""Which executor runs which objects: pure functions of arrays, without MPI."""
