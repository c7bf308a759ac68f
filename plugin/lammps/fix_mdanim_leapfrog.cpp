// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/leapfrog: loops over the particles; the half steps are in leapfrog/law.h.

#include "lammps/fix_mdanim_leapfrog.h"
#include "lammps/keywords.h"
#include "lammps/object_table.h"

#include "leapfrog/law.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "output.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/leapfrog";
static constexpr int RESTART_VERSION = 1;
static constexpr int CHUNK = 1024;    // particles whose sums are one chain
static constexpr double NS_OF_CHUNK = 2.0 * CHUNK;

FixMdanimLeapfrog::FixMdanimLeapfrog(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg)
{
  time_integrate = 1;
  dynamic_group_allow = 1;
  restart_global = 1;
  comm_forward = 3;
  need(THREE_DIMENSIONS);
  look_up({}, {&lambda});
  tell({{"phi", false, [this] { return largest(largest_phi); }}, {"kinetic", true, [this] { return sum(kinetic()); }}, clock()});

  int drag_word = 0;
  const std::vector<Keyword> known = {{"lambda", "L|d_NAME", "",
                                       [&, this](int at, char **arg) {
                                         lambda = ParticleValue(lmp, "fix mdanim/leapfrog: lambda", at + 1, arg[at + 1]);
                                         has_drag = true;
                                       }},
                                      {"drag", "implicit|exp", "", [&, this](int at, char **arg) {
                                         drag_word = at;
                                         exponential = choice(lmp, STYLE, "drag must be", {"implicit", "exp"}, at + 1, arg) == 1;
                                       }}};
  for (int iarg = 3; iarg < narg;) iarg += take_keyword(lmp, STYLE, known, iarg, narg, arg);
  if (drag_word && !has_drag)
    error->all(FLERR, drag_word, "fix mdanim/leapfrog: drag says how lambda is used, but there is no lambda; add one");
}

int FixMdanimLeapfrog::setmask() { return INITIAL_INTEGRATE | FINAL_INTEGRATE; }

void FixMdanimLeapfrog::init()
{
  FixBase::init();
  reset_dt();
  largest_phi = 0.0;
}

// (1-phi)/(1+phi) changes sign at phi = 1: strongly damped particles then jitter instead of creeping.
void FixMdanimLeapfrog::setup(int)
{
  bent = 0.0;
  told = true;
  if (!has_drag || exponential) return;
  const double phi = largest(largest_phi_here());
  if (phi > 0.5 && comm->me == 0)
    error->warning(FLERR,
                   "{}: phi = lambda dt/2m reaches {:.3g}; above 0.5 use drag exp or a "
                   "smaller time step",
                   name(), phi);
}

void FixMdanimLeapfrog::reset_dt() { half_dt = 0.5 * update->dt * force->ftm2v; }

double FixMdanimLeapfrog::largest_phi_here() const
{
  const double *own = lambda.values(lmp);
  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit)
      largest = std::max(largest, (own ? own[i] : lambda.number) * half_dt / mass_of(atom->rmass, atom->mass, atom->type, i));
  return largest;
}

// Calls visit(i, sums) for the particles that move now. Each chunk has sums of its own, which are added in order: they do not
// depend on threads.
template <class Visit> FixMdanimLeapfrog::Sums FixMdanimLeapfrog::each(Visit visit) const
{
  const int *const mask = atom->mask, *const listed = only ? only->data() : nullptr;
  const int moving = only ? static_cast<int>(only->size()) : atom->nlocal;
  std::vector<Sums> of_chunk((moving + CHUNK - 1) / CHUNK);
  threads.parts(static_cast<long>(of_chunk.size()), NS_OF_CHUNK, [&](long begin, long end) {
    for (long k = begin; k < end; ++k) {
      const int first = static_cast<int>(k) * CHUNK;
      Sums sums;
      for (int n = first; n < std::min(first + CHUNK, moving); ++n)
        if (const int i = listed ? listed[n] : n; mask[i] & groupbit) visit(i, sums);
      of_chunk[k] = sums;
    }
  });
  Sums all;
  for (const Sums &sums : of_chunk) all.add(sums);
  return all;
}

// Without drag both halves are v <- v + dt/2m F.
template <bool FIRST> void FixMdanimLeapfrog::half_step()
{
  const Lap lap(seconds);
  if (!has_drag) {
    double *const *v = atom->v, *const *f = atom->f;
    const double *rmass = atom->rmass, *mass = atom->mass;
    const int *type = atom->type;
    each([&](int i, Sums &) { add_to(v[i], half_dt / mass_of(rmass, mass, type, i) * vec3(f[i])); });
  } else if (exponential) {
    half_step_with_drag<FIRST, Exponential<double>>();
  } else {
    half_step_with_drag<FIRST, Implicit<double>>();
  }
}

template <bool FIRST, class Drag> void FixMdanimLeapfrog::half_step_with_drag()
{
  double *const *v = atom->v, *const *f = atom->f;
  const double *rmass = atom->rmass, *mass = atom->mass, *own = lambda.values(lmp);
  const int *type = atom->type;
  const Sums all = each([&](int i, Sums &sums) {
    const double m = mass_of(rmass, mass, type, i), kick = half_dt / m;
    const double phi = (own ? own[i] : lambda.number) * kick;
    if (phi == 0.0) {    // the same bits, for particles out of the liquid
      add_to(v[i], kick * vec3(f[i]));
      return;
    }
    const Vec3 before = vec3(v[i]), push = vec3(f[i]);
    const Drag drag = Drag::of(phi, kick);
    const Vec3 after = FIRST ? drag.first_half(before, push) : drag.final_half(before, push);
    v[i][0] = after.x;
    v[i][1] = after.y;
    v[i][2] = after.z;
    sums.loss += drag.loss(before, after, push, m, FIRST);
    sums.largest_phi = std::max(sums.largest_phi, phi);
  });
  lost += force->mvv2e * all.loss;
  largest_phi = std::max(largest_phi, all.largest_phi);
}

// v^n -> v^{n+1/2}, then r^{n+1} = r^n + dt v^{n+1/2}: the end of eq. (3.12).
void FixMdanimLeapfrog::initial_integrate(int)
{
  half_step<true>();
  told = tells_of(update->ntimestep);
  if (told) bent = -bend();
  drift();
}

void FixMdanimLeapfrog::drift()
{
  const Lap lap(seconds);
  if (!trace.empty() && !only) {
    drift_and_trace();
    return;
  }
  double *const *x = atom->x, *const *v = atom->v;
  const double dt = update->dt;
  each([&](int i, Sums &) { add_to(x[i], dt * vec3(v[i])); });
}

// The box in which the object of a particle has been. Its molecule ID may have changed since the trace was started.
FixMdanimLeapfrog::Way &FixMdanimLeapfrog::way_of(int i)
{
  const tagint object = atom->molecule[i];
  if (object < 1 || object > traced())
    error->one(FLERR,
               "{}: particle {} has molecule ID {}, but objects 1 to {} are traced; molecule IDs must stay as "
               "they were when the trace was started (mdanim_trace_start)",
               name(), atom->tag[i], object, traced());
  return trace[object - 1];
}

// The same, and the box of each object grows to the present places of its particles. Those of an object mostly stand side by
// side: their box stays in registers until the object changes.
void FixMdanimLeapfrog::drift_and_trace()
{
  double *const *x = atom->x, *const *v = atom->v;
  const tagint *molecule = atom->molecule;
  const int *mask = atom->mask, nlocal = atom->nlocal;
  const double dt = update->dt;
  for (int i = 0; i < nlocal;) {
    const tagint object = molecule[i];
    Way &way = way_of(i);
    Box box;
    for (; i < nlocal && molecule[i] == object; ++i) {
      if (mask[i] & groupbit)
        add_to(x[i], dt * vec3(v[i]));
      else if (v[i][0] == 0.0 && v[i][1] == 0.0 && v[i][2] == 0.0)
        continue;    // it does not move: its place is in the box already
      box.include(x[i]);
    }
    way.box.unite(box);
  }
  not_seen = 0;
}

bool FixMdanimLeapfrog::looks()
{
  if (++not_seen < look_after) return false;
  not_seen = 0;
  return true;
}

std::string FixMdanimLeapfrog::start_trace(int objects)
{
  if (!atom->molecule_flag) return NO_OBJECTS;
  const auto [first, last] = std::minmax_element(atom->molecule, atom->molecule + atom->nlocal);
  tagint bounds[2] = {objects, -1};    // the largest ID, and the smallest with its sign changed
  if (atom->nlocal) bounds[0] = *last, bounds[1] = -*first;
  MPI_Allreduce(MPI_IN_PLACE, bounds, 2, MPI_LMP_TAGINT, MPI_MAX, world);
  if (bounds[0] > objects || -bounds[1] < 1)
    return fmt::format("molecule IDs go from {} to {}, they must be within 1 and the {} objects to trace", -bounds[1], bounds[0],
                       objects);
  trace.assign(objects, Way());
  for (int i = 0; i < atom->nlocal; ++i) way_of(i).box.include(atom->x[i]);
  look_after = 1;
  not_seen = 0;
  return "";
}

std::vector<Box> FixMdanimLeapfrog::traced_boxes() const
{
  static_assert(sizeof(Way) == TRACE * sizeof(double), "rows of passes, and what goes over the wire");
  std::vector<Way> all(trace.size());
  MPI_Allreduce(trace.data(), all.data(), TRACE * traced(), MPI_DOUBLE, MPI_MIN, world);
  std::vector<Box> boxes;
  for (const Way &way : all) boxes.push_back(way.box.grown((look_after - 1) * update->dt * std::sqrt(-way.fastest)));
  return boxes;
}

// v^{n-1/2} -> v^n, eq. (3.10).
void FixMdanimLeapfrog::final_integrate()
{
  if (told) bent += bend();
  half_step<false>();
}

// --- together with run_style verlet/mdanim ---

Friction FixMdanimLeapfrog::friction() const
{
  if (!has_drag) return Friction::NONE;
  return exponential ? Friction::EXPONENTIAL : Friction::IMPLICIT;
}

Mover FixMdanimLeapfrog::mover(int i)
{
  if (!(atom->mask[i] & groupbit)) return {0.0, 0.0, 0.0, 0.0, 0.0, false};
  const double mass = mass_of(atom->rmass, atom->mass, atom->type, i), kick = half_dt / mass, *own = lambda.values(lmp);
  const double phi = has_drag ? (own ? own[i] : lambda.number) * kick : 0.0;
  return {0.0, mass, kick, update->dt, phi, false};
}

std::vector<PassIntegrator::Known> FixMdanimLeapfrog::survey_ghosts(std::vector<int> &those_sent)
{
  sent.clear();
  known.resize(atom->nlocal + atom->nghost);
  for (int i = 0; i < atom->nlocal; ++i) known[i] = {atom->molecule_flag ? atom->molecule[i] : 1, {comm->me, i}};
  comm->forward_comm(this);
  std::sort(sent.begin(), sent.end());
  those_sent.assign(sent.begin(), std::unique(sent.begin(), sent.end()));
  return std::exchange(known, {});
}

int FixMdanimLeapfrog::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  int m = 0;
  for (int k = 0; k < n; ++k) {
    if (list[k] < atom->nlocal) sent.push_back(list[k]);    // other ranks pass ghosts on
    const Known &one = known[list[k]];
    buf[m++] = static_cast<double>(one.object);
    buf[m++] = static_cast<double>(one.home.rank);
    buf[m++] = static_cast<double>(one.home.index);
  }
  return m;
}

void FixMdanimLeapfrog::unpack_forward_comm(int n, int first, double *buf)
{
  for (int i = first; i < first + n; ++i, buf += 3)
    known[i] = {static_cast<int>(buf[0]), {static_cast<int>(buf[1]), static_cast<int>(buf[2])}};
}

void FixMdanimLeapfrog::finish_step(const std::vector<int> &particles)
{
  only = &particles;
  half_step<false>();
  only = nullptr;
}

void FixMdanimLeapfrog::begin_step(const std::vector<int> &particles)
{
  only = &particles;
  half_step<true>();
  if (told) bent -= bend();
  drift();
  only = nullptr;
  if (!trace.empty())
    for (const int i : particles)
      if (atom->mask[i] & groupbit) way_of(i).box.include(atom->x[i]);
}

void FixMdanimLeapfrog::moved(double loss, double bend, double phi, double more_seconds)
{
  largest_phi = std::max(largest_phi, phi);
  told = tells_of(update->ntimestep + 1);
  bent = -bend;
  lost += force->mvv2e * loss;
  seconds += more_seconds;
}

// --- energy ---

bool FixMdanimLeapfrog::tells_of(long long step) const { return step == output->next; }

// dt v . F of the particles that move now.
double FixMdanimLeapfrog::bend() const
{
  return each([&](int i, Sums &sums) { sums.bend += update->dt * dot(vec3(atom->v[i]), vec3(atom->f[i])); }).bend;
}

// Kinetic energy of this rank's particles, corrected so that the sum of all energies is conserved by leap-frog to fourth order in
// dt. It is T + U + dt^2 (v . U'' v / 12 - F . F / 24 m), the energy of the nearby system whose exact motion the steps are
// (Hairer, Lubich & Wanner, Geometric Numerical Integration, IX.3). Without the correction a vibration of frequency w seems to
// hold (w dt)^2/24 too little, and an impact to lose the energy that goes into vibrations. U'' v is (F^{n-1} - F^n) / dt, and v
// the velocity between these two steps.
double FixMdanimLeapfrog::kinetic()
{
  if (!told)
    error->all(FLERR,
               "{}: kinetic energy, f_{}[2], is worked out in steps with output alone; ask for it in "
               "these, as thermo_style does",
               name(), id);
  const Sums all = each([&](int i, Sums &sums) {
    const double mass = mass_of(atom->rmass, atom->mass, atom->type, i);
    const Vec3 v = vec3(atom->v[i]), f = vec3(atom->f[i]);
    sums.kinetic += 0.5 * mass * dot(v, v);
    sums.swing += half_dt / mass * update->dt * dot(f, f);
  });
  return force->mvv2e * all.kinetic - (all.swing + bent) / 12.0;
}

double FixMdanimLeapfrog::compute_scalar() { return sum(lost); }

void FixMdanimLeapfrog::write_restart(FILE *fp)
{
  const double list[2] = {RESTART_VERSION, compute_scalar()};
  if (comm->me != 0) return;
  const int size = sizeof list;
  fwrite(&size, sizeof size, 1, fp);
  fwrite(list, sizeof list, 1, fp);
}

void FixMdanimLeapfrog::restart(char *buffer)
{
  double list[2];
  memcpy(list, buffer, sizeof list);
  if (list[0] != RESTART_VERSION)
    error->all(FLERR, "fix mdanim/leapfrog: restart state has version {}, {} is needed", list[0], RESTART_VERSION);
  lost = comm->me == 0 ? list[1] : 0.0;
}
