// SPDX-License-Identifier: GPL-2.0-only
// The surface of an object as links of it go: which of its elements and particles may touch, and what is near along links.
//
// A layer loses the elements that have both ends of a link that is gone. A body of cells loses such cells; its surface are the
// faces of one of those that are left. What a tear lays bare of it touches others as a layer does, all else by its particles
// (contact/contact_object.h): a face inside, and each face of a cell with an end of a link that is gone, which pushes at no point
// of others.

#pragma once

#include "folds/fold_object.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace mdanim {

// Rows of numbers, one behind the other.
class NumberRows {
 public:
  NumberRows() = default;
  // Row r has all second numbers of pairs {r, number}, in their order.
  NumberRows(std::size_t rows, const std::vector<std::array<int, 2>> &pairs);
  int *begin(int row) { return numbers.data() + first[row]; }
  int *end(int row) { return numbers.data() + first[row + 1]; }
  const int *begin(int row) const { return numbers.data() + first[row]; }
  const int *end(int row) const { return numbers.data() + first[row + 1]; }
  std::size_t bytes() const { return (first.capacity() + numbers.capacity()) * sizeof(int); }

 private:
  std::vector<int> first{0}, numbers;
};

class FoldSurface {
 public:
  explicit FoldSurface(const FoldObject &object);

  // Takes a link away: numbers of particles as in the table of the object, and none where this has not both of them.
  void open(int low, int high);
  bool is_torn() const { return torn; }
  // Since the last time that it was told to forget: particles at ends of links that went, and elements that were looked at anew.
  const std::vector<int> &new_ends() const { return ends; }
  const std::vector<int> &new_elements() const { return changed; }
  void forget_news() { ends.clear(), changed.clear(); }

  // Whether an element, or a particle, may touch parts of the object itself, or else other objects.
  bool has_element(int e, bool itself) const { return element[e] & (itself ? ITSELF : OTHERS); }
  bool has_particle(int p, bool itself) const { return particle[p] & (itself ? ITSELF : OTHERS); }
  // Corners of elements.
  int corners() const { return object.triangles.empty() ? 2 : 3; }
  int corner(int e, int k) const { return object.triangles.empty() ? object.segments[e][k] : object.triangles[e][k]; }
  // Calls visit(q) for each particle up to so many links from one, itself first; ends with true when visit returns true.
  template <class Visit> bool any_near(int p, int links, const Visit &visit) const;
  std::size_t bytes() const
  {
    return element.capacity() + particle.capacity() + whole.capacity() + is_end.capacity() + links.bytes() + bodies.bytes() +
           faces.bytes() + seen.capacity() * sizeof(int);
  }

 private:
  static constexpr unsigned char ITSELF = 1, OTHERS = 2;

  std::vector<std::array<int, 2>> links_of_bodies() const;
  void look_at_layer(int a, int b);
  void look_at_cells(int a, int b);
  void look_at_face(int e);

  const FoldObject &object;
  bool torn = false;
  std::vector<unsigned char> element, particle;
  std::vector<char> whole, is_end;    // cells of which no link is gone; particles
  NumberRows links;                   // of particles to others; -1 for one that is gone
  NumberRows bodies;                  // elements of each particle, or its cells
  NumberRows faces;                   // triangles of each cell
  std::vector<int> ends, changed;
  mutable std::vector<int> seen, ring;    // who has been visited in which search, and in which order
  mutable int search = 0;
};

template <class Visit> bool FoldSurface::any_near(int p, int many, const Visit &visit) const
{
  if (search == std::numeric_limits<int>::max()) {
    std::fill(seen.begin(), seen.end(), 0);
    search = 0;
  }
  ++search;
  ring.assign(1, p);
  seen[p] = search;
  if (visit(p)) return true;
  std::size_t from = 0;
  for (int level = 0; level < many; ++level)
    for (const std::size_t to = ring.size(); from < to; ++from)
      for (const int *q = links.begin(ring[from]), *last = links.end(ring[from]); q < last; ++q) {
        if (*q < 0 || seen[*q] == search) continue;
        seen[*q] = search;
        if (visit(*q)) return true;
        ring.push_back(*q);
      }
  return false;
}

}    // namespace mdanim
