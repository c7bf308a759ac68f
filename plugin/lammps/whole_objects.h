// SPDX-License-Identifier: GPL-2.0-only
// The particles of objects that a fix acts on as a whole: which object each is of, and sums over them.

#pragma once

#include "lammps/object_table.h"
#include "lammps/particle_value.h"
#include "numbers/unordered_sum.h"
#include "numbers/vec3.h"
#include "rigid/inertia.h"
#include "threads/team.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "pointers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace mdanim {

class WholeObjects : protected LAMMPS_NS::Pointers {
 public:
  // Takes the objects of the group of a fix.
  WholeObjects(LAMMPS_NS::LAMMPS *lmp, const LAMMPS_NS::Fix &fix) : Pointers(lmp), fix(fix) {}

  // Sets the threads that sums are shared among. Their number changes no bit.
  void use(const Threads &now) { threads = now; }
  const Threads &helpers() const { return threads; }

  bool moves(int i) const { return atom->mask[i] & fix.groupbit; }
  double mass_at(int i) const { return mass_of(atom->rmass, atom->mass, atom->type, i); }
  int body_of(int i) const { return of_particle[i]; }    // ObjectTable::NONE of one that is not in the group

  // Called by all ranks together. find_objects() tells whether there are other objects or particles than before, or they are all
  // new. Objects whose particles have left the group together are laid aside: they stay known until there are others.
  bool find_objects(bool are_new = false);
  void locate();
  const ObjectTable &objects() const { return known; }
  LAMMPS_NS::bigint particles_of(int body) const { return particles[body]; }
  // Numbers of particles in the group now, of each object on all ranks.
  std::vector<LAMMPS_NS::bigint> present() const;

  // Sums over the particles of an object, as points.
  struct MassProperties {
    double mass = 0.0;
    Vec3 centre;
    Inertia inertia;
  };
  std::vector<MassProperties> weigh() const;
  struct BodyMotion {
    Vec3 momentum, angular;    // the latter about the centre
  };
  std::vector<BodyMotion> motion(const std::vector<MassProperties> &about) const;
  std::vector<double> kinetic() const;
  // Sums of terms_of(i), N numbers of each local particle of a body, over all particles of each body on all ranks. They have the
  // same bits for any distribution of particles over ranks.
  template <int N, class Terms> std::vector<std::array<double, N>> sums(const Terms &terms_of) const
  {
    return sums<N>(terms_of, [](int) { return true; });
  }
  // The same of bodies for which this holds; of all others they are 0. It is the same on all ranks.
  template <int N, class Terms, class Asked>
  std::vector<std::array<double, N>> sums(const Terms &terms_of, const Asked &asked) const
  { return sums_within<N>(terms_of, asked, largest<N>(terms_of, asked)); }
  // Such sums where no term is larger than a bound of its body, which all ranks have.
  template <int N, class Terms, class Asked>
  std::vector<std::array<double, N>> sums_within(const Terms &terms_of, const Asked &asked,
                                                 const std::vector<std::array<double, N>> &bounds) const;
  // The largest magnitude of each of N numbers of the particles of a body on all ranks.
  template <int N, class Terms, class Asked>
  std::vector<std::array<double, N>> largest(const Terms &terms_of, const Asked &asked) const;

  template <class Term> std::vector<double> sum_of(const Term &term_of) const
  {
    const auto values = sums<1>([&](int i) { return std::array<double, 1>{term_of(i)}; });
    std::vector<double> found;
    for (const auto &value : values) found.push_back(value[0]);
    return found;
  }

  template <class Term> std::vector<double> largest_of(const Term &term_of) const
  {
    const auto values = largest<1>([&](int i) { return std::array<double, 1>{term_of(i)}; }, [](int) { return true; });
    std::vector<double> found;
    for (const auto &value : values) found.push_back(value[0]);
    return found;
  }

  // Degrees of freedom that bodies take from the temperature of a group, if all their particles belong to it.
  LAMMPS_NS::bigint degrees_taken(int group_number) const;
  double bytes() const;

 protected:
  // Calls work(i) for all local particles, shared by bodies; one call takes about `ns` nanoseconds.
  template <class Work> void each_particle(double ns, const Work &work) const;

  std::vector<int> of_particle;

 private:
  static constexpr double NS_OF_TERMS = 15.0;    // of a particle, approximately

  std::string name() const;
  void find_runs();
  std::vector<LAMMPS_NS::bigint> take_objects(bool with_aside);    // their numbers of particles

  const LAMMPS_NS::Fix &fix;
  ObjectTable known;
  std::vector<LAMMPS_NS::bigint> particles;    // of each object, on all ranks
  Threads threads;
  std::vector<int> run;    // first particles of bodies, where those of each body follow each other; else none
};

template <class Work> void WholeObjects::each_particle(double ns, const Work &work) const
{
  const auto runs = static_cast<long>(run.size());
  if (runs == 0) {
    for (int i = 0; i < atom->nlocal; ++i) work(i);
    return;
  }
  threads.parts(runs, ns * static_cast<double>(atom->nlocal) / static_cast<double>(runs), [&](long first, long end) {
    const int last = end < runs ? run[end] : atom->nlocal;
    for (int i = run[first]; i < last; ++i) work(i);
  });
}

template <int N, class Terms, class Asked>
std::vector<std::array<double, N>> WholeObjects::largest(const Terms &terms_of, const Asked &asked) const
{
  std::vector<std::array<double, N>> found(known.size(), std::array<double, N>{});
  each_particle(NS_OF_TERMS, [&](int i) {
    if (of_particle[i] == ObjectTable::NONE || !asked(of_particle[i])) return;
    const std::array<double, N> terms = terms_of(i);
    std::array<double, N> &of_body = found[of_particle[i]];
    for (int k = 0; k < N; ++k) of_body[k] = std::isfinite(terms[k]) ? std::max(of_body[k], std::fabs(terms[k])) : HUGE_VAL;
  });
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, found.data(), static_cast<int>(N * found.size()), MPI_DOUBLE, MPI_MAX, world);
  for (const auto &of_body : found)
    for (const double one : of_body)
      if (one == HUGE_VAL) error->all(FLERR, "{}: a force, velocity or place of a particle is not a finite number", name());
  return found;
}

template <int N, class Terms, class Asked>
std::vector<std::array<double, N>> WholeObjects::sums_within(const Terms &terms_of, const Asked &asked,
                                                             const std::vector<std::array<double, N>> &bounds) const
{
  const std::size_t count = known.size();
  std::vector<std::array<double, N>> scale = bounds;
  for (auto &of_body : scale)
    for (double &one : of_body) one = unordered::scale_for(one);
  std::vector<UnorderedSums<N>> sum(count);
  each_particle(NS_OF_TERMS, [&](int i) {
    if (of_particle[i] != ObjectTable::NONE && asked(of_particle[i])) sum[of_particle[i]].add(terms_of(i), scale[of_particle[i]]);
  });
  static_assert(sizeof(UnorderedSums<N>) == 2 * N * sizeof(std::uint64_t), "whole numbers, summed over ranks");
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, sum.data(), static_cast<int>(2 * N * count), MPI_UINT64_T, MPI_SUM, world);
  std::vector<std::array<double, N>> values(count);
  for (std::size_t n = 0; n < count; ++n)
    for (int k = 0; k < N; ++k) values[n][k] = sum[n].value(k, scale[n][k]);
  return values;
}

}    // namespace mdanim
