// SPDX-License-Identifier: GPL-2.0-only
// The liquid of waves at the start.

#pragma once

#include "liquid/basin.h"
#include "liquid/waves/waves.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace mdanim {

// Pours an amount between solids, to the unit: in each column of the basin into the lowest layers that are `within`, of all
// cells. `floats`: see Waves::hollows().
Basin::Filled fill_with(Waves &waves, const Basin &basin, const Basin::Amount &amount, const std::vector<std::uint8_t> &within,
                        const std::function<bool(int column, int z)> &floats);

}    // namespace mdanim
