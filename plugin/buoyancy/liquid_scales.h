// SPDX-License-Identifier: GPL-2.0-only
// Values that are the same for all particles in a liquid.

#pragma once

namespace mdanim {

struct LiquidScales {
  double rho, g;
  double calming;      // rate at which immersed particles lose the velocity relative to the solid around them [1/time]
  double per_force;    // turns mass * velocity / time into force
  double impulse;      // turns force into impulse on the liquid in a step, over its density
  bool quadratic;      // whether some particle has that drag
};

}    // namespace mdanim
