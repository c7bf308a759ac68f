// SPDX-License-Identifier: GPL-2.0-only
// Places and velocities of a few particles, of which every rank needs all.

#pragma once

#include "numbers/vec3.h"

#include "lmptype.h"
#include "pointers.h"

#include <cstddef>
#include <string>
#include <vector>

namespace mdanim {

// All ranks call all functions together, but for those that are const.
class SharedMotion : protected LAMMPS_NS::Pointers {
 public:
  static constexpr int ELSEWHERE = -1;

  explicit SharedMotion(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  // Chooses the particles with these tags, which ascend; they are numbered in this order.
  void choose(std::vector<LAMMPS_NS::tagint> ascending) { tags = std::move(ascending); }
  int number_of(LAMMPS_NS::tagint tag) const;
  // To be called after particles have come to other ranks or indices, when LAMMPS's map is up to date. Raises a LAMMPS error for
  // a particle that is gone; `who` begins the message.
  void locate(const std::string &who, int groupbit);
  // To be called after particles have moved.
  void share();

  // Where place() and speed() have a particle, until the next locate().
  int row_of(int number) const { return rows[number]; }
  Vec3 place(int row) const { return vec3(x + stride * static_cast<std::size_t>(row)); }
  Vec3 speed(int row) const { return vec3(v + stride * static_cast<std::size_t>(row)); }
  int local(int number) const { return locals[number]; }              // index here, or ELSEWHERE
  bool is_pushed(int number) const { return pushed[number] != 0; }    // it is in the group
  std::size_t bytes() const;

 private:
  std::vector<LAMMPS_NS::tagint> tags;
  std::vector<int> locals, rows;
  std::vector<char> pushed;
  std::vector<int> counts, starts;    // of the numbers that ranks send
  std::vector<double> sent, received;
  const double *x = nullptr, *v = nullptr;
  std::size_t stride = 3;
};

}    // namespace mdanim
