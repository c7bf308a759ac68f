// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/contact. When LAMMPS rebuilds its lists: boxes of objects, objects near each other, the particles that may take part
// in contacts. Every step all ranks exchange the places of these. Each rank computes all contacts, with the same bits, and takes
// the forces on its own particles. Contacts are few compared with springs; their memory is then the same on all ranks.

#include "lammps/fix_mdanim_contact.h"

#include "contact/bodies_file.h"
#include "lammps/keywords.h"
#include "lammps/object_survey.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static constexpr double NS_OF_PARTICLE = 4.0, NS_OF_ZONES = 15.0;    // of a particle, approximately
static constexpr double USUAL_DAMPING = 0.3;                         // beta
static const char *const STYLE = "fix mdanim/contact";
static const char *const LEFT_OUT = ", or leave it out by 'among GROUP'";

static std::vector<OwnParticles> by_object(const std::vector<ContactParticle> &ascending)
{
  std::vector<OwnParticles> found;
  for (long n = 0; n < static_cast<long>(ascending.size()); ++n) {
    if (found.empty() || found.back().object != ascending[n].object) found.push_back({ascending[n].object, n, n});
    ++found.back().end;
  }
  return found;
}

// Calls give(first, end) for the particles of each object that is pushed; threads share them.
template <class Give>
static void each_pushed(const ContactWorld &world, const std::vector<OwnParticles> &all, const Threads &threads, const Give &give)
{
  threads.parts(all.empty() ? 0 : all.back().end, NS_OF_PARTICLE, [&](long from, long to) {
    for (const OwnParticles &own : all)
      if (world.is_pushed(own.object)) give(std::max(own.first, from), std::min(own.end, to));
  });
}

// --- the command ---

static void read_bodies_of(const char *file, LAMMPS *lmp, std::map<int, std::shared_ptr<const ContactBody>> &bodies)
{
  const std::string text = read_shared_file(lmp, STYLE, "bodies", file);
  try {
    for (auto &[number, body] : read_bodies(file, text)) bodies[number] = std::make_shared<const ContactBody>(std::move(body));
  } catch (const std::exception &problem) {
    lmp->error->all(FLERR, "{}: {}", STYLE, problem.what());
  }
}

// fix ID group mdanim/contact BODY YOUNG FRICTION [objects] [plane x|y|z lo|hi at]… [moving x|y|z lo|hi at FIXID]…
//     [stiffness f] [damping beta] [pair MOL MOL mu beta]… [exclude MOL MOL]… [belt MOL vx vy vz]… [among GROUP] [except GROUP]
//     [bodies FILE]
FixMdanimContact::FixMdanimContact(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), moving(lmp), shared(lmp)
{
  restart_global = 1;
  need(THREE_DIMENSIONS | ORTHOGONAL_BOX | OPEN_BOX | OBJECTS | PROMPT_LISTS, "surfaces may meet");
  look_up({&among, &except}, {&kind, &young, &friction});
  const ContactAccount &account = world_of_contact.account;
  tell({{"stick_energy", true, [&] { return account.stick_energy; }},
        {"friction_heat", true, [this] { return world_of_contact.booked().heat; }},
        {"damping_loss", true, [this] { return world_of_contact.booked().damped; }},
        {"let_go", true, [&] { return account.let_go; }},
        {"deepest", false, [&] { return account.deepest; }},
        {"touching", true, [&] { return account.touching; }},
        {"near", true, [this] { return static_cast<double>(world_of_contact.near.pairs().size()); }},
        clock(),
        {"force_x", true, [this] { return world_of_contact.force_on_planes().x; }},
        {"force_y", true, [this] { return world_of_contact.force_on_planes().y; }},
        {"force_z", true, [this] { return world_of_contact.force_on_planes().z; }},
        {"bytes_of_bodies", false, [this] { return static_cast<double>(bytes_of_bodies()); }},
        {"bytes_of_pairs", false, [this] { return static_cast<double>(world_of_contact.bytes_of_fields()); }},
        {"bytes_of_particles", false, [this] { return static_cast<double>(bytes_of_particles()); }},
        {"looks", true, [&] { return account.looks; }},
        {"work", true, [&] { return account.work; }}});

  need_words(lmp, "fix mdanim/contact", "fix ID group mdanim/contact", "BODY YOUNG FRICTION", narg - 3);
  kind = ParticleValue(lmp, "fix mdanim/contact: BODY", 3, arg[3]);
  young = ParticleValue(lmp, "fix mdanim/contact: YOUNG", 4, arg[4]);
  friction = ParticleValue(lmp, "fix mdanim/contact: FRICTION", 5, arg[5]);
  ContactSettings &settings = world_of_contact.settings;
  settings.damping = USUAL_DAMPING;
  const std::vector<Keyword> known = keywords();
  for (int iarg = 6; iarg < narg;) iarg += take_keyword(lmp, STYLE, known, iarg, narg, arg);
  force_reneighbor = moving.any();
  next_reneighbor = -1;
  if (!settings.objects && settings.planes.empty())
    error->all(FLERR, "fix mdanim/contact: nothing can touch; write objects, or plane x|y|z lo|hi and its place");
}

std::vector<Keyword> FixMdanimContact::keywords()
{
  ContactSettings &settings = world_of_contact.settings;
  const auto number = [this](int at, const char *what, char **arg) {
    const double value = utils::numeric(FLERR, arg[at], false, lmp);
    if (!(value >= 0.0)) error->all(FLERR, at, "{}: {} must be at least 0, got {}", STYLE, what, arg[at]);
    return value;
  };
  const auto group = [this](NamedGroup &into) {
    return [this, &into](int at, char **arg) { into = NamedGroup(lmp, STYLE, at + 1, arg[at + 1]); };
  };
  const auto plane = [&settings, this](int at, char **arg) -> ContactPlane & {
    const int axis = choice(lmp, STYLE, "the axis of a plane is", {"x", "y", "z"}, at + 1, arg);
    const int upper = choice(lmp, STYLE, "the end of what is allowed at a plane is", {"lo", "hi"}, at + 2, arg);
    settings.planes.push_back({axis, upper ? -1.0 : 1.0, utils::numeric(FLERR, arg[at + 3], false, lmp)});
    return settings.planes.back();
  };
  return {{"objects", "", "", [&settings](int, char **) { settings.objects = true; }},
          {"plane", "x|y|z lo|hi at", "", [=](int at, char **arg) { plane(at, arg); }},
          {"moving", "x|y|z lo|hi at FIXID", "",
           [=, &settings, this](int at, char **arg) {
             plane(at, arg).moves = true;
             moving.add(static_cast<int>(settings.planes.size()) - 1, arg[at + 4]);
           }},
          {"stiffness", "f", "",
           [=, &settings, this](int at, char **arg) {
             settings.stiffness = number(at + 1, "stiffness", arg);
             if (settings.stiffness == 0.0)
               error->all(FLERR, at + 1, "{}: stiffness must be above 0, got {}; leave the fix out where nothing is to touch",
                          STYLE, arg[at + 1]);
           }},
          {"damping", "beta", "", [=, &settings](int at, char **arg) { settings.damping = number(at + 1, "damping", arg); }},
          {"pair", "MOL1 MOL2 mu beta", "",
           [=, &settings, this](int at, char **arg) {
             settings.pairs[two_molecules(lmp, STYLE, at + 1, arg)] = {number(at + 3, "mu of a pair", arg),
                                                                       number(at + 4, "beta of a pair", arg)};
           }},
          {"exclude", "MOL1 MOL2", "",
           [&settings, this](int at, char **arg) { settings.excluded.insert(two_molecules(lmp, STYLE, at + 1, arg)); }},
          {"belt", "MOL vx vy vz", "",
           [&settings, this](int at, char **arg) {
             const int id = utils::inumeric(FLERR, arg[at + 1], false, lmp);
             const auto along = [&](int k) { return utils::numeric(FLERR, arg[at + k], false, lmp); };
             settings.belts[id] = {along(2), along(3), along(4)};
           }},
          {"among", "GROUP", "", group(among)},
          {"except", "GROUP", "", group(except)},
          {"bodies", "FILE", "", [this](int at, char **arg) { read_bodies_of(arg[at + 1], lmp, bodies); }}};
}

// A rule for a molecule that does not exist is a mistake.
static void need_molecules_of(const ContactSettings &settings, const Fix *fix, LAMMPS *lmp)
{
  std::vector<int> with_laws, apart;
  for (const auto &[ids, law] : settings.pairs) with_laws.insert(with_laws.end(), {ids.first, ids.second});
  for (const auto &[a, b] : settings.excluded) apart.insert(apart.end(), {a, b});
  std::vector<int> with_belts;
  for (const auto &[id, velocity] : settings.belts) with_belts.push_back(id);
  need_molecules(fix, lmp, "pair", with_laws);
  need_molecules(fix, lmp, "exclude", apart);
  need_molecules(fix, lmp, "belt", with_belts);
}

int FixMdanimContact::setmask() { return POST_NEIGHBOR | POST_FORCE; }

void FixMdanimContact::take_body(int number, const ContactBodyArrays &arrays)
{ bodies[number] = std::make_shared<const ContactBody>(arrays); }

void FixMdanimContact::init()
{
  FixBase::init();
  need_molecules_of(world_of_contact.settings, this, lmp);
  moving.init(name());
  torn.init(lmp);
  threads_now = Threads();
  world_of_contact.use(nullptr, threads_now);    // until passes give those of their instructions
}

// --- objects ---

bool FixMdanimContact::is_among(int i) const { return !among.given() || atom->mask[i] & among.bit(); }

void FixMdanimContact::take_objects(Contacts contacts)
{
  kind.init(lmp);
  young.init(lmp);
  friction.init(lmp);
  std::vector<ContactObject> made;
  std::vector<char> moves;
  std::vector<tagint> ids;
  lowest.clear();
  const auto among_them = [this](int i) {
    if (is_among(i)) need_object(this, lmp, i, LEFT_OUT);
    return is_among(i);
  };
  for (const SurveyedObject &one : survey_objects(lmp, groupbit, except.bit(), {kind, young, friction}, among_them)) {
    const auto found = bodies.find(static_cast<int>(one.kind));
    if (found == bodies.end())
      error->all(FLERR, "{}: object {} (molecule ID) has body {}, and no such body was given", name(), one.id, one.kind);
    const ContactBody &body = *found->second;
    if (one.particles != body.particles())
      error->all(FLERR, "{}: object {} (molecule ID) has {} particles, its body {} has {}", name(), one.id, one.particles,
                 one.kind, body.particles());
    if (!(one.young > 0.0) || !(one.friction >= 0.0))
      error->all(FLERR, "{}: object {} (molecule ID) needs YOUNG > 0 and FRICTION >= 0, got {} and {}", name(), one.id, one.young,
                 one.friction);
    if (one.excepted != 0 && one.excepted != one.particles)
      error->all(
          FLERR,
          "{}: {} of the {} particles of object {} (molecule ID) are in the group that is excepted; it needs all of them or "
          "none",
          name(), one.excepted, one.particles, one.id);
    const double volume = body.edge(0) * body.edge(1) * body.edge(2);
    const double inertia = one.mass / force->ftm2v;    // the ratio of force to acceleration
    const double density = inertia / (volume * static_cast<double>(body.filled_cells()));
    made.push_back({one.id, found->second, one.young, one.friction, density, one.lowest, one.excepted != 0});
    moves.push_back(static_cast<char>(one.moves));
    ids.push_back(one.id);
    lowest.push_back(one.lowest);
  }
  if (contacts == Contacts::STAY)
    if (const ContactObject *one = world_of_contact.misfit(made))
      error->all(FLERR,
                 "{}: object {} (molecule ID) has {} than in the last run, and touches others: what contacts "
                 "remember does not fit; 'unfix' the fix and define it anew",
                 name(), one->id,
                 one->first_tag != world_of_contact.with_id(one->id)->first_tag ? "other particles" : "another body");
  objects.set(std::move(ids));
  world_of_contact.take(std::move(made), std::move(moves));
}

void FixMdanimContact::refuse_new_object(int i) const
{
  need_object(this, lmp, i, LEFT_OUT);
  error->one(FLERR,
             "{}: object {} (molecule ID) has come since the setup of this run, with particle {}; let it come "
             "between two runs, the second without 'pre no'{}",
             name(), atom->molecule[i], atom->tag[i], LEFT_OUT);
}

// --- lists, when LAMMPS rebuilds its own ---

void FixMdanimContact::setup_post_neighbor()
{
  take_objects(Contacts::STAY);
  if (restarted) {
    try {
      unpack(StateRecords(*restarted));
    } catch (const std::exception &problem) {
      error->all(FLERR, "{}: {}", name(), problem.what());
    }
  }
  torn.tell_all(world_of_contact);
  world_of_contact.forget();
  list();
}

void FixMdanimContact::post_neighbor() { list(); }

// Tells all ranks where rigid objects are, and sets the boxes of these.
void FixMdanimContact::place_rigid(std::vector<Box> &boxes)
{
  constexpr int N = RigidFrame::PARTICLES;
  std::vector<int> row(boxes.size(), -1);    // of an object's frame
  int rows = 0;
  for (int n = 0; n < objects.size(); ++n)
    if (world_of_contact.object(n).is_rigid()) row[n] = rows++;
  if (rows == 0) return;
  std::vector<Vec3> frames(N * rows, Vec3{Box::FAR, Box::FAR, Box::FAR});
  for (int i = 0; i < atom->nlocal; ++i) {
    const int n = objects[i];
    if (n < 0 || row[n] < 0) continue;
    const int k = world_of_contact.object(n).body->slot_of(static_cast<int>(atom->tag[i] - lowest[n]));
    if (k >= 0) frames[N * row[n] + k] = vec3(atom->x[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, &frames.data()->x, 3 * N * rows, MPI_DOUBLE, MPI_MIN, world);
  world_of_contact.place_rigid(frames, boxes);
}

// To where planes are in this step.
void FixMdanimContact::move_planes()
{
  moving.each(
      [this](int plane, const Vec3 &shift, const Vec3 &way) { world_of_contact.settings.planes[plane].move_to(shift, way); });
}

// Lowers extents by those of all particles: lower(i, extents) does so for one.
template <class Lower>
static void lower_by_all(const Threads &threads, int particles, std::vector<double> &extents, const Lower &lower)
{
  std::mutex one_at_a_time;
  threads.parts(particles, NS_OF_ZONES, [&](long from, long to) {
    std::vector<double> here(extents.size(), Box::FAR);
    for (long i = from; i < to; ++i) lower(static_cast<int>(i), here);
    const std::lock_guard<std::mutex> lock(one_at_a_time);
    for (std::size_t k = 0; k < here.size(); ++k) extents[k] = std::min(extents[k], here[k]);
  });
}

// Particles for which this holds, ascending.
template <class Holds> static std::vector<int> find_all(const Threads &threads, int particles, const Holds &holds)
{
  std::vector<char> found(particles);
  threads.parts(particles, NS_OF_ZONES, [&](long from, long to) {
    for (long i = from; i < to; ++i) found[i] = holds(static_cast<int>(i));
  });
  std::vector<int> all;
  for (int i = 0; i < particles; ++i)
    if (found[i]) all.push_back(i);
  return all;
}

void FixMdanimContact::list()
{
  const Lap lap(seconds);
  move_planes();
  moving.listed();
  const int nlocal = atom->nlocal;
  std::vector<Box> boxes =
      objects.place(*atom, world, [this](int i) { return is_among(i); }, [this](int i) { refuse_new_object(i); });
  place_rigid(boxes);
  world_of_contact.near.look_ahead(boxes, neighbor->skin);
  std::vector<double> extents = world_of_contact.near.initial_extents();
  if (!extents.empty()) {
    lower_by_all(threads_now, nlocal, extents, [this](int i, std::vector<double> &here) {
      if (world_of_contact.near.has_zones(objects[i])) world_of_contact.near.lower_extents(objects[i], vec3(atom->x[i]), here);
    });
    MPI_Allreduce(MPI_IN_PLACE, extents.data(), static_cast<int>(extents.size()), MPI_DOUBLE, MPI_MIN, world);
    world_of_contact.near.drop_separated_pairs(extents);
  }
  std::vector<std::pair<ContactParticle, int>> needed;    // and local indices
  const auto node = [this](int i) { return static_cast<int>(atom->tag[i] - lowest[objects[i]]); };
  const auto is_needed = [&](int i) {
    return world_of_contact.near.has_zones(objects[i]) && world_of_contact.near.needs({objects[i], node(i)}, vec3(atom->x[i]));
  };
  if (!world_of_contact.near.none())
    for (const int i : find_all(threads_now, nlocal, is_needed)) needed.push_back({{objects[i], node(i)}, i});
  if (!std::is_sorted(needed.begin(), needed.end())) std::sort(needed.begin(), needed.end());
  std::vector<ContactParticle> particles;
  mine.clear();
  for (const auto &[particle, i] : needed) particles.push_back(particle), mine.push_back(i);
  of_object = by_object(particles);
  const std::vector<ContactParticle> ascending = shared.share(particles);
  for (const ContactParticle &one : ascending)
    if (one.node < 0 || one.node >= world_of_contact.object(one.object).body->particles())
      error->all(FLERR, "{}: tags of object {} (molecule ID) do not follow each other", name(),
                 world_of_contact.object(one.object).id);
  world_of_contact.list(ascending, places_now());
}

// --- forces ---

void FixMdanimContact::need_lists() const
{
  if (!world_of_contact.is_listed())
    error->all(FLERR, "{}: its objects were read anew and no setup came after; leave out 'pre no' of this run", name());
}

// Places on all ranks, as LAMMPS has them.
Coordinates FixMdanimContact::places_now()
{
  my_places.make_room(mine.size());
  for (std::size_t n = 0; n < mine.size(); ++n) my_places.put(n, atom->x[mine[n]]);
  return shared.places(my_places.all());
}

// Calls add(n, force) for those of `mine` that may move.
template <class Add> void FixMdanimContact::give_forces(const Add &add) const
{
  each_pushed(world_of_contact, of_object, threads_now, [&](long n, long end) {
    for (; n < end; ++n) {
      const Vec3 &force = world_of_contact.forces()[shared.number_of(n)].value;
      if ((force.x != 0.0 || force.y != 0.0 || force.z != 0.0) && atom->mask[mine[n]] & groupbit) add(n, force);
    }
  });
}

// Adds forces with particles where LAMMPS has them.
void FixMdanimContact::push(double dt)
{
  const Lap lap(seconds);
  if (torn.tell(world_of_contact, [this] { return places_now(); })) list();
  need_lists();
  move_planes();
  world_of_contact.step(places_now(), dt);
  if (moving.any() && moving.needs_lists(0.5 * neighbor->skin)) next_reneighbor = update->ntimestep + 1;
  give_forces([this](std::size_t n, const Vec3 &force) { add_to(atom->f[mine[n]], force); });
}

void FixMdanimContact::setup(int)
{
  world_of_contact.account.deepest = 0.0;
  push(0.0);
}

void FixMdanimContact::post_force(int) { push(update->dt); }

void FixMdanimContact::append_required_atoms(std::vector<int> &particles) const
{ particles.insert(particles.end(), mine.begin(), mine.end()); }

void FixMdanimContact::add_forces(const Positions &place, const ForceSums &force)
{
  const Lap lap(seconds);
  need_lists();
  world_of_contact.step(shared.places(place.all()), update->dt);
  if (has_all)
    each_pushed(world_of_contact, of_object, threads_now,
                [&, all = world_of_contact.take_forces()](long first, long end) { force.take(first, end, all); });
  else
    give_forces([&force](std::size_t n, const Vec3 &one) { force.add(n, one); });
}

// Every rank needs the places of all that is near, so passes do this for one rank alone. A particle beside the group would not
// feel its contacts.
std::vector<PointsAtPlane> FixMdanimContact::hand_over_planes()
{
  const Lap lap(seconds);
  has_all = comm->nprocs == 1 && std::all_of(mine.begin(), mine.end(), [this](int i) { return atom->mask[i] & groupbit; });
  if (!has_all || world_of_contact.settings.objects) return {};
  need_lists();
  std::vector<PointsAtPlane> found = world_of_contact.hand_over_planes();
  for (PointsAtPlane &some : found)
    for (PointAtPlane &point : some.points) point.particle = mine[point.particle];
  return found;
}

void FixMdanimContact::take_back_planes(const std::vector<PointsAtPlane> &planes, double of_passes)
{
  const Lap lap(seconds);
  world_of_contact.take_back_planes(planes);
  seconds += of_passes;
}

// --- output ---

double FixMdanimContact::compute_scalar() { return world_of_contact.account.energy + world_of_contact.account.stick_energy; }

std::size_t FixMdanimContact::bytes_of_bodies() const
{
  std::size_t sum = 0;
  for (const auto &[number, body] : bodies) sum += body->bytes();
  return sum;
}

std::size_t FixMdanimContact::bytes_of_particles() const
{
  return world_of_contact.bytes_of_particles() + my_places.bytes() + shared.bytes() + objects.bytes() +
         mine.capacity() * sizeof(int) + of_object.capacity() * sizeof(OwnParticles);
}

double FixMdanimContact::memory_usage()
{ return static_cast<double>(bytes_of_bodies() + world_of_contact.bytes_of_fields() + bytes_of_particles()); }
