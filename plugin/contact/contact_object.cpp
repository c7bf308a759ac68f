// SPDX-License-Identifier: GPL-2.0-only

#include "contact/contact_object.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <utility>

namespace mdanim {

// The place of the particle of a point of kind INNER: the low corner of its cell.
static int inner_place(const ContactBody &body, int point)
{
  const int (&cell)[3] = body.points()[point].cell;
  return body.place(cell[0], cell[1], cell[2]);
}

TornBody::TornBody(const ContactBody &body, const std::vector<int> &ends)
    : at_tear(body.slots(), 0), replaced(body.points().size(), 0), area(body.areas(), body.areas() + body.points().size())
{
  for (const int slot : ends) at_tear[slot] = 1;
  if (body.is_line())
    find_torn_between(body, ends);
  else
    find_replaced(body, laid_bare(body, ends));
  const std::vector<int> own = body.is_line() ? std::vector<int>(replaced.size(), -1) : own_particles(body);
  for (std::size_t p = 0; p < replaced.size(); ++p) {
    const PointCarriers by = body.carriers_of(static_cast<int>(p));
    first.push_back(static_cast<int>(carriers.size()));
    if (!replaced[p])
      carriers.insert(carriers.end(), by.first, by.middle);
    else if (own[p] >= 0)
      carriers.push_back({own[p], 1.0});
    first.push_back(static_cast<int>(carriers.size()));
    if (!replaced[p]) carriers.insert(carriers.end(), by.middle, by.last);
  }
  first.push_back(static_cast<int>(carriers.size()));
  carriers.push_back({0, 0.0});    // one more, as bodies have it
}

// Points between particles of a line go with a link between these.
void TornBody::find_torn_between(const ContactBody &body, const std::vector<int> &ends)
{
  std::set<std::pair<int, int>> gone;
  for (std::size_t n = 0; n + 1 < ends.size(); n += 2) gone.insert(std::minmax(ends[n], ends[n + 1]));
  for (int p = body.particles(); p < static_cast<int>(replaced.size()); ++p) {
    const PointCarriers by = body.carriers_of(p);
    for (const PointCarrier *one = by.first; one < by.middle; ++one)
      for (const PointCarrier *other = by.first; other < one; ++other)
        if (gone.count(std::minmax(one->slot, other->slot))) replaced[p] = 1;
  }
}

void TornBody::find_replaced(const ContactBody &body, const std::vector<char> &bare)
{
  for (std::size_t p = 0; p < replaced.size(); ++p) {
    const PointCarriers by = body.carriers_of(static_cast<int>(p));
    if (body.points()[p].kind == PointKind::INNER)
      replaced[p] = bare[inner_place(body, static_cast<int>(p))];
    else
      replaced[p] = std::any_of(by.first, by.last, [this](const PointCarrier &one) { return at_tear[one.slot] != 0; });
  }
}

// Which particles are corners of a cell with both ends of a link, by places.
std::vector<char> TornBody::laid_bare(const ContactBody &body, const std::vector<int> &ends) const
{
  std::vector<char> found(at_tear.size(), 0);
  const auto at = [&](int place, int axis) {
    return axis == 0 ? place % body.row() : axis == 1 ? place % body.layer() / body.row() : place / body.layer();
  };
  for (std::size_t n = 0; n + 1 < ends.size(); n += 2) {
    int from[3], to[3];
    for (int d = 0; d < 3; ++d) {
      const auto [low, high] = std::minmax({at(ends[n], d), at(ends[n + 1], d)});
      from[d] = high - 1, to[d] = low;    // cells that have both
    }
    for (int k = from[2]; k <= to[2]; ++k)
      for (int j = from[1]; j <= to[1]; ++j)
        for (int i = from[0]; i <= to[0]; ++i) {
          if (!body.is_filled(i, j, k)) continue;
          for (int c = 0; c < 8; ++c) found[body.place(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))] = 1;
        }
  }
  return found;
}

// The particle of each point that is replaced, -1 for none, those first that carry most of a point; and the areas of these: of a
// particle inside of the body, the larger one of those that it carried and its own.
std::vector<int> TornBody::own_particles(const ContactBody &body)
{
  struct Carried {
    double weight;
    int point, slot;
  };
  std::vector<Carried> all;
  std::vector<double> of_particle(at_tear.size(), 0.0), of_fine(at_tear.size(), 0.0);    // one set or the other acts
  for (int p = 0; p < static_cast<int>(replaced.size()); ++p) {
    if (!replaced[p]) continue;
    const PointCarriers by = body.carriers_of(p);
    double sum = 0.0;
    for (const PointCarrier *one = by.first; one < by.middle; ++one) sum += std::fabs(one->weight);
    for (const PointCarrier *one = by.first; one < by.middle; ++one) {
      all.push_back({std::fabs(one->weight), p, one->slot});
      (body.points()[p].kind == PointKind::FINE ? of_fine : of_particle)[one->slot] +=
          body.areas()[p] * std::fabs(one->weight) * sum;
    }
  }
  for (std::size_t slot = 0; slot < of_fine.size(); ++slot) of_particle[slot] = std::max(of_particle[slot], of_fine[slot]);
  std::stable_sort(all.begin(), all.end(), [](const Carried &a, const Carried &b) { return a.weight > b.weight; });
  std::vector<int> found(replaced.size(), -1);
  std::vector<char> has_one(at_tear.size(), 0);
  for (int p = 0; p < static_cast<int>(replaced.size()); ++p) {
    if (!replaced[p] || body.points()[p].kind != PointKind::INNER) continue;
    found[p] = inner_place(body, p);
    has_one[found[p]] = 1;
    area[p] = std::max(area[p], of_particle[found[p]]);
  }
  for (const Carried &one : all) {
    if (found[one.point] >= 0 || has_one[one.slot]) continue;
    found[one.point] = one.slot;
    has_one[one.slot] = 1;
    area[one.point] = of_particle[one.slot];
  }
  return found;
}

bool ContactObject::has_changed(int point, const TornBody *before) const
{
  if (!torn->is_replaced(point)) return false;
  if (!before || !before->is_replaced(point) || before->areas()[point] != torn->areas()[point]) return true;
  const PointCarriers was = before->carriers_of(point), now = torn->carriers_of(point);
  return was.middle - was.first != now.middle - now.first || (now.first < now.middle && was.first->slot != now.first->slot);
}

void ContactObject::find_host_slots()
{
  slot_of_host.clear();
  if (!torn) return;
  slot_of_host = slot;
  for (std::size_t at = 0; at < slot_of_host.size(); ++at)
    if (torn->is_at_tear(static_cast<int>(at))) slot_of_host[at] = -1;
}

void ContactObject::find_outline(const PaddedVec3 *place)
{
  outline.forget();
  if (!is_host || !body->is_round() || is_rigid() || first_slot == last_slot) return;
  std::vector<Vec3> grid(last_slot - first_slot);
  for (std::size_t at = 0; at < slot.size(); ++at)
    if (slot[at] >= 0) grid[slot[at] - first_slot] = body->grid_place(static_cast<int>(at));
  outline.begin(*body, grid, place + first_slot);
}

// Volume of a cell, by the means of its edges; more than any where it is not here.
static double volume_of_cell(const int *slots, int row, int layer, const PaddedVec3 *place)
{
  Vec3 corner[8];
  int missing = 0;
  for (int c = 0; c < 8; ++c) {
    const int slot = slots[(c & 1) + row * (c >> 1 & 1) + layer * (c >> 2)];
    missing |= slot;
    corner[c] = place[slot].value;
  }
  const auto edge = [&corner](int step) {
    Vec3 sum;
    for (int c = 0; c < 8; ++c)
      if (!(c & step)) sum += corner[c | step] - corner[c];
    return 0.25 * sum;
  };
  return missing < 0 ? Box::FAR : dot(edge(1), cross(edge(2), edge(4)));
}

void ContactObject::find_crushed(const PaddedVec3 *place)
{
  constexpr double LEAST = 0.5, CALM = 0.8;    // volumes of cells: not crushed, and not soon without a push
  constexpr double CHANGE = 12.0;              // of a volume over that of places, in cells, at most
  if (!is_host || is_rigid() || body->is_line() || (is_calm && !is_pushed) || (unchecked -= stir) >= 0.0) return;
  const double h = body->spacing();
  double least = 1.0;
  for (int k = 0; k < body->count(2); ++k)
    for (int j = 0; j < body->count(1); ++j)
      for (int i = 0; i < body->count(0); ++i)
        if (body->is_filled(i, j, k)) {
          const int *const slots = host_slots().data() + body->place(i, j, k);
          if (slots[0] >= 0) least = std::min(least, volume_of_cell(slots, body->row(), body->layer(), place) / (h * h * h));
        }
  is_crushed = least < LEAST;
  is_calm = least > CALM;
  unchecked = h * std::fabs(least - LEAST) / CHANGE;
}

// Points of a torn object may be far from the rest of their cells, a line has points alone, and where an object is near planes
// only those of its particles are here that carry points.
static Box box_of_points(const PointCell &cell, const ContactObject &owner, const PaddedVec3 *place)
{
  Box box;
  for (int n = cell.first; n < cell.last; ++n) {
    const int point = owner.body->points_by_cell()[n];
    if (!owner.has_place_of(point)) continue;
    const Vec3 x = owner.place_of(point, place);
    box.include(&x.x);
  }
  return box;
}

// The box around the points of a cell that are here. A map that is linear along each axis maps a box into the box around the
// images of its corners.
static Box box_of(const PointCell &cell, const ContactObject &owner, const PaddedVec3 *place)
{
  const int row = owner.body->row(), layer = owner.body->layer();
  Vec3 corner[8];
  int here = 0;
  for (int c = 0; c < 8; ++c) {
    if (owner.is_rigid()) {
      const int i = cell.place % row, j = cell.place % layer / row, k = cell.place / layer;
      corner[c] = owner.rigid.x + owner.rigid.to_space({i + 1.0 * (c & 1), j + 1.0 * (c >> 1 & 1), k + 1.0 * (c >> 2)});
      ++here;
      continue;
    }
    const int slot = owner.slot[cell.place + (c & 1) + row * (c >> 1 & 1) + layer * (c >> 2)];
    here += slot >= 0;
    corner[c] = place[slot].value;
  }
  Box box;
  if (here == 0) return box;
  if (here < 8) return owner.body->points_are_particles() ? box_of_points(cell, owner, place) : box;
  const auto stretch = [&corner](int step, double low, double high) {
    for (int c = 0; c < 8; ++c) {
      if (c & step) continue;
      const Vec3 first = corner[c], across = corner[c | step] - first;
      corner[c] = first + low * across;
      corner[c | step] = first + high * across;
    }
  };
  stretch(1, cell.low.x, cell.high.x);
  stretch(2, cell.low.y, cell.high.y);
  stretch(4, cell.low.z, cell.high.z);
  for (const Vec3 &one : corner) box.include(&one.x);
  return box;
}

PointFinder::PointFinder(const ContactObject &owner, const ContactArrays &arrays) : owner(owner), arrays(arrays)
{
  const std::vector<PointCell> &all = owner.body->point_cells();
  cells.reserve(all.size());
  for (int c = 0; c < static_cast<int>(all.size()); ++c) {
    const Box box = (owner.torn || owner.body->is_line() ? box_of_points : box_of)(all[c], owner, arrays.place());
    if (!box.empty()) cells.emplace_back(c, box);
  }
}

double PointFinder::least_along(const Vec3 &direction) const
{
  const std::vector<int> &points = owner.body->points_by_cell();
  const auto low = [&](const Box &box) { return dot(direction, farthest(box, -1.0 * direction)); };
  const auto first = std::min_element(cells.begin(), cells.end(),
                                      [&](const auto &one, const auto &other) { return low(one.second) < low(other.second); });
  double least = Box::FAR;
  const auto try_points_of = [&](const PointCell &cell) {
    for (int n = cell.first; n < cell.fine; ++n) {    // points that are not fine are close enough for this
      if (owner.has_place_of(points[n])) least = std::min(least, dot(direction, owner.place_of(points[n], arrays.place())));
    }
  };
  if (first != cells.end()) try_points_of(owner.body->point_cells()[first->first]);
  for (const auto &[c, box] : cells)
    if (low(box) < least && c != first->first) try_points_of(owner.body->point_cells()[c]);
  return least;
}

OuterCells::OuterCells(const ContactObject &owner, const ContactArrays &arrays)
    : spacing(owner.body->spacing()), grid([](int) { return static_cast<const double *>(nullptr); }, 0, 1.0)
{
  const ContactBody &body = *owner.body;
  std::vector<OuterCell> found;
  std::vector<Vec3> middle;
  for (int k = 0; k < body.count(2); ++k)
    for (int j = 0; j < body.count(1); ++j)
      for (int i = 0; i < body.count(0); ++i) {
        if (!body.is_outer(i, j, k)) continue;
        const std::vector<int> &slots = owner.host_slots();
        const int low = slots[body.place(i, j, k)], high = slots[body.place(i + 1, j + 1, k + 1)];
        if (low < 0 || high < 0) continue;
        found.push_back({{i, j, k}, low, high, static_cast<int>(found.size())});
        middle.push_back(0.5 * (arrays.place()[low].value + arrays.place()[high].value));
      }
  grid = Grid([&](int n) { return &middle[n].x; }, static_cast<int>(middle.size()), SEARCHED * body.spacing());
  cells.reserve(found.size());
  for (const int n : grid.order()) cells.push_back(found[n]);
}

// Uses the present places of cells, so that the answer does not depend on when lists were made. Loops have no branch that the
// processor would have to guess.
OuterCells::NearestCell OuterCells::nearest(const Vec3 &x, const PaddedVec3 *place) const
{
  constexpr double KNOWN = 3.0;    // spacings to go to a cell that is not searched, at least, since this was made
  thread_local std::vector<double> squares;
  squares.resize(cells.size());
  const auto each = [&](const auto &visit) __attribute__((always_inline)) {
    grid.ranges(&x.x, [&](int from, int to) {
      for (int n = from; n < to; ++n) visit(cells[n], squares[n]);
    });
  };
  double least = std::numeric_limits<double>::infinity(), others = KNOWN * spacing * KNOWN * spacing;
  each([&](const OuterCell &one, double &square) {
    const Vec3 d = 0.5 * (place[one.low].value + place[one.high].value) - x;
    square = dot(d, d);
    least = square < least ? square : least;
  });
  const OuterCell *best = nullptr;
  each([&](const OuterCell &one, double square) {
    if (square == least && (!best || one.number < best->number)) best = &one;
  });
  if (!best || !(least < std::numeric_limits<double>::infinity())) return {};
  const std::array<int, 3> cell = best->at;
  each([&](const OuterCell &one, double square) {
    const auto beside = [&](int d) { return static_cast<unsigned>(one.at[d] - cell[d] + 1) <= 2; };
    const bool counts = !(beside(0) & beside(1) & beside(2)) & (square < others);
    others = counts ? square : others;
  });
  return {cell, std::sqrt(least), std::sqrt(others)};
}

}    // namespace mdanim
