// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/folds: sheets, ropes and surfaces that touch each other and themselves.

#pragma once

#include "folds/fold_contact.h"
#include "lammps/fix_base.h"
#include "lammps/fix_mdanim_tear.h"
#include "lammps/object_nodes.h"
#include "lammps/stateful.h"

#include <map>
#include <optional>
#include <vector>

namespace LAMMPS_NS {

// Every rank computes the contacts of all objects, from places and velocities that ranks share, and pushes its own particles of
// the group. Its state are the forces of friction and of dashpots in the last step, which follow from velocities of half a step
// before.
class FixMdanimFolds : public mdanim::FixBase, public mdanim::Stateful {
 public:
  FixMdanimFolds(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_pre_neighbor() override { locate(); }
  void pre_neighbor() override { locate(); }
  void setup(int) override;
  void post_integrate() override;
  void post_force(int) override;
  double compute_scalar() override { return energy; }
  double memory_usage() override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &) override;

 private:
  // One way of a pair, by its place in the table, and by numbers of objects.
  struct FoldWay {
    std::size_t pair;
    int first, second;
    mdanim::FoldContact contact;
  };
  // Losses of energy on the way, taken from a particle's motion.
  struct Lost {
    mdanim::Vec3 rub, damp;
  };
  struct FoldForce {
    int i;    // local particle
    mdanim::Vec3 push;
    Lost lost;
  };

  void make_surfaces();
  bool may_touch() const;
  void locate() { nodes.locate(name(), groupbit); }
  void find_pushes(bool moves);
  double push_all();
  void open_torn();
  void list_again();
  void find_ways();
  void append_ways(std::size_t p, int one, int other);
  void push() const;
  void count();    // the losses of half a step

  mdanim::FoldTable table;
  mdanim::ObjectNodes nodes;
  std::vector<mdanim::FoldSurface> surfaces;    // of nodes' objects
  std::map<int, int> number;                    // of nodes' objects, by molecule ID
  bool untorn_touch = false;                    // some objects touch before anything is torn
  std::vector<FoldWay> ways;                    // of pairs near each other, in the order of the table
  double skin = 0.0;
  const FixMdanimTear *tears = nullptr;                              // null where nothing tears
  std::size_t known_tears = 0;                                       // of its links
  std::vector<mdanim::Vec3> x, v, listed, pushed, rubbed, damped;    // of nodes
  std::vector<double> mass;
  std::vector<FoldForce> pushes;                    // of this step
  std::map<tagint, Lost> acted;                     // forces of a state, until the setup of a run
  std::optional<mdanim::StateRecords> restarted;    // of a restart file, until a run begins
  double energy = 0.0;
  double heat = 0.0, loss = 0.0;    // on this rank
  double lists = 0.0;               // how often they were made
};

}    // namespace LAMMPS_NS
