// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/barrier: objects push each other off. Wcislo 1999, sec. 3.3, eq. (3.14), (3.15).

#ifndef LMP_FIX_MDANIM_BARRIER_H
#define LMP_FIX_MDANIM_BARRIER_H

#include "boxes.h"
#include "fix.h"
#include "guest.h"
#include "loss.h"
#include "particle_value.h"

#include <vector>

namespace LAMMPS_NS {

class FixMdanimBarrier : public Fix, public mdanim::Guest {
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
  double compute_vector(int) override;
  double memory_usage() override;
  void concerned(std::vector<int> &particles) const override;
  bool reads_all() const override { return damping > 0.0 && !loss.idle(); }

 private:
  // What a particle brings into a pair. Of ghosts it is asked from their owners at every rebuild.
  struct Own {
    double stiffness, reach, mass;
    tagint object;    // molecule ID
  };
  struct Candidate {
    int partner;                // local or ghost index
    bool lower, in_group;       // whether i has the lower tag; whether the partner feels this fix too
    double stiffness, reach;    // of the pair
  };

  int group_bit(int iarg, const char *word);
  int role(int i) const;
  void collect_own();
  double survey(std::vector<mdanim::Box> &boxes);
  void find_candidates();
  struct Glance;
  struct Crowd;
  void find_candidates_near(const std::vector<mdanim::Box> &zone, double range);
  double sum(double here);

  int boundary_bit = 0, barrier_bit = 0, thin_bit = 0;
  double thin_ratio = 0.0, damping = 0.0;
  int power = 3;
  mdanim::ParticleValue stiffness, reach;

  std::vector<Own> own;      // local and ghost particles
  std::vector<int> row;      // local particles that have candidates,
  std::vector<int> first;    // theirs are [first[n], first[n+1]), ascending by tag
  std::vector<Candidate> candidate;

  bigint meeting_objects = 0;            // pairs of objects whose boxes meet
  double pairs = 0.0, touching = 0.0;    // on this rank; a pair counts half at either end
  double energy = 0.0;
  mdanim::Loss loss;       // to damp
  double deepest = 1.0;    // smallest r/reach in this run
  double seconds = 0.0;
};

}    // namespace LAMMPS_NS

#endif
