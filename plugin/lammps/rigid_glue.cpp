// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/rigid_glue.h"

#include "lammps/shared_file.h"

#include "error.h"
#include "force.h"
#include "lammps.h"

#include <stdexcept>
#include <utility>

namespace mdanim {

std::vector<Output> RigidGlue::outputs(const std::function<bool()> &collect, const double &half_dt,
                                       const std::vector<double> &drag)
{
  const double &mvv2e = lmp->force->mvv2e;
  const auto energy_of_motion = [&, collect, this] {
    collect();
    return mvv2e * kinetic(half_dt, drag);
  };
  return {{"kinetic", true, energy_of_motion},
          {"torn", true, [&mvv2e, this] { return mvv2e * torn; }},
          {"broken_faces", true, [this] { return static_cast<double>(glued.broken_faces()); }},
          {"stress_share", false, [this] { return glued.largest_share(); }}};
}

FaceLoads RigidGlue::load_of(int body, const std::function<bool()> &collect)
{
  if (!glued.is_on()) return {};
  collect();
  if (loads.empty()) loads = glued.face_loads(bodies, lmp->force->ftm2v);
  return loads[body];
}

void RigidGlue::read_file(const char *file)
{
  const std::string text = read_shared_file(lmp, "fix mdanim/rigid", "glue", file);
  try {
    faces = read_glue(file, text);
  } catch (const std::exception &problem) {
    lmp->error->all(FLERR, "fix mdanim/rigid: {}", problem.what());
  }
}

void RigidGlue::forget_bodies()
{
  bodies.clear();
  glued = GluedBodies();
}

// Numbers the bodies of faces.
void RigidGlue::take(const std::string &fix)
{
  const ObjectTable &objects = particles.objects();
  std::vector<GlueFace> numbered = faces;
  for (GlueFace &face : numbered)
    for (int *const end : {&face.a, &face.b}) {
      const int molecule = *end;
      *end = objects.number_of(molecule);
      if (*end == ObjectTable::NONE)
        lmp->error->all(FLERR, "{}: glue names molecule {}, which has no particle in its group", fix, molecule);
    }
  glued.take(std::move(numbered), static_cast<std::size_t>(objects.size()));
}

void RigidGlue::join(const std::string &fix)
{
  if (faces.empty()) return;
  glued = GluedBodies();
  take(fix);
  glued.join(bodies);
  glued.take_motion(bodies);
  tell_contact();
}

void RigidGlue::unpack(const std::string &fix, std::vector<std::optional<ByteReader>> &rest)
{
  if (faces.empty()) return;
  if (!glued.is_on()) take(fix);
  std::vector<char> has;
  for (std::size_t n = 0; n < rest.size(); ++n) {
    has.push_back(rest[n].has_value());
    if (rest[n]) glued.read(static_cast<int>(n), *rest[n]);
  }
  glued.rebuild(has);
  tell_contact();
}

// Calls work(n) for bodies that move alone, shared among threads; one call takes about `ns` nanoseconds.
template <class Work> void RigidGlue::each_mover(double ns, const Work &work)
{
  particles.helpers().parts(static_cast<long>(bodies.size()), ns, [&](long first, long end) {
    for (int n = static_cast<int>(first); n < end; ++n)
      if (is_mover(n)) work(n);
  });
}

void RigidGlue::kick(double half_dt, const std::vector<double> &drag, bool first, double &drag_loss)
{
  constexpr double NS_OF_KICK = 25.0;
  each_mover(NS_OF_KICK, [&](int n) {
    if (drag[n] == 0.0) bodies[n].kick(half_dt);
  });
  for (int n = 0; n < static_cast<int>(bodies.size()); ++n)    // losses in the order of bodies
    if (drag[n] != 0.0 && is_mover(n)) drag_loss += bodies[n].kick_with_drag(half_dt, drag[n], first);
  drag_loss += glued.kick(bodies, half_dt, first);
}

void RigidGlue::drift(double dt)
{
  constexpr double NS_OF_DRIFT = 60.0;
  each_mover(NS_OF_DRIFT, [&](int n) { bodies[n].drift(dt); });
  glued.drift(bodies, dt);
}

void RigidGlue::tell_contact()
{
  std::vector<int> pieces;
  for (int n = 0; n < static_cast<int>(bodies.size()); ++n)
    if (glued.is_on() && !glued.faces_of(n).empty()) pieces.push_back(n);
  touching.glue(glued, pieces);
}

double RigidGlue::kinetic_of(int n, double half_dt, const std::vector<double> &drag) const
{
  if (!glued.holds(n)) return bodies[n].kinetic(half_dt, drag[n]);
  return glued.first_of(n) == n ? glued.whole(n).body.kinetic(half_dt, glued.whole(n).drag) : 0.0;
}

double RigidGlue::kinetic(double half_dt, const std::vector<double> &drag) const
{
  const std::vector<LAMMPS_NS::bigint> present = particles.present();
  double all = 0.0;
  for (std::size_t n = 0; n < bodies.size(); ++n)
    if (present[n] > 0) all += kinetic_of(static_cast<int>(n), half_dt, drag);
  return all;
}

double RigidGlue::kinetic_of_all(double half_dt, const std::vector<double> &drag) const
{
  double all = 0.0;
  for (std::size_t n = 0; n < bodies.size(); ++n) all += kinetic_of(static_cast<int>(n), half_dt, drag);
  return all;
}

bool RigidGlue::judge()
{
  PieceMotions more(bodies.size());
  if (touching.is_on()) {
    const PieceMotions of_solids = touching.contact.spread_over_beds();
    for (std::size_t n = 0; n < bodies.size(); ++n)
      if (const int solid = touching.solid(static_cast<int>(n)); solid != RigidTouching::NO_SHAPE) more[n] = of_solids[solid];
  }
  const std::vector<int> apart = glued.judge(bodies, more, lmp->force->ftm2v);
  if (apart.empty()) return false;
  for (const int n : apart)
    if (touching.is_on() && touching.solid(n) != RigidTouching::NO_SHAPE) touching.contact.place(touching.solid(n), bodies[n]);
  torn += touching.unglue(glued, apart);
  return true;
}

}    // namespace mdanim
