// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/wall: asks the region for the nearest point of its surface; the law is in wall/law.h.

#include "lammps/fix_mdanim_wall.h"
#include "lammps/keywords.h"

#include "numbers/stopwatch.h"
#include "wall/law.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "neighbor.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static constexpr double MOST = 65536.0;        // look-ahead in halves of the skin
static constexpr double ANY_DEPTH = 1.0e20;    // as large as LAMMPS's INF

// fix ID group mdanim/wall REGION k
FixMdanimWall::FixMdanimWall(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg)
{
  dynamic_group_allow = 1;
  look_up({}, {&stiffness});
  tell({{"force_x", true, [this] { return sum(on_wall.x); }},
        {"force_y", true, [this] { return sum(on_wall.y); }},
        {"force_z", true, [this] { return sum(on_wall.z); }},
        {"behind", true, [this] { return sum(particles_behind); }},
        {"deepest", false, [this] { return largest(deepest); }},
        clock()});

  need_words(lmp, "fix mdanim/wall", "fix ID group mdanim/wall", "REGION k", narg - 3);
  if (narg > 5) error->all(FLERR, 5, "fix mdanim/wall: region and k are all it takes, got also {}", arg[5]);
  region_id = arg[3];
  if (!domain->get_region_by_id(region_id))
    error->all(FLERR, 3, "fix mdanim/wall: there is no region {}; make it before this fix", arg[3]);
  take_region(3);
  stiffness = ParticleValue(lmp, "fix mdanim/wall: k", 4, arg[4]);
}

// The region may have been deleted and made anew since; `iarg` is its word in the command.
void FixMdanimWall::take_region(int iarg)
{
  region = domain->get_region_by_id(region_id);
  if (!region) error->all(FLERR, "{}: region {} has been deleted", name(), region_id);
  if (region->openflag)
    error->all(FLERR, iarg,
               "fix mdanim/wall: region {} has open faces, it has no inside; use INF for a face that shall not "
               "be there",
               region_id);
  if (strcmp(region->style, "union") == 0 || strcmp(region->style, "intersect") == 0)
    error->all(FLERR, iarg, "fix mdanim/wall: region style {} cannot tell its nearest surface; use one fix per part",
               region->style);
  convex = false;
  for (const char *known : {"block", "cone", "cylinder", "ellipsoid", "plane", "prism", "sphere"})
    convex = convex || strcmp(region->style, known) == 0;
}

int FixMdanimWall::setmask() { return POST_NEIGHBOR | POST_FORCE; }

void FixMdanimWall::init()
{
  FixBase::init();
  take_region(Error::NOPOINTER);
  watching = !region->dynamic_check() && lists_are_prompt();
}

// Whether x lies outside the region's own side, and if so the vector to it from the nearest point of the surface. A region gives
// surface points only for particles on its own side, so for this question it is turned inside out.
bool FixMdanimWall::behind(const Vec3 &x, Vec3 &d)
{
  if (region->match(x.x, x.y, x.z)) return false;
  region->interior = !region->interior;
  const int contacts = region->surface(x.x, x.y, x.z, ANY_DEPTH);
  region->interior = !region->interior;
  if (contacts == 0) return false;    // on the surface itself, or on an axis or centre, where no point is nearest
  const Region::Contact *nearest = region->contact;
  for (int n = 1; n < contacts; ++n)
    if (region->contact[n].r < nearest->r) nearest = &region->contact[n];
  d = {nearest->delx, nearest->dely, nearest->delz};
  return true;
}

Box FixMdanimWall::box_of_all() const
{
  Box box;
  for (int i = 0; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit) box.include(atom->x[i]);
  return box;
}

// A box is in a convex region when its corners are. During most of a scene no particle is near a wall, and this is far less work
// than to test each particle.
bool FixMdanimWall::is_inside(const Box &box)
{
  for (int corner = 0; corner < 8; ++corner)
    if (!region->match(corner & 1 ? box.high(0) : box.low(0), corner & 2 ? box.high(1) : box.low(1),
                       corner & 4 ? box.high(2) : box.low(2)))
      return false;
  return true;
}

void FixMdanimWall::setup_post_neighbor() { post_neighbor(); }

void FixMdanimWall::post_neighbor()
{
  if (!watching) return;
  const Lap lap(seconds);
  watched.clear();
  clear = 0.0;
  region->prematch();
  const double far = 0.5 * neighbor->skin;
  if (convex && region->interior) {
    const Box box = box_of_all();
    for (double times = 1.0; times <= MOST && (box.empty() || is_inside(box.grown(1.001 * times * far))); times *= 2.0)
      clear = times * far;
    if (clear > 0.0) return;
  }
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *x = atom->x[i];
    if (!region->match(x[0], x[1], x[2]) || region->surface(x[0], x[1], x[2], far) > 0) watched.push_back(i);
  }
}

void FixMdanimWall::setup(int vflag)
{
  deepest = 0.0;
  post_force(vflag);
}

void FixMdanimWall::post_force(int)
{
  begin_sums();
  if (watching && watched.empty()) return;

  const Lap lap(seconds);
  region->prematch();
  const double *k = stiffness.values(lmp);
  const auto push = [&](int i) { add_to(atom->f[i], push_back(vec3(atom->x[i]), k ? k[i] : stiffness.number)); };
  if (watching) {
    for (const int i : watched) push(i);
  } else {
    for (int i = 0; i < atom->nlocal; ++i)
      if (atom->mask[i] & groupbit) push(i);
  }
}

// Adds forces on particles that are watched.
void FixMdanimWall::add_forces(const Positions &place, const ForceSums &force)
{
  begin_sums();
  if (watched.empty()) return;

  const Lap lap(seconds);
  region->prematch();
  const double *k = stiffness.values(lmp);
  for (size_t n = 0; n < watched.size(); ++n) force.add(n, push_back(place[n], k ? k[watched[n]] : stiffness.number));
}

void FixMdanimWall::begin_sums()
{
  energy = particles_behind = 0.0;
  on_wall = Vec3();
}

void FixMdanimWall::append_required_atoms(std::vector<int> &particles) const
{ particles.insert(particles.end(), watched.begin(), watched.end()); }

// The force on a particle.
Vec3 FixMdanimWall::push_back(const Vec3 &x, double k)
{
  Vec3 d;
  if (!behind(x, d)) return {};
  const Vec3 force = wall_force(k, d);
  on_wall -= force;
  energy += wall_energy(k, d);
  particles_behind += 1.0;
  deepest = std::max(deepest, std::sqrt(dot(d, d)));
  return force;
}

double FixMdanimWall::compute_scalar() { return sum(energy); }

double FixMdanimWall::memory_usage() { return watched.capacity() * sizeof(int); }
