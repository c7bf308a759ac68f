// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/barrier: objects repel each other. Wcislo 1999, sec. 3.3, eq. (3.14), (3.15).

#pragma once

#include "barrier/pair_filter.h"
#include "geometry/boxes.h"
#include "lammps/fix_base.h"
#include "lammps/object_table.h"
#include "passes/pass_participant.h"
#include "simd/kernels.h"

#include <set>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

class FixMdanimBarrier : public mdanim::FixBase, public mdanim::PassParticipant {
 public:
  FixMdanimBarrier(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_post_neighbor() override;
  void setup(int) override;
  void post_neighbor() override;
  void post_force(int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  double compute_scalar() override;
  double memory_usage() override;
  void append_required_atoms(std::vector<int> &particles) const override;
  bool depends_on_positions_only() const override { return true; }
  void add_forces(const mdanim::Positions &place, const mdanim::ForceSums &force) override;
  void equip(const mdanim::Kernels &kernels, const mdanim::Threads &) override { filter = &kernels.pair_filter; }
  double safe_displacement() const override { return clear; }
  bool sees_absolute_position() const override { return false; }
  double rests_for() const override;

 private:
  // A particle's contribution to a pair. Owners send that of ghosts at every rebuild.
  struct Own {
    double stiffness, reach;
    int object;    // its number in `objects`, or NONE
  };
  struct ContactPair {
    double stiffness, reach;
    double share;    // part of the pair that this rank counts: 1/2 for each end that it moves, 1 if the other end is never moved
  };

  int role(int i) const;
  void find_objects();
  double survey(std::vector<mdanim::Box> &boxes);
  void collect_own();
  std::vector<std::pair<int, int>> meeting_within(const std::vector<mdanim::Box> &boxes, double range) const;
  double distance_apart(const std::vector<mdanim::Box> &boxes, double range) const;
  void find_pairs();
  void add_pair(int low, int high, const ContactPair &pair);
  template <bool TELLS> void push(const mdanim::Positions &place, const mdanim::ForceSums &total);
  int find_touching(const mdanim::Positions &place);
  bool moves(int i) const;

  mdanim::NamedGroup boundary, barrier, thin;
  double thin_ratio = 0.0;
  mdanim::ParticleValue stiffness, reach;
  std::set<std::pair<int, int>> excluded;    // molecule IDs of pairs that never touch, the lower one first

  mdanim::ObjectTable objects;    // of particles of the two groups
  std::vector<Own> own;           // local and ghost particles

  // Pairs that may touch, numbered ascending by the lower tag and then by the higher one: added up in this order, the forces on
  // every particle are in ascending order of its partners' tags. Some numbers in between do not stand for pairs (pair_filter.h).
  std::vector<mdanim::Strip> strip;
  mdanim::Doubles reach2;           // squares of the reach of pairs, NO_PAIR for numbers without a pair
  std::vector<ContactPair> pair;    // and other data of the pairs
  int last_high = 0;                // the higher one of the last pair
  double longest = 0.0;             // reach of these pairs
  double least_beyond = 0.0;        // r^2 - reach^2 of these, when it was computed last
  std::vector<int> particle;        // of pairs, local or ghost: first boundary, then barrier, each ascending by tag
  std::vector<int> unmoved;         // places in it of particles that this rank adds no forces to
  const mdanim::PairFilter *filter;
  std::vector<mdanim::StripMask> masks;    // room for the filter
  std::vector<int> touching_pair;          // in this step
  // In a step without passes: positions of these particles, forces on them, and where the forces on those of each begin in `on`.
  mdanim::Positions here;
  std::vector<double> on;
  std::vector<long> slot;

  double clear = 0.0;                          // no two objects meet before a particle has gone this far
  bigint meeting_objects = 0;                  // pairs of objects whose boxes meet
  double tried_pairs = 0.0, touching = 0.0;    // on this rank; a pair counts half at either end
  double energy = 0.0;
  double deepest = 1.0;    // smallest r/reach in this run
};

}    // namespace LAMMPS_NS
