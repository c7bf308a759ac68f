// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/folds: from particles to contacts, and from their forces to those on particles.

#include "lammps/fix_mdanim_folds.h"

#include "lammps/keywords.h"
#include "lammps/object_table.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"
#include "records/byte_reader.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/folds";
static constexpr std::int64_t STATE_VERSION = 1;
// How far particles go before contacts are looked for again, over the largest reach.
static constexpr double SKIN = 1.5;

// fix ID group mdanim/folds FILE
FixMdanimFolds::FixMdanimFolds(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), nodes(lmp)
{
  restart_global = 1;
  need(THREE_DIMENSIONS | OPEN_BOX | OBJECTS | ATOM_MAP);
  if (!atom->molecule_flag) error->all(FLERR, "{}: {}", STYLE, NO_OBJECTS);
  tell({{"friction_heat", true, [this] { return sum(heat); }},
        {"contact_damping_loss", true, [this] { return sum(loss); }},
        {"lists", false, [this] { return lists; }},
        clock()});
  need_words(lmp, STYLE, "fix ID group mdanim/folds", "FILE", narg - 3);
  if (narg > 4) error->all(FLERR, 4, "{}: there is more than belongs to it, from {} on", STYLE, arg[4]);
  try {
    table = read_folds(arg[3], read_shared_file(lmp, STYLE, "table", arg[3]));
  } catch (const std::runtime_error &wrong) {
    error->all(FLERR, "{}: {}", STYLE, wrong.what());
  }
  if (table.pairs.empty()) error->all(FLERR, "{}: nothing touches; write a line pair in {}", STYLE, arg[3]);
  for (const auto &[molecule, object] : table.objects) nodes.append(molecule, object.particles);
}

// All objects, without what is torn.
void FixMdanimFolds::make_surfaces()
{
  number.clear();
  surfaces.clear();
  ways.clear();
  for (int n = 0; n < nodes.count(); ++n) {
    number[nodes.molecule(n)] = n;
    surfaces.emplace_back(table.objects.at(nodes.molecule(n)));
  }
  for (const FoldPair &pair : table.pairs) {
    skin = std::max(skin, SKIN * pair.law.reach);
    untorn_touch |= touch_untorn(table.objects.at(pair.first), table.objects.at(pair.second), pair.apart);
  }
}

bool FixMdanimFolds::may_touch() const
{
  return untorn_touch || std::any_of(surfaces.begin(), surfaces.end(), [](const FoldSurface &one) { return one.is_torn(); });
}

int FixMdanimFolds::setmask() { return PRE_NEIGHBOR | POST_INTEGRATE | POST_FORCE; }

void FixMdanimFolds::init()
{
  FixBase::init();
  nodes.find(name());
  listed.clear();
  tears = FixMdanimTear::of(lmp);
  known_tears = 0;
  energy = 0.0;
  make_surfaces();
}

// --- forces ---

void FixMdanimFolds::list_again()
{
  find_ways();
  for (FoldWay &way : ways) way.contact.list(&x[nodes.first(way.first)], &x[nodes.first(way.second)], skin);
  listed = x;
  lists += 1.0;
}

// Contacts of the pairs that may come within reach before the next list; with many objects most pairs are far from each other.
void FixMdanimFolds::find_ways()
{
  std::vector<Box> around(nodes.count());
  for (int n = 0; n < nodes.count(); ++n)
    for (std::size_t k = nodes.first(n); k < nodes.end(n); ++k) around[n].include(&x[k].x);

  std::vector<FoldWay> before = std::move(ways);
  ways.clear();
  auto known = before.begin();
  for (std::size_t p = 0; p < table.pairs.size(); ++p) {
    const FoldPair &pair = table.pairs[p];
    const int one = number.at(pair.first), other = number.at(pair.second);
    if (one != other && !meet(around[one], around[other], pair.law.reach + skin)) continue;
    known = std::find_if(known, before.end(), [p](const FoldWay &way) { return way.pair >= p; });
    if (known == before.end() || known->pair > p) {
      append_ways(p, one, other);
      continue;
    }
    for (; known != before.end() && known->pair == p; ++known) ways.push_back(std::move(*known));
  }
}

void FixMdanimFolds::append_ways(std::size_t p, int one, int other)
{
  const FoldPair &pair = table.pairs[p];
  const FoldObject &a = table.objects.at(pair.first), &b = table.objects.at(pair.second);
  ways.push_back({p, one, other, FoldContact(a, surfaces[one], b, surfaces[other], pair.law, pair.apart)});
  if (one != other && (a.segments.empty() || b.segments.empty()))
    ways.push_back({p, other, one, FoldContact(b, surfaces[other], a, surfaces[one], pair.law, 0.0)});
}

// Velocities are those of half a step before: what has moved the particles here. Nothing moves at the setup of a run.
void FixMdanimFolds::find_pushes(bool moves)
{
  const bool has_torn = tears && known_tears < tears->gone().size(), woken = may_touch();
  if (!woken && !has_torn) {
    pushes.clear();
    return;
  }
  const double units = 1.0 / force->ftm2v;
  nodes.share();
  const std::size_t count = nodes.count() ? nodes.end(nodes.count() - 1) : 0;
  x.resize(count);
  v.resize(count);
  mass.resize(count);
  double farthest = 0.0;
  const bool known = woken && listed.size() == count;
  for (std::size_t k = 0; k < count; ++k) {
    x[k] = nodes.place(k);
    v[k] = nodes.speed(k);
    mass[k] = units * nodes.mass(k);
    if (!known) continue;
    const Vec3 gone = x[k] - listed[k];
    farthest = std::max(farthest, dot(gone, gone));
  }
  if (!known || !(farthest <= 0.25 * skin * skin)) list_again();

  if (has_torn) {    // what a torn element has stored is lost
    const double before = known ? push_all() : 0.0;
    open_torn();
    for (FoldWay &way : ways) way.contact.renew(&listed[nodes.first(way.first)], &listed[nodes.first(way.second)], skin);
    for (FoldSurface &one : surfaces) one.forget_news();
    energy = push_all();
    if (moves && comm->me == 0) loss += before - energy;
  } else {
    energy = push_all();
  }

  pushes.clear();
  const auto is_pushed = [this](std::size_t k) {
    return dot(pushed[k], pushed[k]) + dot(rubbed[k], rubbed[k]) + dot(damped[k], damped[k]) != 0.0;
  };
  for (std::size_t k = 0; k < count; ++k)
    if (const int i = nodes.target(k); i != ObjectNodes::ELSEWHERE && is_pushed(k))
      pushes.push_back({i, pushed[k], {rubbed[k], damped[k]}});
}

// The links that are gone since the last time.
void FixMdanimFolds::open_torn()
{
  for (; known_tears < tears->gone().size(); ++known_tears) {
    const GoneLink &link = tears->gone()[known_tears];
    if (const auto found = number.find(link.object); found != number.end()) surfaces[found->second].open(link.low, link.high);
  }
}

// Forces of all contacts on nodes, and their energy.
double FixMdanimFolds::push_all()
{
  for (std::vector<Vec3> *all : {&pushed, &rubbed, &damped}) all->assign(x.size(), Vec3{});
  const auto of = [this](int n) {
    const std::size_t from = nodes.first(n);
    return FoldNodes{&x[from], &v[from], &mass[from], &pushed[from], &rubbed[from], &damped[from]};
  };
  double found = 0.0;
  for (const FoldWay &way : ways)
    if (nodes.acts(way.first) || nodes.acts(way.second)) found += way.contact.push(of(way.first), of(way.second), update->dt);
  return found;
}

void FixMdanimFolds::push() const
{
  for (const FoldForce &one : pushes) add_to(atom->f[one.i], one.push + (one.lost.rub + one.lost.damp));
}

// A force acts over the half steps before and behind it, as leap-frog takes it. What has been laid aside since then moves in
// another instance, which counts it.
void FixMdanimFolds::count()
{
  const double half = 0.5 * update->dt;
  double rubbing = 0.0, damping = 0.0;
  for (const FoldForce &one : pushes) {
    if (!(atom->mask[one.i] & groupbit)) continue;
    const Vec3 speed = vec3(atom->v[one.i]);
    rubbing += dot(one.lost.rub, speed);
    damping += dot(one.lost.damp, speed);
  }
  heat -= half * rubbing;
  loss -= half * damping;
}

// Forces of a state act in place of those by its velocities.
void FixMdanimFolds::setup(int)
{
  if (restarted) unpack(StateRecords(*restarted));
  find_pushes(false);
  for (FoldForce &one : pushes)
    if (const auto found = acted.find(atom->tag[one.i]); found != acted.end()) one.lost = found->second;
  acted.clear();
  push();
}

void FixMdanimFolds::post_integrate()
{
  const Lap lap(seconds);
  count();
}

void FixMdanimFolds::post_force(int)
{
  const Lap lap(seconds);
  find_pushes(true);
  push();
  count();
}

// --- state ---

StateRecords FixMdanimFolds::pack() const
{
  if (restarted) return *restarted;
  StateRecords records;
  ParticleRows rows(lmp, STATE_VERSION, sizeof(Lost));
  for (const FoldForce &one : pushes)
    if (atom->mask[one.i] & groupbit) rows.add(one.i, &one.lost);
  rows.pack(records);
  return records;
}

void FixMdanimFolds::unpack(const StateRecords &records)
{
  std::map<tagint, Lost> found;
  ParticleRows(lmp, STATE_VERSION, sizeof(Lost)).unpack(records, [&](int i, const std::uint8_t *from) {
    const auto lost = ByteReader(from, sizeof(Lost), "what is lost at a particle").get<Lost>();
    if (!std::isfinite(dot(lost.rub, lost.rub) + dot(lost.damp, lost.damp)))
      throw std::runtime_error("a force of contact is damaged");
    found[atom->tag[i]] = lost;
  });
  acted = std::move(found);
  restarted.reset();
}

void FixMdanimFolds::write_restart(FILE *file) { mdanim::write_restart(*this, lmp, name(), file); }

void FixMdanimFolds::restart(char *buffer)
{
  mdanim::read_restart([this](const StateRecords &all) { restarted = all; }, lmp, name(), buffer);
}

double FixMdanimFolds::memory_usage()
{
  std::size_t found = nodes.bytes() + (x.capacity() + v.capacity() + listed.capacity() + pushed.capacity()) * sizeof(Vec3);
  for (const auto &one : table.objects) found += one.second.bytes();
  for (const FoldWay &way : ways) found += way.contact.bytes();
  for (const FoldSurface &one : surfaces) found += one.bytes();
  return static_cast<double>(found);
}
