// SPDX-License-Identifier: GPL-2.0-only

#include "contact/contact_object.h"

#include <algorithm>
#include <limits>

namespace mdanim {

// A map that is linear along each axis maps a box into the box around the images of its corners.
static Box box_of(const PointCell &cell, const ContactObject &owner, const PaddedVec3 *place, bool &is_there)
{
  const int row = owner.body->row(), layer = owner.body->layer();
  if (owner.body->is_line()) {
    Box box;
    const int slot = owner.slot[cell.place];
    is_there = slot >= 0;
    if (is_there) box.include(&place[slot].value.x);
    return box;
  }
  Vec3 corner[8];
  int missing = 0;
  for (int c = 0; c < 8; ++c) {
    if (owner.is_rigid()) {
      const int i = cell.place % row, j = cell.place % layer / row, k = cell.place / layer;
      corner[c] = owner.rigid.x + owner.rigid.to_space({i + 1.0 * (c & 1), j + 1.0 * (c >> 1 & 1), k + 1.0 * (c >> 2)});
      continue;
    }
    const int slot = owner.slot[cell.place + (c & 1) + row * (c >> 1 & 1) + layer * (c >> 2)];
    missing |= slot;
    corner[c] = place[slot].value;
  }
  is_there = missing >= 0;
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
  Box box;
  for (const Vec3 &one : corner) box.include(&one.x);
  return box;
}

PointFinder::PointFinder(const ContactObject &owner, const ContactArrays &arrays) : owner(owner), arrays(arrays)
{
  const std::vector<PointCell> &all = owner.body->point_cells();
  cells.reserve(all.size());
  for (int c = 0; c < static_cast<int>(all.size()); ++c) {
    bool is_there = false;
    const Box box = box_of(all[c], owner, arrays.place(), is_there);
    if (is_there) cells.emplace_back(c, box);
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
      if (owner.has_point(points[n])) least = std::min(least, dot(direction, owner.place_of(points[n], arrays.place())));
    }
  };
  if (first != cells.end()) try_points_of(owner.body->point_cells()[first->first]);
  for (const auto &[c, box] : cells)
    if (low(box) < least && c != first->first) try_points_of(owner.body->point_cells()[c]);
  return least;
}

OuterCells::OuterCells(const ContactObject &owner, const ContactArrays &arrays)
    : grid([](int) { return static_cast<const double *>(nullptr); }, 0, 1.0)
{
  const ContactBody &body = *owner.body;
  for (int k = 0; k < body.count(2); ++k)
    for (int j = 0; j < body.count(1); ++j)
      for (int i = 0; i < body.count(0); ++i) {
        if (!body.is_outer(i, j, k)) continue;
        const int low = owner.slot[body.place(i, j, k)], high = owner.slot[body.place(i + 1, j + 1, k + 1)];
        if (low < 0 || high < 0) continue;
        cells.push_back({{i, j, k}, low, high});
        middle.push_back(0.5 * (arrays.place()[low].value + arrays.place()[high].value));
      }
  grid = Grid([this](int n) { return &middle[n].x; }, static_cast<int>(middle.size()), SEARCHED * body.spacing());
}

// Uses the present places of cells, so that the answer does not depend on when lists were made.
std::array<int, 3> OuterCells::nearest(const Vec3 &x, const PaddedVec3 *place) const
{
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  grid.around(&x.x, [&](int slot) {
    const int n = grid.order()[slot];
    const Vec3 d = 0.5 * (place[cells[n].low].value + place[cells[n].high].value) - x;
    if (dot(d, d) < least || (dot(d, d) == least && n < best)) least = dot(d, d), best = n;
  });
  return best < 0 ? std::array<int, 3>{-1, -1, -1} : cells[best].at;
}

}    // namespace mdanim
