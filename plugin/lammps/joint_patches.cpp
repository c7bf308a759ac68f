// SPDX-License-Identifier: GPL-2.0-only
// Each object's own particles are looked at for each of its joints.

#include "lammps/joint_patches.h"

#include "lammps/object_table.h"
#include "lammps/particle_value.h"
#include "lammps/rank_gather.h"

#include "atom.h"
#include "fmt/format.h"
#include "force.h"
#include "lammps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mpi.h>
#include <stdexcept>
#include <tuple>
#include <utility>

using namespace LAMMPS_NS;

namespace mdanim {

namespace {

constexpr double ROUNDING = 1.0 + 1e-9;    // of distances that should be equal

struct Found {
  int end;    // 2 n and 2 n + 1 of the joint n
  int pushed;
  tagint tag;
  double mass;
  Vec3 x;
  bool operator<(const Found &other) const { return std::tie(end, tag) < std::tie(other.end, other.tag); }
};

// Objects with joints, and their particles on this rank.
class ObjectsOfJoints {
 public:
  ObjectsOfJoints(const Atom &atom, MPI_Comm world, const std::vector<JointWords> &words)
  {
    for (const JointWords &joint : words)
      for (const JointWords::End *end : {&joint.a, &joint.b})
        if (end->object != WORLD) ids.push_back(end->object);
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    particles.resize(ids.size());
    lowest.assign(ids.size(), MAXTAGINT);
    for (int i = 0; i < atom.nlocal; ++i) {
      const auto found = std::lower_bound(ids.begin(), ids.end(), atom.molecule[i]);
      if (found == ids.end() || *found != atom.molecule[i]) continue;
      particles[found - ids.begin()].push_back(i);
      lowest[found - ids.begin()] = std::min(lowest[found - ids.begin()], atom.tag[i]);
    }
    MPI_Allreduce(MPI_IN_PLACE, lowest.data(), static_cast<int>(lowest.size()), MPI_LMP_TAGINT, MPI_MIN, world);
  }
  std::size_t number_of(int id) const { return std::lower_bound(ids.begin(), ids.end(), id) - ids.begin(); }

  std::vector<tagint> ids;
  std::vector<std::vector<int>> particles;
  std::vector<tagint> lowest;
};

const JointWords::End &end_of(const std::vector<JointWords> &words, std::size_t end)
{ return end % 2 == 0 ? words[end / 2].a : words[end / 2].b; }

}    // namespace

std::string name_of_joint(std::size_t n, const JointWords &words) { return fmt::format("joint {} ({})", n + 1, words.name()); }

FoundJoints find_joints(LAMMPS *lmp, int groupbit, const std::vector<JointWords> &words)
{
  const Atom &atom = *lmp->atom;
  FoundJoints found;
  const ObjectsOfJoints objects(atom, lmp->world, words);
  for (std::size_t n = 0; n < objects.ids.size(); ++n) {
    if (objects.lowest[n] == MAXTAGINT) {
      found.problem = fmt::format("there is no object {} (molecule ID)", objects.ids[n]);
      return found;
    }
    found.lowest_tags[static_cast<int>(objects.ids[n])] = objects.lowest[n];
  }

  std::vector<double> nearest(2 * words.size(), HUGE_VAL);
  std::vector<Found> here;
  for (std::size_t end = 0; end < nearest.size(); ++end) {
    const JointWords::End &wanted = end_of(words, end);
    if (wanted.object == WORLD) continue;
    for (const int i : objects.particles[objects.number_of(wanted.object)]) {
      const Vec3 x = vec3(atom.x[i]);
      const double far = length(x - wanted.at);
      nearest[end] = std::min(nearest[end], far);
      if (far <= wanted.radius * ROUNDING)
        here.push_back({static_cast<int>(end), (atom.mask[i] & groupbit) != 0, atom.tag[i],
                        mass_of(atom.rmass, atom.mass, atom.type, i), x});
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, nearest.data(), static_cast<int>(nearest.size()), MPI_DOUBLE, MPI_MIN, lmp->world);
  std::vector<Found> all = gather(lmp->world, here);
  std::sort(all.begin(), all.end());

  const auto make_end = [&](std::size_t end, auto &from) {
    JointEnd made;
    std::vector<Patch::Member> members;
    found.pushes.push_back(0);
    for (; from != all.end() && from->end == static_cast<int>(end); ++from) {
      members.push_back({from->mass, from->x});
      made.tags.push_back(from->tag);
      if (from->pushed) found.pushes.back() = made.moves = true;
    }
    const JointWords::End &wanted = end_of(words, end);
    if (wanted.object != WORLD && members.empty())
      throw std::runtime_error(fmt::format("object {} has no particle within {} of its place, the nearest is {:.6g} away; "
                                           "move the place, or give a larger 'patch'",
                                           wanted.object, wanted.radius, nearest[end]));
    if (wanted.object != WORLD) made.patch = Patch::of(std::move(members));
    made.d = wanted.at - made.patch.centre();
    return made;
  };
  auto from = all.begin();
  for (std::size_t n = 0; n < words.size(); ++n) try {
      JointEnd a = make_end(2 * n, from), b = make_end(2 * n + 1, from);
      if (!found.pushes[2 * n] && !found.pushes[2 * n + 1])
        throw std::runtime_error("none of the particles that it holds on to is in the group of the fix");
      found.joints.emplace_back(words[n], std::move(a), std::move(b), length(words[n].a.at - words[n].b.at), lmp->force->ftm2v);
    } catch (const std::exception &problem) {
      found.problem = name_of_joint(n, words[n]) + ": " + problem.what();
      found.joints.clear();
      return found;
    }
  return found;
}

}    // namespace mdanim
