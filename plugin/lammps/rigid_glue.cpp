// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/rigid_glue.h"

#include <stdexcept>
#include <utility>

namespace mdanim {

std::vector<Output> RigidGlue::outputs(const double &mvv2e)
{
  return {{"torn", true, [&, this] { return mvv2e * torn; }},
          {"broken_faces", true, [this] { return static_cast<double>(glued.broken_faces()); }},
          {"stress_share", false, [this] { return glued.largest_share(); }}};
}

void RigidGlue::take()
{
  if (faces.empty() || glued.is_on()) return;
  const ObjectTable &objects = particles.objects();
  std::vector<GlueFace> numbered = faces;
  for (GlueFace &face : numbered)
    for (int *const end : {&face.a, &face.b}) {
      const int molecule = *end;
      *end = objects.number_of(molecule);
      if (*end == ObjectTable::NONE)
        throw std::runtime_error("glue names molecule " + std::to_string(molecule) + ", which has no particle in its group");
    }
  glued.take(std::move(numbered), static_cast<std::size_t>(objects.size()));
}

void RigidGlue::join()
{
  if (faces.empty()) return;
  forget();
  take();
  glued.join(bodies);
  glued.take_motion(bodies);
  tell_contact();
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

std::vector<int> RigidGlue::judge(double to_acceleration, double half_dt)
{
  std::vector<int> apart = glued.judge(bodies, to_acceleration, half_dt, torn);
  if (apart.empty()) return apart;
  for (const int n : apart)
    if (touching.is_on() && touching.solid(n) != RigidTouching::NO_SHAPE) touching.contact.place(touching.solid(n), bodies[n]);
  torn += touching.unglue(glued, apart);
  return apart;
}

}    // namespace mdanim
