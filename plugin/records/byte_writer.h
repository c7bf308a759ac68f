// SPDX-License-Identifier: GPL-2.0-only
// Writes the bytes of a record, value after value as they lie in memory. ByteReader reads them in the same order.

#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

namespace mdanim {

using Bytes = std::vector<std::uint8_t>;

class ByteWriter {
 public:
  ByteWriter() = default;
  explicit ByteWriter(Bytes &&begun) : bytes(std::move(begun)) {}

  ByteWriter &put(const void *from, std::size_t size)
  {
    const auto *first = static_cast<const std::uint8_t *>(from);
    bytes.insert(bytes.end(), first, first + size);
    return *this;
  }
  template <class Value> ByteWriter &put(const Value &value)
  {
    static_assert(std::is_trivially_copyable_v<Value> && !std::is_pointer_v<Value>, "a record holds plain values");
    return put(&value, sizeof value);
  }
  // Values without their number, which the reader must know.
  template <class Value> ByteWriter &put_all(const std::vector<Value> &values)
  {
    static_assert(std::is_trivially_copyable_v<Value>, "a record holds plain values");
    return put(values.data(), values.size() * sizeof(Value));
  }
  template <class Value> ByteWriter &put_counted(const std::vector<Value> &values)
  { return put(static_cast<std::int64_t>(values.size())).put_all(values); }
  bool is_empty() const { return bytes.empty(); }
  Bytes take() { return std::move(bytes); }

 private:
  Bytes bytes;
};

}    // namespace mdanim
