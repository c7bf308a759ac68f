// SPDX-License-Identifier: GPL-2.0-only
// Sums over the ranks of a LAMMPS, for what knows nothing of MPI.

#pragma once

#include "liquid/rank_sums.h"

#include "comm.h"
#include "lammps.h"

#include <mpi.h>

namespace mdanim {

class WorldSums : public RankSums {
 public:
  explicit WorldSums(LAMMPS_NS::LAMMPS *lmp) : lmp(lmp) {}
  bool alone() const override { return lmp->comm->nprocs == 1; }
  bool first() const override { return lmp->comm->me == 0; }
  void add(int *values, int count) const override { reduce(values, count, MPI_INT, MPI_SUM); }
  void add_wide(std::int64_t *values, int count) const override { reduce(values, count, MPI_INT64_T, MPI_SUM); }
  void lowest(int *values, int count) const override { reduce(values, count, MPI_INT, MPI_MIN); }

 private:
  void reduce(void *values, int count, MPI_Datatype type, MPI_Op operation) const
  {
    if (!alone()) MPI_Allreduce(MPI_IN_PLACE, values, count, type, operation, lmp->world);
  }

  const LAMMPS_NS::LAMMPS *lmp;
};

}    // namespace mdanim
