// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/barrier. When LAMMPS rebuilds its lists: boxes of objects, those that meet, particles where they
// meet, pairs. Every step: pairs are gone through in an order in which each particle sums up its own in the order of its
// partners' tags, so that the bits of a force depend on neither the order of particles nor the ranks that hold them.

#include "styles/fix_mdanim_barrier.h"

#include "engine/kernels.h"
#include "engine/stopwatch.h"
#include "laws/barrier.h"

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
#include <numeric>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static constexpr double MOST = 64.0;    // skins that are looked ahead where objects are apart

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
  filter = &best_kernels(false).pair_filter;

  if (narg < 7) utils::missing_cmd_args(FLERR, "fix mdanim/barrier", error);
  boundary_bit = group_bit(3, arg[3]);
  barrier_bit = group_bit(4, arg[4]);
  stiffness = ParticleValue(lmp, "fix mdanim/barrier: k", 5, arg[5]);
  reach = ParticleValue(lmp, "fix mdanim/barrier: rc", 6, arg[6]);

  for (int iarg = 7; iarg < narg;) {
    const int words = strcmp(arg[iarg], "thin") == 0 ? 2 : 1;
    if (iarg + words >= narg) utils::missing_cmd_args(FLERR, fmt::format("fix mdanim/barrier {}", arg[iarg]), error);
    if (strcmp(arg[iarg], "thin") == 0) {
      thin_bit = group_bit(iarg + 1, arg[iarg + 1]);
      thin_ratio = utils::numeric(FLERR, arg[iarg + 2], false, lmp);
      if (!(thin_ratio > 0.0)) error->all(FLERR, iarg + 2, "fix mdanim/barrier: thin ratio must be > 0, got {}", arg[iarg + 2]);
    } else if (strcmp(arg[iarg], "damp") == 0) {
      damping = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      if (!(damping >= 0.0)) error->all(FLERR, iarg + 1, "fix mdanim/barrier: damp must be >= 0, got {}", arg[iarg + 1]);
    } else if (strcmp(arg[iarg], "power") == 0) {
      power = utils::inumeric(FLERR, arg[iarg + 1], false, lmp);
      if (power != 2 && power != 3)
        error->all(FLERR, iarg + 1, "fix mdanim/barrier: power must be 2 or 3, got {}", arg[iarg + 1]);
    } else {
      error->all(FLERR, iarg, "fix mdanim/barrier: unknown keyword {}; it knows thin, damp and power", arg[iarg]);
    }
    iarg += 1 + words;
  }
}

int FixMdanimBarrier::group_bit(int iarg, const char *word)
{
  const int index = group->find(word);
  if (index < 0) error->all(FLERR, iarg, "fix mdanim/barrier: there is no group {}; make it before this fix", word);
  return group->bitmask[index];
}

int FixMdanimBarrier::setmask() { return POST_NEIGHBOR | POST_FORCE; }

void FixMdanimBarrier::init()
{
  const auto refuse = [this](const char *why) { error->all(FLERR, "fix {} mdanim/barrier: {}", id, why); };
  if (utils::strmatch(update->integrate_style, "^respa")) refuse("run_style respa is not supported; use run_style verlet");
  if (domain->dimension != 3) refuse("the box has 2 dimensions, 3 are needed; use 'dimension 3'");
  if (domain->triclinic) refuse("the box is triclinic; use an orthogonal one");
  if (domain->xperiodic || domain->yperiodic || domain->zperiodic)
    refuse("the box is periodic; put 'boundary s s s' (or f) before the box is made");
  if (!atom->molecule_flag)
    refuse("objects are told apart by molecule IDs; use 'atom_style bond' or 'fix ID all property/atom mol'");
  if (atom->map_style == Atom::MAP_NONE) refuse("needs an atom map; put 'atom_modify map array' before the box is made");
  if (neighbor->every != 1 || neighbor->delay != 0 || neighbor->build_once)
    refuse("a pair may come into reach between two rebuilds; use 'neigh_modify every 1 delay 0 check yes "
           "once no'");
  if (damping > 0.0 && comm->nprocs > 1 && !comm->ghost_velocity)
    refuse("damp needs the velocities of particles of other ranks; use 'comm_modify vel yes'");
  stiffness.init(lmp);
  reach.init(lmp);

  for (int i = 0; i < atom->nlocal; ++i)
    if (role(i) != NONE && atom->molecule[i] <= 0)
      error->one(FLERR,
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
    own[i] = {k ? k[i] : stiffness.number, rc ? rc[i] : reach.number, mass_of(atom->rmass, atom->mass, atom->type, i), object[i]};
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
  for (int i = start; i < start + n; ++i, buf += 4) own[i] = {buf[0], buf[1], buf[2], static_cast<int>(buf[3])};
}

// Molecule IDs of the objects that have particles of the two groups, ascending; the same on all ranks.
std::vector<tagint> FixMdanimBarrier::find_objects() const
{
  const auto make_unique = [](std::vector<tagint> &ids) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  };
  std::vector<tagint> here;
  for (int i = 0; i < atom->nlocal; ++i)
    if (role(i) != NONE && (here.empty() || here.back() != atom->molecule[i])) here.push_back(atom->molecule[i]);
  make_unique(here);
  if (comm->nprocs == 1) return here;

  const int size = static_cast<int>(here.size());
  std::vector<int> sizes(comm->nprocs), begin(comm->nprocs + 1, 0);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, world);
  std::partial_sum(sizes.begin(), sizes.end(), begin.begin() + 1);
  std::vector<tagint> all(begin.back());
  MPI_Allgatherv(here.data(), size, MPI_LMP_TAGINT, all.data(), sizes.data(), begin.data(), MPI_LMP_TAGINT, world);
  make_unique(all);
  return all;
}

// The longest reach of any pair, and eq. (3.14) for every object in ascending order of molecule IDs; the same on all ranks.
double FixMdanimBarrier::survey(std::vector<Box> &boxes)
{
  const std::vector<tagint> ids = find_objects();
  const double *rc = reach.values(lmp);
  const int nlocal = atom->nlocal;
  double reach_here = 0.0, longest = 0.0;
  std::vector<Box> here(ids.size());
  object.assign(nlocal, NO_OBJECT);
  int number = 0;
  for (int i = 0; i < nlocal; ++i) {
    if (role(i) == NONE) continue;
    const tagint id = atom->molecule[i];
    if (ids[number] != id) number = static_cast<int>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
    object[i] = number;
    here[number].include(atom->x[i]);
    reach_here = std::max(reach_here, rc ? rc[i] : reach.number);
  }
  MPI_Allreduce(&reach_here, &longest, 1, MPI_DOUBLE, MPI_MAX, world);
  boxes.resize(here.size());
  MPI_Allreduce(here.data(), boxes.data(), 6 * static_cast<int>(here.size()), MPI_DOUBLE, MPI_MIN, world);
  return thin_bit ? std::max(1.0, thin_ratio) * longest : longest;
}

// Whether this rank adds forces to a particle.
bool FixMdanimBarrier::moves(int i) const { return i < atom->nlocal && atom->mask[i] & groupbit; }

// The way from particles where boxes meet to the list of pairs.
struct FixMdanimBarrier::Search {
  // Particles of one object, copied one after the other.
  struct Side {
    Positions place;
    std::vector<int> rank;    // in `near`

    int size() const { return static_cast<int>(rank.size()); }
    void clear(int room)
    {
      place.make_room(room);
      rank.clear();
    }
    void add(const double *at, int n)
    {
      place.put(rank.size(), at);
      rank.push_back(n);
    }
  };
  // A particle where boxes meet.
  struct Near {
    int particle, role;
    bool moves;
    double reach;
  };
  struct Found {
    int low, high;    // in `near`
  };

  const FixMdanimBarrier &fix;
  const double range, skin;
  std::vector<Near> near;               // ascending by tag
  std::vector<int> begin, of_object;    // those of object n, by their places in `near`:
                                        // of_object[begin[n]] to [begin[n + 1] - 1]
  std::vector<Found> found;

  Search(const FixMdanimBarrier &fix, double range) : fix(fix), range(range), skin(fix.neighbor->skin) {}

  // Only particles within range of a partner's box can be in a pair: `zone` is for each object the box around all such places.
  void collect(const std::vector<Box> &zone)
  {
    const double *const *x = fix.atom->x;
    const tagint *tag = fix.atom->tag;
    for (int i = 0; i < fix.atom->nlocal + fix.atom->nghost; ++i) {
      const Own &own = fix.own[i];
      if (own.object != NO_OBJECT && zone[own.object].contains(x[i])) near.push_back({i, fix.role(i), fix.moves(i), own.reach});
    }
    const auto by_tag = [tag](const Near &a, const Near &b) { return tag[a.particle] < tag[b.particle]; };
    if (!std::is_sorted(near.begin(), near.end(), by_tag)) std::sort(near.begin(), near.end(), by_tag);

    begin.assign(zone.size() + 1, 0);
    for (const Near &n : near) ++begin[fix.own[n.particle].object + 1];
    for (size_t n = 1; n < begin.size(); ++n) begin[n] += begin[n - 1];
    of_object.resize(near.size());
    std::vector<int> at(begin.begin(), begin.end() - 1);
    for (size_t n = 0; n < near.size(); ++n) of_object[at[fix.own[near[n].particle].object]++] = static_cast<int>(n);
  }

  // Boundary particles of `seeking` against guards of `guarding`, the particles that form the barrier; each within range of the
  // other object's box. Thin ones are both: a pair of them is found from one side, that with `thin_too`.
  void search(int seeking, const Box &seeking_box, int guarding, const Box &guarding_box, bool thin_too)
  {
    const double *const *x = fix.atom->x;
    const auto pick = [&](Side &side, int object, int wanted, const Box &inside) {
      side.clear(begin[object + 1] - begin[object]);
      for (int k = begin[object]; k < begin[object + 1]; ++k) {
        const int n = of_object[k];
        const double *const place = x[near[n].particle];
        if (near[n].role & wanted && inside.contains(place)) side.add(place, n);
      }
    };
    pick(guards, guarding, BARRIER | THIN, seeking_box.grown(range));
    if (guards.size() == 0) return;
    pick(seekers, seeking, BOUNDARY, guarding_box.grown(range));
    if (seekers.size() == 0) return;

    close.resize(guards.size() + STRIP);
    if (static_cast<size_t>(guards.size()) * seekers.size() <= FEW) {
      for (int s = 0; s < seekers.size(); ++s) look(s, guards, 0, guards.size(), thin_too);
      return;
    }
    const auto place = [&](const Side &side, int k) { return x[near[side.rank[k]].particle]; };
    const Grid grid([&](int k) { return place(guards, k); }, guards.size(), range);
    sorted.clear(guards.size());
    for (const int k : grid.order()) sorted.add(place(guards, k), guards.rank[k]);
    for (int s = 0; s < seekers.size(); ++s)
      grid.ranges(place(seekers, s), [&](int from, int to) { look(s, sorted, from, to, thin_too); });
  }

  // Counts instead of comparisons: twice as many particles take twice as long.
  template <class Key> void sort_found(Key key)
  {
    std::vector<int> at(near.size() + 1, 0);
    for (const Found &f : found) ++at[key(f) + 1];
    for (size_t n = 1; n < at.size(); ++n) at[n] += at[n - 1];
    std::vector<Found> order(found.size());
    for (const Found &f : found) order[at[key(f)]++] = f;
    found.swap(order);
  }

  Law law_of(const Found &pair) const
  {
    const Near &one = near[pair.low], &other = near[pair.high];
    const Own &a = fix.own[one.particle], &b = fix.own[other.particle];
    const double k = fix.stiffness.constant() ? fix.stiffness.number : pair_stiffness(a.stiffness, b.stiffness);
    const bool both = fix.atom->mask[one.particle] & fix.atom->mask[other.particle] & fix.groupbit;
    return {k, reach_of(one, other), (one.moves + other.moves) * (both ? 0.5 : 1.0)};
  }

 private:
  static constexpr size_t FEW = 4000;    // pairs that are tried one by one: a grid would take longer

  Side seekers, guards, sorted;
  std::vector<int> close;

  double reach_of(const Near &one, const Near &other) const
  { return reach_factor(one.role, other.role, fix.thin_ratio) * std::max(one.reach, other.reach); }

  // One seeker and guards in a row.
  void look(int s, const Side &side, int from, int to, bool thin_too)
  {
    const Vec3 at = seekers.place[s];
    const double of_seeker[] = {at.x, at.y, at.z};
    const int many = fix.filter->within(side.place.all().data(), from, to, of_seeker, range * range, close.data());
    for (int m = 0; m < many; ++m) {
      const Vec3 d = at - side.place[close[m]];
      consider(seekers.rank[s], side.rank[close[m]], dot(d, d), thin_too);
    }
  }

  void consider(int a, int b, double r2, bool thin_too)
  {
    const Near &one = near[a], &other = near[b];
    if (!thin_too && one.role & other.role & THIN) return;
    if (!one.moves && !other.moves) return;
    const double reach = reach_of(one, other);
    if (reach > 0.0 && r2 < (reach + skin) * (reach + skin)) found.push_back({std::min(a, b), std::max(a, b)});
  }
};

// Until the next rebuild no two particles come nearer to each other by more than the skin, so pairs within reach + skin are
// enough.
void FixMdanimBarrier::find_candidates()
{
  strip.clear();
  reach2.clear();
  law.clear();
  particle.clear();
  unmoved.clear();
  pairs = 0.0;

  std::vector<Box> boxes;
  const double range = survey(boxes) + neighbor->skin;
  const double ghosts = std::min({comm->cutghost[0], comm->cutghost[1], comm->cutghost[2]});
  if (comm->nprocs > 1 && ghosts < range)
    error->all(FLERR,
               "fix {} mdanim/barrier: particles of other ranks are seen up to {:.6g}, reach and skin need {:.6g}; "
               "use 'comm_modify cutoff {:.6g}'",
               id, ghosts, range, 1.001 * range);

  const auto meeting = meeting_pairs(boxes, range);
  meeting_objects = static_cast<bigint>(meeting.size());
  clear = 0.0;
  if (meeting.empty()) {
    for (double skins = 1.0; skins <= MOST; skins *= 2.0) {
      const double more = skins * neighbor->skin;
      if (!meeting_pairs(boxes, range + more).empty()) break;
      clear = 0.5 * (neighbor->skin + more);
    }
    return;
  }
  collect_own();

  std::vector<Box> zone(boxes.size());
  for (const auto &[a, b] : meeting) {
    zone[a].unite(intersection(boxes[a], boxes[b].grown(range)));
    zone[b].unite(intersection(boxes[b], boxes[a].grown(range)));
  }
  Search search(*this, range);
  search.collect(zone);
  for (const auto &[a, b] : meeting) {
    search.search(a, boxes[a], b, boxes[b], true);
    search.search(b, boxes[b], a, boxes[a], false);
  }
  search.sort_found([](const Search::Found &f) { return f.high; });
  search.sort_found([](const Search::Found &f) { return f.low; });

  // Partners of a particle are mostly of the other kind, and more of them are side by side in a list of that kind alone.
  constexpr int NONE_YET = -1;
  std::vector<int> number(search.near.size());    // in `particle`
  for (const Search::Found &found : search.found) number[found.low] = number[found.high] = NONE_YET;
  for (const int kind : {static_cast<int>(BOUNDARY), 0})
    for (size_t n = 0; n < number.size(); ++n)
      if (number[n] == NONE_YET && (search.near[n].role & BOUNDARY) == kind) {
        number[n] = static_cast<int>(particle.size());
        particle.push_back(search.near[n].particle);
      }
  for (const Search::Found &found : search.found) {
    const Law known = search.law_of(found);
    add_candidate(number[found.low], number[found.high], known);
    pairs += known.share;
  }
  for (size_t n = 0; n < particle.size(); ++n)
    if (!moves(particle[n])) unmoved.push_back(static_cast<int>(n));
  slot.resize(particle.size());
  for (size_t n = 0; n < slot.size(); ++n) slot[n] = 3 * static_cast<long>(n);
}

// They come in ascending order, of low and then of high tags, and pairs are to be numbered in that order.
void FixMdanimBarrier::add_candidate(int low, int high, const Law &known)
{
  if (strip.empty() || strip.back().one != low || high <= last_high || strip.back().first + STRIP <= high) {
    constexpr double none[STRIP] = {};
    strip.push_back({low, high});
    reach2.push(none, STRIP);
    law.resize(law.size() + STRIP, {0.0, 0.0, 0.0});
  }
  const size_t pair = STRIP * (strip.size() - 1) + high - strip.back().first;
  reach2.data()[pair] = known.reach * known.reach;
  law[pair] = known;
  last_high = high;
}

// --- forces ---

void FixMdanimBarrier::setup(int vflag)
{
  deepest = 1.0;
  post_force(vflag);
}

void FixMdanimBarrier::post_force(int)
{
  {
    const Lap lap(seconds);
    here.make_room(particle.size());
    for (size_t n = 0; n < particle.size(); ++n) here.put(n, atom->x[particle[n]]);
  }
  on.assign(3 * particle.size(), 0.0);
  push<true>(here, ForceSums(on.data(), slot.data(), 1));
  const Lap lap(seconds);
  for (size_t n = 0; n < particle.size(); ++n) add_to(atom->f[particle[n]], vec3(&on[slot[n]]));
}

// Puts the pairs in touch into touching_pair; returns how many.
int FixMdanimBarrier::find_touching(const Positions &place)
{
  lanes.resize(strip.size() + 1);
  touching_pair.resize(law.size() + STRIP);
  const auto all = place.all();
  return filter->in_reach({all.data(), strip.data(), static_cast<int>(strip.size()), reach2.data(), lanes.data()},
                          touching_pair.data());
}

// Between outputs, where nobody reads the energy.
void FixMdanimBarrier::add_forces(const Positions &place, const ForceSums &total) { push<false>(place, total); }

// On the particles that have candidates; nothing on those that are not moved. TELLS: of energy and pairs in touch, too.
template <bool TELLS> void FixMdanimBarrier::push(const Positions &place, const ForceSums &total)
{
  if (TELLS) energy = touching = 0.0;
  if (strip.empty() && loss.idle()) {
    loss.rest();
    return;
  }

  const Lap lap(seconds);
  const double *const *v = atom->v;
  std::vector<Vec3> *slowed = damping > 0.0 ? &loss.forces(atom->nlocal) : nullptr;

  const int many = find_touching(place);
  for (int m = 0; m < many; ++m) {
    const auto &[k, reach, share] = law[touching_pair[m]];
    const auto [low, first] = strip[touching_pair[m] / STRIP];
    const int high = first + touching_pair[m] % STRIP;
    const Vec3 d = place[low] - place[high];
    const double r = std::sqrt(dot(d, d)), q = 1.0 - r / reach;
    const Vec3 normal = direction(d, r, true);
    double size = barrier_force(power, k, reach, q);
    if (TELLS) {
      energy += share * barrier_energy(power, k, reach, q);
      touching += share;
    }
    if (damping > 0.0) {
      const int i = particle[low], j = particle[high];
      const double approach = dot(vec3(v[i]) - vec3(v[j]), normal);
      const double rate = damping * reduced_mass(own[i].mass, own[j].mass) / force->ftm2v;
      size -= rate * q * approach;
      const Vec3 slowing = (rate * q * approach) * normal;
      if (moves(i)) (*slowed)[i] -= slowing;
      if (moves(j)) (*slowed)[j] += slowing;
    }
    const Vec3 on_low = size * normal;
    total.add(low, on_low);
    total.add(high, -1.0 * on_low);
    deepest = std::min(deepest, r / reach);
  }
  for (const int n : unmoved) total.clear(n);
  if (slowed) loss.step(v, update->dt, update->setupflag);
}

// Together with run_style verlet/mdanim, which leaves ghosts out.
void FixMdanimBarrier::append_required_atoms(std::vector<int> &particles) const
{ particles.insert(particles.end(), particle.begin(), particle.end()); }

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
    case 0:
      return static_cast<double>(meeting_objects);
    case 1:
      return sum(pairs);
    case 2:
      return sum(touching);
    case 3:
      MPI_Allreduce(&deepest, &all, 1, MPI_DOUBLE, MPI_MIN, world);
      return all;
    case 4:
      return sum(loss.total());
    default:
      MPI_Allreduce(&seconds, &all, 1, MPI_DOUBLE, MPI_MAX, world);
      return all;
  }
}

double FixMdanimBarrier::memory_usage()
{
  return own.capacity() * sizeof(Own) + strip.capacity() * sizeof(Strip) + reach2.bytes() + law.capacity() * sizeof(Law) +
         lanes.capacity() * sizeof(StripMask) +
         (object.capacity() + particle.capacity() + unmoved.capacity() + touching_pair.capacity()) * sizeof(int) + here.bytes() +
         on.capacity() * sizeof(double) + slot.capacity() * sizeof(long) + loss.bytes();
}
