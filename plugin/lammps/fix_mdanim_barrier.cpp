// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/barrier. When LAMMPS rebuilds its lists: boxes of objects, pairs of boxes that meet, the pairs of their particles
// (barrier/contact_search.h). Every step: forces of the pairs in reach. Each particle sums its forces in the order of its
// partners' tags, so the bits of a force depend on neither the order of particles nor the ranks that hold them.

#include "lammps/fix_mdanim_barrier.h"

#include "barrier/contact_search.h"
#include "barrier/law.h"
#include "lammps/keywords.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/barrier";
static constexpr double MOST_SKINS = 64.0;    // to look ahead where objects are apart

// --- the command ---

// fix ID group mdanim/barrier BOUNDARY BARRIER k rc [thin GROUP ratio] [exclude MOL MOL]…
FixMdanimBarrier::FixMdanimBarrier(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg)
{
  need(THREE_DIMENSIONS | ORTHOGONAL_BOX | OPEN_BOX | OBJECTS | ATOM_MAP | PROMPT_LISTS, "a pair may come into reach");
  look_up({&boundary, &barrier, &thin}, {&stiffness, &reach});
  tell({{"meeting", true, [this] { return static_cast<double>(meeting_objects); }},
        {"tried", true, [this] { return sum(tried_pairs); }},
        {"touching", true, [this] { return sum(touching); }},
        {"nearest", false, [this] { return least(deepest); }},
        clock()});
  comm_forward = 3;
  filter = &widest_kernels().pair_filter;

  need_words(lmp, STYLE, "fix ID group mdanim/barrier", "BOUNDARY BARRIER k rc", narg - 3);
  boundary = NamedGroup(lmp, STYLE, 3, arg[3]);
  barrier = NamedGroup(lmp, STYLE, 4, arg[4]);
  stiffness = ParticleValue(lmp, "fix mdanim/barrier: k", 5, arg[5]);
  reach = ParticleValue(lmp, "fix mdanim/barrier: rc", 6, arg[6]);

  const std::vector<Keyword> known = {
      {"thin", "GROUP ratio", "",
       [&, this](int at, char **arg) {
         thin = NamedGroup(lmp, STYLE, at + 1, arg[at + 1]);
         thin_ratio = positive(lmp, STYLE, "thin ratio", at + 2, arg);
       }},
      {"exclude", "MOL1 MOL2", "", [&, this](int at, char **arg) { excluded.insert(two_molecules(lmp, STYLE, at + 1, arg)); }},
      {"damp", "", "leave it out; objects with friction lose energy at the surfaces of fix mdanim/contact"},
      {"power", "", "leave it out for the law of power 3, and take fix mdanim/contact for a surface that is linear"}};
  for (int iarg = 7; iarg < narg;) iarg += take_keyword(lmp, STYLE, known, iarg, narg, arg);
}

int FixMdanimBarrier::setmask() { return POST_NEIGHBOR | POST_FORCE; }

void FixMdanimBarrier::init()
{
  FixBase::init();
  std::vector<int> apart;
  for (const auto &[a, b] : excluded) apart.insert(apart.end(), {a, b});
  need_molecules(this, lmp, "exclude", apart);
}

// --- candidates, when LAMMPS rebuilds ---

int FixMdanimBarrier::role(int i) const
{
  const int mask = atom->mask[i];
  if (mask & boundary.bit()) return mask & thin.bit() ? BOUNDARY | THIN : BOUNDARY;
  return mask & barrier.bit() ? BARRIER : NONE;
}

void FixMdanimBarrier::setup_post_neighbor() { post_neighbor(); }

void FixMdanimBarrier::post_neighbor()
{
  const Lap lap(seconds);
  find_pairs();
}

void FixMdanimBarrier::collect_own()
{
  own.resize(atom->nlocal + atom->nghost);
  const double *k = stiffness.values(lmp), *rc = reach.values(lmp);
  for (int i = 0; i < atom->nlocal; ++i) own[i] = {k ? k[i] : stiffness.number, rc ? rc[i] : reach.number, objects[i]};
  comm->forward_comm(this);
}

int FixMdanimBarrier::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  int m = 0;
  for (int i = 0; i < n; ++i) {
    const Own &o = own[list[i]];
    buf[m++] = o.stiffness;
    buf[m++] = o.reach;
    buf[m++] = static_cast<double>(o.object);
  }
  return m;
}

void FixMdanimBarrier::unpack_forward_comm(int n, int start, double *buf)
{
  for (int i = start; i < start + n; ++i, buf += 3) own[i] = {buf[0], buf[1], static_cast<int>(buf[2])};
}

void FixMdanimBarrier::find_objects()
{
  std::vector<tagint> here;
  for (int i = 0; i < atom->nlocal; ++i)
    if (role(i) != NONE && (here.empty() || here.back() != atom->molecule[i])) {
      need_object(this, lmp, i);
      here.push_back(atom->molecule[i]);
    }
  objects.make(world, std::move(here));
}

// The longest reach of any pair, and a box around every object in ascending order of molecule IDs; the same on all ranks.
double FixMdanimBarrier::survey(std::vector<Box> &boxes)
{
  find_objects();
  const double *k = stiffness.values(lmp), *rc = reach.values(lmp);
  boxes = objects.place(
      *atom, world, [&](int i) { return role(i) != NONE && !(k && k[i] == 0.0); },    // without stiffness it takes no part
      [](int) {});
  double reach_here = 0.0;
  for (int i = 0; i < atom->nlocal; ++i)
    if (objects[i] != ObjectTable::NONE) reach_here = std::max(reach_here, rc ? rc[i] : reach.number);
  const double longest = largest(reach_here);
  return thin.given() ? std::max(1.0, thin_ratio) * longest : longest;
}

// Whether this rank adds forces to a particle.
bool FixMdanimBarrier::moves(int i) const { return i < atom->nlocal && atom->mask[i] & groupbit; }

// Pairs of objects that may touch, by their numbers, whose boxes meet.
std::vector<std::pair<int, int>> FixMdanimBarrier::meeting_within(const std::vector<Box> &boxes, double range) const
{
  auto found = meeting_pairs(boxes, range);
  const auto is_excluded = [this](const std::pair<int, int> &pair) {
    return excluded.count({static_cast<int>(objects.id(pair.first)), static_cast<int>(objects.id(pair.second))}) > 0;
  };
  if (!excluded.empty()) found.erase(std::remove_if(found.begin(), found.end(), is_excluded), found.end());
  return found;
}

// How far every particle may go before two objects meet, up to the look-ahead.
double FixMdanimBarrier::distance_apart(const std::vector<Box> &boxes, double range) const
{
  double apart = 0.0;
  for (double skins = 1.0; skins <= MOST_SKINS; skins *= 2.0) {
    const double more = skins * neighbor->skin;
    if (!meeting_within(boxes, range + more).empty()) break;
    apart = 0.5 * (neighbor->skin + more);
  }
  return apart;
}

void FixMdanimBarrier::find_pairs()
{
  strip.clear();
  reach2.clear();
  pair.clear();
  particle.clear();
  unmoved.clear();
  tried_pairs = longest = 0.0;
  least_beyond = std::numeric_limits<double>::infinity();    // until there are pairs

  std::vector<Box> boxes;
  const double range = survey(boxes) + neighbor->skin;
  const double ghosts = std::min({comm->cutghost[0], comm->cutghost[1], comm->cutghost[2]});
  if (comm->nprocs > 1 && ghosts < range)
    error->all(FLERR,
               "{}: particles of other ranks are seen up to {:.6g}, reach and skin need {:.6g}; use "
               "'comm_modify cutoff {:.6g}'",
               name(), ghosts, range, 1.001 * range);

  const auto meeting = meeting_within(boxes, range);
  meeting_objects = static_cast<bigint>(meeting.size());
  clear = meeting.empty() ? distance_apart(boxes, range) : 0.0;
  if (meeting.empty()) return;
  collect_own();

  ContactSearch search(boxes, meeting, {range, neighbor->skin, thin_ratio, filter});
  for (int i = 0; i < atom->nlocal + atom->nghost; ++i)
    if (own[i].object != ObjectTable::NONE && search.is_near(own[i].object, atom->x[i]))
      search.add({i, atom->tag[i], own[i].object, role(i), moves(i), own[i].reach, atom->x[i]});
  search.run();

  // Partners of a particle are mostly of the other kind. More of them are side by side in a list of that kind only.
  constexpr int NONE_YET = -1;
  std::vector<int> number(search.particles().size());    // places in `particle`
  for (const auto &[low, high] : search.pairs()) number[low] = number[high] = NONE_YET;
  for (const int kind : {static_cast<int>(BOUNDARY), 0})
    for (size_t n = 0; n < number.size(); ++n)
      if (const auto &one = search.particles()[n]; number[n] == NONE_YET && (one.role & BOUNDARY) == kind) {
        number[n] = static_cast<int>(particle.size());
        if (!one.moves) unmoved.push_back(number[n]);
        particle.push_back(one.index);
      }
  for (const auto &[low, high] : search.pairs()) {
    const auto &one = search.particles()[low], &other = search.particles()[high];
    const double a = own[one.index].stiffness, b = own[other.index].stiffness;
    const double k = stiffness.constant() ? stiffness.number : pair_stiffness(a, b);
    const bool both = atom->mask[one.index] & atom->mask[other.index] & groupbit;
    add_pair(number[low], number[high], {k, search.reach_of(one, other), (one.moves + other.moves) * (both ? 0.5 : 1.0)});
  }
  slot.resize(particle.size());
  for (size_t n = 0; n < slot.size(); ++n) slot[n] = 3 * static_cast<long>(n);
}

// Pairs come in ascending order of low and then of high tags, and are numbered in that order.
void FixMdanimBarrier::add_pair(int low, int high, const ContactPair &known)
{
  if (strip.empty() || strip.back().one != low || high <= last_high || strip.back().first + STRIP <= high) {
    constexpr double none[STRIP] = {NO_PAIR, NO_PAIR, NO_PAIR, NO_PAIR};
    strip.push_back({low, high});
    reach2.push(none, STRIP);
    pair.resize(pair.size() + STRIP, {0.0, 0.0, 0.0});
  }
  const size_t number = STRIP * (strip.size() - 1) + high - strip.back().first;
  reach2.data()[number] = known.reach * known.reach;
  longest = std::max(longest, known.reach);
  pair[number] = known;
  tried_pairs += known.share;
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

// Puts the pairs in touch into touching_pair; returns their number.
int FixMdanimBarrier::find_touching(const Positions &place)
{
  masks.resize(strip.size() + 1);
  touching_pair.resize(pair.size() + STRIP);
  const auto all = place.all();
  return filter->in_reach({all.data(), strip.data(), static_cast<int>(strip.size()), reach2.data(), masks.data(), &least_beyond},
                          touching_pair.data());
}

// Between outputs, where the energy is not read.
void FixMdanimBarrier::add_forces(const Positions &place, const ForceSums &total) { push<false>(place, total); }

// A pair comes nearer by what both of its particles go. Particles of other ranks may be faster than those of this one.
double FixMdanimBarrier::rests_for() const
{
  constexpr double ROUNDING = 1e-6;    // of a reach, by which places and sums may be wrong after many steps
  if (comm->nprocs > 1 || !(least_beyond > 0.0)) return 0.0;
  return 0.5 * (std::sqrt(longest * longest + least_beyond) - longest) - ROUNDING * longest;
}

// Forces on the particles that have candidates; none on those that are not moved. TELLS: computes energy and pairs in touch, too.
template <bool TELLS> void FixMdanimBarrier::push(const Positions &place, const ForceSums &total)
{
  if (TELLS) energy = touching = 0.0;
  if (strip.empty()) return;

  const Lap lap(seconds);
  const int many = find_touching(place);
  for (int m = 0; m < many; ++m) {
    const auto &[k, reach, share] = pair[touching_pair[m]];
    const auto [low, first] = strip[touching_pair[m] / STRIP];
    const int high = first + touching_pair[m] % STRIP;
    const Vec3 d = place[low] - place[high];
    const double r = std::sqrt(dot(d, d)), q = 1.0 - r / reach;
    const Vec3 normal = direction(d, r, true);
    if (TELLS) {
      energy += share * barrier_energy(k, reach, q);
      touching += share;
    }
    const Vec3 on_low = barrier_force(k, reach, q) * normal;
    total.add(low, on_low);
    total.add(high, -1.0 * on_low);
    deepest = std::min(deepest, r / reach);
  }
  for (const int n : unmoved) total.clear(n);
}

// Together with run_style verlet/mdanim, which ignores ghosts.
void FixMdanimBarrier::append_required_atoms(std::vector<int> &particles) const
{ particles.insert(particles.end(), particle.begin(), particle.end()); }

// --- output ---

double FixMdanimBarrier::compute_scalar() { return sum(energy); }

double FixMdanimBarrier::memory_usage()
{
  return objects.bytes() + own.capacity() * sizeof(Own) + strip.capacity() * sizeof(Strip) + reach2.bytes() +
         pair.capacity() * sizeof(ContactPair) + masks.capacity() * sizeof(StripMask) +
         (particle.capacity() + unmoved.capacity() + touching_pair.capacity()) * sizeof(int) + here.bytes() +
         on.capacity() * sizeof(double) + slot.capacity() * sizeof(long);
}
