// SPDX-License-Identifier: GPL-2.0-only

#include "contact/look_batches.h"

#include "contact/lattice_field.h"

#include <algorithm>

namespace mdanim {

void LookBatches::add(LatticeField &field, std::size_t q, bool is_smooth, const PointBefore &before)
{
  auto batch = std::find_if(all.begin(), all.end(), [&](const Batch &one) {
    return one.task.is_smooth == is_smooth && (one.like == &field || one.like->looks_like(field));
  });
  if (batch == all.end()) batch = all.insert(batch, {field.look_task(is_smooth, arrays), &field, 0, {}, {}, {}});
  batch->before[batch->n] = before;
  batch->field[batch->n] = &field;
  batch->q[batch->n] = q;
  if (++batch->n == CONTACT_LANES) look(*batch);
}

void LookBatches::look(Batch &batch)
{
  LookedBlock looked;
  arrays.kernels->look(batch.task, batch.before, batch.n, looked);
  for (int lane = 0; lane < batch.n; ++lane) batch.field[lane]->take_look(batch.q[lane], looked, lane, arrays);
  batch.n = 0;
}

void LookBatches::finish()
{
  for (Batch &batch : all)
    if (batch.n > 0) look(batch);
}

}    // namespace mdanim
