// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/joined_body.h"

#include "rigid/inertia.h"

namespace mdanim {

// R diag(moments) R^T.
static Matrix3 tensor(const Matrix3 &turn, const Vec3 &moments)
{
  Matrix3 found;
  const Matrix3 columns = transposed(turn);
  const double own[3] = {moments.x, moments.y, moments.z};
  for (int k = 0; k < 3; ++k) found += own[k] * outer(columns.row[k], columns.row[k]);
  return found;
}

RigidBody joined_body(const std::vector<RigidBody> &bodies, const std::vector<int> &pieces)
{
  RigidBody body;
  Vec3 centre, momentum, angular;
  for (const int n : pieces) {
    body.mass += bodies[n].mass;
    centre += bodies[n].mass * bodies[n].centre;
    momentum += bodies[n].mass * bodies[n].velocity;
  }
  body.centre = (1.0 / body.mass) * centre;
  body.velocity = (1.0 / body.mass) * momentum;
  Matrix3 inertia;
  for (const int n : pieces) {
    const RigidBody &one = bodies[n];
    const Vec3 arm = one.centre - body.centre;
    inertia += tensor(one.turn, one.moments) + one.mass * (diagonal(dot(arm, arm)) + -1.0 * outer(arm, arm));
    angular += one.L + one.mass * cross(arm, one.velocity - body.velocity);
    body.aside = one.aside;
  }
  const PrincipalAxes axes = principal_axes(
      {inertia.row[0].x, inertia.row[1].y, inertia.row[2].z, inertia.row[0].y, inertia.row[0].z, inertia.row[1].z});
  body.moments = axes.moments;
  body.q = axes.q;
  body.L = angular;
  body.refresh();
  return body;
}

PieceMotions loads_of_pieces(const RigidBody &whole, const std::vector<int> &pieces, const std::vector<Pose> &in_whole,
                             const std::vector<RigidBody> &bodies, double to_acceleration)
{
  const Matrix3 &turn = whole.turn;
  const Vec3 spin = transposed_times(turn, whole.spin);
  const Vec3 along = (to_acceleration / whole.mass) * transposed_times(turn, whole.force);
  const Vec3 momentum{whole.moments.x * spin.x, whole.moments.y * spin.y, whole.moments.z * spin.z};
  const Vec3 turning = to_acceleration * transposed_times(turn, whole.torque) - cross(spin, momentum);
  const Vec3 faster{whole.over.x * turning.x, whole.over.y * turning.y, whole.over.z * turning.z};
  const double inertial = 1.0 / to_acceleration;
  PieceMotions found;
  found.reserve(pieces.size());
  for (const int n : pieces) {
    const RigidBody &one = bodies[n];
    const Vec3 &place = in_whole[n].place;
    const Vec3 a = along + cross(faster, place) + cross(spin, cross(spin, place));
    const Matrix3 inertia = tensor(matrix(in_whole[n].q), one.moments);
    found.push_back({transposed_times(turn, one.force) - (inertial * one.mass) * a,
                     transposed_times(turn, one.torque) - inertial * (inertia * faster + cross(spin, inertia * spin))});
  }
  return found;
}

void add_in_frame(const RigidBody &whole, const std::vector<int> &pieces, const PieceMotions &more, PieceMotions &load)
{
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    load[k].place += transposed_times(whole.turn, more[pieces[k]].place);
    load[k].turn += transposed_times(whole.turn, more[pieces[k]].turn);
  }
}

}    // namespace mdanim
