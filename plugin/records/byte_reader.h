// SPDX-License-Identifier: GPL-2.0-only
// Reads the bytes of a record in the order in which ByteWriter wrote them; they need not be aligned. All functions throw
// std::runtime_error with a message that begins with the name of the record.

#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace mdanim {

class ByteReader {
 public:
  // `name` names the record in messages, as "the liquid's state".
  ByteReader(const std::uint8_t *bytes, std::size_t size, std::string name)
      : bytes(bytes), all(size), next(0), name(std::move(name))
  {
  }

  std::size_t left() const { return all - next; }

  // Address of the next `size` bytes, which are skipped.
  const std::uint8_t *skip(std::size_t size)
  {
    if (size > left()) is_cut_off();
    const std::uint8_t *const from = bytes + next;
    next += size;
    return from;
  }
  template <class Value> Value get()
  {
    static_assert(std::is_trivially_copyable_v<Value>, "a record holds plain values");
    Value value;
    std::memcpy(static_cast<void *>(&value), skip(sizeof value), sizeof value);
    return value;
  }
  template <class Value> std::vector<Value> get_all(std::size_t count)
  {
    if (count > left() / sizeof(Value)) is_cut_off();
    std::vector<Value> values(count);
    if (count > 0) std::memcpy(static_cast<void *>(values.data()), skip(count * sizeof(Value)), count * sizeof(Value));
    return values;
  }
  template <class Value> std::vector<Value> get_counted()
  {
    const auto count = get<std::int64_t>();
    if (count < 0) is_cut_off();
    return get_all<Value>(static_cast<std::size_t>(count));
  }

  void expect_version(std::int64_t version)
  {
    const auto found = get<std::int64_t>();
    if (found != version)
      fail("has version " + std::to_string(found) + ", " + std::to_string(version) +
           " is needed; it was written by another version of the plugin");
  }
  void expect_end() const
  {
    if (left() > 0) fail("is too long: " + std::to_string(left()) + " of its " + std::to_string(all) + " bytes are left");
  }
  // Throws unless every number is finite and not below `least`; `what` names them, as "the mass of a column".
  template <class Numbers> void expect_numbers(const Numbers &numbers, const char *what, double least = -HUGE_VAL) const
  {
    for (const double number : numbers)
      if (!(std::isfinite(number) && number >= least)) is_damaged(std::string(what) + " is " + std::to_string(number));
  }

  [[noreturn]] void fail(const std::string &why) const { throw std::runtime_error(name + " " + why); }
  [[noreturn]] void is_damaged(const std::string &how) const { fail("is damaged: " + how); }

 private:
  [[noreturn]] void is_cut_off() const { fail("is cut off: it has " + std::to_string(all) + " bytes, that is too few"); }
  const std::uint8_t *bytes;
  std::size_t all, next;
  std::string name;
};

}    // namespace mdanim
