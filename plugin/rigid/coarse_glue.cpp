// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/coarse_glue.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace mdanim {

static constexpr double STANDS =
    1e12;    // over the diagonal of the first group, which stands: nothing resists motions of the whole

// Halves groups along their longest side, the largest one first.
void CoarseGlue::find_groups(const std::vector<Vec3> &places)
{
  const std::size_t wanted = std::min(MOST_GROUPS, places.size() / OF_GROUP);
  std::vector<std::vector<int>> groups(1, std::vector<int>(places.size()));
  std::iota(groups[0].begin(), groups[0].end(), 0);
  const auto along = [&](int piece, int axis) {
    const Vec3 &x = places[piece];
    return axis == 0 ? x.x : axis == 1 ? x.y : x.z;
  };
  while (groups.size() < wanted) {
    const auto is_smaller = [](const std::vector<int> &a, const std::vector<int> &b) { return a.size() < b.size(); };
    std::vector<int> &own = *std::max_element(groups.begin(), groups.end(), is_smaller);
    int longest = 0;
    double most = -1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto is_lower = [&](int a, int b) { return along(a, axis) < along(b, axis); };
      const auto [low, high] = std::minmax_element(own.begin(), own.end(), is_lower);
      const double size = along(*high, axis) - along(*low, axis);
      if (size > most) most = size, longest = axis;
    }
    std::stable_sort(own.begin(), own.end(), [&](int a, int b) { return along(a, longest) < along(b, longest); });
    const auto half = own.begin() + static_cast<std::ptrdiff_t>(own.size() / 2);
    std::vector<int> upper(half, own.end());
    own.erase(half, own.end());
    groups.push_back(std::move(upper));
  }
  group.assign(places.size(), 0);
  arm.assign(places.size(), {});
  centre.assign(groups.size(), {});
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const int piece : groups[g]) centre[g] += (1.0 / static_cast<double>(groups[g].size())) * places[piece];
    for (const int piece : groups[g]) group[piece] = static_cast<int>(g), arm[piece] = places[piece] - centre[g];
  }
}

void CoarseGlue::make(const std::vector<GlueSpring> &springs, const std::vector<Vec3> &places)
{
  centre.clear();
  if (places.size() < LEAST) return;
  find_groups(places);
  const std::size_t size = 6 * centre.size();
  lower.assign(size * size, 0.0);
  for (const GlueSpring &one : springs) {
    const int a = group[one.a], b = group[one.b];
    if (a == b) continue;
    const Vec3 arm_a = arm[one.a] + one.arm_a, arm_b = arm[one.b] + one.arm_b;
    const double twist[3] = {one.twist.x, one.twist.y, one.twist.z};
    std::array<std::size_t, 12> at;
    for (std::size_t k = 0; k < 6; ++k)
      at[k] = 6 * static_cast<std::size_t>(a) + k, at[k + 6] = 6 * static_cast<std::size_t>(b) + k;
    // Adds stiff w w^T: w is how far the face opens by each motion of both groups.
    const auto add_row = [&](double stiff, const Vec3 &place_a, const Vec3 &turn_a, const Vec3 &place_b, const Vec3 &turn_b) {
      const double w[12] = {place_a.x, place_a.y, place_a.z, turn_a.x, turn_a.y, turn_a.z,
                            place_b.x, place_b.y, place_b.z, turn_b.x, turn_b.y, turn_b.z};
      for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 12; ++j)
          if (at[j] <= at[i]) lower[at[i] * size + at[j]] += stiff * w[i] * w[j];
    };
    for (int k = 0; k < 3; ++k) {
      const Vec3 &e = one.axis[k];
      add_row(one.stiffness, e, cross(arm_a, e), -1.0 * e, -1.0 * cross(arm_b, e));
      add_row(twist[k], {}, e, {}, -1.0 * e);
    }
  }
  factorize();
}

void CoarseGlue::factorize()
{
  const std::size_t size = 6 * centre.size();
  std::vector<double> scaled(size);
  for (std::size_t i = 0; i < size; ++i) {
    double *const row = &lower[i * size];
    if (i < 6) row[i] *= STANDS;
    for (std::size_t j = 0; j < i; ++j) {
      const double *const other = &lower[j * size];
      double left = row[j];
      for (std::size_t k = 0; k < j; ++k) left -= scaled[k] * other[k];
      scaled[j] = left;    // L D
      row[j] = left / other[j];
    }
    for (std::size_t j = 0; j < i; ++j) row[i] -= scaled[j] * row[j];
  }
}

void CoarseGlue::add(const PieceMotions &load, PieceMotions &to) const
{
  const std::size_t size = 6 * centre.size();
  std::vector<double> x(size, 0.0);
  for (std::size_t n = 0; n < load.size(); ++n) {
    const Vec3 &force = load[n].place, torque = load[n].turn + cross(arm[n], force);
    double *const own = &x[6 * static_cast<std::size_t>(group[n])];
    own[0] += force.x, own[1] += force.y, own[2] += force.z;
    own[3] += torque.x, own[4] += torque.y, own[5] += torque.z;
  }
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t k = 0; k < i; ++k) x[i] -= lower[i * size + k] * x[k];
  for (std::size_t i = 0; i < size; ++i) x[i] /= lower[i * size + i];
  for (std::size_t i = size; i-- > 0;)
    for (std::size_t k = 0; k < i; ++k) x[k] -= lower[i * size + k] * x[i];
  for (std::size_t n = 0; n < load.size(); ++n) {
    const double *const own = &x[6 * static_cast<std::size_t>(group[n])];
    const Vec3 turn{own[3], own[4], own[5]};
    to[n].place += Vec3{own[0], own[1], own[2]} + cross(turn, arm[n]);
    to[n].turn += turn;
  }
}

}    // namespace mdanim
