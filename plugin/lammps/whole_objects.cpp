// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/whole_objects.h"

#include "fmt/format.h"
#include "group.h"

#include <utility>

using namespace LAMMPS_NS;

namespace mdanim {

std::string WholeObjects::name() const { return fmt::format("fix {} {}", fix.id, fix.style); }

// --- objects ---

bool WholeObjects::find_objects(bool are_new)
{
  const ObjectTable before = known;
  if (!are_new && take_objects(true) == particles && known == before) return false;
  particles = take_objects(false);
  return true;
}

std::vector<bigint> WholeObjects::take_objects(bool with_aside)
{
  std::vector<tagint> here;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (moves(i))
      need_object(&fix, lmp, i);
    else if (!with_aside || known.number_of(atom->molecule[i]) == ObjectTable::NONE)
      continue;
    here.push_back(atom->molecule[i]);
  }
  known.make(world, std::move(here));
  std::vector<bigint> inside(known.size(), 0), all(known.size(), 0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int n = known.number_of(atom->molecule[i]);
    if (n == ObjectTable::NONE) continue;
    ++all[n];
    inside[n] += moves(i);
  }
  MPI_Allreduce(MPI_IN_PLACE, inside.data(), known.size(), MPI_LMP_BIGINT, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, all.data(), known.size(), MPI_LMP_BIGINT, MPI_SUM, world);
  for (int n = 0; n < known.size(); ++n) {
    if (inside[n] > 0 && inside[n] != all[n])
      error->all(FLERR, "{}: {} of the {} particles of object {} (molecule ID) are in its group; a body has all of them", name(),
                 inside[n], all[n], known.id(n));
    if (all[n] > unordered::MOST_TERMS)
      error->all(FLERR, "{}: object {} (molecule ID) has {} particles, a body may have {}", name(), known.id(n), all[n],
                 unordered::MOST_TERMS);
  }
  return all;
}

void WholeObjects::locate()
{
  of_particle.assign(atom->nlocal, ObjectTable::NONE);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!moves(i)) continue;
    of_particle[i] = known.number_of(atom->molecule[i]);
    if (of_particle[i] == ObjectTable::NONE)
      error->one(FLERR,
                 "{}: particle {} of object {} (molecule ID) has come into its group since the setup of this run; let it come "
                 "between two runs, the second without 'pre no'",
                 name(), atom->tag[i], atom->molecule[i]);
  }
  find_runs();
}

void WholeObjects::find_runs()
{
  run.clear();
  std::vector<char> has_begun(known.size(), false);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (i > 0 && of_particle[i] == of_particle[i - 1]) continue;
    if (of_particle[i] != ObjectTable::NONE && std::exchange(has_begun[of_particle[i]], true)) return run.clear();
    run.push_back(i);
  }
}

std::vector<bigint> WholeObjects::present() const
{
  std::vector<bigint> count(known.size(), 0);
  for (int i = 0; i < atom->nlocal; ++i)
    if (of_particle[i] != ObjectTable::NONE) ++count[of_particle[i]];
  MPI_Allreduce(MPI_IN_PLACE, count.data(), known.size(), MPI_LMP_BIGINT, MPI_SUM, world);
  return count;
}

std::vector<WholeObjects::MassProperties> WholeObjects::weigh() const
{
  std::vector<MassProperties> found(known.size());
  const auto first = sums<4>([this](int i) {
    const Vec3 mx = mass_at(i) * vec3(atom->x[i]);
    return std::array<double, 4>{mass_at(i), mx.x, mx.y, mx.z};
  });
  for (std::size_t n = 0; n < found.size(); ++n) {
    if (first[n][0] == 0.0) continue;    // laid aside
    found[n].mass = first[n][0];
    found[n].centre = {first[n][1] / first[n][0], first[n][2] / first[n][0], first[n][3] / first[n][0]};
  }
  const auto second = sums<6>([&](int i) {
    const double m = mass_at(i);
    const Vec3 r = vec3(atom->x[i]) - found[of_particle[i]].centre;
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

std::vector<WholeObjects::BodyMotion> WholeObjects::motion(const std::vector<MassProperties> &about) const
{
  const auto all = sums<6>([&](int i) {
    const Vec3 p = mass_at(i) * vec3(atom->v[i]), l = cross(vec3(atom->x[i]) - about[of_particle[i]].centre, p);
    return std::array<double, 6>{p.x, p.y, p.z, l.x, l.y, l.z};
  });
  std::vector<BodyMotion> found;
  for (const auto &one : all) found.push_back({{one[0], one[1], one[2]}, {one[3], one[4], one[5]}});
  return found;
}

std::vector<double> WholeObjects::kinetic() const
{
  return sum_of([this](int i) { return 0.5 * mass_at(i) * dot(vec3(atom->v[i]), vec3(atom->v[i])); });
}

bigint WholeObjects::degrees_taken(int group_number) const
{
  std::vector<bigint> of_group(known.size(), 0);
  for (int i = 0; i < atom->nlocal; ++i)
    if (of_particle[i] != ObjectTable::NONE && (atom->mask[i] & group->bitmask[group_number])) ++of_group[of_particle[i]];
  MPI_Allreduce(MPI_IN_PLACE, of_group.data(), known.size(), MPI_LMP_BIGINT, MPI_SUM, world);
  bigint taken = 0;
  for (int n = 0; n < known.size(); ++n)
    if (of_group[n] == particles[n]) taken += 3 * particles[n] - 6;
  return taken;
}

double WholeObjects::bytes() const { return static_cast<double>(sizeof(int) * of_particle.capacity() + known.bytes()); }

}    // namespace mdanim
