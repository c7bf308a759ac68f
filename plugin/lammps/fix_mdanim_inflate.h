// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/inflate: gas in closed surfaces.

#pragma once

#include "inflate/bag.h"
#include "lammps/fix_base.h"
#include "lammps/object_nodes.h"

#include <utility>
#include <vector>

namespace LAMMPS_NS {

class FixMdanimTear;

// Every rank finds the volumes of all objects, from places that ranks share, and pushes its own particles of the group.
class FixMdanimInflate : public mdanim::FixBase {
 public:
  FixMdanimInflate(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_pre_neighbor() override { locate(); }
  void pre_neighbor() override { locate(); }
  void setup(int) override;
  void post_force(int) override;
  void final_integrate() override;
  double compute_scalar() override;
  double compute_array(int object, int column) override;
  double memory_usage() override;

 private:
  struct InflatedObject {
    mdanim::Bag bag;
    double volume, pressure;
    bool is_open;    // a link of it is gone, and so is the gas
  };
  void locate() { nodes.locate(name(), groupbit); }
  void push();
  std::vector<int> opened();
  void find(int n);
  void let_out(int n);

  std::vector<InflatedObject> objects;
  mdanim::ObjectNodes nodes;
  std::vector<mdanim::Vec3> x, areas;    // of one object
  const FixMdanimTear *tears = nullptr;
  std::size_t known = 0;                                 // links that are gone of which it knows
  std::vector<std::pair<int, mdanim::Vec3>> released;    // forces of gas that went out in this step, by local particles
  double lost = 0.0;                                     // energy of gas that went out, on this rank
};

}    // namespace LAMMPS_NS
