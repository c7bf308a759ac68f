// SPDX-License-Identifier: GPL-2.0-only
// Pieces that glue holds together move as one rigid body, until the stress in a face is above what its glue bears.
//
// Forces on pieces and the motion of the whole leave a load on each piece, f = F - m a and the same of torques. Faces bear these
// loads like springs between rigid pieces (Kawai 1978), K x = f, with E A/L along and across the normal and E I/L about axes, L
// being the distance of the middles of both pieces; E cancels. The loads of a whole are in balance, so the six motions that K
// does not resist have no part. Conjugate gradients find x, from that of the step before.

#pragma once

#include "records/byte_reader.h"
#include "records/byte_writer.h"
#include "rigid/body.h"
#include "rigid/coarse_glue.h"
#include "rigid/glue.h"
#include "rigid/glue_groups.h"
#include "rigid/glue_springs.h"
#include "rigid/shape.h"

#include <cstdint>
#include <vector>

namespace mdanim {

class GluedBodies {
 public:
  static constexpr int ALONE = -1;
  struct Whole {
    RigidBody body;
    std::vector<int> pieces;    // ascending
    double drag = 0.0;
    std::vector<GlueSpring> springs;    // of unbroken faces
    PieceMotions stiff;                 // diagonal of K
    CoarseGlue coarse;
    double bears = 0.0;    // force that its weakest face bears; infinite of one that never breaks
  };

  bool is_on() const { return !faces.empty(); }
  // Faces between bodies, whose numbers these are in place of molecule IDs.
  void take(std::vector<GlueFace> given, std::size_t bodies);
  // Makes wholes of all pieces, as these are now; no glue is broken. Space is that of the faces.
  void join(const std::vector<RigidBody> &bodies);

  bool holds(std::size_t body) const { return is_on() && whole_of[body] != ALONE; }
  const std::vector<GlueFace> &all_faces() const { return faces; }
  bool may_break() const { return breakable; }
  bool is_broken(std::size_t face) const { return broken[face] != 0; }
  const std::vector<int> &faces_of(int body) const { return at[body]; }
  int number_of_whole(int body) const { return is_on() ? whole_of[body] : ALONE; }    // ALONE where it is none
  const Whole &whole(int body) const { return wholes[whole_of[body]]; }
  RigidBody &body_of_whole(int body) { return wholes[whole_of[body]].body; }
  int first_of(int body) const { return holds(body) ? whole(body).pieces.front() : body; }
  const Pose &pose(int body) const { return in_whole[body]; }    // of a piece in its whole
  int broken_faces() const;
  double largest_share() const { return most_share; }                     // of what a face bears, since the bodies were made
  double stress(int body) const { return is_on() ? bore[body] : 0.0; }    // the largest in a face of a piece, so far
  // Loads of faces by pieces, in space, as hanging_loads has them.
  std::vector<FaceLoads> face_loads(const std::vector<RigidBody> &bodies, double to_acceleration) const;

  // Sums up forces on pieces, drag and whether they are laid aside.
  void gather(const std::vector<RigidBody> &bodies, const std::vector<double> &drag);
  // Half a step of forces; returns the energy that drag takes. Pieces have the motion of their whole behind it.
  double kick(std::vector<RigidBody> &bodies, double half_dt, bool first);
  void drift(std::vector<RigidBody> &bodies, double dt);
  // After velocities of pieces were set.
  void take_motion(std::vector<RigidBody> &bodies);

  // Breaks the glue whose stress is too large, and takes wholes apart. `more`: what bodies bear besides their forces, in space.
  // Returns the pieces of these, ascending.
  std::vector<int> judge(const std::vector<RigidBody> &bodies, const PieceMotions &more, double to_acceleration);

  // Part of the record of a body.
  void put(int body, ByteWriter &writer) const;
  void read(int body, ByteReader &reader);
  // After the records of all bodies were read: `has`: those that have one.
  void rebuild(const std::vector<char> &has);

 private:
  // In the record of each piece.
  struct Kept {
    std::int64_t behind = ALONE;    // the first piece of its whole is so many places before this one in `at_start`
    double mass = 0.0;              // of the whole, and its motion
    Vec3 moments, centre, velocity;
    Quaternion q;
    Vec3 L;
    Pose pose, from_start;
    PieceMotion way;
    double bore = 0.0;
  };

  void make_whole(const std::vector<RigidBody> &bodies, std::vector<int> pieces);
  void spread(std::vector<RigidBody> &bodies, const Whole &whole, bool places) const;
  void find_springs(Whole &whole) const;
  // The largest stress in the face of each spring of a whole, over what the face bears.
  std::vector<double> shares(const Whole &whole, const std::vector<RigidBody> &bodies, const PieceMotions &more,
                             double to_acceleration);
  void number_wholes();
  void take_stress(const Whole &whole, const std::vector<double> &share);
  std::vector<std::vector<int>> parts(const Whole &whole) const;

  std::vector<GlueFace> faces;    // a and b are numbers of bodies
  bool breakable = false;         // whether not all of them are welds
  std::vector<char> broken;
  std::vector<std::vector<int>> at;    // faces of bodies
  GlueGroups at_start;
  std::vector<int> whole_of;
  std::vector<Pose> in_whole;      // of pieces
  std::vector<Pose> from_start;    // of pieces: from space at the start to their frames
  PieceMotions given_way;          // x of pieces, in the frame of their whole
  std::vector<double> bore;        // largest stress in a face of each piece, so far
  double most_share = 0.0;
  std::vector<Whole> wholes;    // by their first pieces
  std::vector<Kept> kept;       // while records are read
};

}    // namespace mdanim
