// SPDX-License-Identifier: GPL-2.0-only
// Objects that may touch each other, or planes, before lists are made again; and the particles of them that may take part.

#pragma once

#include "contact/contact_laws.h"
#include "contact/contact_object.h"
#include "geometry/boxes.h"
#include "geometry/zone.h"

#include <utility>
#include <vector>

namespace mdanim {

// A particle of an object: the number of the object in the world and that of the particle in the object.
struct ContactParticle {
  int object, node;
  bool operator<(const ContactParticle &other) const
  { return object != other.object ? object < other.object : node < other.node; }
};

class NearObjects {
 public:
  // A pair of objects that may touch, by their numbers, and the zones of their particles near each other.
  struct NearPair {
    int a, b;
    Zone of_a, of_b;    // `across` points at the other
  };

  // The objects to look at, and for each whether some particle can move. All must outlive this.
  NearObjects(const ContactSettings &settings, const std::vector<ContactObject> &all, const std::vector<char> &movable)
      : settings(settings), all(all), movable(movable)
  {
  }

  // Sets boxes of all objects. No object comes nearer to another than by `skin` until lists are made again.
  void look_ahead(const std::vector<Box> &boxes, double skin);
  // Two extents for each near pair, along the line between the middles of its boxes, each to be replaced by its minimum over all
  // ranks after lower_extents() has been called with all particles.
  std::vector<double> initial_extents() const;
  void lower_extents(int object, const Vec3 &x, std::vector<double> &extents) const;
  void drop_separated_pairs(const std::vector<double> &extents);

  // How far every particle may go until two objects, or an object and a plane, can touch; at most 32 times the skin; 0 where some
  // already can.
  double distance_apart() const { return apart; }
  bool none() const { return near_pairs.empty() && near_planes.empty(); }
  const std::vector<NearPair> &pairs() const { return near_pairs; }
  const std::vector<std::pair<int, int>> &planes() const { return near_planes; }    // numbers of the object and of the plane
  bool has_zones(int object) const { return object >= 0 && !zones[object].empty(); }
  // Whether a particle of an object may take part in contacts.
  bool needs(const ContactParticle &particle, const Vec3 &x) const;
  double skin() const { return skin_now; }

 private:
  // A zone in which particles of an object may take part in contacts.
  struct SearchZone {
    Zone zone;
    int extent;    // of the other object of the pair; -1 for a plane
  };
  bool is_excluded(int a, int b) const;
  std::vector<std::pair<int, int>> pairs_within(const std::vector<Box> &boxes, double gap) const;
  std::vector<std::pair<int, int>> planes_within(const std::vector<Box> &boxes, double gap) const;
  void find_zones();

  const ContactSettings &settings;
  const std::vector<ContactObject> &all;
  const std::vector<char> &movable;
  double skin_now = 0.0, apart = 0.0;
  std::vector<NearPair> near_pairs;
  std::vector<std::pair<int, int>> near_planes;
  std::vector<std::vector<SearchZone>> zones;    // of each object
};

}    // namespace mdanim
