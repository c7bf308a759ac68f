# SPDX-License-Identifier: GPL-2.0-only
"""Columns of the ledger of a liquid."""

WAVES = "waves"
"""Energy of a liquid with momentum [J]."""
DUE = "liquid_due"
"""Extra of a liquid that comes and goes: cells at the start, and what has come since less what has gone."""
LIQUID_MOMENTUM = ("liquid_momentum.x", "liquid_momentum.y")
"""Extras of a liquid with momentum [N s]."""
BASIN_IMPULSE = ("basin_impulse.x", "basin_impulse.y")
"""Further ones: what it has given to walls, floor and all that is held, by pressure and friction [N s]."""
SOLID_IMPULSE = ("solid_impulse.x", "solid_impulse.y")
"""Impulse that it has given to moving solids, by push and drag [N s]."""
MOMENTUM_RESIDUAL = ("momentum_residual.x", "momentum_residual.y")
"""The sum of these three, less the momentum of liquid that came: what no one accounts for [N s]."""
MOMENTA = (*LIQUID_MOMENTUM, *BASIN_IMPULSE, *SOLID_IMPULSE, *MOMENTUM_RESIDUAL)
CREST = "liquid_crest"
"""Extra where an ``expect`` asks for it: height of the highest liquid [m]."""
CELLS = "liquid_cells"
"""Extra of any liquid: its cells now."""
