// SPDX-License-Identifier: GPL-2.0-only
// Looks at points of any field.

#include "contact/contact_field.h"

namespace mdanim {

void ContactField::settle(const ContactArrays &arrays)
{
  for (std::size_t q = 0; q < near.size(); ++q)
    if (wake[q] < NEVER && wake[q] <= budget) look_at(q, arrays, false);
}

void ContactField::find_due(double dt, double now)
{
  budget = now;
  if (host->is_crushed)
    for (std::size_t q = 0; q < near.size(); ++q)
      if (wake[q] < NEVER && distrusts(q)) wake.set(q, AT_ONCE);
  if (dt > 0.0) fetch(wake.find_due(budget));
}

void ContactField::look(const ContactArrays &arrays, LookBatches &batches)
{
  if (!wake.found_due().empty()) look_at_all(wake.found_due(), arrays, batches);
}

void ContactField::end_looks(const ContactArrays &arrays)
{
  wake.settle();
  begin_step(arrays);
}

}    // namespace mdanim
