// SPDX-License-Identifier: GPL-2.0-only

#include "joints/patch.h"

#include "rigid/inertia.h"

#include <cmath>
#include <utility>

namespace mdanim {

static constexpr double FLAT = 1e-8;    // smallest second moment over the largest of what has a thickness

Patch Patch::of(std::vector<Member> members)
{
  Vec3 centre;
  double total = 0.0;
  for (const Member &one : members) {
    total += one.mass;
    centre += one.mass * one.r;
  }
  centre = (1.0 / total) * centre;
  for (Member &one : members) one.r -= centre;
  return from(std::move(members), centre);
}

Patch Patch::from(std::vector<Member> members, const Vec3 &centre)
{
  Patch made;
  made.all = std::move(members);
  made.middle = centre;
  for (const Member &one : made.all) {
    made.total += one.mass;
    made.S += outer(one.mass * one.r, one.r);
  }
  const Matrix3 &S = made.S;
  const PrincipalAxes found = principal_axes({S.row[0].x, S.row[1].y, S.row[2].z, S.row[0].y, S.row[0].z, S.row[1].z});
  const Matrix3 columns = transposed(matrix(found.q));
  const double second[3] = {found.moments.x, found.moments.y, found.moments.z};
  const double nothing = ROUNDING * ROUNDING * made.total * dot(centre, centre);
  made.rank = 0;
  for (int k = 2; k >= 0 && second[k] > FLAT * second[2] && second[k] > nothing; --k) {
    const Vec3 axis = columns.row[k];
    made.inverse_S += outer((1.0 / second[k]) * axis, axis);
    made.span += outer(axis, axis);
    made.axes[made.rank++] = axis;
  }
  if (made.rank == 3) {
    made.span = diagonal(1.0);
    for (int k = 0; k < 3; ++k) made.axes[k] = made.span.row[k];
  }
  return made;
}

double Patch::radius() const { return is_world() ? 0.0 : std::sqrt((S.row[0].x + S.row[1].y + S.row[2].z) / total); }

}    // namespace mdanim
