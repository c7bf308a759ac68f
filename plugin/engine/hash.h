// SPDX-License-Identifier: GPL-2.0-only
// A hash of a row of words: FNV-1a by words instead of bytes.

#ifndef MDANIM_HASH_H
#define MDANIM_HASH_H

#include <cstdint>

namespace mdanim {

constexpr std::uint64_t HASH_OF_NOTHING = 1469598103934665603u;

inline std::uint64_t hash_with(std::uint64_t hash, std::uint64_t word) { return (hash ^ word ^ word >> 29) * 1099511628211u; }

}    // namespace mdanim

#endif
