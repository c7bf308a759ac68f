// SPDX-License-Identifier: GPL-2.0-only
// The surface of an object as links of it go: which of its elements and particles may touch, and what hangs together.
//
// A layer loses the elements that have both ends of a link that is gone. A body of cells loses such cells; its surface are the
// faces of one of those that are left. What a tear lays bare of it touches others as a layer does, all else by its particles
// (contact/contact_object.h): a face inside, and each face of a cell with an end of a link that is gone, which pushes at no point
// of others.

#pragma once

#include "folds/fold_object.h"

#include <cstddef>
#include <set>
#include <utility>
#include <vector>

namespace mdanim {

class FoldSurface {
 public:
  explicit FoldSurface(const FoldObject &object);

  // Takes a link away: numbers of particles as in the table of the object, and none where this has not both of them. settle()
  // must follow before all else is asked.
  void open(int low, int high);
  void settle();

  bool is_torn() const { return !gone.empty(); }
  // Whether an element, or a particle, may touch parts of the object itself, or else other objects.
  bool has_element(int e, bool itself) const { return element[e] & (itself ? ITSELF : OTHERS); }
  bool has_particle(int p, bool itself) const { return particle[p] & (itself ? ITSELF : OTHERS); }
  // The lowest particle of the piece that a particle is of.
  int part(int p) const { return parts[p]; }
  std::size_t bytes() const
  { return element.capacity() + particle.capacity() + parts.capacity() * sizeof(int) + gone.size() * 6 * sizeof(void *); }

 private:
  static constexpr unsigned char ITSELF = 1, OTHERS = 2;

  bool is_gone(int a, int b) const;
  void settle_layer();
  void settle_cells();
  int root(int p);
  void join(int a, int b);

  const FoldObject &object;
  std::set<std::pair<int, int>> gone;
  std::vector<unsigned char> element, particle;
  std::vector<int> parts;
};

}    // namespace mdanim
