// SPDX-License-Identifier: GPL-2.0-only
// Points without a contact that are due in a step, as many at a time as the kernel takes. A field often has one or two; those of
// several fields go together where their objects have the same bodies.

#pragma once

#include "contact/contact_kernel.h"
#include "contact/contact_object.h"

#include <cstddef>
#include <vector>

namespace mdanim {

class LatticeField;

class LookBatches {
 public:
  // The arrays must outlive this.
  explicit LookBatches(const ContactArrays &arrays) : arrays(arrays) {}

  // Looks at near point `q` of a field, now or when others of its kind have come. The field takes the result.
  void add(LatticeField &field, std::size_t q, bool is_smooth, const PointBefore &before);
  // Looks at the points that are left.
  void finish();

 private:
  struct Batch {
    LookTask task;
    const LatticeField *like;    // one of its fields
    int n;
    PointBefore before[CONTACT_LANES];
    LatticeField *field[CONTACT_LANES];
    std::size_t q[CONTACT_LANES];
  };
  void look(Batch &batch);

  const ContactArrays &arrays;
  std::vector<Batch> all;
};

}    // namespace mdanim
