// SPDX-License-Identifier: GPL-2.0-only
// Rigid pieces between springs: the loads of faces from the loads of pieces, K x = f by conjugate gradients.

#pragma once

#include "numbers/vec3.h"

#include <vector>

namespace mdanim {

// Place and rotation of a piece, or force and torque on it.
struct PieceMotion {
  Vec3 place, turn;
};
using PieceMotions = std::vector<PieceMotion>;

// A face in the frame of its whole.
struct GlueSpring {
  int face, a, b;    // of the pieces of the whole
  Vec3 arm_a, arm_b, axis[3];
  double stiffness;    // E A/L, along and across
  Vec3 twist;          // E I/L about n, e1, e2
};

// Force and torque on piece a along the axes of a face.
struct FaceForce {
  Vec3 force, torque;
};

// Force, torque about its middle, and middle of a face.
struct FaceLoads {
  Vec3 force, torque, at;
};

// The load of the face by which each piece hangs on the first one, where faces are a tree: all that hangs on it is in balance.
// `places` are those of pieces, in the frame of their whole as loads are. Zeros for the first one, and for all where faces make
// a ring.
std::vector<FaceLoads> hanging_loads(const std::vector<GlueSpring> &springs, const std::vector<Vec3> &places, PieceMotions load);

FaceForce face_force(const GlueSpring &spring, const PieceMotions &x);
// Adds the diagonal of K.
void add_diagonal(const GlueSpring &spring, PieceMotions &stiff);
class CoarseGlue;
// Solves K x = load from x on; `stiff` is the diagonal of K.
void solve(const std::vector<GlueSpring> &springs, const PieceMotions &stiff, const CoarseGlue &coarse, const PieceMotions &load,
           PieceMotions &x);

}    // namespace mdanim
