// SPDX-License-Identifier: GPL-2.0-only
// Bodies from particles: masses, moments, velocities; and what has changed between two runs.

#include "lammps/fix_mdanim_rigid.h"

#include "lammps/shared_file.h"

#include "fmt/format.h"

#include <sstream>
#include <string>

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr double THIN = 1e-10;    // smallest moment over the largest of what counts as a line

// A line for each object: molecule ID, Ixx Iyy Izz Ixy Ixz Iyz about its centre; # begins a comment.
void FixMdanimRigid::read_inertia_of(const char *file)
{
  std::istringstream text(read_shared_file(lmp, "fix mdanim/rigid", "moments of inertia", file));
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    const auto refuse = [&](const std::string &why) {
      error->all(FLERR, "fix mdanim/rigid: line {} of {}: {}; a line is a molecule ID and Ixx Iyy Izz Ixy Ixz Iyz", number, file,
                 why);
    };
    std::istringstream words(line);
    std::vector<double> value;
    for (std::string word; words >> word;) {
      if (!utils::is_double(word)) refuse(word + " is not a number");
      value.push_back(std::stod(word));
    }
    if (value.empty()) continue;
    if (value.size() != 7) refuse(fmt::format("there are {} numbers", value.size()));
    const Inertia inertia{value[1], value[2], value[3], value[4], value[5], value[6]};
    const Vec3 moments = principal_axes(inertia).moments;
    if (!(moments.x > 0.0 && moments.x + moments.y >= (1.0 - 1e-9) * moments.z))
      refuse(
          fmt::format("no body has the principal moments {:.6g}, {:.6g} and {:.6g}, which must be positive, none above the sum "
                      "of the other two",
                      moments.x, moments.y, moments.z));
    const int molecule = static_cast<int>(value[0]);
    if (molecule != value[0] || molecule < 1) refuse(fmt::format("{} is not a molecule ID", value[0]));
    if (!given.emplace(molecule, inertia).second) refuse(fmt::format("object {} has a line already", molecule));
  }
}

// Called by all ranks together.
void FixMdanimRigid::find_objects()
{
  std::vector<tagint> here;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!moves(i)) continue;
    need_object(this, lmp, i);
    here.push_back(atom->molecule[i]);
  }
  const ObjectTable before = objects;
  objects.make(world, std::move(here));
  std::vector<bigint> inside(objects.size(), 0), all(objects.size(), 0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int n = objects.number_of(atom->molecule[i]);
    if (n == ObjectTable::NONE) continue;
    ++all[n];
    inside[n] += moves(i);
  }
  MPI_Allreduce(MPI_IN_PLACE, inside.data(), objects.size(), MPI_LMP_BIGINT, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, all.data(), objects.size(), MPI_LMP_BIGINT, MPI_SUM, world);
  for (int n = 0; n < objects.size(); ++n) {
    if (inside[n] != all[n])
      error->all(FLERR, "{}: {} of the {} particles of object {} (molecule ID) are in its group; a rigid body has all of them",
                 name(), inside[n], all[n], objects.id(n));
    if (all[n] > UnorderedSum::MOST_TERMS)
      error->all(FLERR, "{}: object {} (molecule ID) has {} particles, a rigid body may have {}", name(), objects.id(n), all[n],
                 UnorderedSum::MOST_TERMS);
  }
  for (const auto &[molecule, inertia] : given)
    if (objects.number_of(molecule) == ObjectTable::NONE)
      error->all(FLERR, "{}: there are moments of inertia for object {} (molecule ID), which has no particle in its group",
                 name(), molecule);
  if (!(objects == before) || all != particles) bodies.clear();
  particles = std::move(all);
  size_array_rows = objects.size();
}

void FixMdanimRigid::locate()
{
  body_of.assign(atom->nlocal, ObjectTable::NONE);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!moves(i)) continue;
    body_of[i] = objects.number_of(atom->molecule[i]);
    if (body_of[i] == ObjectTable::NONE)
      error->one(FLERR,
                 "{}: particle {} of object {} (molecule ID) has come into its group since the setup of this run; let it come "
                 "between two runs, the second without 'pre no'",
                 name(), atom->tag[i], atom->molecule[i]);
  }
}

// Mass, centre and moments of objects from their particles, as points.
std::vector<FixMdanimRigid::MassProperties> FixMdanimRigid::weigh() const
{
  std::vector<MassProperties> found(objects.size());
  const auto first = sums<4>([this](int i) {
    const Vec3 mx = mass_at(i) * vec3(atom->x[i]);
    return std::array<double, 4>{mass_at(i), mx.x, mx.y, mx.z};
  });
  for (std::size_t n = 0; n < found.size(); ++n) {
    found[n].mass = first[n][0];
    found[n].centre = {first[n][1] / first[n][0], first[n][2] / first[n][0], first[n][3] / first[n][0]};
  }
  const auto second = sums<6>([&](int i) {
    const double m = mass_at(i);
    const Vec3 r = vec3(atom->x[i]) - found[body_of[i]].centre;
    return std::array<double, 6>{m * (r.y * r.y + r.z * r.z),
                                 m * (r.x * r.x + r.z * r.z),
                                 m * (r.x * r.x + r.y * r.y),
                                 -m * r.x * r.y,
                                 -m * r.x * r.z,
                                 -m * r.y * r.z};
  });
  for (std::size_t n = 0; n < found.size(); ++n)
    found[n].inertia = {second[n][0], second[n][1], second[n][2], second[n][3], second[n][4], second[n][5]};
  return found;
}

void FixMdanimRigid::make()
{
  const std::vector<MassProperties> found = weigh();
  bodies.assign(objects.size(), RigidBody());
  for (int n = 0; n < objects.size(); ++n) {
    const auto other = given.find(static_cast<int>(objects.id(n)));
    const PrincipalAxes axes = principal_axes(other == given.end() ? found[n].inertia : other->second);
    if (!(axes.moments.x > THIN * axes.moments.z))
      error->all(FLERR,
                 "{}: the particles of object {} (molecule ID) stand on a line, so it has no moment of inertia about it; add "
                 "'inertia FILE' with the moments of the body",
                 name(), objects.id(n));
    RigidBody &body = bodies[n];
    body.mass = found[n].mass;
    body.centre = found[n].centre;
    body.moments = axes.moments;
    body.q = axes.q;
    body.refresh();
  }
  for (int i = 0; i < atom->nlocal; ++i) {
    if (body_of[i] == ObjectTable::NONE) continue;
    const RigidBody &body = bodies[body_of[i]];
    const Vec3 place = transposed_times(body.turn, vec3(atom->x[i]) - body.centre);
    own[i][0] = place.x, own[i][1] = place.y, own[i][2] = place.z;
  }
  set_velocities(found);
  put(true);
}

// R diag(moments) R^T v.
static Vec3 times_moments(const Matrix3 &turn, const Vec3 &moments, const Vec3 &v)
{
  const Vec3 along = transposed_times(turn, v);
  return turn * Vec3{moments.x * along.x, moments.y * along.y, moments.z * along.z};
}

// Particles on a line have no rotation about it.
static Vec3 inverse_of(const Vec3 &moments)
{
  const auto inverse = [&](double moment) { return moment > THIN * moments.z ? 1.0 / moment : 0.0; };
  return {inverse(moments.x), inverse(moments.y), inverse(moments.z)};
}

// Velocities and angular momenta of bodies from those of their particles; of a body whose moments are given, the angular
// velocity is that of its particles.
void FixMdanimRigid::set_velocities(const std::vector<MassProperties> &found)
{
  const auto motion = sums<6>([&](int i) {
    const Vec3 p = mass_at(i) * vec3(atom->v[i]), l = cross(vec3(atom->x[i]) - found[body_of[i]].centre, p);
    return std::array<double, 6>{p.x, p.y, p.z, l.x, l.y, l.z};
  });
  for (int n = 0; n < objects.size(); ++n) {
    RigidBody &body = bodies[n];
    body.velocity = (1.0 / found[n].mass) * Vec3{motion[n][0], motion[n][1], motion[n][2]};
    body.L = {motion[n][3], motion[n][4], motion[n][5]};
    if (given.count(static_cast<int>(objects.id(n)))) {
      const PrincipalAxes axes = principal_axes(found[n].inertia);
      const Vec3 spin = times_moments(matrix(axes.q), inverse_of(axes.moments), body.L);
      body.L = times_moments(body.turn, body.moments, spin);
    }
    body.refresh();
  }
}

// Particles may have been moved, or been given other velocities, since the last run.
void FixMdanimRigid::follow_changes()
{
  const auto is_same = [](const double *a, const Vec3 &b) { return a[0] == b.x && a[1] == b.y && a[2] == b.z; };
  bool moved = false, pushed = false;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (body_of[i] == ObjectTable::NONE) continue;
    const RigidBody &body = bodies[body_of[i]];
    const Vec3 from_centre = body.turn * vec3(own[i]);
    moved = moved || !is_same(atom->x[i], body.centre + from_centre);
    pushed = pushed || !is_same(atom->v[i], body.velocity_at(from_centre));
  }
  if (largest(moved) > 0.0) {
    if (!given.empty())
      error->all(FLERR,
                 "{}: particles were moved since the last run, so the moments in its file are those of other places; write the "
                 "fix again, with a file for the new places",
                 name());
    make();
  } else if (largest(pushed) > 0.0) {
    set_velocities(weigh());
    put(false);
  }
}
