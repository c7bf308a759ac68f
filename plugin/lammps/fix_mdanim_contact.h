// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/contact: objects touch each other and planes at their drawn surfaces, with friction.

#pragma once

#include "contact/contact_world.h"
#include "lammps/fix_base.h"
#include "lammps/keywords.h"
#include "lammps/moving_planes.h"
#include "lammps/object_table.h"
#include "lammps/shared_places.h"
#include "lammps/stateful.h"
#include "lammps/torn_ends.h"
#include "passes/pass_participant.h"
#include "simd/kernels.h"

#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace mdanim {

// A rank's particles of an object, among all of its particles that take part in contacts.
struct OwnParticles {
  int object;
  long first, end;
};

}    // namespace mdanim

namespace LAMMPS_NS {

class FixMdanimContact : public mdanim::FixBase, public mdanim::PassParticipant, public mdanim::Stateful {
 public:
  FixMdanimContact(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_post_neighbor() override;
  void setup(int) override;
  void post_neighbor() override;
  void post_force(int) override;
  double compute_scalar() override;
  double memory_usage() override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  void append_required_atoms(std::vector<int> &particles) const override;
  bool depends_on_positions_only() const override { return true; }
  void equip(const mdanim::Kernels &kernels, const mdanim::Threads &threads) override
  {
    world_of_contact.use(&kernels.contact, threads);
    threads_now = threads;
  }
  void add_forces(const mdanim::Positions &place, const mdanim::ForceSums &force) override;
  std::vector<mdanim::PointsAtPlane> hand_over_planes() override;
  void take_back_planes(const std::vector<mdanim::PointsAtPlane> &planes, double seconds) override;
  double safe_displacement() const override { return world_of_contact.near.distance_apart(); }
  bool sees_absolute_position() const override { return !world_of_contact.settings.planes.empty(); }

  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &records) override;

  // Sets the body of objects whose particles have this number as their BODY. Throws std::runtime_error.
  void take_body(int kind, const mdanim::ContactBodyArrays &arrays);

 private:
  // Whether contacts may belong to other bodies or particles than objects have now: they are then replaced.
  enum class Contacts { STAY, ARE_REPLACED };
  std::vector<mdanim::Keyword> keywords();
  void take_objects(Contacts contacts);
  [[noreturn]] void refuse_new_object(int i) const;
  void need_lists() const;
  void place_rigid(std::vector<mdanim::Box> &boxes);
  void list();
  mdanim::Coordinates places_now();
  template <class Add> void give_forces(const Add &add) const;
  void push(double dt);
  void move_planes();
  std::size_t bytes_of_bodies() const;
  std::size_t bytes_of_particles() const;

  mdanim::ParticleValue kind, young, friction;
  mdanim::NamedGroup among;     // none: all
  mdanim::NamedGroup except;    // none: no object
  bool is_among(int i) const;
  std::map<int, std::shared_ptr<const mdanim::ContactBody>> bodies;
  std::optional<mdanim::StateRecords> restarted;    // state of a restart file, until there are bodies
  mdanim::ContactWorld world_of_contact;
  mdanim::MovingPlanes moving;

  mdanim::TornEnds torn;
  mdanim::ObjectTable objects;    // at the setup; their particles when lists were made
  std::vector<tagint> lowest;     // tags of objects
  bool has_all = false;           // that take part in contacts, and all of these are in the group
  std::vector<int> mine;          // local particles that take part in contacts, in the order of the world of contact
  std::vector<mdanim::OwnParticles> of_object;    // parts of these, by ascending objects
  mdanim::SharedPlaces shared;                    // places of these particles, on all ranks
  mdanim::Positions my_places;
  mdanim::Threads threads_now;
};

}    // namespace LAMMPS_NS
