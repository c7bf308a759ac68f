// SPDX-License-Identifier: GPL-2.0-only
// Objects in pairs: particles of one against those of the other, found by a grid of cells.

#include "barrier/contact_search.h"

#include "barrier/law.h"

#include <algorithm>

namespace mdanim {

static constexpr std::size_t PAIRS_TO_TRY = 4000;    // pair by pair: for few particles a grid takes longer

void ContactSearch::ObjectParticles::clear(int room)
{
  place.make_room(room);
  rank.clear();
}

void ContactSearch::ObjectParticles::add(const double *at, int n)
{
  place.put(rank.size(), at);
  rank.push_back(n);
}

ContactSearch::ContactSearch(const std::vector<Box> &boxes, const std::vector<std::pair<int, int>> &meeting,
                             const Settings &settings)
    : boxes(boxes), meeting(meeting), set(settings), zone(boxes.size())
{
  for (const auto &[a, b] : meeting) {
    zone[a].unite(intersection(boxes[a], boxes[b].grown(set.range)));
    zone[b].unite(intersection(boxes[b], boxes[a].grown(set.range)));
  }
}

void ContactSearch::run()
{
  const auto by_tag = [](const Particle &a, const Particle &b) { return a.tag < b.tag; };
  if (!std::is_sorted(near.begin(), near.end(), by_tag)) std::sort(near.begin(), near.end(), by_tag);
  sort_by_object();
  for (const auto &[a, b] : meeting) {
    search(a, b, true);
    search(b, a, false);
  }
  sort_found([](const Pair &f) { return f.high; });
  sort_found([](const Pair &f) { return f.low; });
}

void ContactSearch::sort_by_object()
{
  begin.assign(zone.size() + 1, 0);
  for (const Particle &one : near) ++begin[one.object + 1];
  for (std::size_t n = 1; n < begin.size(); ++n) begin[n] += begin[n - 1];
  of_object.resize(near.size());
  std::vector<int> at(begin.begin(), begin.end() - 1);
  for (std::size_t n = 0; n < near.size(); ++n) of_object[at[near[n].object]++] = static_cast<int>(n);
}

// Boundary particles of `seeking` against guards of `guarding`, the particles that form the barrier; each within range of the
// other object's box. Thin particles are both: a pair of them is found from one side only, the one with `thin_too`.
void ContactSearch::search(int seeking, int guarding, bool thin_too)
{
  pick(guards, guarding, BARRIER | THIN, boxes[seeking].grown(set.range));
  if (guards.size() == 0) return;
  pick(seekers, seeking, BOUNDARY, boxes[guarding].grown(set.range));
  if (seekers.size() == 0) return;

  close.resize(guards.size() + STRIP);
  if (static_cast<std::size_t>(guards.size()) * seekers.size() <= PAIRS_TO_TRY) {
    for (int s = 0; s < seekers.size(); ++s) look(s, guards, 0, guards.size(), thin_too);
    return;
  }
  const auto place = [&](const ObjectParticles &side, int k) { return near[side.rank[k]].x; };
  const Grid grid([&](int k) { return place(guards, k); }, guards.size(), set.range);
  sorted.clear(guards.size());
  for (const int k : grid.order()) sorted.add(place(guards, k), guards.rank[k]);
  for (int s = 0; s < seekers.size(); ++s)
    grid.ranges(place(seekers, s), [&](int from, int to) { look(s, sorted, from, to, thin_too); });
}

void ContactSearch::pick(ObjectParticles &side, int object, int wanted, const Box &inside) const
{
  side.clear(begin[object + 1] - begin[object]);
  for (int k = begin[object]; k < begin[object + 1]; ++k) {
    const Particle &one = near[of_object[k]];
    if (one.role & wanted && inside.contains(one.x)) side.add(one.x, of_object[k]);
  }
}

// One seeker against guards that stand in a row.
void ContactSearch::look(int seeker, const ObjectParticles &side, int from, int to, bool thin_too)
{
  const Vec3 at = seekers.place[seeker];
  const double of_seeker[] = {at.x, at.y, at.z};
  const int many = set.filter->within(side.place.all().data(), from, to, of_seeker, set.range * set.range, close.data());
  for (int m = 0; m < many; ++m) {
    const Vec3 d = at - side.place[close[m]];
    consider(seekers.rank[seeker], side.rank[close[m]], dot(d, d), thin_too);
  }
}

void ContactSearch::consider(int a, int b, double r2, bool thin_too)
{
  const Particle &one = near[a], &other = near[b];
  if (!thin_too && one.role & other.role & THIN) return;
  if (!one.moves && !other.moves) return;
  const double reach = reach_of(one, other);
  if (reach > 0.0 && r2 < (reach + set.skin) * (reach + set.skin)) found.push_back({std::min(a, b), std::max(a, b)});
}

double ContactSearch::reach_of(const Particle &one, const Particle &other) const
{ return reach_factor(one.role, other.role, set.thin_ratio) * std::max(one.reach, other.reach); }

// Sorts by counting: twice as many pairs take twice as long.
template <class Key> void ContactSearch::sort_found(Key key)
{
  std::vector<int> at(near.size() + 1, 0);
  for (const Pair &f : found) ++at[key(f) + 1];
  for (std::size_t n = 1; n < at.size(); ++n) at[n] += at[n - 1];
  std::vector<Pair> order(found.size());
  for (const Pair &f : found) order[at[key(f)]++] = f;
  found.swap(order);
}

}    // namespace mdanim
