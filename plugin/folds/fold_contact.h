// SPDX-License-Identifier: GPL-2.0-only
// Contact of one object's features with the elements of another one, or of its own: each feature is pushed by the nearest
// element.
//
// The least distance is a continuous function of all places, so the energy is one, too, whatever is the nearest; and which
// elements are looked at never changes a bit, because all that may be within reach are.

#pragma once

#include "folds/fold_object.h"
#include "folds/fold_surface.h"
#include "geometry/box_tree.h"

#include <cstddef>
#include <vector>

namespace mdanim {

// Particles of an object in a step.
struct FoldNodes {
  const Vec3 *x, *v;
  const double *mass;
  Vec3 *push, *rub, *damp;    // forces on them: of the potential, of friction and of dashpots
};

// One way of a pair: features of one object against elements of the other one. Features are particles, and against segments those
// of an object of segments are its segments. The parts of an object that touch each other are `apart` without load, or, once
// it is torn, some links from each other.
class FoldContact {
 public:
  // Objects and surfaces must outlive it; with the same object twice it touches itself.
  FoldContact(const FoldObject &own, const FoldSurface &of_own, const FoldObject &other, const FoldSurface &of_other,
              const FoldLaw &law, double apart);

  bool may_touch() const { return touch_untorn(*own, *other, apart) || of_own->is_torn() || of_other->is_torn(); }
  // Looks for what may come within reach while no particle moves by more than half of the skin.
  void list(const Vec3 *own, const Vec3 *other, double skin);
  // The same lists, with the surfaces as they are now: to be called with the places and the skin of the last time, while the
  // surfaces have news.
  void renew(const Vec3 *own, const Vec3 *other, double skin);
  // Adds forces, and returns the energy.
  double push(const FoldNodes &own, const FoldNodes &other, double dt) const;
  std::size_t bytes() const { return (first.capacity() + elements.capacity()) * sizeof(int) + boxes.capacity() * sizeof(Box); }

 private:
  int features() const { return static_cast<int>(lines ? own->segments.size() : own->particles.size()); }
  int corners_of_feature() const { return lines ? 2 : 1; }
  int corners_of_element() const { return other->triangles.empty() ? 2 : 3; }
  const int *feature(int n) const { return lines ? own->segments[n].data() : &identity[n]; }
  const int *element(int n) const { return other->triangles.empty() ? other->segments[n].data() : other->triangles[n].data(); }
  int count() const { return static_cast<int>(other->triangles.empty() ? other->segments.size() : other->triangles.size()); }
  double weight(int f) const;
  NearestPoints foot(const Vec3 *x, int f, const Vec3 *y, int e) const;
  Vec3 way(const Vec3 *x, int f, const Vec3 *y, int e, const NearestPoints &at) const;
  bool is_apart(int f, int e) const;
  bool are_linked(int f, int e) const;
  bool has_feature(int f) const;
  void look_around(const Vec3 *own, const Vec3 *other, int f);
  std::vector<char> to_renew(const Vec3 *own, std::size_t known) const;
  void append_box(const Vec3 *other, int e);
  void act(const FoldNodes &own, const FoldNodes &other, int f, int e, const NearestPoints &at, double distance, double dt) const;

  const FoldObject *own, *other;
  const FoldSurface *of_own, *of_other;
  FoldLaw rule;
  double apart;    // 0 of two objects, and where what is torn alone touches itself
  bool itself, lines;
  int links = 0;    // up to so many links from each other parts of one object never touch

  std::vector<int> identity;
  std::vector<int> first, elements;    // elements near each feature, ascending
  // Elements that may touch, and boxes of what they reach: those of the tree, and further ones since it was made.
  bool listed = false, listed_torn = false;    // the latter: of an own object that was torn
  double far = 0.0;
  BoxTree tree;
  std::size_t in_tree = 0;
  std::vector<int> number;
  std::vector<Box> boxes;
};

}    // namespace mdanim
