// SPDX-License-Identifier: GPL-2.0-only

#include "folds/fold_surface.h"

#include <algorithm>
#include <numeric>

namespace mdanim {

NumberRows::NumberRows(std::size_t rows, const std::vector<std::array<int, 2>> &pairs) : first(rows + 1, 0), numbers(pairs.size())
{
  for (const auto &[row, number] : pairs) ++first[row + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<int> next(first.begin(), first.end() - 1);
  for (const auto &[row, number] : pairs) numbers[next[row]++] = number;
}

template <class Bodies, class Visit> static void each_corner(const Bodies &bodies, const Visit &visit)
{
  for (std::size_t n = 0; n < bodies.size(); ++n)
    for (const int p : bodies[n]) visit(p, static_cast<int>(n));
}

FoldSurface::FoldSurface(const FoldObject &object) : object(object), seen(object.particles.size(), 0)
{
  const std::size_t particles = object.particles.size();
  std::vector<std::array<int, 2>> rows;
  const auto append = [&rows](int p, int n) { rows.push_back({p, n}); };
  if (!object.cells.empty())
    each_corner(object.cells, append);
  else if (!object.triangles.empty())
    each_corner(object.triangles, append);
  else
    each_corner(object.segments, append);
  bodies = NumberRows(particles, rows);
  links = NumberRows(particles, links_of_bodies());
  if (object.cells.empty()) {
    element.assign(std::max(object.triangles.size(), object.segments.size()), ITSELF | OTHERS);
    particle.assign(particles, ITSELF | OTHERS);
    return;
  }
  whole.assign(object.cells.size(), 1);
  is_end.assign(particles, 0);
  element.assign(object.triangles.size(), 0);
  particle.assign(particles, 0);
  rows.clear();
  for (std::size_t e = 0; e < element.size(); ++e)
    for (const int c : object.sides[e])
      if (c >= 0) rows.push_back({c, static_cast<int>(e)});
  faces = NumberRows(object.cells.size(), rows);
  for (std::size_t e = 0; e < element.size(); ++e) look_at_face(static_cast<int>(e));
}

// Edges of elements; of cells edges and diagonals of faces. Each in both directions, once.
std::vector<std::array<int, 2>> FoldSurface::links_of_bodies() const
{
  std::vector<std::array<int, 2>> found;
  const auto append = [&found](const auto &corner, bool (*is_one)(int, int)) {
    for (int k = 0; k < static_cast<int>(corner.size()); ++k)
      for (int n = 0; n < static_cast<int>(corner.size()); ++n)
        if (n != k && is_one(n, k)) found.push_back({corner[n], corner[k]});
  };
  const auto any = [](int, int) { return true; };
  for (const auto &cell : object.cells) append(cell, [](int a, int b) { return !FoldObject::is_across(a, b); });
  if (object.cells.empty())
    for (const auto &one : object.triangles) append(one, any);
  for (const auto &one : object.segments) append(one, any);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

void FoldSurface::open(int low, int high)
{
  int entry[2];
  for (int k = 0; k < 2; ++k) {
    const int number = k ? high : low;
    const auto found = std::lower_bound(object.particles.begin(), object.particles.end(), number);
    if (found == object.particles.end() || *found != number) return;
    entry[k] = static_cast<int>(found - object.particles.begin());
  }
  const auto [a, b] = entry;
  std::replace(links.begin(a), links.end(a), b, -1);
  std::replace(links.begin(b), links.end(b), a, -1);
  torn = true;
  ends.insert(ends.end(), {a, b});
  if (object.cells.empty())
    look_at_layer(a, b);
  else
    look_at_cells(a, b);
}

void FoldSurface::look_at_layer(int a, int b)
{
  const auto has = [this, b](int e) {
    if (object.triangles.empty()) return object.segments[e][0] == b || object.segments[e][1] == b;
    return std::find(object.triangles[e].begin(), object.triangles[e].end(), b) != object.triangles[e].end();
  };
  for (const int *e = bodies.begin(a); e < bodies.end(a); ++e) {
    if (!has(*e) || !element[*e]) continue;
    element[*e] = 0;
    changed.push_back(*e);
  }
}

void FoldSurface::look_at_cells(int a, int b)
{
  is_end[a] = is_end[b] = 1;
  for (const int end : {a, b})
    for (const int *c = bodies.begin(end); c < bodies.end(end); ++c) {
      const auto &corner = object.cells[*c];
      if (end == a && std::find(corner.begin(), corner.end(), b) != corner.end()) whole[*c] = 0;
    }
  for (const int end : {a, b})
    for (const int *c = bodies.begin(end); c < bodies.end(end); ++c)
      for (const int *e = faces.begin(*c); e < faces.end(*c); ++e) look_at_face(*e);
}

// The face of cells between one that is whole and none, and its corners.
void FoldSurface::look_at_face(int e)
{
  const auto [one, other] = object.sides[e];
  const bool has_one = whole[one], has_other = other >= 0 && whole[other];
  const auto bares = [this](int c) {
    return std::any_of(object.cells[c].begin(), object.cells[c].end(), [this](int p) { return is_end[p]; });
  };
  const unsigned char before = element[e];
  element[e] = has_one == has_other ? 0 : ITSELF | (other >= 0 || bares(one) ? OTHERS : 0);
  if (element[e] == before) return;
  changed.push_back(e);
  for (const int p : object.triangles[e]) {
    particle[p] = 0;
    for (const int *c = bodies.begin(p); c < bodies.end(p); ++c)
      for (const int *f = faces.begin(*c); f < faces.end(*c); ++f) {
        const auto &corner = object.triangles[*f];
        if (corner[0] == p || corner[1] == p || corner[2] == p) particle[p] |= element[*f];
      }
  }
}

}    // namespace mdanim
