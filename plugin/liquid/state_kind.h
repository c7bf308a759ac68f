// SPDX-License-Identifier: GPL-2.0-only
// The beginning of the states of liquids, and the checks that all of them need.

#pragma once

#include "records/byte_reader.h"

#include <cstring>
#include <string>

namespace mdanim {

// The kind of liquid and the version of its state: a word of up to seven letters and a number, counted separately for each kind.
struct StateKind {
  char word[8];
  double version;

  // Throws std::runtime_error where `found` is another kind or version.
  void expect(const StateKind &found, const ByteReader &reader) const
  {
    if (std::memcmp(found.word, word, sizeof word) == 0 && found.version == version) return;
    reader.fail("is not of version " + std::to_string(static_cast<int>(version)) + " of kind " + word +
                ", as this liquid's is; it was written for another model or by another version of the plugin");
  }
};

// The grid of cells that a state is of.
struct StateGrid {
  std::int64_t nx, ny, nz;

  std::string words() const { return std::to_string(nx) + " x " + std::to_string(ny) + " x " + std::to_string(nz); }
  // Throws std::runtime_error where `found` is another one.
  void expect(const StateGrid &found, const ByteReader &reader) const
  {
    if (found.nx != nx || found.ny != ny || found.nz != nz)
      reader.fail("is of a grid of " + found.words() + " cells, this one has " + words());
  }
};

}    // namespace mdanim
