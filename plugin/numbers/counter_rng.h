// SPDX-License-Identifier: GPL-2.0-only
// Random numbers that depend only on their own key: the same on every rank, in every order, after every resume.

#pragma once

#include <cstdint>

namespace mdanim {

// 64 bits to 64 bits, one to one (the finaliser of splitmix64).
inline std::uint64_t mix64(std::uint64_t x)
{
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

// 32 bits to 32 bits, one to one; few operations, so that a compiler can vectorise it.
inline std::uint32_t mix32(std::uint32_t x)
{
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

// 32 bits of a draw under a key: two rounds, one with each half of the key, so that no two keys give the same
// sequence shifted.
inline std::uint32_t draw32(std::uint64_t key, std::uint32_t index)
{ return mix32(mix32(index ^ static_cast<std::uint32_t>(key)) ^ static_cast<std::uint32_t>(key >> 32)); }

// The use of a draw, so that no two uses share numbers.
enum class Phase : std::uint64_t { EVEN_BLOCKS, ODD_BLOCKS, DISPLACEMENT, LEVEL, FILL, DROPS };

// Key of all draws of one kind at one time; `when` counts sweeps or steps.
inline std::uint64_t draw_key(std::uint64_t seed, std::uint64_t when, Phase phase)
{ return mix64(mix64(mix64(seed) + when) + static_cast<std::uint64_t>(phase)); }

// The draw of a cell under a key.
inline std::uint64_t draw(std::uint64_t key, std::uint64_t cell) { return mix64(key ^ mix64(cell)); }

}    // namespace mdanim
