// SPDX-License-Identifier: GPL-2.0-only

#include "folds/fold_contact.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace mdanim {

// As many links as are as long as what is apart without load, two at least; in a triangular lattice they go 0.87 of that.
template <class Element>
static int links_of(const FoldObject &object, int count, int corners, const Element &element, double apart)
{
  constexpr double LEAST_WAY = 0.86;
  double sum = 0.0;
  for (int e = 0; e < count; ++e) sum += length(object.rest[element(e)[1]] - object.rest[element(e)[0]]);
  return std::max(2, static_cast<int>(std::ceil(apart * count / (LEAST_WAY * sum))));
}

FoldContact::FoldContact(const FoldObject &own, const FoldSurface &of_own, const FoldObject &other, const FoldSurface &of_other,
                         const FoldLaw &law, double apart)
    : own(&own), other(&other), of_own(&of_own), of_other(&of_other), rule(law), apart(apart), itself(&own == &other),
      lines(!own.segments.empty() && !other.segments.empty())
{
  identity.resize(own.particles.size());
  for (std::size_t n = 0; n < identity.size(); ++n) identity[n] = static_cast<int>(n);
  first.assign(features() + 1, 0);
  if (itself) links = links_of(*this->other, count(), corners_of_element(), [this](int e) { return element(e); }, apart);
}

double FoldContact::weight(int f) const
{
  const int *const a = feature(f);
  return lines ? 0.5 * (own->weight[a[0]] + own->weight[a[1]]) : own->weight[a[0]];
}

NearestPoints FoldContact::foot(const Vec3 *x, int f, const Vec3 *y, int e) const
{
  const int *const a = feature(f), *const b = element(e);
  if (lines) return feet_of_segments(x[a[0]], x[a[1]], y[b[0]], y[b[1]]);
  if (other->triangles.empty()) return foot_on_segment(x[a[0]], y[b[0]], y[b[1]]);
  return foot_on_triangle(x[a[0]], y[b[0]], y[b[1]], y[b[2]]);
}

static Vec3 at_foot(const Vec3 *x, const int *corners, const double *weight, int count)
{
  Vec3 sum = weight[0] * x[corners[0]];
  for (int k = 1; k < count; ++k) sum += weight[k] * x[corners[k]];
  return sum;
}

// From the foot on the element to that on the feature.
Vec3 FoldContact::way(const Vec3 *x, int f, const Vec3 *y, int e, const NearestPoints &at) const
{ return at_foot(x, feature(f), at.own, corners_of_feature()) - at_foot(y, element(e), at.other, corners_of_element()); }

// Whether two parts of one object may touch: they are so far from each other without load, or a tear has parted them.
bool FoldContact::is_apart(int f, int e) const
{
  if (!itself) return true;
  if (of_own->is_torn() && !are_linked(f, e)) return true;
  if (apart == 0.0) return false;
  const int *const a = feature(f), *const b = element(e);
  for (int k = 0; k < corners_of_element(); ++k) {    // most of what is near is a neighbour
    const Vec3 corner = other->rest[b[k]] - own->rest[a[0]];
    if (dot(corner, corner) < apart * apart) return false;
  }
  const Vec3 way = this->way(own->rest.data(), f, other->rest.data(), e, foot(own->rest.data(), f, other->rest.data(), e));
  return dot(way, way) >= apart * apart;
}

bool FoldContact::are_linked(int f, int e) const
{
  const int *const a = feature(f), *const b = element(e);
  const auto is_corner = [b, end = b + corners_of_element()](int p) { return std::find(b, end, p) != end; };
  return std::any_of(a, a + corners_of_feature(), [&](int p) { return of_own->any_near(p, links, is_corner); });
}

bool FoldContact::has_feature(int f) const { return lines ? of_own->has_element(f, itself) : of_own->has_particle(f, itself); }

static Box box_of(const Vec3 *x, const int *corners, int count)
{
  Box box;
  for (int k = 0; k < count; ++k) box.include(&x[corners[k]].x);
  return box;
}

void FoldContact::append_box(const Vec3 *y, int e)
{
  boxes.push_back(box_of(y, element(e), corners_of_element()).grown(far));
  number.push_back(e);
}

// Appends the elements near a feature.
void FoldContact::look_around(const Vec3 *x, const Vec3 *y, int f)
{
  if (!has_feature(f)) return;
  const std::size_t begin = elements.size();
  const Box mine = box_of(x, feature(f), corners_of_feature());
  const auto look = [&](std::size_t n) {
    const int e = number[n];
    if (!of_other->has_element(e, itself) || !is_apart(f, e)) return;
    const Vec3 there = way(x, f, y, e, foot(x, f, y, e));
    if (dot(there, there) < far * far) elements.push_back(e);
  };
  tree.meeting(mine, look);
  for (std::size_t n = in_tree; n < boxes.size(); ++n)
    if (meet(boxes[n], mine, 0.0)) look(n);
  std::sort(elements.begin() + begin, elements.end());
  elements.erase(std::unique(elements.begin() + begin, elements.end()), elements.end());
}

void FoldContact::list(const Vec3 *x, const Vec3 *y, double skin)
{
  Box mine, all;
  far = rule.reach + skin;
  listed = false;
  listed_torn = of_own->is_torn();
  boxes.clear();
  number.clear();
  elements.clear();
  std::fill(first.begin(), first.end(), 0);
  if (!may_touch()) return;
  for (int f = 0; f < features(); ++f)
    if (has_feature(f)) mine.unite(box_of(x, feature(f), corners_of_feature()));
  for (int e = 0; e < count(); ++e) {
    if (!of_other->has_element(e, itself)) continue;
    append_box(y, e);
    all.unite(boxes.back());
  }
  if (boxes.empty() || mine.empty() || !meet(mine, all, 0.0)) return;
  listed = true;
  tree = BoxTree(boxes);
  in_tree = boxes.size();
  for (int f = 0; f < features(); ++f) {
    first[f] = static_cast<int>(elements.size());
    look_around(x, y, f);
  }
  first[features()] = static_cast<int>(elements.size());
}

void FoldContact::renew(const Vec3 *x, const Vec3 *y, double skin)
{
  constexpr std::size_t MOST = 200;    // further boxes, which are looked at one by one
  // From its first tear on, parts of an object far from that may touch, too.
  const bool first_tear = itself && listed_torn != of_own->is_torn();
  if (!listed || first_tear || boxes.size() > in_tree + MOST) {
    list(x, y, skin);
    return;
  }
  const std::size_t known = boxes.size();
  for (const int e : of_other->new_elements())
    if (of_other->has_element(e, itself)) append_box(y, e);
  const std::vector<char> anew = to_renew(x, known);
  const std::vector<int> before = std::move(elements);
  elements.clear();
  for (int f = 0, from = 0; f < features(); ++f) {
    const int to = first[f + 1];
    first[f] = static_cast<int>(elements.size());
    if (anew[f])
      look_around(x, y, f);
    else
      std::copy_if(before.begin() + from, before.begin() + to, std::back_inserter(elements),
                   [this](int e) { return of_other->has_element(e, itself); });
    from = to;
  }
  first[features()] = static_cast<int>(elements.size());
}

// Features that the news may be about: near the ends of links that went, corners of elements that changed, and near elements that
// are further ones from this box on.
std::vector<char> FoldContact::to_renew(const Vec3 *x, std::size_t known) const
{
  std::vector<char> particle(own->particles.size(), 0), found(features(), 0);
  for (const int end : of_own->new_ends()) of_own->any_near(end, links, [&](int p) { return particle[p] = 1, false; });
  for (const int e : of_own->new_elements())
    for (int k = 0; k < of_own->corners(); ++k) particle[of_own->corner(e, k)] = 1;
  Box further;
  for (std::size_t n = known; n < boxes.size(); ++n) further.unite(boxes[n]);
  for (int f = 0; f < features(); ++f) {
    const int *const a = feature(f);
    found[f] = particle[a[0]] || (lines && particle[a[1]]);
    if (found[f] || known == boxes.size()) continue;
    const Box mine = box_of(x, a, corners_of_feature());
    if (!meet(mine, further, 0.0)) continue;
    found[f] = std::any_of(boxes.begin() + known, boxes.end(), [&mine](const Box &one) { return meet(mine, one, 0.0); });
  }
  return found;
}

double FoldContact::push(const FoldNodes &mine, const FoldNodes &theirs, double dt) const
{
  double energy = 0.0;
  if (elements.empty()) return energy;
  for (int f = 0; f < features(); ++f) {
    double least = rule.reach * rule.reach;
    int nearest = -1;
    NearestPoints there;
    for (int n = first[f]; n < first[f + 1]; ++n) {
      const NearestPoints at = foot(mine.x, f, theirs.x, elements[n]);
      const Vec3 gap = way(mine.x, f, theirs.x, elements[n], at);
      const double square = dot(gap, gap);
      if (square >= least) continue;
      least = square;
      nearest = elements[n];
      there = at;
    }
    if (nearest < 0) continue;
    const double distance = std::sqrt(least);
    energy += weight(f) * rule.push(distance).energy;
    if (distance > 0.0) act(mine, theirs, f, nearest, there, distance, dt);
  }
  return energy;
}

void FoldContact::act(const FoldNodes &mine, const FoldNodes &theirs, int f, int e, const NearestPoints &at, double distance,
                      double dt) const
{
  const int *const a = feature(f), *const b = element(e);
  const int na = corners_of_feature(), nb = corners_of_element();
  const Vec3 n = (1.0 / distance) * way(mine.x, f, theirs.x, e, at);
  const double push = weight(f) * rule.push(distance).force;
  const auto add = [&](Vec3 *on_own, Vec3 *on_other, const Vec3 &force) {
    for (int k = 0; k < na; ++k) on_own[a[k]] += at.own[k] * force;
    for (int k = 0; k < nb; ++k) on_other[b[k]] -= at.other[k] * force;
  };
  add(mine.push, theirs.push, push * n);
  if (rule.friction == 0.0 && rule.damping == 0.0) return;
  double light = 0.0;    // 1/m of what moves along the line
  for (int k = 0; k < na; ++k) light += at.own[k] * at.own[k] / mine.mass[a[k]];
  for (int k = 0; k < nb; ++k) light += at.other[k] * at.other[k] / theirs.mass[b[k]];
  const Vec3 v = at_foot(mine.v, a, at.own, na) - at_foot(theirs.v, b, at.other, nb);
  const double along = dot(v, n), mass = 1.0 / light;
  const double dashpot = rule.damping > 0.0 ? rule.dashpot(distance, push, along, mass, dt) : 0.0;
  if (dashpot != 0.0) add(mine.damp, theirs.damp, dashpot * n);
  const Vec3 across = v - along * n;
  const double rub = rule.friction > 0.0 ? rule.rub(push + dashpot, length(across), mass, dt) : 0.0;
  if (rub != 0.0) add(mine.rub, theirs.rub, rub * across);
}

}    // namespace mdanim
