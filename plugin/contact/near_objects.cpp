// SPDX-License-Identifier: GPL-2.0-only
// Pairs by their boxes, then by their extents along the line between them.

#include "contact/near_objects.h"

#include "contact/lattice_field.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static constexpr double AROUND = 3.0;      // spacings around a contact within which particles may take part in it
static constexpr double CARRIED = 2.25;    // spacings that a particle may be from a point of its cells
static constexpr double MOST_SKINS = 32.0;

bool NearObjects::is_excluded(int a, int b) const
{ return !settings.excluded.empty() && settings.excluded.count(std::minmax(all[a].id, all[b].id)); }

std::vector<std::pair<int, int>> NearObjects::pairs_within(const std::vector<Box> &boxes, double gap) const
{
  std::vector<std::pair<int, int>> found;
  const auto is_excepted = [](const ContactObject &one) { return one.is_excepted; };
  if (settings.objects && !std::all_of(all.begin(), all.end(), is_excepted))
    for (const auto &[a, b] : meeting_pairs(boxes, gap))
      if ((movable[a] || movable[b]) && !(all[a].is_excepted && all[b].is_excepted) && !is_excluded(a, b))
        found.emplace_back(a, b);
  return found;
}

static double distance(const Box &box, const ContactPlane &plane)
{ return plane.sign > 0 ? box.low(plane.axis) - plane.place() : plane.place() - box.high(plane.axis); }

std::vector<std::pair<int, int>> NearObjects::planes_within(const std::vector<Box> &boxes, double gap) const
{
  std::vector<std::pair<int, int>> found;
  for (int n = 0; n < static_cast<int>(all.size()); ++n)
    for (int p = 0; p < static_cast<int>(settings.planes.size()); ++p)
      if (movable[n] && !all[n].is_excepted && !boxes[n].empty() &&
          distance(boxes[n], settings.planes[p]) <= gap + settings.planes[p].ahead(skin_now) +
                                                        LatticeField::STRETCHED * all[n].body->overhang() + all[n].body->radius())
        found.emplace_back(n, p);
  return found;
}

void NearObjects::look_ahead(const std::vector<Box> &boxes, double now)
{
  skin_now = now;
  double widest = 0.0, thickest = 0.0;
  for (const ContactObject &one : all) {
    widest = std::max({widest, LatticeField::stands_out(*one.body, *one.body), 1.2 * one.body->spacing()});
    thickest = std::max(thickest, one.body->radius());
  }
  widest += thickest;
  near_pairs.clear();
  for (const auto &[a, b] : pairs_within(boxes, skin_now + widest)) {
    Vec3 way;    // between the middles of their boxes
    for (int d = 0; d < 3; ++d)
      (d == 0 ? way.x : d == 1 ? way.y : way.z) = boxes[b].low(d) + boxes[b].high(d) - boxes[a].low(d) - boxes[a].high(d);
    const double length = std::sqrt(dot(way, way));
    if (length > 0.0) way = (1.0 / length) * way;
    near_pairs.push_back({a, b, {boxes[a], -1.0 * way}, {boxes[b], way}});
  }
  near_planes = planes_within(boxes, skin_now);
  apart = 0.0;
  for (double skins = 1.0; none() && skins <= MOST_SKINS; skins *= 2.0) {
    const double more = skins * skin_now;
    if (!pairs_within(boxes, skin_now + widest + more).empty() || !planes_within(boxes, skin_now + more).empty()) break;
    apart = 0.5 * (1.0 + skins) * skin_now;
  }
  find_zones();
}

void NearObjects::find_zones()
{
  zones.assign(all.size(), {});
  for (std::size_t k = 0; k < near_pairs.size(); ++k) {
    const NearPair &pair = near_pairs[k];
    const ContactBody &one = *all[pair.a].body, &other = *all[pair.b].body;
    const double around = skin_now + AROUND * std::max(one.spacing(), other.spacing()) +
                          LatticeField::STRETCHED * std::max(one.overhang(), other.overhang()) +
                          std::max(one.radius(), other.radius());
    zones[pair.a].push_back({pair.of_b.grown(around), static_cast<int>(2 * k + 1)});
    zones[pair.b].push_back({pair.of_a.grown(around), static_cast<int>(2 * k)});
  }
  for (const auto &[n, p] : near_planes) {
    const ContactBody &body = *all[n].body;
    const ContactPlane &plane = settings.planes[p];
    const double carried = body.points_are_particles() ? 0.0 : CARRIED * body.spacing() + body.overhang();
    const double gap = PlaneField::REACH * skin_now + plane.ahead(skin_now) + carried + body.radius();
    zones[n].push_back({plane.within(gap), -1});
  }
}

// A rigid object has those of the box around it.
std::vector<double> NearObjects::initial_extents() const
{
  std::vector<double> extents;
  for (const NearPair &pair : near_pairs)
    for (const auto &[n, zone] : {std::pair{pair.a, pair.of_a}, std::pair{pair.b, pair.of_b}}) {
      double least = Box::FAR;
      if (all[n].is_rigid())
        for (const Vec3 &corner : all[n].corners()) least = std::min(least, dot(zone.across, corner));
      extents.push_back(least);
    }
  return extents;
}

void NearObjects::lower_extents(int object, const Vec3 &x, std::vector<double> &extents) const
{
  if (all[object].is_rigid()) return;
  for (const SearchZone &one : zones[object])
    if (one.extent >= 0 && one.zone.contains(x)) {
      double &own = extents[one.extent ^ 1];
      own = std::min(own, -dot(one.zone.across, x));
    }
}

void NearObjects::drop_separated_pairs(const std::vector<double> &extents)
{
  std::vector<NearPair> left;
  for (std::size_t k = 0; k < near_pairs.size(); ++k) {
    NearPair &pair = near_pairs[k];
    const ContactBody &one = *all[pair.a].body, &other = *all[pair.b].body;
    pair.of_a.from = extents[2 * k], pair.of_b.from = extents[2 * k + 1];
    const double range = skin_now + std::max(LatticeField::stands_out(one, other), LatticeField::stands_out(other, one));
    if (pair.of_a.from + pair.of_b.from <= range) left.push_back(pair);
  }
  near_pairs = std::move(left);
  find_zones();
}

bool NearObjects::needs(const ContactParticle &particle, const Vec3 &x) const
{
  const ContactBody &body = *all[particle.object].body;
  if (body.frame() && particle.node >= 0 && particle.node < body.particles())
    return has_zones(particle.object) && body.carries(particle.node);
  const bool is_carrier = particle.node < 0 || particle.node >= body.particles() || body.carries(particle.node);
  return std::any_of(zones[particle.object].begin(), zones[particle.object].end(),
                     [&](const SearchZone &one) { return (is_carrier || one.extent >= 0) && one.zone.contains(x); });
}

}    // namespace mdanim
