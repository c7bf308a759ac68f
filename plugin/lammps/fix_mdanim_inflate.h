// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/inflate: gas in closed surfaces.

#pragma once

#include "inflate/bag.h"
#include "lammps/fix_base.h"
#include "lammps/object_nodes.h"

#include <vector>

namespace LAMMPS_NS {

// Every rank finds the volumes of all objects, from places that ranks share, and pushes its own particles of the group.
class FixMdanimInflate : public mdanim::FixBase {
 public:
  FixMdanimInflate(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_pre_neighbor() override { locate(); }
  void pre_neighbor() override { locate(); }
  void setup(int) override { push(); }
  void post_force(int) override;
  double compute_scalar() override;
  double compute_array(int object, int column) override;
  double memory_usage() override;

 private:
  struct InflatedObject {
    mdanim::Bag bag;
    double volume, pressure;
  };
  void locate() { nodes.locate(name(), groupbit); }
  void push();

  std::vector<InflatedObject> objects;
  mdanim::ObjectNodes nodes;
  std::vector<mdanim::Vec3> x, areas;    // of one object
};

}    // namespace LAMMPS_NS
