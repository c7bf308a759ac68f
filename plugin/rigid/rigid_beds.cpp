// SPDX-License-Identifier: GPL-2.0-only
// Flat surfaces that bear what is glued together: those of planes, and sides of bodies with flat ones.

#include "rigid/rigid_beds.h"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace mdanim {

namespace {

constexpr double ONE_PLANE = 1e-4;    // 1 less the cosine up to which two normals are one
constexpr double FACES = 0.5;         // least cosine of a side that lies on a surface, or stands on an edge of it

using Other = std::pair<bool, int>;                                // a plane or a body by its ID, or a whole
using Beds = std::map<std::pair<int, Other>, std::vector<Bed>>;    // by wholes, and what bears them

Other other(const Solid &one)
{
  if (one.whole != Solid::ALONE) return {true, one.whole};
  return {false, one.held && !one.driven ? 0 : one.id};
}

Bed &bed_of(std::vector<Bed> &beds, const Vec3 &n, double at, double near)
{
  for (Bed &one : beds)
    if (dot(one.n, n) > 1.0 - ONE_PLANE && std::fabs(one.at - at) < near) return one;
  beds.push_back({n, at, {}, {}});
  return beds.back();
}

// Corners of a piece that `lies` says are at a surface with the normal n, with their parts of the areas of its open sides.
template <class Lies> void add_spots(Bed &bed, int number, const Solid &piece, const Lies &lies)
{
  if (piece.shape.kind() != SolidShape::POLYHEDRON) return;
  const Polyhedron &shape = piece.shape.polyhedron();
  const Vec3 n = piece.in_body(bed.n);
  for (std::size_t q = 0; q < shape.corners().size(); ++q) {
    const Polyhedron::Corner &corner = shape.corners()[q];
    double area = 0.0;
    const Vec3 at = piece.place(corner.at);
    if (!lies(at)) continue;
    for (const int f : corner.faces) {
      const Polyhedron::Face &face = shape.faces()[f];
      const double against = -dot(face.normal, n);
      if (!face.covered && against > FACES) area += against * shape.area(f) / static_cast<double>(face.corners.size());
    }
    if (area > 0.0) bed.spots.push_back({number, static_cast<int>(q), piece.centre, at, area});
  }
}

// The normal of the flat side at which two bodies touch, out of the second one, and n . X of its points. Returns whether there is
// one.
bool find_side(const std::vector<Touch> &touches, const Solid &a, const Solid &b, Vec3 &n, double &at)
{
  for (const Touch &touch : touches) {
    const bool in_b = touch.kind == Touch::CORNER;
    if (touch.parted != 0.0 || (!in_b && touch.kind != Touch::CORNER_OF_OTHER)) continue;
    const Solid &host = in_b ? b : a;
    if (host.shape.kind() != SolidShape::POLYHEDRON) continue;
    const Polyhedron::Face &side = host.shape.polyhedron().faces()[touch.side];
    const double sign = in_b ? 1.0 : -1.0;
    n = sign * host.in_space(side.normal);
    at = dot(n, host.centre) + sign * side.at;
    return true;
  }
  return false;
}

}    // namespace

PieceMotions RigidBeds::spread(const std::vector<Solid> &solids, const std::vector<SolidPair> &pairs,
                               const std::vector<SolidPlane> &planes, const TouchesAtPlanes &at_plane, double onset)
{
  PieceMotions more(solids.size());
  if (pieces_of.empty())
    for (int n = 0; n < static_cast<int>(solids.size()); ++n)
      if (solids[n].whole != Solid::ALONE) pieces_of[solids[n].whole].push_back(n);
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const SolidPlane &plane = planes[k];
    const double at = plane.at + dot(plane.n, plane.shift);
    for (const auto &[whole, pieces] : pieces_of) {
      Bed bed{plane.n, at, {}, {}};
      std::size_t count = 0;
      for (const int n : pieces) {
        const Solid &piece = solids[n];
        Vec3 force, torque;
        for (const Touch &touch : at_plane[k][n]) {
          if (touch.parted != 0.0) continue;
          force += touch.press * plane.n;
          torque += cross(piece.in_space(piece.shape.corners()[touch.first].at), touch.press * plane.n);
          ++count;
        }
        bed.press(n, piece.centre, force, torque);
      }
      if (count < 2) continue;
      for (const int n : pieces)
        if (!plane.is_above(solids[n])) add_spots(bed, n, solids[n], [&](const Vec3 &x) { return dot(plane.n, x) < at; });
      bed.spread(more);
    }
  }
  Beds beds;
  Vec3 n;
  double at = 0.0;
  for (const SolidPair &pair : pairs) {
    const Solid &a = solids[pair.a], &b = solids[pair.b];
    if ((a.whole == Solid::ALONE && b.whole == Solid::ALONE) || !find_side(pair.touches, a, b, n, at)) continue;
    if (a.whole != Solid::ALONE)
      bed_of(beds[{a.whole, other(b)}], n, at, onset).press(pair.a, a.centre, pair.force, pair.torque_a);
    if (b.whole != Solid::ALONE)
      bed_of(beds[{b.whole, other(a)}], -1.0 * n, -at, onset).press(pair.b, b.centre, -1.0 * pair.force, pair.torque_b);
  }
  if (beds.empty()) return more;
  for (const SolidPair &pair : pairs) {
    for (const auto &[own, host] : {std::pair{pair.a, pair.b}, {pair.b, pair.a}}) {
      const Solid &piece = solids[own], &by = solids[host];
      if (piece.whole == Solid::ALONE || by.shape.kind() != SolidShape::POLYHEDRON) continue;
      const auto found = beds.find({piece.whole, other(by)});
      if (found == beds.end()) continue;
      for (Bed &bed : found->second)
        add_spots(bed, own, piece, [&](const Vec3 &x) {
          return dot(bed.n, x) < bed.at && by.shape.polyhedron().outside(by.in_body(x - by.centre)) < onset;
        });
    }
  }
  for (auto &[which, of_pair] : beds)
    for (Bed &bed : of_pair) bed.spread(more);
  return more;
}

}    // namespace mdanim
