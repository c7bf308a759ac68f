// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/glued_bodies.h"

#include "rigid/joined_body.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace mdanim {

static constexpr double QUIET = 1e-6;    // of the force that the weakest face bears: loads below this are none

static Quaternion reversed(const Quaternion &q) { return {q.w, -q.x, -q.y, -q.z}; }

void GluedBodies::take(std::vector<GlueFace> given, std::size_t bodies)
{
  faces = std::move(given);
  breakable = !std::all_of(faces.begin(), faces.end(), [](const GlueFace &face) { return face.is_weld(); });
  broken.assign(faces.size(), 0);
  at.assign(bodies, {});
  whole_of.assign(bodies, ALONE);
  in_whole.assign(bodies, {});
  from_start.assign(bodies, {});
  given_way.assign(bodies, {});
  bore.assign(bodies, 0.0);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const int body : {faces[f].a, faces[f].b}) at[body].push_back(static_cast<int>(f));
  Whole all;
  for (std::size_t n = 0; n < bodies; ++n)
    if (!at[n].empty()) all.pieces.push_back(static_cast<int>(n));
  at_start = GlueGroups(parts(all), bodies);
}

void GluedBodies::join(const std::vector<RigidBody> &bodies)
{
  broken.assign(faces.size(), 0);
  wholes.clear();
  for (std::size_t n = 0; n < bodies.size(); ++n)
    from_start[n] = {-1.0 * transposed_times(bodies[n].turn, bodies[n].centre), reversed(bodies[n].q)};
  for (const std::vector<int> &group : at_start.groups) make_whole(bodies, group);
  number_wholes();
}

// Pieces that unbroken glue holds together, in the order of their first ones.
std::vector<std::vector<int>> GluedBodies::parts(const Whole &whole) const
{
  std::vector<std::vector<int>> found;
  std::vector<char> seen(whole_of.size(), 0);
  for (const int first : whole.pieces) {
    if (seen[first]) continue;
    std::vector<int> part{first};
    seen[first] = 1;
    for (std::size_t k = 0; k < part.size(); ++k)
      for (const int f : at[part[k]]) {
        const int other = faces[f].a == part[k] ? faces[f].b : faces[f].a;
        if (broken[f] || seen[other]) continue;
        seen[other] = 1;
        part.push_back(other);
      }
    std::sort(part.begin(), part.end());
    found.push_back(std::move(part));
  }
  return found;
}

void GluedBodies::make_whole(const std::vector<RigidBody> &bodies, std::vector<int> pieces)
{
  if (pieces.size() < 2) {
    whole_of[pieces.front()] = ALONE;
    return;
  }
  Whole whole;
  whole.body = joined_body(bodies, pieces);
  const Quaternion back = reversed(whole.body.q);
  for (const int n : pieces) {
    whole_of[n] = static_cast<int>(wholes.size());
    in_whole[n] = {transposed_times(whole.body.turn, bodies[n].centre - whole.body.centre), unit(back * bodies[n].q)};
    given_way[n] = {};
  }
  whole.pieces = std::move(pieces);
  find_springs(whole);
  wholes.push_back(std::move(whole));
}

int GluedBodies::broken_faces() const { return static_cast<int>(std::count(broken.begin(), broken.end(), 1)); }

// --- motion ---

void GluedBodies::gather(const std::vector<RigidBody> &bodies, const std::vector<double> &drag)
{
  for (Whole &whole : wholes) {
    whole.body.force = whole.body.torque = Vec3(), whole.drag = 0.0;
    for (const int n : whole.pieces) {
      whole.body.force += bodies[n].force;
      whole.body.torque += bodies[n].torque + cross(bodies[n].centre - whole.body.centre, bodies[n].force);
      whole.drag += drag[n];
    }
    whole.body.aside = bodies[whole.pieces.front()].aside;
  }
}

void GluedBodies::spread(std::vector<RigidBody> &bodies, const Whole &whole, bool places) const
{
  for (const int n : whole.pieces) {
    RigidBody &one = bodies[n];
    const Vec3 arm = whole.body.turn * in_whole[n].place;
    if (places) {
      one.centre = whole.body.centre + arm;
      one.q = unit(whole.body.q * in_whole[n].q);
      one.turn = matrix(one.q);
    }
    one.set_motion(whole.body.velocity_at(arm), whole.body.spin);
  }
}

double GluedBodies::kick(std::vector<RigidBody> &bodies, double half_dt, bool first)
{
  double taken = 0.0;
  for (Whole &whole : wholes) {
    if (whole.body.aside || whole.body.asleep) continue;
    if (whole.drag == 0.0)
      whole.body.kick(half_dt);
    else
      taken += whole.body.kick_with_drag(half_dt, whole.drag, first);
    spread(bodies, whole, false);
  }
  return taken;
}

void GluedBodies::drift(std::vector<RigidBody> &bodies, double dt)
{
  for (Whole &whole : wholes) {
    if (whole.body.aside || whole.body.asleep) continue;
    whole.body.drift(dt);
    spread(bodies, whole, true);
  }
}

void GluedBodies::take_motion(std::vector<RigidBody> &bodies)
{
  for (Whole &whole : wholes) {
    const RigidBody now = joined_body(bodies, whole.pieces);
    whole.body.velocity = now.velocity;
    whole.body.L = now.L;
    whole.body.refresh();
    spread(bodies, whole, false);
  }
}

// --- stress ---

static std::vector<Vec3> places_of(const GluedBodies::Whole &whole, const std::vector<Pose> &in_whole)
{
  std::vector<Vec3> found;
  for (const int n : whole.pieces) found.push_back(in_whole[n].place);
  return found;
}

void GluedBodies::find_springs(Whole &whole) const
{
  std::vector<int> own;
  for (const int n : whole.pieces)
    for (const int f : at[n])
      if (!broken[f] && faces[f].a == n) own.push_back(f);
  const auto row = [&](int body) {
    return static_cast<int>(std::lower_bound(whole.pieces.begin(), whole.pieces.end(), body) - whole.pieces.begin());
  };
  whole.springs.clear();
  whole.stiff.assign(whole.pieces.size(), {});
  whole.bears = HUGE_VAL;
  for (const int f : own) {
    const GlueFace &face = faces[f];
    const Pose &piece = in_whole[face.a], &start = from_start[face.a];
    const Matrix3 turn = matrix(piece.q) * matrix(start.q);
    const Vec3 middle = piece.place + matrix(piece.q) * (start.place + matrix(start.q) * face.at);
    const double over = face.is_weld() ? 0.0 : 1.0 / length(in_whole[face.b].place - piece.place);
    GlueSpring spring;
    spring.face = f, spring.a = row(face.a), spring.b = row(face.b);
    spring.arm_a = middle - piece.place;
    spring.arm_b = middle - in_whole[face.b].place;
    spring.stiffness = over * face.area;
    spring.twist = over * Vec3{face.second.z, face.second.x, face.second.y};
    for (int k = 0; k < 3; ++k) spring.axis[k] = turn * face.axis[k];
    add_diagonal(spring, whole.stiff);
    whole.bears = std::min(whole.bears, face.strength * face.area);
    whole.springs.push_back(spring);
  }
  whole.coarse.make(whole.springs, places_of(whole, in_whole));
}

std::vector<double> GluedBodies::shares(const Whole &whole, const std::vector<RigidBody> &bodies, const PieceMotions &more,
                                        double to_acceleration)
{
  std::vector<double> found(whole.springs.size(), 0.0);
  PieceMotions load = loads_of_pieces(whole.body, whole.pieces, in_whole, bodies, to_acceleration);
  add_in_frame(whole.body, whole.pieces, more, load);
  double pushes = 0.0;
  for (const PieceMotion &one : load) pushes = std::max(pushes, length(one.place));
  if (pushes <= QUIET * whole.bears) return found;
  PieceMotions x;
  for (const int n : whole.pieces) x.push_back(given_way[n]);
  solve(whole.springs, whole.stiff, whole.coarse, load, x);
  for (std::size_t k = 0; k < x.size(); ++k) given_way[whole.pieces[k]] = x[k];
  for (std::size_t s = 0; s < found.size(); ++s) {
    const FaceForce on_a = face_force(whole.springs[s], x);
    const GlueFace &face = faces[whole.springs[s].face];
    found[s] = FaceLoad::of(face, on_a.force, on_a.torque).share(face);
  }
  return found;
}

void GluedBodies::take_stress(const Whole &whole, const std::vector<double> &share)
{
  for (std::size_t s = 0; s < share.size(); ++s) {
    const GlueFace &face = faces[whole.springs[s].face];
    most_share = std::max(most_share, share[s]);
    for (const int body : {face.a, face.b}) bore[body] = std::max(bore[body], share[s] * face.strength);
  }
}

// Faces above their strength break that have the largest share of all faces of both of their pieces, so that a crack
// goes from face to face; of equal ones the first.
static std::vector<int> faces_that_break(const GluedBodies::Whole &whole, const std::vector<double> &share)
{
  std::vector<double> most(whole.pieces.size(), 0.0);
  std::vector<int> first(whole.pieces.size(), -1), found;
  for (std::size_t s = 0; s < share.size(); ++s)
    for (const int end : {whole.springs[s].a, whole.springs[s].b})
      if (share[s] > most[end]) most[end] = share[s], first[end] = static_cast<int>(s);
  for (std::size_t s = 0; s < share.size(); ++s) {
    const int number = static_cast<int>(s);
    const bool is_largest = first[whole.springs[s].a] == number && first[whole.springs[s].b] == number;
    if (share[s] > 1.0 && is_largest) found.push_back(whole.springs[s].face);
  }
  return found;
}

std::vector<int> GluedBodies::judge(const std::vector<RigidBody> &bodies, const PieceMotions &more, double to_acceleration)
{
  std::vector<int> apart;
  std::vector<char> is_opened(wholes.size(), 0);
  for (std::size_t w = 0; w < wholes.size(); ++w) {
    Whole &whole = wholes[w];
    if (whole.body.aside || whole.body.asleep || !std::isfinite(whole.bears)) continue;
    const std::vector<double> share = shares(whole, bodies, more, to_acceleration);
    take_stress(whole, share);
    const std::vector<int> gone = faces_that_break(whole, share);
    if (gone.empty()) continue;
    for (const int f : gone) broken[f] = 1;
    is_opened[w] = 1;
    apart.insert(apart.end(), whole.pieces.begin(), whole.pieces.end());
  }
  if (apart.empty()) return apart;
  std::sort(apart.begin(), apart.end());
  std::vector<Whole> before = std::move(wholes);
  wholes.clear();
  for (std::size_t w = 0; w < before.size(); ++w) {
    if (is_opened[w]) {
      std::vector<std::vector<int>> found = parts(before[w]);
      if (found.size() > 1) {
        for (std::vector<int> &part : found) make_whole(bodies, std::move(part));
        continue;
      }
      find_springs(before[w]);
    }
    wholes.push_back(std::move(before[w]));
  }
  number_wholes();
  return apart;
}

std::vector<FaceLoads> GluedBodies::face_loads(const std::vector<RigidBody> &bodies, double to_acceleration) const
{
  std::vector<FaceLoads> found(at.size());
  for (const Whole &whole : wholes) {
    if (whole.body.aside) continue;
    const std::vector<Vec3> places = places_of(whole, in_whole);
    const PieceMotions load = loads_of_pieces(whole.body, whole.pieces, in_whole, bodies, to_acceleration);
    const std::vector<FaceLoads> own = hanging_loads(whole.springs, places, load);
    const Matrix3 &turn = whole.body.turn;
    for (std::size_t k = 0; k < own.size(); ++k)
      found[whole.pieces[k]] = {turn * own[k].force, turn * own[k].torque, whole.body.centre + turn * own[k].at};
  }
  return found;
}

// In the order of their first pieces, in which records bring them.
void GluedBodies::number_wholes()
{
  std::sort(wholes.begin(), wholes.end(), [](const Whole &a, const Whole &b) { return a.pieces.front() < b.pieces.front(); });
  for (std::size_t w = 0; w < wholes.size(); ++w)
    for (const int n : wholes[w].pieces) whole_of[n] = static_cast<int>(w);
}

// --- records ---

void GluedBodies::put(int body, ByteWriter &writer) const
{
  if (!is_on() || at[body].empty()) return;
  Kept kept;
  kept.from_start = from_start[body], kept.bore = bore[body];
  if (holds(body)) {
    const Whole &whole = wholes[whole_of[body]];
    kept.behind = at_start.place[body] - at_start.place[whole.pieces.front()];
    kept.mass = whole.body.mass, kept.moments = whole.body.moments, kept.centre = whole.body.centre;
    kept.velocity = whole.body.velocity, kept.q = whole.body.q, kept.L = whole.body.L;
    kept.pose = in_whole[body];
    kept.way = given_way[body];
  }
  std::vector<std::int8_t> own;
  for (const int f : at[body])
    if (faces[f].a == body) own.push_back(static_cast<std::int8_t>(broken[f]));
  writer.put(kept).put_counted(own);
}

void GluedBodies::read(int body, ByteReader &reader)
{
  if (!is_on() || at[body].empty()) return;
  kept.resize(at.size());
  kept[body] = reader.get<Kept>();
  const auto own = reader.get_counted<std::int8_t>();
  std::size_t next = 0;
  for (const int f : at[body])
    if (faces[f].a == body) {
      if (next == own.size()) reader.is_damaged("it has fewer faces of glue than the piece");
      broken[f] = own[next++] != 0;
    }
  const Kept &now = kept[body];
  if (next != own.size() || !(now.bore >= 0.0) || now.behind > at_start.place[body] || now.behind < ALONE ||
      (now.behind != ALONE && !(now.mass > 0.0)) ||
      !std::isfinite(now.centre.x + now.centre.y + now.centre.z + now.velocity.x + now.velocity.y + now.velocity.z))
    reader.is_damaged("its glue");
}

void GluedBodies::rebuild(const std::vector<char> &has)
{
  if (!is_on()) return;
  std::vector<Whole> before = std::move(wholes);
  wholes.clear();
  std::vector<int> number(at.size(), ALONE);    // of wholes, by their first pieces
  for (std::size_t n = 0; n < at.size(); ++n) {
    if (at[n].empty()) continue;
    if (!has[n]) {    // laid aside: as it was
      if (whole_of[n] == ALONE) continue;
      const Whole &was = before[whole_of[n]];
      const int first = was.pieces.front();
      if (number[first] == ALONE) number[first] = static_cast<int>(wholes.size()), wholes.push_back(was);
      whole_of[n] = number[first];
      continue;
    }
    const Kept &own = kept[n];
    from_start[n] = own.from_start, in_whole[n] = own.pose;
    bore[n] = own.bore, given_way[n] = own.way;
    whole_of[n] = ALONE;
    if (own.behind == ALONE) continue;
    const int first = at_start.groups[at_start.group[n]][at_start.place[n] - own.behind];
    if (number[first] == ALONE) {
      number[first] = static_cast<int>(wholes.size());
      Whole whole;
      RigidBody &body = whole.body;
      body.mass = own.mass, body.moments = own.moments, body.centre = own.centre;
      body.velocity = own.velocity, body.q = own.q, body.L = own.L;
      body.refresh();
      wholes.push_back(std::move(whole));
    }
    whole_of[n] = number[first];
    wholes[number[first]].pieces.push_back(static_cast<int>(n));
  }
  number_wholes();
  for (Whole &whole : wholes) find_springs(whole);
  kept.clear();
}

}    // namespace mdanim
