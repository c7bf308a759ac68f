// SPDX-License-Identifier: GPL-2.0-only
// Rows of values, most of which are equal.

#pragma once

#include <cstddef>
#include <cstring>
#include <functional>
#include <new>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace mdanim {

// Memory that starts on a cache line, for the vector units.
template <class Value> struct OnCacheLine {
  using value_type = Value;
  static constexpr std::align_val_t LINE{64};
  OnCacheLine() = default;
  template <class Other> OnCacheLine(const OnCacheLine<Other> &) {}
  Value *allocate(std::size_t n) { return static_cast<Value *>(operator new(n * sizeof(Value), LINE)); }
  void deallocate(Value *values, std::size_t) { operator delete(values, LINE); }
  bool operator==(const OnCacheLine &) const { return true; }
  bool operator!=(const OnCacheLine &) const { return false; }
};

// Distinct rows of values, one after the other. Each is kept once and found by a hash of its bytes. Coefficients of springs and
// of motion, and springs of particles, mostly repeat.
template <class Value> class DistinctRows {
 public:
  // Number of the row: that of an equal row that is already kept, else the next one.
  unsigned find_or_add(const Value *row, std::size_t n)
  {
    if (size() && is(latest, row, n)) return latest;    // the usual case
    const std::size_t hash = std::hash<std::string_view>()({reinterpret_cast<const char *>(row), n * sizeof(Value)});
    const auto [begin, end] = known.equal_range(hash);
    for (auto it = begin; it != end; ++it)
      if (is(it->second, row, n)) return latest = it->second;
    latest = size();
    known.emplace(hash, latest);
    values.insert(values.end(), row, row + n);
    first.push_back(values.size());
    return latest;
  }
  void close() { known = {}; }    // no row is added after this
  bool is(unsigned k, const Value *row, std::size_t n) const
  {
    return last_of(k) - first_of(k) == static_cast<std::ptrdiff_t>(n) &&
           (n == 0 || !std::memcmp(first_of(k), row, n * sizeof(Value)));
  }

  const Value *first_of(unsigned k) const { return values.data() + first[k]; }
  const Value *last_of(unsigned k) const { return values.data() + first[k + 1]; }    // one beyond its last value
  const Value *data() const { return values.data(); }
  unsigned size() const { return static_cast<unsigned>(first.size() - 1); }
  std::size_t bytes() const
  { return values.capacity() * sizeof(Value) + first.capacity() * sizeof(std::size_t) + known.size() * OF_KNOWN; }

 private:
  static constexpr std::size_t OF_KNOWN = 32;    // bytes of an entry, approximately

  std::vector<Value, OnCacheLine<Value>> values;
  std::vector<std::size_t> first{0};    // start of each row, and the end of the last
  unsigned latest = 0;
  std::unordered_multimap<std::size_t, unsigned> known;    // rows by hash, until all are there
};

}    // namespace mdanim
