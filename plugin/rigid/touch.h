// SPDX-License-Identifier: GPL-2.0-only
// One contact of two rigid bodies, or of one and a plane; and what all of them tell.

#pragma once

#include "contact/law.h"
#include "rigid/blows.h"
#include "rigid/late_sums.h"
#include "rigid/solid.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace mdanim {

// Plain values: records hold them as they are.
struct Touch {
  enum TouchKind : std::int32_t { CORNER, CORNER_OF_OTHER, EDGES, MOVING, MOVING_OF_OTHER, CURVES };
  TouchKind kind = CORNER;
  std::int32_t first = 0, second = 0;    // features: a corner, two edges or curves, a moving point
  std::int32_t side = 0;                 // of the host of a corner or a moving point
  double stiffness = 0.0;                // k [N/m]
  double damping = 0.0;                  // dashpot over k [s]
  double shares = 0.0;                   // 1 where it began by a blow, which it shares with others until it rests
  double part = 1.0;                     // that counted last
  double yields = 0.0;                   // acceleration of the depth over the force, of all that press alike [1/kg]
  double alone = 0.0;                    // the same by this contact alone: sets its dashpot where it rests
  Vec3 anchor;    // corners: in the host; edges: places along both; moving points: way from the anchor, in the host's frame
  Vec3 at, n;     // where it was last, and the normal along which it pushes the body with the lower number
  Vec3 place;     // of curves, which may meet at several: in the host. Of an ellipsoid: the normal
  ContactMemory<double> memory;
  double earlier = 0.0;    // depth of the step before that of memory [m], where it is `followed`
  double press = 0.0;      // force of the last step, without friction, and its part `more` [N] (see touch.cpp)
  double more = 0.0;
  double owed = 0.0;         // work that `more` has still to do [J]
  double met = 0.0;          // way of its bodies towards each other along n in the step that led here [m]
  double followed = 0.0;     // steps in which it was pressed, up to 2
  double shared = 1.0;       // its damping in the blow over that of one that has it alone
  double rests = 0.0;        // 1 from where it goes deeper again after it came back
  double parted = 0.0;       // 1 in the step after the bodies have parted, the last one that it is there
  double counted = 0.0;      // part of it that counted in the last step, of points that are nearest on a mesh
  double over_ends = 0.0;    // 1 for edges that count beyond their ends
  double energy = 0.0;       // now, with that of sticking [J]
  // Resistance to rolling: its spring, dashpot and stick energy, of angles and torques in place of ways and forces.
  ContactMemory<double> rolling;
  Vec3 rolled;    // angle from its anchor, in the host's frame [rad]
};

// How deep it is beyond where it began without a force.
inline double depth_of(const Touch &touch) { return touch.memory.depth - touch.memory.offset; }

// Takes out contacts of bodies that had parted in the step before.
inline void forget_parted(std::vector<Touch> &list)
{
  list.erase(std::remove_if(list.begin(), list.end(), [](const Touch &one) { return one.parted != 0.0; }), list.end());
}

// The contact of these features in a list; its end where there is none.
template <class List> auto find_touch(List &list, Touch::TouchKind kind, int first, int second = 0)
{
  return std::find_if(list.begin(), list.end(),
                      [&](const Touch &one) { return one.kind == kind && one.first == first && one.second == second; });
}

// Stiffness, friction and damping of all contacts of a pair.
struct TouchLaw {
  double stiffness = 0.0, friction = 0.0, damping = 0.0, rolling = 0.0;
};

struct TouchAccount {
  double energy = 0.0;                              // of contacts and of sticking, now [J]
  int touching = 0;                                 // now
  double heat = 0.0, damped = 0.0, let_go = 0.0;    // since the beginning [J]
  double work = 0.0;                                // of surfaces and planes that move, since the beginning [J]
  double deepest = 0.0;                             // in this run [m]
  double worst_bound = 0.0;                         // largest dt^2 S / 4 + dt D / 2 of a body in this run
  int most_touching = 0;                            // contacts of one body, in this run
};

// A contact now: at x in space, at the depth d below a surface with the outward normal n in space.
struct Meeting {
  Vec3 x, n;
  double depth = 0.0, part = 1.0;
};

// The gradient of the part of a contact that counts, by the places and the rotation of the first body about x.
struct PartSlope {
  Vec3 by_place, by_turn;
};

// One evaluation of contacts: forces on bodies, and the account.
class TouchStep {
 public:
  // dt = 0 at the setup of a run: there are no dashpots, and what overlaps by then does so without a force.
  TouchStep(double dt, double onset, TouchAccount &account) : dt(dt), onset(onset), account(account) {}
  // The same within a run, where glue breaks: edges far below each other are those of faces that met, and do not touch.
  static TouchStep where_glue_breaks(double onset, TouchAccount &account)
  {
    TouchStep step(0.0, onset, account);
    step.deep = false;
    return step;
  }

  // The same step for some of the contacts, which keeps what it adds up in `sums`.
  TouchStep with(LateSums &sums) const
  {
    TouchStep step(*this);
    step.late = &sums;
    step.blows = {};
    return step;
  }
  LateSums *late_sums() const { return late; }
  const Blows &held_blows() const { return blows; }
  void take(const Blows &of_some) const { blows.take(of_some); }

  bool is_first() const { return dt == 0.0; }
  bool may_be_deep() const { return is_first() && deep; }    // whether edges that overlap far touch
  double time_step() const { return dt; }

  // A contact that is born at x. `depth_before`: that of the step before, where it came through the surface; else it overlaps
  // from the beginning, without a force.
  Touch born(Touch::TouchKind kind, const TouchLaw &law, const Solid &a, const Solid *b, const Vec3 &x, const Vec3 &n) const;
  // The same of a point that shares its contact with others: its depth yields so to its force.
  static Touch born(Touch::TouchKind kind, const TouchLaw &law, double yields);
  // These are all contacts of two bodies, or of one and a plane, as they are after this step.
  void listed(std::vector<Touch> &touches, const InBlow &of) const;
  std::vector<std::pair<InBlow, Vec3>> share_blows() const { return blows.share(account); }
  static void came_from(Touch &touch, double depth_before) { touch.memory.depth = std::min(0.0, depth_before); }
  static void overlaps(Touch &touch, double depth)
  {
    touch.memory.offset = touch.memory.depth = depth;
    touch.shares = 0.0;
  }
  // Velocity of the point x of `a` over that of `b`, or of a plane.
  static Vec3 relative_velocity(const Solid &a, const Solid *b, const Vec3 &x);
  void end(Touch &touch, double depth) const;
  // Ends a contact of bodies that have parted: what is owed is given by a last force. It is taken out before the next step.
  void part(Touch &touch, Solid &a, Solid *b, const Meeting &at) const;
  // Ends a contact that is still pressed.
  void let_go(Touch &touch, double depth, double part) const;
  // The same of one whose place is not known any more.
  void let_go(Touch &touch) const
  {
    add(account.let_go, touch.energy - touch.memory.stick_energy - touch.rolling.stick_energy);
    end(touch, touch.memory.depth);
  }

  // Another part of a contact counts from now on: what it held for the rest is let go.
  void count_part(Touch &touch, double part) const
  {
    const Onset<double> g(touch.memory.depth - touch.memory.offset, onset);
    if (touch.followed != 0.0) add(account.let_go, touch.stiffness * (touch.counted - part) * g.value);
    touch.counted = part;
  }

  ContactLaw law_of(const Touch &touch, const TouchLaw &law) const
  { return {touch.stiffness, onset, law.friction, touch.damping, {}}; }
  // Says which contacts come next, those of one pair. Where all of them began below the surface, without a force, nothing keeps
  // the bodies from lying in each other: they are pressed out slowly (see touch.cpp).
  void next(const std::vector<Touch> &touches) const
  {
    const auto is_inside = [this](const Touch &one) { return one.memory.offset > onset; };
    presses_out = !is_first() && std::all_of(touches.begin(), touches.end(), is_inside);
  }
  // The part of a contact that depends on its depth. In the step in which it begins or ends, its force counts for as long as it
  // acts (see touch.cpp).
  ContactForce<double> pressure(Touch &touch, const Solid &a, const Solid *b, const ContactLaw &law, double part,
                                double depth) const;
  // The way of the surface of `a` over that of `b`, or of a plane, in this step, besides that of their bodies.
  Vec3 ran(const Solid &a, const Solid *b) const { return b ? dt * (a.belt - b->belt) : dt * a.belt; }
  // Friction, whose spring has half of the dashpot: with all of it a stack of ten boxes that are turned trembles at 0.35/Omega.
  // `ran` is a part of the way that bodies do not see: surfaces that run do work by it.
  void friction(Touch &touch, ContactLaw law, double part, const Vec3 &away, const Vec3 &n, const Vec3 &ran,
                ContactForce<double> &force) const
  {
    const Vec3 before = touch.memory.pull + touch.memory.drag;
    law.damping *= STICK_DAMPING;
    contact_friction<double>(law, 1.0, part, away, n, dt, touch.memory, force);
    add(account.work, -0.5 * dot(before + force.pull + force.drag, ran));
  }
  // All that a step adds to bodies goes through these, and through add() to the account.
  void push(const TouchPush &one) const { give(one); }
  void apply(Solid &a, Solid *b, const Vec3 &x, const Vec3 &f) const;
  // A torque on `a`, and against it on `b`.
  void turn(Solid &a, Solid *b, const Vec3 &torque) const { push({&a, b, {}, torque, torque}); }
  void carry(Solid &one) const { late ? late->carry(one) : void(one.is_carried = true); }
  void book(Solid &a, Solid *b, Touch &touch, const Meeting &at, const ContactForce<double> &force) const;

  // A point X of `a`, in the frame of its host `b` or of space, at the depth d below a side with the outward normal n in space.
  // `slope`: gradient of `part` in the host's frame.
  void press(Touch &touch, const TouchLaw &law, Solid &a, Solid *b, const Vec3 &own, double depth, double part, const Vec3 &slope,
             const Vec3 &n) const;
  // The contact of a point of `a` at x, at the depth d below a surface with the outward normal n: found in the list, or begun
  // with this anchor. Null where there is none, or has ended.
  Touch *meet(std::vector<Touch> &list, Touch::TouchKind kind, int number, const TouchLaw &law, Solid &a, Solid *b, const Vec3 &x,
              const Vec3 &n, double depth, const Vec3 &anchor) const;
  // Begins a contact: `came` where it came through the surface or over an edge, else it overlaps without a force.
  void begin(Touch &touch, const Solid &a, const Solid *b, const Meeting &at, bool came) const;
  // A contact whose points move over both bodies. `slope` may be null: that of a part that is 1.
  void press_between(Touch &touch, const TouchLaw &law, Solid &a, Solid *b, const Meeting &at, const PartSlope *slope) const;
  // A point of `a` that moves over its surface, as the lowest of a ball: at x in space, at the depth d below a surface with the
  // outward normal n. Finds its contact in the list, or makes or ends it.
  void press_moving(std::vector<Touch> &list, Touch::TouchKind kind, int number, const TouchLaw &law, Solid &a, Solid *b,
                    const Vec3 &x, const Vec3 &n, double depth) const;

 private:
  static constexpr double STICK_DAMPING = 0.5;
  // The torque that resists rolling, up to the arm `rolling` of the law times the force of the contact.
  void resist_rolling(Touch &touch, const TouchLaw &law, Solid &a, Solid *b, const Vec3 &n, double part,
                      ContactForce<double> &push) const;
  template <class Given> void give(const Given &one) const { __builtin_expect(late != nullptr, 0) ? late->add(one) : one.add(); }
  void add(double &sum, double more) const { __builtin_expect(late != nullptr, 0) ? late->add(sum, more) : void(sum += more); }
  double follow(Touch &touch, const Solid &a, const Solid *b, double depth, double k) const;
  double unlike_depth(const Touch &touch, const Solid &a, const Solid *b, double depth) const;
  void press_out(Touch &touch, double depth, double k) const;
  double dt, onset;
  bool deep = true;
  mutable bool presses_out = false;
  TouchAccount &account;
  LateSums *late = nullptr;        // none: all is added at once
  mutable bool changes = false;    // whether one of those that are listed next has begun or ended
  mutable Blows blows;
};

}    // namespace mdanim
