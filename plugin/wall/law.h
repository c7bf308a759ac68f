// SPDX-License-Identifier: GPL-2.0-only
// The force that holds a particle in its region: a spring to the nearest point of the surface, at any depth.
//   F = -k d,  U = k d^2 / 2,  d = vector from the surface to the particle behind it

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

inline Vec3 wall_force(double k, const Vec3 &d) { return {-k * d.x, -k * d.y, -k * d.z}; }

inline double wall_energy(double k, const Vec3 &d) { return 0.5 * k * dot(d, d); }

}    // namespace mdanim
