// SPDX-License-Identifier: GPL-2.0-only
// Places of an object's particles in a step, and how they have moved, for one set of instructions (simd/of_set.h).

#include "contact/contact_lanes.h"
#include "simd/of_set.h"

namespace mdanim {

MovedBy MDANIM_OF_SET(move_particles)(const MoveTask &task);
MovedBy MDANIM_OF_SET(move_particles)(const MoveTask &task)
{
  const Vec<Four> about = {constant<Four>(task.about.x), constant<Four>(task.about.y), constant<Four>(task.about.z)};
  Vec<Four> sums;
  Four squares{};
  int s = task.first;
  for (; s + LANES <= task.end; s += LANES) {
    const Vec<Four> now = load<Four>(task.to, s);
    const Vec<Four> way = now - gather_rows([&](int lane) { return &task.last[s + lane].value.x; }), off = way - about;
    sums += way;
    squares = larger(squares, dot(off, off));
    const Four column[4] = {now.x, now.y, now.z, Four{}};
    store_columns(column, [&](int lane) { return &task.now[s + lane].value.x; });
  }
  const auto total = [](const Four &of) { return (of[0] + of[1]) + (of[2] + of[3]); };
  Vec3 sum = {total(sums.x), total(sums.y), total(sums.z)};
  double square = larger<double>(larger<double>(squares[0], squares[1]), larger<double>(squares[2], squares[3]));
  for (; s < task.end; ++s) {
    const Vec3 now = {task.to[0][s], task.to[1][s], task.to[2][s]}, way = now - task.last[s].value, off = way - task.about;
    sum += way;
    square = larger<double>(square, dot(off, off));
    task.now[s].value = now;
  }
  return {(1.0 / (task.end - task.first)) * sum, square};
}

}    // namespace mdanim
