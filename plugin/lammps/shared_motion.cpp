// SPDX-License-Identifier: GPL-2.0-only
// One exchange a step; a process that has all particles reads LAMMPS's own arrays.

#include "lammps/shared_motion.h"

#include "lammps/rank_gather.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

#include <algorithm>
#include <mpi.h>
#include <numeric>

using namespace LAMMPS_NS;

namespace mdanim {

static constexpr int NUMBERS = 6;    // of a particle in an exchange

int SharedMotion::number_of(tagint tag) const
{ return static_cast<int>(std::lower_bound(tags.begin(), tags.end(), tag) - tags.begin()); }

void SharedMotion::locate(const std::string &who, int groupbit)
{
  struct Here {
    int number, pushed;
  };
  std::vector<Here> here;
  const int size = static_cast<int>(tags.size());
  locals.assign(size, ELSEWHERE);
  for (int n = 0; n < size; ++n) {
    const int i = tags[n] > atom->map_tag_max ? -1 : atom->map(tags[n]);    // which has no entry beyond
    if (i < 0 || i >= atom->nlocal) continue;
    locals[n] = i;
    here.push_back({n, (atom->mask[i] & groupbit) != 0});
  }
  const std::vector<Here> all = gather(world, here);
  rows.assign(size, ELSEWHERE);
  pushed.assign(size, 0);
  for (std::size_t row = 0; row < all.size(); ++row) {
    rows[all[row].number] = comm->nprocs == 1 ? locals[all[row].number] : static_cast<int>(row);
    pushed[all[row].number] = static_cast<char>(all[row].pushed);
  }
  if (const auto gone = std::find(rows.begin(), rows.end(), ELSEWHERE); gone != rows.end())
    error->all(FLERR, "{}: particle {}, which it holds on to, is gone; write the fix again", who, tags[gone - rows.begin()]);
  if (comm->nprocs == 1) return;
  counts.assign(comm->nprocs, 0);
  starts.assign(comm->nprocs, 0);
  const int numbers = NUMBERS * static_cast<int>(here.size());
  MPI_Allgather(&numbers, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  sent.resize(numbers);
  received.resize(NUMBERS * static_cast<std::size_t>(size));
}

void SharedMotion::share()
{
  if (tags.empty()) return;
  if (comm->nprocs == 1) {
    x = atom->x[0], v = atom->v[0];
    return;
  }
  double *to = sent.data();
  for (const int i : locals) {
    if (i == ELSEWHERE) continue;
    to = std::copy_n(atom->x[i], 3, to);
    to = std::copy_n(atom->v[i], 3, to);
  }
  MPI_Allgatherv(sent.data(), static_cast<int>(sent.size()), MPI_DOUBLE, received.data(), counts.data(), starts.data(),
                 MPI_DOUBLE, world);
  x = received.data(), v = x + 3, stride = NUMBERS;
}

std::size_t SharedMotion::bytes() const
{
  return tags.capacity() * sizeof(tagint) + (locals.capacity() + rows.capacity()) * sizeof(int) + pushed.capacity() +
         (sent.capacity() + received.capacity()) * sizeof(double);
}

}    // namespace mdanim
