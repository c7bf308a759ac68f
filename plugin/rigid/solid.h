// SPDX-License-Identifier: GPL-2.0-only
// A rigid body as contact by features sees it: its shape, where it is, how it yields, and the forces on it.

#pragma once

#include "numbers/matrix3.h"
#include "rigid/shape.h"

#include <cmath>
#include <vector>

namespace mdanim {

struct Material {
  static constexpr double MOST_DAMPING = 1.0;    // at 2 and steps of 0.35/Omega a dashpot makes energy
  double friction = 0.0, damping = 0.0;          // mu, and beta, the part of critical damping
  bool gives_way = false;                        // whether beta of another body that does not do so counts alone
  double rolling = 0.0;                          // arm of the torque that resists rolling [m]
};

// The rigid body that a piece is glued into, in the frame of the piece: its centre, its axes, 1/m and 1/I about these.
struct Carrier {
  Vec3 centre;
  Matrix3 turn;
  double over_mass = 0.0;
  Vec3 over;
};

struct Solid {
  static constexpr int ALONE = -1;
  // Values that all pairs ask for in each step come first.
  int id = 0;
  int whole = ALONE;    // number of the body that it is glued into; its pieces do not touch each other
  bool held = false;
  bool driven = false;        // held, and moves
  bool aside = false;         // touches nothing
  bool asleep = false;        // does not move in this step
  bool settled = false;       // does not move, and contacts with others that are so stay as they are
  bool is_carried = false;    // touches something that is driven, and moves
  double stir = 0.0;          // farthest way of a point of it in this step
  Vec3 centre;

  Matrix3 turn;
  Vec3 axis[3];    // columns of `turn`
  Vec3 velocity, spin;
  Vec3 force, torque;
  double stiffness_sum = 0.0, damping_sum = 0.0;    // S and D of the bound on the step
  int touching = 0;
  double over_mass = 0.0;    // 1/m, and 1/I about its axes; 0 of one that is held
  Vec3 over;
  double yields = 0.0;        // largest lambda along normals at its features (see find_yields)
  double yields_any = 0.0;    // along any direction
  Material material;
  SolidShape shape;                          // in the frame of the body
  double fastest_turn = 0.0;                 // no less than its angular velocity at any time of the step
  Vec3 belt;                                 // velocity at which its surface runs over it
  Carrier carrier;                           // the body that it is glued into
  Vec3 force_at_planes, torque_at_planes;    // the part of forces that planes give

  Vec3 in_space(const Vec3 &own) const { return turn * own; }
  Vec3 place(const Vec3 &own) const { return centre + turn * own; }
  Vec3 in_body(const Vec3 &a) const { return transposed_times(turn, a); }
  Vec3 velocity_at(const Vec3 &x) const { return velocity + cross(spin, x - centre); }
  // The same, in the step that ends now, of what was at x before it.
  Vec3 velocity_from(const Vec3 &x, double dt) const
  {
    const Vec3 middle = whole == ALONE ? centre : place(carrier.centre), v = velocity_at(middle);
    return v + cross(spin, x - (middle - dt * v));
  }
  // lambda = 1/m + (r x n) I^-1 (r x n): acceleration along n of the point x over a force along n that acts there.
  double yields_at(const Vec3 &x, const Vec3 &n) const
  {
    if (whole != ALONE) return yields_in_whole(in_body(x - centre), in_body(n));
    return held ? 0.0 : yields_by(in_body(cross(x - centre, n)));
  }
  // The same of a point and a normal in the frame of a piece.
  double yields_in_whole(const Vec3 &own, const Vec3 &n) const
  {
    const Vec3 t = transposed_times(carrier.turn, cross(own - carrier.centre, n)), &over_I = carrier.over;
    return carrier.over_mass + (t.x * t.x * over_I.x + t.y * t.y * over_I.y + t.z * t.z * over_I.z);
  }
  // The same of the lever t = r x n, in the frame of the body.
  double yields_by(const Vec3 &t) const { return over_mass + (t.x * t.x * over.x + t.y * t.y * over.y + t.z * t.z * over.z); }

  void move_to(const Vec3 &to, const Matrix3 &now)
  {
    centre = to;
    turn = now;
    for (int k = 0; k < 3; ++k) {
      const auto pick = [k](const Vec3 &row) { return k == 0 ? row.x : k == 1 ? row.y : row.z; };
      axis[k] = {pick(now.row[0]), pick(now.row[1]), pick(now.row[2])};
    }
  }
  // The same, with the motion that it has there.
  void put(const Vec3 &to, const Matrix3 &now, const Vec3 &v, const Vec3 &w)
  {
    move_to(to, now);
    velocity = v, spin = w;
    fastest_turn = std::sqrt(dot(w, w));
  }
  void begin_step(double dt)
  {
    const double speed = std::sqrt(dot(velocity, velocity)) + fastest_turn * shape.bound();
    stir = held && !driven ? 0.0 : dt * speed;
    force = torque = Vec3();
    stiffness_sum = damping_sum = 0.0;
    touching = 0;
    is_carried = false;
  }
  // To be called after the shape, the mass and the moments were set.
  void find_yields();
  // Takes what another one yields, if it is the same body.
  bool take_yields(const Solid &known)
  {
    const bool is_same = held == known.held && known.whole == ALONE && over_mass == known.over_mass && over.x == known.over.x &&
                         over.y == known.over.y && over.z == known.over.z && shape.is_same(known.shape);
    if (is_same) yields = known.yields, yields_any = known.yields_any;
    return is_same;
  }
};

// Forces on a body, or on that which it is glued into, and how its points move by them. Arms are from the centre of the body.
class SolidPush {
 public:
  void add(const Solid &one, const Vec3 &arm, const Vec3 &f)
  {
    force += f;
    torque += cross(from_middle(one, arm), f);
  }
  // Acceleration along n at the end of the arm.
  double moves(const Solid &one, const Vec3 &arm, const Vec3 &n) const
  {
    const bool alone = one.whole == Solid::ALONE;
    const Vec3 own = one.in_body(torque), t = alone ? own : transposed_times(one.carrier.turn, own);
    const Vec3 &over = alone ? one.over : one.carrier.over, turns{over.x * t.x, over.y * t.y, over.z * t.z};
    const Vec3 in_space = one.in_space(alone ? turns : one.carrier.turn * turns);
    return (alone ? one.over_mass : one.carrier.over_mass) * dot(force, n) + dot(cross(in_space, from_middle(one, arm)), n);
  }

 private:
  static Vec3 from_middle(const Solid &one, const Vec3 &arm)
  { return one.whole == Solid::ALONE ? arm : arm - one.in_space(one.carrier.centre); }
  Vec3 force, torque;
};

// Largest eigenvalue of 1/m + [r]^T I^-1 [r]: how a point r yields along the direction in which it yields most.
inline double largest_yield(double over_mass, const Vec3 &over, const Vec3 &r)
{
  Vec3 v{0.6, 0.7, 0.3};
  double value = 0.0;
  constexpr int POWERS = 200;
  for (int n = 0; n < POWERS; ++n) {
    const Vec3 t = cross(r, v), w = over_mass * v - cross(r, Vec3{over.x * t.x, over.y * t.y, over.z * t.z});
    value = std::sqrt(dot(w, w));
    v = (1.0 / value) * w;
  }
  return value;
}

inline void Solid::find_yields()
{
  yields = yields_any = 0.0;
  if (held) return;
  Vec3 last{HUGE_VAL, 0.0, 0.0};    // a corner comes once with each of its faces
  shape.each_feature([&](const Vec3 &at, const Vec3 &n) {
    yields = std::max(yields, whole == ALONE ? yields_by(cross(at, n)) : yields_in_whole(at, n));
    if (at.x == last.x && at.y == last.y && at.z == last.z) return;
    yields_any = std::max(yields_any, whole == ALONE ? largest_yield(over_mass, over, at)
                                                     : largest_yield(carrier.over_mass, carrier.over,
                                                                     transposed_times(carrier.turn, at - carrier.centre)));
    last = at;
  });
}

}    // namespace mdanim
