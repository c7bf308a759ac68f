// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/rigid_touching.h"

#include "lammps/fix_mdanim_drive.h"
#include "lammps/shared_file.h"

#include "error.h"
#include "fmt/format.h"
#include "force.h"
#include "lammps.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

using namespace LAMMPS_NS;

namespace mdanim {

static const char *const STYLE = "fix mdanim/rigid";

std::vector<Output> RigidTouching::outputs()
{
  const TouchAccount &account = contact.account;
  const double &mvv2e = lmp->force->mvv2e;
  return {{"contact", true, [&, this] { return mvv2e * contact.found().energy; }},
          {"friction_heat", true, [&] { return mvv2e * account.heat; }},
          {"damping_loss", true, [&] { return mvv2e * account.damped; }},
          {"let_go", true, [&] { return mvv2e * account.let_go; }},
          {"deepest", false, [&] { return account.deepest; }},
          {"touching", true, [this] { return static_cast<double>(contact.found().touching); }},
          {"near", true, [this] { return static_cast<double>(contact.near_pairs()); }},
          {"worst_bound", false, [&] { return account.worst_bound; }},
          {"most_touching", false, [&] { return static_cast<double>(account.most_touching); }},
          {"work", true, [&, this] { return mvv2e * taken(); }}};
}

// --- the command ---

std::vector<Keyword> RigidTouching::words()
{
  return {{"shapes", "FILE"},          {"contact", "OMEGA EPS"}, {"objects", ""},    {"drive", "FIXID"},
          {"plane", "x|y|z lo|hi at"}, {"pair", "A B mu beta"},  {"exclude", "A B"}, {"moving", "x|y|z lo|hi at FIXID"},
          {"belt", "A vx vy vz"},      {"rolling", "A B r"}};
}

static double number(LAMMPS *lmp, int iarg, char **arg, const char *what, double least, bool or_equal)
{
  const double value = utils::numeric(FLERR, arg[iarg], false, lmp);
  if (!(or_equal ? value >= least : value > least))
    lmp->error->all(FLERR, iarg, "{}: {} must be {} {}, got {}", STYLE, what, or_equal ? "at least" : "above", least, arg[iarg]);
  return value;
}

void RigidTouching::read_word(int iarg, char **arg)
{
  const auto is = [&](const char *word) { return strcmp(arg[iarg], word) == 0; };
  if (is("shapes")) {
    has_file = true;
    const std::string text = read_shared_file(lmp, STYLE, "shapes", arg[iarg + 1]);
    try {
      for (auto &[molecule, shape] : read_shapes(arg[iarg + 1], text)) shapes[molecule] = std::move(shape);
    } catch (const std::exception &problem) {
      lmp->error->all(FLERR, "{}: {}", STYLE, problem.what());
    }
  }
  if (is("contact")) {
    contact.settings.frequency = number(lmp, iarg + 1, arg, "OMEGA", 0.0, false);
    contact.settings.onset = number(lmp, iarg + 2, arg, "EPS", 0.0, false);
  }
  if (is("drive")) drive_id = arg[iarg + 1];
  if (is("objects")) contact.settings.objects = true;
  if (is("plane") || is("moving")) read_plane(iarg, arg);
  if (is("moving")) {
    contact.settings.planes.back().moves = true;
    moving.add(static_cast<int>(contact.settings.planes.size()) - 1, arg[iarg + 4]);
  }
  if (is("belt")) {
    const auto along = [&](int k) { return utils::numeric(FLERR, arg[iarg + k], false, lmp); };
    contact.settings.belts[utils::inumeric(FLERR, arg[iarg + 1], false, lmp)] = {along(2), along(3), along(4)};
  }
  if (is("pair")) read_pair(iarg, arg);
  if (is("rolling")) contact.settings.rolling[read_two(iarg, arg)] = number(lmp, iarg + 3, arg, "the arm of rolling", 0.0, true);
  if (is("exclude")) contact.settings.excluded.insert(two_molecules(lmp, STYLE, iarg + 1, arg));
}

void RigidTouching::read_plane(int iarg, char **arg)
{
  const int axis = arg[iarg + 1][0] - 'x';
  if (axis < 0 || axis > 2 || arg[iarg + 1][1])
    lmp->error->all(FLERR, iarg + 1, "{}: the axis of a plane is x, y or z, got {}", STYLE, arg[iarg + 1]);
  const bool low = strcmp(arg[iarg + 2], "lo") == 0;
  if (!low && strcmp(arg[iarg + 2], "hi") != 0)
    lmp->error->all(FLERR, iarg + 2, "{}: a plane is the lower end of what is allowed, lo, or the upper, hi; got {}", STYLE,
                    arg[iarg + 2]);
  const double sign = low ? 1.0 : -1.0, at = utils::numeric(FLERR, arg[iarg + 3], false, lmp);
  SolidPlane plane;
  plane.n = {axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0};
  plane.at = sign * at;
  contact.settings.planes.push_back(plane);
}

// The second of a pair may be a plane: plane1 is the first one of the command.
std::pair<int, int> RigidTouching::read_two(int iarg, char **arg) const
{
  int a = utils::inumeric(FLERR, arg[iarg + 1], false, lmp), b = 0;
  if (strncmp(arg[iarg + 2], "plane", 5) == 0) {
    const int plane = utils::inumeric(FLERR, arg[iarg + 2] + 5, false, lmp);
    if (plane < 1 || plane > static_cast<int>(contact.settings.planes.size()))
      lmp->error->all(FLERR, iarg + 2, "{}: a pair has {}, and {} planes are given before it", STYLE, arg[iarg + 2],
                      contact.settings.planes.size());
    b = -plane;
  } else {
    b = utils::inumeric(FLERR, arg[iarg + 2], false, lmp);
  }
  if (a < 1 || b == 0 || a == b)
    lmp->error->all(FLERR, iarg + 1,
                    "{}: a pair is two different molecule IDs > 0, or one and plane1, plane2, ...; got {} and {}", STYLE,
                    arg[iarg + 1], arg[iarg + 2]);
  if (b > 0 && b < a) std::swap(a, b);
  return {a, b};
}

void RigidTouching::read_pair(int iarg, char **arg)
{
  const Material material{number(lmp, iarg + 3, arg, "mu of a pair", 0.0, true),
                          number(lmp, iarg + 4, arg, "beta of a pair", 0.0, true)};
  if (material.damping > Material::MOST_DAMPING)
    lmp->error->all(FLERR, iarg + 4, "{}: beta of a pair must be at most {}, got {}", STYLE, Material::MOST_DAMPING,
                    arg[iarg + 4]);
  contact.settings.pairs[read_two(iarg, arg)] = material;
}

void RigidTouching::check() const
{
  const RigidContactSettings &settings = contact.settings;
  if (!is_on()) {
    if (has_file || settings.frequency > 0.0)
      lmp->error->all(FLERR, "{}: nothing can touch; write objects, or plane x|y|z lo|hi and its place", STYLE);
    return;
  }
  if (!has_file || !(settings.frequency > 0.0))
    lmp->error->all(FLERR, "{}: contact needs 'shapes FILE' and 'contact OMEGA EPS'", STYLE);
}

// --- bodies ---

void RigidTouching::make(const std::string &fix, const ObjectTable &objects, const std::vector<RigidBody> &bodies)
{
  std::vector<Pose> in_bodies(bodies.size());
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n) {
    const auto found = shapes.find(static_cast<int>(objects.id(static_cast<int>(n))));
    if (found == shapes.end()) continue;
    if (bodies[n].aside) {
      in_bodies[n] = poses[n];
      continue;
    }
    in_bodies[n] = in_body(found->second.pose, bodies[n], found->second.shape.thin());
  }
  take(fix, objects, bodies, std::move(in_bodies));
}

void RigidTouching::take(const std::string &fix, const ObjectTable &objects, const std::vector<RigidBody> &bodies,
                         std::vector<Pose> in_bodies)
{
  poses = std::move(in_bodies);
  solid_of.assign(bodies.size(), NO_SHAPE);
  driven.clear();
  is_current = false;
  if (!is_on()) return;
  std::vector<Solid> solids;
  SharedShapes shared;
  for (const auto &[id, given] : shapes) {
    const int n = objects.number_of(id);
    if (given.held != (n == ObjectTable::NONE))
      lmp->error->all(FLERR, "{}: the file of shapes has object {} (molecule ID) as {}, and it has {} particle in the group", fix,
                      id, given.held ? "held" : "free", given.held ? "a" : "no");
    Solid one;
    one.id = id;
    one.held = given.held;
    one.driven = given.driven;
    if (const auto belt = contact.settings.belts.find(id); belt != contact.settings.belts.end()) one.belt = belt->second;
    if (given.driven) driven.push_back({id, static_cast<int>(solids.size()), given.pose, {}, {}, {}});
    one.material = given.material;
    if (given.held) {
      one.shape = given.shape.placed({});
      one.move_to(given.pose.place, matrix(given.pose.q));
    } else {
      one.shape = shared.take(given.shape.placed(poses[n]));
      one.over_mass = 1.0 / bodies[n].mass;
      one.over = bodies[n].over;
      one.aside = bodies[n].aside;
      solid_of[n] = static_cast<int>(solids.size());
    }
    solids.push_back(std::move(one));
  }
  for (const auto &[ids, law] : contact.settings.pairs)
    for (const int id : {ids.first, ids.second})
      if (id > 0 && !shapes.count(id)) lmp->error->all(FLERR, "{}: pair names molecule {}, which has no shape", fix, id);
  for (const auto &[ids, arm] : contact.settings.rolling)
    for (const int id : {ids.first, ids.second})
      if (id > 0 && !shapes.count(id)) lmp->error->all(FLERR, "{}: rolling names molecule {}, which has no shape", fix, id);
  for (const auto &[id, velocity] : contact.settings.belts)
    if (!shapes.count(id)) lmp->error->all(FLERR, "{}: belt names molecule {}, which has no shape", fix, id);
  for (const auto &[a, b] : contact.settings.excluded)
    for (const int id : {a, b})
      if (!shapes.count(id)) lmp->error->all(FLERR, "{}: exclude names molecule {}, which has no shape", fix, id);
  contact.take(std::move(solids));
  place_all(bodies, true);
}

void RigidTouching::glue(const GluedBodies &glued, const std::vector<int> &pieces)
{
  for (const int n : pieces) {
    const int number = is_on() ? solid_of[n] : NO_SHAPE;
    if (number == NO_SHAPE) continue;
    const SolidShape &shape = contact.solid(number).shape;
    std::vector<char> faces(shape.kind() == SolidShape::POLYHEDRON ? shape.sides() : 0, 0);
    for (const int f : glued.faces_of(n)) {
      const GlueFace &face = glued.all_faces()[f];
      const std::size_t side = static_cast<std::size_t>(face.a == n ? face.side_a : face.side_b);
      if (side < faces.size() && faces[side] != 2) faces[side] = glued.is_broken(f) ? 2 : 1;
    }
    Carrier carrier;
    if (glued.holds(n)) {
      const Matrix3 turn = matrix(glued.pose(n).q);
      const RigidBody &whole = glued.whole(n).body;
      carrier = {-1.0 * transposed_times(turn, glued.pose(n).place), transposed(turn), 1.0 / whole.mass, whole.over};
    }
    contact.glue(number, glued.holds(n) ? glued.first_of(n) : Solid::ALONE, carrier, faces);
  }
}

double RigidTouching::unglue(const GluedBodies &glued, const std::vector<int> &pieces)
{
  if (!is_on()) return 0.0;
  std::map<int, double> yielded;
  for (const int n : pieces)
    if (solid_of[n] != NO_SHAPE) yielded[solid_of[n]] = contact.solid(solid_of[n]).yields;
  glue(glued, pieces);
  return contact.change(yielded);
}

void RigidTouching::place_all(const std::vector<RigidBody> &bodies, bool settled)
{
  constexpr double NS_OF_PLACE = 30.0;
  contact.helpers().parts(static_cast<long>(bodies.size()), NS_OF_PLACE, [&](long first, long end) {
    for (long n = first; n < end; ++n)
      if (solid_of[n] != NO_SHAPE && (settled || !bodies[n].settled)) contact.place(solid_of[n], bodies[n]);
  });
}

// Where driven shapes are now; velocities are the means of the step that ends here.
void RigidTouching::place_driven()
{
  const double per_dt = 1.0 / lmp->update->dt;
  for (DrivenSolid &one : driven) {
    const FixMdanimDrive::Ways *const ways = drive ? drive->ways_of(one.id) : nullptr;
    if (!ways)
      lmp->error->all(FLERR,
                      "{}: object {} (molecule ID) is driven, and no motion is given for it; write drive and the ID of a fix "
                      "mdanim/drive that has one",
                      STYLE, one.id);
    const Vec3 centre = ways->now.of(one.start.place);
    one.way = centre - ways->before.of(one.start.place);
    one.turned = DrivenStep(ways->before, ways->now).angle;
    contact.place_driven(one.solid, centre, matrix(ways->now.q * one.start.q), per_dt * one.way, per_dt * one.turned);
  }
}

void RigidTouching::move_planes()
{
  const double per_dt = 1.0 / lmp->update->dt;
  moving.each([&](int k, const Vec3 &shift, const Vec3 &way) {
    SolidPlane &plane = contact.settings.planes[k];
    plane.shift = shift, plane.way = way, plane.velocity = per_dt * way;
  });
}

// -F dx with the mean of the forces before and after the step.
void RigidTouching::count_work(bool moves)
{
  for (DrivenSolid &one : driven) {
    const Push now{contact.solid(one.solid).force, contact.solid(one.solid).torque};
    if (moves) work -= 0.5 * (dot(one.push.force + now.force, one.way) + dot(one.push.torque + now.torque, one.turned));
    one.push = now;
  }
}

void RigidTouching::step(const std::vector<RigidBody> &bodies, double dt)
{
  if (!is_on()) return;
  place_all(bodies, false);
  place_driven();
  move_planes();
  contact.step(dt);
  count_work(dt > 0.0);
  is_current = true;
}

// --- driven shapes ---

void RigidTouching::init(const std::string &fix)
{
  moving.init(fix);
  if (drive_id.empty()) return;
  drive = dynamic_cast<FixMdanimDrive *>(lmp->modify->get_fix_by_id(drive_id));
  if (!drive) lmp->error->all(FLERR, "{}: drive {} is not the ID of a fix mdanim/drive", fix, drive_id);
}

void RigidTouching::lay_driven_aside()
{
  if (driven.empty() || !drive) return;
  const std::set<int> present = drive->present();
  for (const DrivenSolid &one : driven)
    if (contact.lay_aside(one.solid, !present.count(one.id))) is_current = false;
}

bool RigidTouching::is_driven(int id) const
{
  const auto found = shapes.find(id);
  return found != shapes.end() && found->second.driven;
}

void RigidTouching::put_driven(std::int64_t version, StateRecords &records) const
{
  for (const DrivenSolid &one : driven) records[{one.id, 0}] = ByteWriter().put(version).put(one.push).take();
}

void RigidTouching::read_driven(std::int64_t version, const StateRecords &records)
{
  for (DrivenSolid &one : driven) {
    const auto found = records.find({one.id, 0});
    if (found == records.end()) continue;
    ByteReader reader(found->second.data(), found->second.size(), name_of_record(found->first));
    reader.expect_version(version);
    one.push = reader.get<Push>();
    reader.expect_end();
  }
}

// --- records ---

std::string name_of_record(const StateKey &key)
{ return key.b ? fmt::format("the record of objects {} and {}", key.a, key.b) : fmt::format("the record of object {}", key.a); }

void RigidTouching::read_contacts(const StateRecords &records, std::int64_t version,
                                  std::vector<std::optional<ByteReader>> &at_planes)
{
  for (std::size_t n = 0; n < at_planes.size(); ++n) {
    if (!at_planes[n]) continue;
    if (is_on() && solid_of[n] != NO_SHAPE) contact.read_at_planes(solid_of[n], *at_planes[n]);
    at_planes[n]->expect_end();
  }
  for (const auto &[key, bytes] : records) {
    if (key.b == 0) continue;
    ByteReader reader(bytes.data(), bytes.size(), name_of_record(key));
    const int a = contact.number_of(key.a), b = contact.number_of(key.b);
    if (a < 0 || b < 0) reader.fail("is of an object that is not there");
    reader.expect_version(version);
    contact.read_pair(a, b, reader);
    reader.expect_end();
  }
}

}    // namespace mdanim
