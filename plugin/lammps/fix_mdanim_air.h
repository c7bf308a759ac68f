// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/air: air that streams past objects, or that they move through.

#pragma once

#include "air/skin.h"
#include "lammps/fix_base.h"
#include "lammps/object_nodes.h"
#include "lammps/stateful.h"
#include "numbers/vector_path.h"

#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace LAMMPS_NS {

// Every rank computes the forces on all objects, from places and velocities that ranks share, and pushes its own particles of the
// group. Its state are the forces of the last step, which follow from velocities of half a step before.
class FixMdanimAir : public mdanim::FixBase, public mdanim::Stateful {
 public:
  FixMdanimAir(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_pre_neighbor() override { locate(); }
  void pre_neighbor() override { locate(); }
  void setup(int) override;
  void post_integrate() override;
  void post_force(int) override;
  double compute_scalar() override { return taken() - sum(work); }
  double compute_array(int object, int column) override;
  double memory_usage() override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &) override;

 private:
  struct AirObject {
    std::shared_ptr<const mdanim::AirSkin> skin;
    mdanim::Vec3 force;    // on all of it
    mdanim::AirSkin::Holes holes;
  };
  struct GivenForce {
    int i;    // local particle
    mdanim::Vec3 force;
  };

  void read_path(int narg, char **arg, int &iarg);
  void locate() { nodes.locate(name(), groupbit); }
  void find_pushes();
  void open_holes();
  void push() const;
  void count();    // the work of half a step
  mdanim::Vec3 wind() const;
  double taken() const { return sum(loss); }

  double density, coefficient;
  mdanim::VectorPath path;    // of the wind
  double above;               // only there
  std::vector<AirObject> objects;
  mdanim::ObjectNodes nodes;
  const class FixMdanimTear *tears = nullptr;    // null where nothing tears
  std::size_t known_tears = 0;                   // of its links
  mdanim::AirScratch scratch;
  std::vector<GivenForce> pushes;                   // of this step
  std::map<tagint, mdanim::Vec3> acted;             // forces of a state, until the setup of a run
  std::optional<mdanim::StateRecords> restarted;    // of a restart file, until a run begins
  mdanim::Vec3 wind_now;
  double work = 0.0, loss = 0.0;    // on this rank
};

}    // namespace LAMMPS_NS
