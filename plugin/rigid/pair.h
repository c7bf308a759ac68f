// SPDX-License-Identifier: GPL-2.0-only
// Two bodies that may touch: their contacts, and what is known of the features that are near. Of the latter no force depends.

#pragma once

#include "rigid/touch.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace mdanim {

// Features that may touch, numbers of a corner, or of two edges. They cannot as long as `known_for` of the pair is above `until`.
struct NearFeatures {
  int first = 0, second = 0;
  double until = HUGE_VAL;
};

struct SolidPair {
  // Values that each pair is asked for in each step come first: most pairs are near and do not touch.
  int a = 0, b = 0;           // numbers of bodies, a < b
  double asleep = 0.0;        // both may go so far together before the bodies can touch
  double known_for = -1.0;    // and so far until features must be looked up again
  double gone = 0.0;          // ways of both when they were looked at last
  std::vector<Touch> touches;
  int axis = 0;    // number of the direction that separated the bodies last

  // Force on the first body and torques on each, of the last step in which they were found, where one is glued or sleeps.
  Vec3 force, torque_a, torque_b;
  std::vector<NearFeatures> corners[2], edges;    // corners of a near b, of b near a
  // For meshes: sides of b near a, of a near b; corners with the sides that they may be below; triangles near what is round.
  std::vector<int> sides[2], triangles;
  std::vector<std::pair<int, int>> below[2];

  // Begin to fetch it from memory, and then what its lists hold.
  void fetch() const
  {
    constexpr int LINE = 64;
    for (const char *at = reinterpret_cast<const char *>(this); at < reinterpret_cast<const char *>(this + 1); at += LINE)
      __builtin_prefetch(at);
  }
  void fetch_lists() const
  {
    for (const std::vector<NearFeatures> *list : {&corners[0], &corners[1], &edges}) __builtin_prefetch(list->data());
    for (const Touch &touch : touches) __builtin_prefetch(&touch);
  }

  void forget()
  {
    asleep = 0.0;
    known_for = -1.0;
  }

  // Ends all contacts of a body that is laid aside, or comes back: its ways were not counted.
  void end()
  {
    touches.clear();
    force = torque_a = torque_b = Vec3();
    forget();
  }

  // Adds to what is kept; `in_order`: `a` of the blow is the first body.
  void add(bool in_order, const InBlow &one, const Vec3 &push)
  {
    const Vec3 on_a = cross(one.from_a, push), on_b = -1.0 * cross(one.from_b, push);
    force += in_order ? push : -1.0 * push;
    torque_a += in_order ? on_a : on_b;
    torque_b += in_order ? on_b : on_a;
  }
  // Keeps what the pair gives to its bodies in work().
  template <class Work> void keep(const Solid &first, const Solid &second, const Work &work)
  {
    const Vec3 force_before = first.force, torque_before = first.torque, torque_of_second = second.torque;
    work();
    force = first.force - force_before;
    torque_a = first.torque - torque_before;
    torque_b = second.torque - torque_of_second;
  }
  // Takes what is kept from both bodies.
  void take_back(Solid &first, Solid &second) const
  {
    first.force -= force;
    second.force += force;
    first.torque -= torque_a;
    second.torque -= torque_b;
  }
};

// Contacts of two bodies, by their shapes.
void touch_solids(const TouchStep &step, SolidPair &pair, Solid &a, Solid &b, const TouchLaw &law);
// How deep two bodies are in each other: the depth of the deepest contact that begins without a force at the setup of a run; 0
// where they are apart. Corners that are deeper than half of the thinnest part touch nothing.
double overlap(Solid &a, Solid &b);

// Contacts of a pair of polyhedra.
void touch_polyhedra(const TouchStep &step, SolidPair &pair, Solid &a, Solid &b, const TouchLaw &law);
// Contacts of two bodies of which one is a cylinder, a cone or a torus, and none a ball; an ellipsoid only with a torus.
void touch_with_curves(const TouchStep &step, SolidPair &pair, Solid &a, Solid &b, const TouchLaw &law);
// The contact of an ellipsoid with any other shape.
void touch_ellipsoid_and_other(const TouchStep &step, SolidPair &pair, Solid &egg, Solid &host, const TouchLaw &law);
// Contacts of two balls, and of a ball with any other shape.
void touch_balls(const TouchStep &step, SolidPair &pair, Solid &a, Solid &b, const TouchLaw &law);
void touch_ball_and_other(const TouchStep &step, SolidPair &pair, Solid &ball, Solid &host, const TouchLaw &law);

void touch_ball_and_mesh(const TouchStep &step, SolidPair &pair, Solid &ball, Solid &mesh, const TouchLaw &law);
void touch_ellipsoid_and_mesh(const TouchStep &step, SolidPair &pair, Solid &egg, Solid &mesh, const TouchLaw &law);

inline bool is_with_mesh(const Solid &a, const Solid &b)
{ return a.shape.kind() == SolidShape::MESH || b.shape.kind() == SolidShape::MESH; }
// Whether nothing of a mesh is within the sphere about the other body. They then sleep until something may be.
bool is_far_from_mesh(SolidPair &pair, const Solid &a, const Solid &b);
// Looks up sides of a mesh, if there is one, near the other body, which hold until both have moved by the margin.
void look_up_sides(SolidPair &pair, const Solid &a, const Solid &b, double margin);
// Corners of `a` in `b`, of any shapes but balls and ellipsoids. `of_other`: `a` is the second one of the pair.
void touch_corners_in(const TouchStep &step, SolidPair &pair, bool of_other, Solid &a, Solid &b, const TouchLaw &law,
                      double margin, bool stale);

// A plane: what is allowed lies where n . x >= at.
struct SolidPlane {
  Vec3 n;
  double at = 0.0;    // at the start
  bool moves = false;
  Vec3 shift, way, velocity;    // of one that moves: from the start, of the step that ends here, and its mean velocity

  double above(const Solid &one) const { return dot(n, one.centre) - at - one.shape.bound(); }    // the start, of all of it
  bool is_above(const Solid &one) const { return dot(n, one.centre - shift) - at > one.shape.bound(); }    // the same, now
};
// Contacts of a body that may reach the plane.
void touch_plane(const TouchStep &step, std::vector<Touch> &touches, Solid &one, const SolidPlane &plane, const TouchLaw &law);

constexpr double NEAR = 0.02;    // over the thinnest part: how near features are that are remembered
// The walls of a mesh may be thin beside all that touches it.
inline double margin_of(const Solid &a, const Solid &b)
{
  const bool is_mesh = a.shape.kind() == SolidShape::MESH, is_other_mesh = b.shape.kind() == SolidShape::MESH;
  if (is_mesh != is_other_mesh) return NEAR * (is_mesh ? b : a).shape.thin();
  return NEAR * std::min(a.shape.thin(), b.shape.thin());
}

constexpr double FADED = 0.02, FADES = 0.015;    // square of a sine: the ramp of nearly parallel edges and curves
// Width of the ramps about edges over the thinnest part.
inline double ramp_of(const Solid &solid) { return 0.0625 * solid.shape.thin(); }
// Step from 0 at x = -w to 1 at x = w, and its slope.
inline double smooth_step(double x, double w, double &slope)
{
  const double r = (x + w) / (2.0 * w);
  slope = 0.0;
  if (r <= 0.0) return 0.0;
  if (r >= 1.0) return 1.0;
  slope = 6.0 * r * (1.0 - r) / (2.0 * w);
  return r * r * (3.0 - 2.0 * r);
}

}    // namespace mdanim
