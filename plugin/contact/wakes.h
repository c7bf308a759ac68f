// SPDX-License-Identifier: GPL-2.0-only
// Times at which points without a contact are looked at: each point has a value that a budget must exceed first. Most points are
// looked at in few steps. So the least value of every few points is kept, and a step skips those whose least is not exceeded.

#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace mdanim {

class Wakes {
 public:
  static constexpr double NEVER = std::numeric_limits<double>::infinity();

  void clear() { wake.clear(), least_of.clear(), least = NEVER; }
  // Values are less by this than what is set: budgets are sums that are rounded, and an early look changes nothing.
  void set_early(double by) { early = by; }
  void push_back(double at)
  {
    if (wake.size() % BLOCK == 0) least_of.push_back(NEVER);
    wake.push_back(NEVER);
    set(wake.size() - 1, at);
  }
  std::size_t size() const { return wake.size(); }
  double least_value() const { return least; }    // of all, or less
  double operator[](std::size_t q) const { return wake[q]; }
  void set(std::size_t q, double at)
  {
    at -= early;
    wake[q] = at;
    least_of[q / BLOCK] = std::min(least_of[q / BLOCK], at);
    least = std::min(least, at);
  }
  // Finds all points whose value a budget exceeds, ascending. Their values must then be set anew, and settle() must be called.
  const std::vector<std::size_t> &find_due(double budget)
  {
    due_blocks.clear(), due.clear();
    if (!(least < budget)) return due;
    least = NEVER;
    for (std::size_t block = 0; block < least_of.size(); ++block)
      if (least_of[block] < budget) {
        __builtin_prefetch(&wake[block * BLOCK]);
        due_blocks.push_back(block);
      } else {
        least = std::min(least, least_of[block]);
      }
    for (const std::size_t block : due_blocks)
      for (std::size_t q = block * BLOCK; q < end_of(block); ++q)
        if (wake[q] < budget) due.push_back(q);
    return due;
  }
  const std::vector<std::size_t> &found_due() const { return due; }
  void settle()
  {
    for (const std::size_t block : due_blocks) {
      least_of[block] = *std::min_element(wake.begin() + block * BLOCK, wake.begin() + end_of(block));
      least = std::min(least, least_of[block]);
    }
    due_blocks.clear(), due.clear();
  }
  // Has the least values brought into the cache.
  void fetch() const
  {
    for (std::size_t block = 0; block < least_of.size(); block += BLOCK) __builtin_prefetch(&least_of[block]);
  }
  std::size_t bytes() const { return (wake.capacity() + least_of.capacity()) * sizeof(double); }

 private:
  static constexpr std::size_t BLOCK = 8;
  std::size_t end_of(std::size_t block) const { return std::min(wake.size(), (block + 1) * BLOCK); }

  std::vector<double> wake, least_of;    // value of each point; for each block of points the least of them, or less
  double least = NEVER;                  // least of all values, or less
  double early = 0.0;
  std::vector<std::size_t> due_blocks, due;    // from find_due() to settle()
};

}    // namespace mdanim
