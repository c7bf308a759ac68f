// SPDX-License-Identifier: GPL-2.0-only
// Looks at points of any field.

#include "contact/contact_field.h"

namespace mdanim {

void ContactField::settle(const ContactArrays &arrays)
{
  for (std::size_t q = 0; q < near.size(); ++q)
    if (wake[q] < NEVER && wake[q] <= budget) look_at(q, arrays, false);
}

void ContactField::look(const ContactArrays &arrays, double dt, double now)
{
  budget = now;
  if (host->is_crushed)
    for (std::size_t q = 0; q < near.size(); ++q)
      if (wake[q] < NEVER && distrusts(q)) wake.set(q, AT_ONCE);
  if (dt > 0.0)
    wake.look_below(
        budget, [this](std::size_t q) { fetch(q); },
        [&](const std::vector<std::size_t> &points) { look_at_all(points, arrays); });
  begin_step(arrays);
}

}    // namespace mdanim
