// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/rigid: objects that do not deform.

#pragma once

#include "lammps/fix_base.h"
#include "lammps/object_table.h"
#include "lammps/stateful.h"
#include "numbers/unordered_sum.h"
#include "rigid/body.h"
#include "rigid/inertia.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Moves the particles of each object of its group as one rigid body, by the sums of the forces on them. Every rank has all
// bodies; sums over particles have the same bits in any order, so that bodies are the same on any number of ranks.
class FixMdanimRigid : public mdanim::FixBase, public mdanim::Stateful {
 public:
  FixMdanimRigid(class LAMMPS *, int, char **);
  ~FixMdanimRigid() override;

  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_pre_neighbor() override;
  void pre_neighbor() override;
  void reset_dt() override;
  void initial_integrate(int) override;
  void final_integrate() override;
  double compute_scalar() override;
  double compute_array(int body, int column) override;
  bigint dof(int) override;
  double memory_usage() override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;

  void write_restart(FILE *) override;
  void restart(char *) override;
  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &records) override;

 private:
  // Sums over the particles of an object.
  struct MassProperties {
    double mass = 0.0;
    mdanim::Vec3 centre;
    mdanim::Inertia inertia;
  };
  void read_inertia_of(const char *file);
  bool moves(int i) const { return atom->mask[i] & groupbit; }
  double mass_at(int i) const;
  void find_objects();
  void locate();
  template <int N, class Terms> std::vector<std::array<double, N>> sums(const Terms &terms_of) const;
  std::vector<MassProperties> weigh() const;
  void make();
  void set_velocities(const std::vector<MassProperties> &found);
  void follow_changes();
  void collect();
  void put(bool places);

  std::map<int, mdanim::Inertia> given;    // by molecule IDs, from a file
  mdanim::ObjectTable objects;
  std::vector<bigint> particles;    // of each object, on all ranks
  std::vector<mdanim::RigidBody> bodies;
  std::optional<mdanim::StateRecords> restarted;    // state of a restart file, until there are particles
  std::vector<int> body_of;                         // of each local particle; ObjectTable::NONE if it is not in the group
  double **own = nullptr;                           // places of local particles along the axes of their bodies, from the centre
  double half_dt = 0.0;                             // dt/2 in units that turn force/mass into velocity
  bool collected = false;                           // whether bodies have the forces of this step
};

// Sums of terms_of(i), N numbers of each local particle of a body, over all particles of each body on all ranks. They have the
// same bits for any distribution of particles over ranks.
template <int N, class Terms> std::vector<std::array<double, N>> FixMdanimRigid::sums(const Terms &terms_of) const
{
  const std::size_t count = objects.size();
  std::vector<double> largest(N * count, 0.0);
  std::vector<mdanim::UnorderedSum> sum(N * count);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (body_of[i] == mdanim::ObjectTable::NONE) continue;
    const std::array<double, N> terms = terms_of(i);
    double *const of_body = &largest[N * body_of[i]];
    for (int k = 0; k < N; ++k) of_body[k] = std::isfinite(terms[k]) ? std::max(of_body[k], std::fabs(terms[k])) : HUGE_VAL;
  }
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, largest.data(), static_cast<int>(largest.size()), MPI_DOUBLE, MPI_MAX, world);
  for (double &one : largest) {
    if (one == HUGE_VAL) error->all(FLERR, "{}: a force, velocity or place of a particle is not a finite number", name());
    one = mdanim::UnorderedSum::scale_for(one);
  }
  for (int i = 0; i < atom->nlocal; ++i) {
    if (body_of[i] == mdanim::ObjectTable::NONE) continue;
    const std::array<double, N> terms = terms_of(i);
    const std::size_t first = N * body_of[i];
    for (int k = 0; k < N; ++k) sum[first + k].add(terms[k], largest[first + k]);
  }
  static_assert(sizeof(mdanim::UnorderedSum) == 2 * sizeof(std::int64_t), "two numbers, summed over ranks");
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, sum.data(), static_cast<int>(2 * sum.size()), MPI_INT64_T, MPI_SUM, world);
  std::vector<std::array<double, N>> values(count);
  for (std::size_t n = 0; n < N * count; ++n) values[n / N][n % N] = sum[n].value(largest[n]);
  return values;
}

}    // namespace LAMMPS_NS
