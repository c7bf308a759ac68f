// SPDX-License-Identifier: GPL-2.0-only
// Whether a contact begins between a point and a host that is a lattice.

#pragma once

#include "contact/contact_body.h"
#include "contact/lattice_map.h"

#include <cstdint>

namespace mdanim {

constexpr std::uint8_t EVERY_SIDE = 63;

// The result of a look at a point.
struct Verdict {
  int side = -1;    // of the contact that begins; -1 for none
  double depth = 0.0;
  std::uint8_t open = 0;    // sides in which the point would have a potential if it faced them
  double slack = 0.0;       // a motion that cannot yet begin a contact [m]
  bool is_crushed = false;
  bool is_sure = true;    // no contact, although the place of the point is guessed
};

// The outward normal of a point, in space, and the edge of the cell that turns it [m]; or it faces every side.
struct Facing {
  Vec3 normal;
  double cell = 0.0;
  bool all = false;
};

// Ramps: half of a flat point counts one and a half cells inside of an edge, half of other points at the edge.
Ramps ramps_of(const ContactBody &host, PointKind kind);
// Whether the smooth map of a host is that of its contacts with points of a kind.
inline bool is_smooth(const ContactBody &host, PointKind kind) { return kind != PointKind::FLAT && host.is_cuboid(); }

// The slack that judge() would give for a point so far from each side of the host that its own normal does not matter; 0 for a
// point that is nearer. Beside a cuboid some of its sides are far above the point: their edges separate it from these. `off` is
// the error of X, in cells.
double slack_of_far(const ContactBody &host, const SurfacePoint &point, double radius, const Vec3 &X, const Vec3 &X_centre,
                    const Spot<double> &spot, double off);
// Around a point with a radius [m] the surface faces every side.
Verdict judge(const ContactBody &host, const SurfacePoint &point, double radius, const Vec3 &X, const Vec3 &X_centre,
              const Spot<double> &spot, const Facing &facing, double off);

}    // namespace mdanim
