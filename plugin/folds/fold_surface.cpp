// SPDX-License-Identifier: GPL-2.0-only

#include "folds/fold_surface.h"

#include <algorithm>
#include <numeric>

namespace mdanim {

FoldSurface::FoldSurface(const FoldObject &object) : object(object) { settle(); }

void FoldSurface::open(int low, int high)
{
  const auto has = [this](int p) { return std::binary_search(object.particles.begin(), object.particles.end(), p); };
  if (has(low) && has(high)) gone.insert({low, high});
}

// Whether the link between two entries of the object is gone.
bool FoldSurface::is_gone(int a, int b) const
{
  const auto [low, high] = std::minmax(object.particles[a], object.particles[b]);
  return gone.count({low, high}) > 0;
}

int FoldSurface::root(int p)
{
  while (parts[p] != p) p = parts[p] = parts[parts[p]];
  return p;
}

void FoldSurface::join(int a, int b)
{
  const int one = root(a), other = root(b);
  parts[std::max(one, other)] = std::min(one, other);
}

void FoldSurface::settle()
{
  const std::size_t particles = object.particles.size();
  parts.resize(particles);
  std::iota(parts.begin(), parts.end(), 0);
  if (object.cells.empty())
    settle_layer();
  else
    settle_cells();
  for (std::size_t p = 0; p < particles; ++p) parts[p] = root(static_cast<int>(p));
}

void FoldSurface::settle_layer()
{
  const auto settle_all = [&](const auto &all) {
    element.assign(all.size(), ITSELF | OTHERS);
    for (std::size_t e = 0; e < all.size(); ++e)
      for (std::size_t k = 0; k < all[e].size(); ++k)
        for (std::size_t n = 0; n < k; ++n)
          if (is_gone(all[e][n], all[e][k]))
            element[e] = 0;
          else
            join(all[e][n], all[e][k]);
  };
  if (object.triangles.empty())
    settle_all(object.segments);
  else
    settle_all(object.triangles);
  particle.assign(object.particles.size(), ITSELF | OTHERS);
}

// Particles hang together by cells that are whole, and by the edges and face diagonals that are left of others.
void FoldSurface::settle_cells()
{
  std::vector<char> is_end(object.particles.size(), 0), whole(object.cells.size(), 1), bares(object.cells.size(), 0);
  const auto end_of = [&](int number) {
    return std::lower_bound(object.particles.begin(), object.particles.end(), number) - object.particles.begin();
  };
  for (const auto &[low, high] : gone) is_end[end_of(low)] = is_end[end_of(high)] = 1;
  for (std::size_t c = 0; c < object.cells.size(); ++c) {
    const auto &corner = object.cells[c];
    int ends = 0;
    for (const int p : corner) ends += is_end[p];
    bares[c] = ends > 0;
    for (int k = 0; ends > 1 && k < 8; ++k)
      for (int n = 0; n < k; ++n)
        if (is_end[corner[n]] && is_end[corner[k]] && is_gone(corner[n], corner[k])) whole[c] = 0;
    for (int k = 0; k < 8; ++k)
      for (int n = 0; n < k; ++n)
        if (whole[c] ? n == 0 : !FoldObject::is_across(n, k) && !is_gone(corner[n], corner[k])) join(corner[n], corner[k]);
  }
  element.assign(object.triangles.size(), 0);
  particle.assign(object.particles.size(), 0);
  for (std::size_t e = 0; e < element.size(); ++e) {
    const auto [one, other] = object.sides[e];
    const bool has_one = whole[one], has_other = other >= 0 && whole[other];
    if (has_one == has_other) continue;
    element[e] = ITSELF | (other >= 0 || bares[one] ? OTHERS : 0);
    for (const int p : object.triangles[e]) particle[p] |= element[e];
  }
}

}    // namespace mdanim
