// SPDX-License-Identifier: GPL-2.0-only
// Empty kernels for the tables, which this library never calls: its styles and functions use the loops of waves alone. Compiled
// in full, the others take a fifth of the time of the library.

#include <cstdlib>

namespace mdanim {

struct Pass;

#define MDANIM_A_SET(set)                                                                                                        \
  extern const char spring_kernels_##set[1];                                                                                     \
  const char spring_kernels_##set[1] = {};                                                                                       \
  extern const char pair_filter_##set[1];                                                                                        \
  const char pair_filter_##set[1] = {};                                                                                          \
  extern const char contact_kernels_##set[1];                                                                                    \
  const char contact_kernels_##set[1] = {};                                                                                      \
  void pass_of_range_##set(Pass &);                                                                                              \
  void pass_of_range_##set(Pass &) { std::abort(); }
MDANIM_SETS
#undef MDANIM_A_SET

}    // namespace mdanim
