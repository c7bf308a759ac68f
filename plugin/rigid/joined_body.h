// SPDX-License-Identifier: GPL-2.0-only
// The rigid body that some bodies are together, and what its motion leaves of the forces on each of them.

#pragma once

#include "rigid/body.h"
#include "rigid/glue_springs.h"
#include "rigid/shape.h"

#include <vector>

namespace mdanim {

// Mass, centre and moments are sums over pieces, and so are momentum and angular momentum.
RigidBody joined_body(const std::vector<RigidBody> &bodies, const std::vector<int> &pieces);
// f = F - m a of each piece, and the same of its torque, in the frame of the whole; `in_whole`: where pieces are in it, by the
// numbers of bodies.
PieceMotions loads_of_pieces(const RigidBody &whole, const std::vector<int> &pieces, const std::vector<Pose> &in_whole,
                             const std::vector<RigidBody> &bodies, double to_acceleration);
// Adds further forces and torques in space, by the numbers of bodies.
void add_in_frame(const RigidBody &whole, const std::vector<int> &pieces, const PieceMotions &more, PieceMotions &load);

}    // namespace mdanim
