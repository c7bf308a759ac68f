// SPDX-License-Identifier: GPL-2.0-only
// Bends that stay (tearing/bend_law.h): the rings of objects with a particle on this rank.

#pragma once

#include "lammps/spring_losses.h"
#include "numbers/vec3.h"
#include "pointers.h"
#include "tearing/bend_file.h"

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {
class FixMdanimTear;
}

namespace mdanim {

// Every rank that has a particle of a ring finds its forces, in the order of the file, so that no sum depends on ranks. What each
// line is bent by is in a property of the middle particle: it is that of the particles' records, and a run begins with it; a rank
// keeps that of a ghost itself until particles come to other ranks, as places alone decide. A ring with a link that is gone bends
// nothing any more.
class BentRings : protected LAMMPS_NS::Pointers {
 public:
  BentRings(LAMMPS_NS::LAMMPS *lmp, std::string who) : Pointers(lmp), who(std::move(who)) {}

  void read(const char *file);
  void set_property(const std::string &name) { property_name = name; }
  bool has_rings() const { return !rings.empty(); }
  bool has_property() const { return !property_name.empty(); }
  // All ranks call these together.
  void init();
  void begin();    // of a run: links that are gone
  void watch(int groupbit);
  // Forces at places without anything that yields; the same with it, and what is lost.
  void look();
  void yield(SpringLosses &losses);
  void push() const;
  double energy() const;    // of rings whose middle is here
  std::size_t bytes() const;

 private:
  struct OwnRing {
    const BendRing *of;
    int molecule;
    bool is_gone = false;
  };
  // A ring with a particle here: rows of its particles, and their forces.
  struct SeenRing {
    std::size_t ring;
    std::vector<int> row;
    std::vector<Vec3> force;
  };

  double *bent_of(const SeenRing &one) const;
  const BendRing &shape(const SeenRing &one) const { return *rings[one.ring].of; }
  void places(const SeenRing &one, double before);
  void find_force(SeenRing &one);
  std::vector<std::size_t> newly_gone();
  void release(const SeenRing &one, const std::vector<double> &less, double lost, SpringLosses &losses);

  std::string who, property_name;
  int property = -1;
  std::map<int, std::vector<BendRing>> objects;
  std::map<int, LAMMPS_NS::tagint> lowest;    // tags of objects
  std::vector<OwnRing> rings;
  std::map<std::pair<int, std::pair<int, int>>, std::vector<std::size_t>> of_link;    // rings, where links may go
  const LAMMPS_NS::FixMdanimTear *tears = nullptr;
  std::size_t known = 0;    // links that are gone of which it knows
  std::vector<SeenRing> watched;
  std::vector<Vec3> x, now, then;    // of one ring
};

}    // namespace mdanim
