// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/tear: one loop over the bonds that may break, which are listed when LAMMPS makes its lists. A bond is stored at both
// ends, which decide alike.

#include "lammps/fix_mdanim_tear.h"

#include "lammps/bond_mdanim_harmonic.h"
#include "lammps/fix_mdanim_yield.h"
#include "lammps/keywords.h"
#include "lammps/object_table.h"
#include "lammps/rank_gather.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fmt/format.h"
#include "force.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/tear";

// fix ID group mdanim/tear torn NAME objects FILE
FixMdanimTear::FixMdanimTear(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), losses(lmp)
{
  need(OPEN_BOX | OBJECTS | ATOM_MAP);
  if (!atom->molecule_flag) error->all(FLERR, "{}: {}", STYLE, NO_OBJECTS);
  need_words(lmp, STYLE, "fix ID group mdanim/tear", "torn NAME objects FILE", narg - 3);
  const auto name_of_property = [&](int at, char **words) { torn = words[at + 1]; };
  const auto read = [&](int at, char **words) {
    try {
      rules = read_tear_rules(words[at + 1], read_shared_file(this->lmp, STYLE, "objects", words[at + 1]));
    } catch (const std::runtime_error &wrong) {
      error->all(FLERR, "{}: {}", STYLE, wrong.what());
    }
  };
  const std::vector<Keyword> known = {{"torn", "NAME", "", name_of_property}, {"objects", "FILE", "", read}};
  for (int iarg = 3; iarg < narg;) iarg += take_keyword(lmp, STYLE, known, iarg, narg, arg);
  if (torn.empty()) error->all(FLERR, "{}: the keyword torn is missing; write torn NAME", STYLE);
  if (rules.empty()) error->all(FLERR, "{}: nothing may break; write objects FILE with a line object MOLECULE STRAIN", STYLE);
  find_bits();
  comm->ghost_velocity = 1;    // the account sees what both ends of a spring did
  tell({{"energy", true, [this] { return sum(losses.total()); }}, clock()});
}

const FixMdanimTear *FixMdanimTear::of(LAMMPS *lmp)
{
  for (Fix *fix : lmp->modify->get_fix_list())
    if (const auto *one = dynamic_cast<const FixMdanimTear *>(fix)) return one;
  return nullptr;
}

int FixMdanimTear::setmask() { return POST_NEIGHBOR | PRE_FORCE | POST_FORCE | FINAL_INTEGRATE; }

// The property, with a bit for each bond that a particle has room for.
void FixMdanimTear::find_bits()
{
  int is_double = 0, columns = 0;
  const int needed = (atom->bond_per_atom + WORD - 1) / WORD;
  property = atom->find_custom(torn.c_str(), is_double, columns);
  has_one = columns == 0;
  const std::string wanted = needed > 1 ? fmt::format("i2_{} {}", torn, needed) : "i_" + torn;
  if (property < 0 || is_double || std::max(columns, 1) < needed)
    error->all(FLERR, "{}: there is no per-particle property {} of whole numbers; make it with 'fix ID all property/atom {}'",
               STYLE, wanted, wanted);
}

int *FixMdanimTear::one_number() const { return atom->ivector[property]; }

int **FixMdanimTear::numbers() const { return atom->iarray[property]; }

void FixMdanimTear::init()
{
  FixBase::init();
  springs = dynamic_cast<BondMdanimHarmonic *>(force->bond);
  if (!springs || springs->are_given())
    error->all(FLERR, "{}: needs bond_style mdanim/harmonic, with bonds that particles have themselves", name());
  find_bits();
  yields = FixMdanimYield::of(lmp);
  springs->partial_flag = 1;    // LAMMPS then does not look for the partners of bonds that are gone
  find_objects();
}

// --- objects ---

int FixMdanimTear::number(int i) const
{
  const auto found = rules.find(static_cast<int>(atom->molecule[i]));
  return found == rules.end() ? -1 : static_cast<int>(std::distance(rules.begin(), found));
}

void FixMdanimTear::find_objects()
{
  lowest.assign(rules.size(), MAXTAGINT);
  for (int i = 0; i < atom->nlocal; ++i)
    if (const int n = number(i); n >= 0) lowest[n] = std::min(lowest[n], atom->tag[i]);
  MPI_Allreduce(MPI_IN_PLACE, lowest.data(), static_cast<int>(lowest.size()), MPI_LMP_TAGINT, MPI_MIN, world);
  int n = 0;
  for (const auto &[molecule, rule] : rules)
    if (lowest[n++] == MAXTAGINT) error->all(FLERR, "{}: there is no object {} (molecule ID)", name(), molecule);
}

bool FixMdanimTear::is_here(int i) const { return i >= 0 && i < atom->nlocal; }

int FixMdanimTear::slot_of(int i, tagint partner) const
{
  const tagint *const of = atom->bond_atom[i], *const end = of + atom->num_bond[i], *const found = std::find(of, end, partner);
  return found == end ? -1 : static_cast<int>(found - of);
}

// The property comes from records, or from a run before: bonds follow it.
void FixMdanimTear::take_state()
{
  std::vector<GoneLink> here;
  for (int i = 0; i < atom->nlocal; ++i) {
    const int n = number(i);
    if (n < 0) continue;
    const TearRules &of = std::next(rules.begin(), n)->second;
    for (int b = 0; b < atom->num_bond[i]; ++b) {
      int &type = atom->bond_type[i][b];
      type = is_gone(i, b) ? -std::abs(type) : std::abs(type);
      const int low = static_cast<int>(atom->tag[i] - lowest[n]), high = static_cast<int>(atom->bond_atom[i][b] - lowest[n]);
      if (type < 0 && low < high && !of.over(low, high)) here.push_back({static_cast<int>(atom->molecule[i]), low, high});
    }
  }
  gone_links.clear();
  tell_all(std::move(here));
  springs->change_bonds();
}

void FixMdanimTear::setup_post_neighbor()
{
  find_objects();
  take_state();
  watch();
}

void FixMdanimTear::post_neighbor() { watch(); }

// Adds links that are gone to those that all ranks know.
void FixMdanimTear::tell_all(std::vector<GoneLink> here)
{
  std::vector<GoneLink> all = gather(world, here);
  std::sort(all.begin(), all.end());
  gone_links.insert(gone_links.end(), all.begin(), all.end());
}

// --- what may break ---

void FixMdanimTear::watch()
{
  const Lap lap(seconds);
  watched.clear();
  spanning.clear();
  for (int i = 0; i < atom->nlocal; ++i)
    if (const int n = number(i); n >= 0) watch_bonds(i, std::next(rules.begin(), n)->second, lowest[n]);
  int n = 0;
  for (const auto &[molecule, rule] : rules) span(rule, lowest[n++]);
  any_remains = std::any_of(spanning.begin(), spanning.end(), [](const Spanning &one) { return one.gone[0] || one.gone[1]; });
}

void FixMdanimTear::watch_bonds(int i, const TearRules &of, tagint first)
{
  for (int b = 0; b < atom->num_bond[i]; ++b) {
    const tagint other = atom->bond_atom[i][b];
    const int j = atom->map(other), type = atom->bond_type[i][b];
    if (type <= 0) continue;
    if (j < 0) springs->lost_partner(i, static_cast<int>(other));
    if (is_here(j) && other < atom->tag[i]) continue;    // it is among those of its lower end
    const int low = static_cast<int>(std::min(atom->tag[i], other) - first);
    const int high = static_cast<int>(std::max(atom->tag[i], other) - first);
    if (of.over(low, high)) continue;    // goes with its links
    const TearLink *const link = of.link(low, high);
    const double limit = link ? link->limit : (1.0 + of.strain) * springs->springs()[type].r0;
    watched.push_back({i, j, limit * limit});
  }
}

// Lists springs over two links of which an end or the middle is here, unless both links are gone. Particles beyond a link that is
// gone may be anywhere.
void FixMdanimTear::span(const TearRules &of, tagint first)
{
  for (const TearOver &over : of.overs) {
    const tagint tag[3] = {first + over.low, first + over.middle, first + over.high};
    Spanning one{&over, of.leaves_rest, {atom->map(tag[0]), atom->map(tag[1]), atom->map(tag[2])}, {-1, -1}, {}};
    const auto &[a, m, b] = one.at;
    if (!is_here(a) && !is_here(m) && !is_here(b)) continue;
    if (is_here(a)) one.slot[0] = slot_of(a, tag[2]);
    if (is_here(b)) one.slot[1] = slot_of(b, tag[0]);
    if ((is_here(a) && one.slot[0] < 0) || (is_here(b) && one.slot[1] < 0))
      error->one(FLERR, "{}: particles {} and {} have no bond over two links, which its objects tell of", name(), tag[0], tag[2]);
    find_gone(one, tag);
    if ((one.gone[0] && one.gone[1]) || (!one.leaves_rest && (one.gone[0] || one.gone[1]))) continue;
    const int from = one.gone[0] ? 1 : 0, to = one.gone[1] ? 1 : 2;    // the particles that it pulls at
    if (std::none_of(one.at + from, one.at + to + 1, [this](int i) { return is_here(i); })) continue;
    for (int k = from; k <= to; ++k)
      if (one.at[k] < 0) springs->lost_partner(is_here(a) ? a : is_here(b) ? b : m, static_cast<int>(tag[k]));
    spanning.push_back(one);
  }
}

// Which of its links are gone: each end knows its own link, and the spring itself; the middle knows both links.
void FixMdanimTear::find_gone(Spanning &one, const tagint (&tag)[3]) const
{
  const int m = one.at[1];
  bool known[2], itself = false;
  for (int k = 0; k < 2; ++k) {
    const int end = one.at[2 * k];
    known[k] = is_here(end) || is_here(m);
    if (known[k]) one.gone[k] = is_here(end) ? is_gone(end, slot_of(end, tag[1])) : is_gone(m, slot_of(m, tag[2 * k]));
    if (is_here(end)) itself = is_gone(end, one.slot[k]);
  }
  for (int k = 0; k < 2; ++k)
    if (!known[k]) one.gone[k] = itself && !one.gone[1 - k];
}

// --- what breaks ---

void FixMdanimTear::let_go(int i, int slot)
{
  bits(i)[slot / WORD] |= 1 << (slot % WORD);
  atom->bond_type[i][slot] = -std::abs(atom->bond_type[i][slot]);
}

// Takes a spring between two particles into the account: 1 of one that is gone, -1 of one that is there instead.
void FixMdanimTear::release(int i, int j, const LoadFree &spring, double sign)
{
  losses.count(i, j, spring, sign);
  losses.count(j, i, spring, sign);
}

// The same of a spring over two links, or of what remains of it.
void FixMdanimTear::release(const Spanning &one, double sign)
{
  const auto &[a, m, b] = one.at;
  if (!one.gone[0] && !one.gone[1]) {
    losses.count(a, b, grown_by(one.over->whole(), a, one.slot[0]), sign);
    losses.count(b, a, grown_by(one.over->whole(), b, one.slot[1]), sign);
  } else if (!one.leaves_rest || (one.gone[0] && one.gone[1])) {
    return;
  } else if (one.gone[0]) {
    release(m, b, one.over->remainder(1), sign);
  } else {
    release(a, m, one.over->remainder(0), sign);
  }
}

LoadFree FixMdanimTear::load_free(const Watched &one) const
{
  const int slot = slot_of(one.i, atom->tag[one.j]), n = number(one.i);
  const Spring &spring = springs->springs()[std::abs(atom->bond_type[one.i][slot])];
  const TearRules &of = std::next(rules.begin(), n)->second;
  const tagint tag = atom->tag[one.i], other = atom->tag[one.j];
  const TearLink *const link =
      of.link(static_cast<int>(std::min(tag, other) - lowest[n]), static_cast<int>(std::max(tag, other) - lowest[n]));
  return grown_by({{spring.K, spring.r0, 0.0}, link ? link->length : spring.r0}, one.i, slot);
}

// A spring of a particle with what it has grown by.
LoadFree FixMdanimTear::grown_by(const LoadFree &spring, int i, int slot) const
{ return yields && is_here(i) ? grown_spring(spring, yields->more(i, slot)) : spring; }

void FixMdanimTear::break_link(const Watched &one, std::vector<GoneLink> &here)
{
  const tagint tag = atom->tag[one.i], other = atom->tag[one.j], first = lowest[number(one.i)];
  release(one.i, one.j, load_free(one), 1.0);
  let_go(one.i, slot_of(one.i, other));
  if (is_here(one.j)) let_go(one.j, slot_of(one.j, tag));
  if (tag < other)    // else the rank of the other end tells of it
    here.push_back({static_cast<int>(atom->molecule[one.i]), static_cast<int>(tag - first), static_cast<int>(other - first)});
}

void FixMdanimTear::pre_force(int)
{
  const Lap lap(seconds);
  const auto apart = [this](int i, int j) { return vec3(atom->x[i]) - vec3(atom->x[j]); };
  const auto is_whole = [x = atom->x[0]](const Watched &one) {
    const Vec3 along = vec3(x + 3 * one.i) - vec3(x + 3 * one.j);
    return !(dot(along, along) > one.square);
  };
  std::vector<GoneLink> here;
  const auto first_gone = std::find_if_not(watched.begin(), watched.end(), is_whole);
  auto left = first_gone;
  for (auto at = first_gone; at != watched.end(); ++at) {
    if (is_whole(*at))
      *left++ = *at;
    else
      break_link(*at, here);
  }
  int any = left != watched.end();
  watched.erase(left, watched.end());
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any) return;

  for (Spanning &one : spanning) {
    const bool first = one.gone[0] || is_too_long(apart(one.at[0], one.at[1]), one.over->limit[0]);
    const bool second = one.gone[1] || is_too_long(apart(one.at[1], one.at[2]), one.over->limit[1]);
    if (first == one.gone[0] && second == one.gone[1]) continue;
    release(one, 1.0);
    if (!one.gone[0] && !one.gone[1]) {
      if (one.slot[0] >= 0) let_go(one.at[0], one.slot[0]);
      if (one.slot[1] >= 0) let_go(one.at[2], one.slot[1]);
    }
    one.gone[0] = first, one.gone[1] = second;
    release(one, -1.0);
    any_remains = true;
  }
  tell_all(std::move(here));
  springs->change_bonds();
}

// All forces of the step are there.
void FixMdanimTear::final_integrate() { losses.close(groupbit); }

// --- what remains ---

template <class Visit> void FixMdanimTear::each_remainder(Visit visit) const
{
  if (!any_remains) return;
  for (const Spanning &one : spanning) {
    if (one.gone[0] == one.gone[1] || !one.leaves_rest) continue;
    const int link = one.gone[0] ? 1 : 0, i = one.at[link], j = one.at[link + 1];
    const LoadFree left = one.over->remainder(link);
    const Vec3 apart = vec3(atom->x[i]) - vec3(atom->x[j]);
    if (is_here(i)) visit(i, apart, left);
    if (is_here(j)) visit(j, -1.0 * apart, left);
  }
}

void FixMdanimTear::pull() const
{
  each_remainder([this](int i, const Vec3 &apart, const LoadFree &left) { add_to(atom->f[i], force_of(left.spring, apart)); });
}

void FixMdanimTear::post_force(int)
{
  const Lap lap(seconds);
  pull();
}

// Energy of what remains, beyond that without load; half of it at either end.
double FixMdanimTear::compute_scalar()
{
  double here = 0.0;
  each_remainder([&](int, const Vec3 &apart, const LoadFree &left) { here += 0.5 * left.energy(std::sqrt(dot(apart, apart))); });
  return sum(here);
}

double FixMdanimTear::memory_usage()
{
  std::size_t found =
      watched.capacity() * sizeof(Watched) + spanning.capacity() * sizeof(Spanning) + gone_links.capacity() * sizeof(GoneLink);
  for (const auto &[molecule, rule] : rules) found += rule.bytes();
  return static_cast<double>(found);
}
