// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/barrier. When LAMMPS rebuilds its lists: boxes of objects, those that meet, particles where they
// meet, pairs. Every step: each particle sums its pairs in the order of its partners' tags, so that the bits
// of a force depend on neither the order of particles nor the ranks that hold them.

#include "fix_mdanim_barrier.h"

#include "barrier.h"
#include "stopwatch.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

// --- the command ---

// fix ID group mdanim/barrier BOUNDARY BARRIER k rc [thin GROUP ratio] [damp gn] [power 2|3]
FixMdanimBarrier::FixMdanimBarrier(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  scalar_flag = 1;
  extscalar = 1;
  energy_global_flag = 1;
  vector_flag = 1;
  size_vector = 6;
  static int extensive[] = {1, 1, 1, 0, 1, 0};
  extvector = -1;
  extlist = extensive;
  global_freq = 1;
  comm_forward = 4;

  if (narg < 7) utils::missing_cmd_args(FLERR, "fix mdanim/barrier", error);
  boundary_bit = group_bit(3, arg[3]);
  barrier_bit = group_bit(4, arg[4]);
  stiffness = ParticleValue(lmp, "fix mdanim/barrier: k", 5, arg[5]);
  reach = ParticleValue(lmp, "fix mdanim/barrier: rc", 6, arg[6]);

  for (int iarg = 7; iarg < narg;) {
    const int words = strcmp(arg[iarg], "thin") == 0 ? 2 : 1;
    if (iarg + words >= narg)
      utils::missing_cmd_args(FLERR, fmt::format("fix mdanim/barrier {}", arg[iarg]), error);
    if (strcmp(arg[iarg], "thin") == 0) {
      thin_bit = group_bit(iarg + 1, arg[iarg + 1]);
      thin_ratio = utils::numeric(FLERR, arg[iarg + 2], false, lmp);
      if (!(thin_ratio > 0.0))
        error->all(FLERR, iarg + 2, "fix mdanim/barrier: thin ratio must be > 0, got {}", arg[iarg + 2]);
    } else if (strcmp(arg[iarg], "damp") == 0) {
      damping = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      if (!(damping >= 0.0))
        error->all(FLERR, iarg + 1, "fix mdanim/barrier: damp must be >= 0, got {}", arg[iarg + 1]);
    } else if (strcmp(arg[iarg], "power") == 0) {
      power = utils::inumeric(FLERR, arg[iarg + 1], false, lmp);
      if (power != 2 && power != 3)
        error->all(FLERR, iarg + 1, "fix mdanim/barrier: power must be 2 or 3, got {}", arg[iarg + 1]);
    } else {
      error->all(FLERR, iarg, "fix mdanim/barrier: unknown keyword {}; it knows thin, damp and power",
                 arg[iarg]);
    }
    iarg += 1 + words;
  }
}

int FixMdanimBarrier::group_bit(int iarg, const char *word)
{
  const int index = group->find(word);
  if (index < 0)
    error->all(FLERR, iarg, "fix mdanim/barrier: there is no group {}; make it before this fix", word);
  return group->bitmask[index];
}

int FixMdanimBarrier::setmask() { return POST_NEIGHBOR | POST_FORCE; }

void FixMdanimBarrier::init()
{
  const auto refuse = [this](const char *why) { error->all(FLERR, "fix {} mdanim/barrier: {}", id, why); };
  if (utils::strmatch(update->integrate_style, "^respa"))
    refuse("run_style respa is not supported; use run_style verlet");
  if (domain->dimension != 3) refuse("the box has 2 dimensions, 3 are needed; use 'dimension 3'");
  if (domain->triclinic) refuse("the box is triclinic; use an orthogonal one");
  if (domain->xperiodic || domain->yperiodic || domain->zperiodic)
    refuse("the box is periodic; put 'boundary s s s' (or f) before the box is made");
  if (!atom->molecule_flag)
    refuse("objects are told apart by molecule IDs; use 'atom_style bond' or 'fix ID all property/atom mol'");
  if (atom->map_style == Atom::MAP_NONE)
    refuse("needs an atom map; put 'atom_modify map array' before the box is made");
  if (neighbor->every != 1 || neighbor->delay != 0 || neighbor->build_once)
    refuse("a pair may come into reach between two rebuilds; use 'neigh_modify every 1 delay 0 check yes "
           "once no'");
  if (damping > 0.0 && comm->nprocs > 1 && !comm->ghost_velocity)
    refuse("damp needs the velocities of particles of other ranks; use 'comm_modify vel yes'");
  stiffness.init(lmp);
  reach.init(lmp);

  for (int i = 0; i < atom->nlocal; ++i)
    if (role(i) != NONE && atom->molecule[i] <= 0)
      error->one(
          FLERR,
          "fix {} mdanim/barrier: particle {} belongs to no object, its molecule ID is {}; give it one > 0 "
          "('set group … mol …')",
          id, atom->tag[i], atom->molecule[i]);
}

// --- candidates, when LAMMPS rebuilds ---

int FixMdanimBarrier::role(int i) const
{
  const int mask = atom->mask[i];
  if (mask & boundary_bit) return mask & thin_bit ? BOUNDARY | THIN : BOUNDARY;
  return mask & barrier_bit ? BARRIER : NONE;
}

void FixMdanimBarrier::setup_post_neighbor() { post_neighbor(); }

void FixMdanimBarrier::post_neighbor()
{
  const Lap lap(seconds);
  find_candidates();
  if (damping > 0.0) loss.look(atom->tag, atom->nlocal);
}

void FixMdanimBarrier::collect_own()
{
  own.resize(atom->nlocal + atom->nghost);
  const double *k = stiffness.values(lmp), *rc = reach.values(lmp);
  for (int i = 0; i < atom->nlocal; ++i)
    own[i] = {k ? k[i] : stiffness.number, rc ? rc[i] : reach.number,
              mass_of(atom->rmass, atom->mass, atom->type, i), atom->molecule[i]};
  comm->forward_comm(this);
}

int FixMdanimBarrier::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  int m = 0;
  for (int i = 0; i < n; ++i) {
    const Own &o = own[list[i]];
    buf[m++] = o.stiffness;
    buf[m++] = o.reach;
    buf[m++] = o.mass;
    buf[m++] = static_cast<double>(o.object);
  }
  return m;
}

void FixMdanimBarrier::unpack_forward_comm(int n, int start, double *buf)
{
  for (int i = start; i < start + n; ++i, buf += 4)
    own[i] = {buf[0], buf[1], buf[2], static_cast<tagint>(buf[3])};
}

// The longest reach of any pair, and eq. (3.14) for every object, index = molecule ID; the same on all ranks.
double FixMdanimBarrier::survey(std::vector<Box> &boxes)
{
  const double *rc = reach.values(lmp);
  const double *const *x = atom->x;
  const tagint *object = atom->molecule;
  const int nlocal = atom->nlocal;
  tagint largest_here = 0, largest = 0;
  for (int i = 0; i < nlocal; ++i) largest_here = std::max(largest_here, object[i]);
  MPI_Allreduce(&largest_here, &largest, 1, MPI_LMP_TAGINT, MPI_MAX, world);

  double reach_here = 0.0, longest = 0.0;
  std::vector<Box> here(largest + 1);
  for (int i = 0; i < nlocal; ++i) {
    if (role(i) == NONE) continue;
    here[object[i]].include(x[i]);
    reach_here = std::max(reach_here, rc ? rc[i] : reach.number);
  }
  MPI_Allreduce(&reach_here, &longest, 1, MPI_DOUBLE, MPI_MAX, world);
  boxes.resize(here.size());
  MPI_Allreduce(here.data(), boxes.data(), 6 * (largest + 1), MPI_DOUBLE, MPI_MIN, world);
  return thin_bit ? std::max(1.0, thin_ratio) * longest : longest;
}

// Until the next rebuild no particle moves by more than half the skin, so pairs within reach + skin are
// enough.
void FixMdanimBarrier::find_candidates()
{
  row.clear();
  first.assign(1, 0);
  candidate.clear();
  pairs = 0.0;

  std::vector<Box> boxes;
  const double range = survey(boxes) + neighbor->skin;
  const double ghosts = std::min({comm->cutghost[0], comm->cutghost[1], comm->cutghost[2]});
  if (comm->nprocs > 1 && ghosts < range)
    error->all(
        FLERR,
        "fix {} mdanim/barrier: particles of other ranks are seen up to {:.6g}, reach and skin need {:.6g}; "
        "use 'comm_modify cutoff {:.6g}'",
        id, ghosts, range, 1.001 * range);

  const auto meeting = meeting_pairs(boxes, range);
  meeting_objects = static_cast<bigint>(meeting.size());
  if (meeting.empty()) return;
  collect_own();

  // Only particles within range of a partner's box can be in a pair: for each object, the box around all such
  // places.
  std::vector<Box> zone(boxes.size());
  for (const auto &[a, b] : meeting) {
    zone[a].unite(intersection(boxes[a], boxes[b].grown(range)));
    zone[b].unite(intersection(boxes[b], boxes[a].grown(range)));
  }
  find_candidates_near(zone, range);
}

// What a first look needs of a particle: most pairs are turned down by it.
struct FixMdanimBarrier::Glance {
  Vec3 x;
  tagint object;
  int role, particle;
};

// Particles in a grid, in the order of its cells.
struct FixMdanimBarrier::Crowd {
  Crowd(const FixMdanimBarrier &fix, const std::vector<int> &particles, double cell)
      : grid([&](int n) { return fix.atom->x[particles[n]]; }, static_cast<int>(particles.size()), cell)
  {
    glance.reserve(particles.size());
    for (const int n : grid.order()) {
      const int i = particles[n];
      glance.push_back({vec3(fix.atom->x[i]), fix.own[i].object, fix.role(i), i});
    }
  }

  template <class Visit> void around(const Glance &me, Visit visit) const
  {
    const double x[3] = {me.x.x, me.x.y, me.x.z};
    grid.around(x, [&](int slot) { visit(glance[slot]); });
  }

  Grid grid;
  std::vector<Glance> glance;
};

void FixMdanimBarrier::find_candidates_near(const std::vector<Box> &zone, double range)
{
  const double *const *x = atom->x;
  const tagint *tag = atom->tag;
  const double skin = neighbor->skin;

  // Guards form the barrier; all others are boundary particles, which meet guards only. Most pairs are of two such others, so
  // the two kinds stand in grids of their own.
  std::vector<int> guards, others;
  for (int i = 0; i < atom->nlocal + atom->nghost; ++i)
    if (role(i) != NONE && zone[own[i].object].contains(x[i])) (role(i) == BOUNDARY ? others : guards).push_back(i);
  const Crowd guard(*this, guards, range), other(*this, others, range);

  for (const Crowd *crowd : {&guard, &other})
    for (const Glance &me : crowd->glance) {
      const int i = me.particle;
      if (i >= atom->nlocal || !(atom->mask[i] & groupbit)) continue;
      const size_t begin = candidate.size();
      const auto consider = [&](const Glance &partner) {
        if (partner.object == me.object) return;
        const Vec3 d = me.x - partner.x;
        const double r2 = dot(d, d);
        if (r2 >= range * range) return;
        const int j = partner.particle;
        const double pair_reach =
            reach_factor(me.role, partner.role, thin_ratio) * std::max(own[i].reach, own[j].reach);
        if (pair_reach == 0.0 || r2 >= (pair_reach + skin) * (pair_reach + skin)) return;
        const double k =
            stiffness.constant() ? stiffness.number : pair_stiffness(own[i].stiffness, own[j].stiffness);
        candidate.push_back({j, tag[i] < tag[j], (atom->mask[j] & groupbit) != 0, k, pair_reach});
      };
      guard.around(me, consider);
      if (crowd == &guard) other.around(me, consider);
      if (candidate.size() == begin) continue;
      std::sort(candidate.begin() + begin, candidate.end(),
                [tag](const Candidate &a, const Candidate &b) { return tag[a.partner] < tag[b.partner]; });
      row.push_back(i);
      first.push_back(static_cast<int>(candidate.size()));
    }
  for (const Candidate &c : candidate) pairs += c.in_group ? 0.5 : 1.0;
}

// --- forces ---

void FixMdanimBarrier::setup(int vflag)
{
  deepest = 1.0;
  post_force(vflag);
}

void FixMdanimBarrier::post_force(int)
{
  energy = touching = 0.0;
  if (candidate.empty() && loss.idle()) {
    loss.rest();
    return;
  }

  const Lap lap(seconds);
  const double *const *x = atom->x, *const *v = atom->v;
  double *const *f = atom->f;
  std::vector<Vec3> *slowed = damping > 0.0 ? &loss.forces(atom->nlocal) : nullptr;
  for (size_t n = 0; n < row.size(); ++n) {
    const int i = row[n];
    Vec3 total;
    for (int c = first[n]; c < first[n + 1]; ++c) {
      const Candidate &pair = candidate[c];
      const int j = pair.partner;
      const Vec3 d = vec3(x[i]) - vec3(x[j]);
      const double r2 = dot(d, d);
      if (r2 >= pair.reach * pair.reach) continue;
      const double r = std::sqrt(r2), q = 1.0 - r / pair.reach, share = pair.in_group ? 0.5 : 1.0;
      const Vec3 normal = direction(d, r, pair.lower);
      double push = barrier_force(power, pair.stiffness, pair.reach, q);
      energy += share * barrier_energy(power, pair.stiffness, pair.reach, q);
      if (damping > 0.0) {
        const double approach = dot(vec3(v[i]) - vec3(v[j]), normal);
        const double rate = damping * reduced_mass(own[i].mass, own[j].mass) / force->ftm2v;
        push -= rate * q * approach;
        (*slowed)[i] -= (rate * q * approach) * normal;
      }
      total += push * normal;
      touching += share;
      deepest = std::min(deepest, r / pair.reach);
    }
    add_to(f[i], total);
  }
  if (slowed) loss.step(v, update->dt, update->setupflag);
}

// Together with run_style verlet/mdanim, which has no ghosts.
void FixMdanimBarrier::concerned(std::vector<int> &particles) const
{
  particles.insert(particles.end(), row.begin(), row.end());
  for (const Candidate &c : candidate) particles.push_back(c.partner);
}

// --- output ---

double FixMdanimBarrier::sum(double here)
{
  double all = 0.0;
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

double FixMdanimBarrier::compute_scalar() { return sum(energy); }

// 1: pairs of objects whose boxes meet; 2: pairs of particles tried; 3: pairs in touch; 4: smallest r/reach
// in this run; 5: energy lost to damp; 6: wall seconds of the slowest rank
double FixMdanimBarrier::compute_vector(int n)
{
  double all = 0.0;
  switch (n) {
  case 0: return static_cast<double>(meeting_objects);
  case 1: return sum(pairs);
  case 2: return sum(touching);
  case 3: MPI_Allreduce(&deepest, &all, 1, MPI_DOUBLE, MPI_MIN, world); return all;
  case 4: return sum(loss.total());
  default: MPI_Allreduce(&seconds, &all, 1, MPI_DOUBLE, MPI_MAX, world); return all;
  }
}

double FixMdanimBarrier::memory_usage()
{
  return own.capacity() * sizeof(Own) + candidate.capacity() * sizeof(Candidate) +
      (row.capacity() + first.capacity()) * sizeof(int);
}
