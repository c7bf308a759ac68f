// SPDX-License-Identifier: GPL-2.0-only
// Places of an object's particles in a step, and how they have moved, for one set of instructions (simd/of_set.h).

#include "contact/contact_lanes.h"
#include "simd/of_set.h"

namespace mdanim {
namespace {

// Calls four(first, places, displacements) for each four particles and one(number, place, displacement) for each that is left.
template <class OfFour, class OfOne>
MDANIM_ALWAYS_INLINE void each_moved(const MoveTask &task, const OfFour &four, const OfOne &one)
{
  int s = task.first;
  for (; s + LANES <= task.end; s += LANES) {
    const Vec<Four> now = load<Four>(task.to, s);
    four(s, now, now - gather_rows([&](int lane) { return &task.last[s + lane].value.x; }));
  }
  for (; s < task.end; ++s) {
    const Vec3 now = {task.to[0][s], task.to[1][s], task.to[2][s]};
    one(s, now, now - task.last[s].value);
  }
}

}    // namespace

MovedBy MDANIM_OF_SET(move_particles)(const MoveTask &task);
MovedBy MDANIM_OF_SET(move_particles)(const MoveTask &task)
{
  Vec<Four> sums;
  Vec3 sum;
  each_moved(
      task, [&](int, const Vec<Four> &, const Vec<Four> &way) { sums += way; },
      [&](int, const Vec3 &, const Vec3 &way) { sum += way; });
  const auto total = [](const Four &of) { return (of[0] + of[1]) + (of[2] + of[3]); };
  sum += {total(sums.x), total(sums.y), total(sums.z)};
  const Vec3 mean = (1.0 / (task.end - task.first)) * sum;
  const Vec<Four> means = {constant<Four>(mean.x), constant<Four>(mean.y), constant<Four>(mean.z)};
  Four squares{};
  double square = 0.0;
  each_moved(
      task,
      [&](int s, const Vec<Four> &now, const Vec<Four> &way) {
        const Vec<Four> off = way - means;
        squares = larger(squares, dot(off, off));
        const Four column[4] = {now.x, now.y, now.z, Four{}};
        store_columns(column, [&](int lane) { return &task.now[s + lane].value.x; });
      },
      [&](int s, const Vec3 &now, const Vec3 &way) {
        const Vec3 off = way - mean;
        square = larger<double>(square, dot(off, off));
        task.now[s].value = now;
      });
  for (int lane = 0; lane < LANES; ++lane) square = larger<double>(square, squares[lane]);
  return {mean, square};
}

}    // namespace mdanim
