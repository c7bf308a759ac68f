// SPDX-License-Identifier: GPL-2.0-only
// Loops over particles; the laws are in buoyancy/law.h, the surface in liquid/basin.h.

#include "lammps/buoyancy.h"

#include "numbers/stopwatch.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fmt/format.h"
#include "force.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace mdanim {

static constexpr const char *STYLE = "fix mdanim/liquid";
static constexpr double PARTICLE = 25.0;    // or lattice cell [ns], approximately

// --- the command ---

std::vector<Keyword> Buoyancy::keywords()
{
  const auto value = [this](ParticleValue &into, bool &given) {
    return [this, &into, &given](int at, char **arg) {
      into = ParticleValue(lmp, fmt::format("{}: {}", STYLE, arg[at]).c_str(), at + 1, arg[at + 1]);
      given = true;
    };
  };
  const auto column = [this](ParticleColumn &into) {
    return [this, &into](int at, char **arg) { into = ParticleColumn(lmp, STYLE, arg[at], at + 1, arg[at + 1]); };
  };
  return {{"buoyancy", "V|d_NAME", "", value(volume, lifts)},
          {"drag", "gamma|d_NAME", "", value(gamma, slows)},
          {"quadratic", "k|d_NAME", "", value(per_length, is_quadratic)},
          {"lambda", "d_NAME", "", column(lambda_column)},
          {"base", "d_NAME", "", column(base_column)}};
}

void Buoyancy::init(const std::string &fix)
{
  if (slows && !lambda_column.given())
    error->all(FLERR, "{}: drag needs lambda d_NAME, the property that fix mdanim/leapfrog reads", fix);
  if (!slows && (lambda_column.given() || base_column.given()))
    error->all(FLERR, "{}: lambda and base say where drag goes, but there is no drag; add one", fix);
  if (is_quadratic && !slows) error->all(FLERR, "{}: quadratic is a part of drag; add drag, 0 for no other part", fix);
  if (slows && !lifts) error->all(FLERR, "{}: drag acts on the volume of particles, which buoyancy gives; add buoyancy", fix);
  if (lifts) volume.init(lmp);
  if (slows) gamma.init(lmp);
  if (is_quadratic) per_length.init(lmp);
}

// --- data that depend on lists ---

void Buoyancy::clear_friction(int groupbit) const
{
  if (!slows) return;
  double *const lambda = lambda_column.values(lmp);
  const double *const base = base_column.given() ? base_column.values(lmp) : nullptr;
  for (int i = 0; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit) lambda[i] = base ? base[i] : 0.0;
}

// --- an update of the liquid ---

void Buoyancy::give_impulses(Basin &basin, const std::vector<int> &near)
{
  if (!basin.acts_on_cells() || !lifts) return;
  const double *const volumes = volume.values(lmp);
  for (const int i : near) {
    InLiquid &of = kept[i];
    if (const Vec3 along{of.waves.small[ALONG_X], of.waves.small[ALONG_Y], 0.0}; along.x != 0.0 || along.y != 0.0)
      basin.take_push((volumes ? volumes[i] : volume.number) * along);
    if (of.impulse_x == 0.0 && of.impulse_y == 0.0) continue;
    basin.take_impulse(basin.in_cells(atom->x[i]), {of.impulse_x, of.impulse_y, 0.0});
    of.impulse_x = of.impulse_y = 0.0;
  }
}

void Buoyancy::look(const Basin &basin, const std::vector<int> &near)
{
  if (!basin.acts_on_cells() || !lifts || near.empty()) return;
  const Lap lap(seconds);
  const double *const *x = atom->x;
  on_parts.resize(cells.cells.size());
  threads.parts(static_cast<long>(on_parts.size()), PARTICLE, [&](long from, long to) {
    for (long n = from; n < to; ++n) {
      Vec3 sum;
      for (const int corner : cells.cells[n].corner) sum += vec3(x[corner]);
      const double middle[3] = {0.125 * sum.x, 0.125 * sum.y, 0.125 * sum.z};
      on_parts[n] = basin.on_parts(basin.in_cells(middle));
    }
  });
  threads.parts(static_cast<long>(near.size()), PARTICLE, [&](long from, long to) {
    for (long n = from; n < to; ++n)
      kept[near[n]] = atom->mask[near[n]] & standing ? InLiquid{} : look_at_particle(basin, n, x[near[n]]);
  });
}

// The mean of the values of its parts of lattice cells. Until the next update s is a straight line between its values where the
// particle and all others around it have gone up or down as far as an update allows.
InLiquid Buoyancy::look_at_particle(const Basin &basin, std::size_t n, const double *x) const
{
  const double per_height = 1.0 / basin.shape.cell.z, z = (x[2] - basin.shape.low.z) * per_height, far = basin.pace.stride;
  InWaves<double> mean;
  double s = 0.0, lower = 0.0, higher = 0.0;
  int parts = 0;
  cells.each_of(n, [&](int cell) {
    const Basin::OnParts &on = on_parts[cell];
    const double here = on.part_below(z), beside = std::max(0.0, here + on.beside);
    ++parts;
    s += here;
    lower += on.part_below(z - 2.0 * far);    // the middle of the cell moves as far as the corner
    higher += on.part_below(z + 2.0 * far);
    mean.small[MORE] += on.more;
    mean.small[ALONG_X] += on.along_x * beside;
    mean.small[ALONG_Y] += on.along_y * beside;
    mean.small[FLOW_X] += on.flow_x;
    mean.small[FLOW_Y] += on.flow_y;
  });
  if (parts == 0) return {};
  const double part = 1.0 / parts;
  for (double &value : mean.small) value *= part;
  mean.exact[SLOPE] = part * (lower - higher) / (2.0 * far) * per_height;
  mean.exact[BASE] = part * s + mean.exact[SLOPE] * x[2];
  if (mean.acts()) mean.small[RISING] = basin.rising_at(basin.in_cells(x));
  return {mean.rounded()};
}

// --- a step ---

bool Buoyancy::acts_in_passes(bool has_friction, const double *lambda) const
{ return lifts && (slows ? lambda == lambda_column.values(lmp) : lambda || !has_friction); }

std::function<Immersed<double>(int)> Buoyancy::immersed(const std::vector<char> &is_near, const double *lambda) const
{
  const auto of = [this](const ParticleValue &value) {
    return [values = value.values(lmp), number = value.number](int i) { return values ? values[i] : number; };
  };
  const double *const dry = slows ? (base_column.given() ? base_column.values(lmp) : nullptr) : lambda;
  return [=, &is_near, volume = of(volume), gamma = of(gamma), per_length = of(per_length)](int i) -> Immersed<double> {
    const double mass = mass_of(atom->rmass, atom->mass, atom->type, i);
    if (!is_near[i]) return {{0.0, mass, 0.0, 0.0, lambda ? lambda[i] : 0.0, 0.0}};
    return {{volume(i), mass, slows ? gamma(i) : 0.0, is_quadratic ? per_length(i) : 0.0, dry ? dry[i] : 0.0, 1.0}};
  };
}

// Nothing is immersed from `above` up, and all from `below` down: most particles of a large body need not look up the surface.
struct Buoyancy::Surface {
  explicit Surface(const Basin &of) : basin(of), above(of.height(of.top() + 1.0)), below(of.all_below()) {}
  double part_below(const double *x) const
  {
    if (!(x[2] < above)) return 0.0;
    return x[2] <= below && basin.over_floor(x) ? 1.0 : basin.part_below(basin.in_cells(x));
  }

 private:
  const Basin &basin;
  const double above, below;
};

void Buoyancy::parts_below(const Basin &basin, const double *const *x, int first, int many, double *part) const
{
  const Surface surface(basin);
  for (int i = first; i < first + many; ++i) {
    const double place[3] = {x[0][i], x[1][i], x[2][i]};
    *part++ = surface.part_below(place);
  }
}

double Buoyancy::weight(const Basin &basin) const { return basin.g / force->ftm2v; }

LiquidScales Buoyancy::scales(const Basin &basin, bool in_step) const
{
  return {rho,
          weight(basin),
          basin.calms_solids(),
          1.0 / force->ftm2v,
          in_step && basin.acts_on_cells() ? update->dt * force->ftm2v / rho : 0.0,
          is_quadratic};
}

// Values that are the same for all particles.
struct Buoyancy::Acting {
  LiquidScales liquid;
  const double *const *x, *const *v;
  double *const *f;
  const double *volume, *gamma, *per_length, *base;
  double *lambda;
  InLiquid *kept;    // nullptr where the surface is evaluated in each step
  Surface surface;
};

__attribute__((always_inline)) inline Buoyancy::Wet Buoyancy::act_on(const Acting &now, int i)
{
  if (atom->mask[i] & standing) return {i, {}, 0.0};
  const double *const x = now.x[i];
  Basin::AtPlace at;
  if (now.kept)
    at = now.kept[i].waves.at(x[2]);
  else
    at.immersed = at.push.z = now.surface.part_below(x);
  const Immersed<double> particle{{now.volume ? now.volume[i] : volume.number, mass_of(atom->rmass, atom->mass, atom->type, i),
                                   now.gamma ? now.gamma[i] : gamma.number,
                                   now.per_length ? now.per_length[i] : per_length.number}};
  auto force = liquid_force(now.liquid, particle, at, vec3(now.v[i]));
  if (atom->mask[i] & driven) {
    force.push -= force.lambda * vec3(now.v[i]);
    force.lambda = 0.0;
  }
  if (now.lambda) now.lambda[i] = (now.base ? now.base[i] : 0.0) + force.lambda;
  if (now.kept) {
    now.kept[i].impulse_x += force.impulse_x;
    now.kept[i].impulse_y += force.impulse_y;
  }
  add_to(now.f[i], force.push);
  return {i, force.push, force.lambda};
}

// Threads share particles. The forces of all particles on the liquid and their parts in the ledger are added up in the order of
// particles.
void Buoyancy::act(const Basin &basin, const std::vector<int> &these, bool in_step)
{
  wet.resize(lifts ? these.size() : 0);
  if (wet.empty()) return;
  const Lap lap(seconds);
  const Acting now{scales(basin, in_step),
                   atom->x,
                   atom->v,
                   atom->f,
                   volume.values(lmp),
                   slows ? gamma.values(lmp) : nullptr,
                   is_quadratic ? per_length.values(lmp) : nullptr,
                   base_column.given() ? base_column.values(lmp) : nullptr,
                   slows ? lambda_column.values(lmp) : nullptr,
                   basin.acts_on_cells() ? kept.data() : nullptr,
                   Surface(basin)};
  threads.parts(static_cast<long>(these.size()), PARTICLE, [&](long from, long to) {
    for (long n = from; n < to; ++n) wet[n] = act_on(now, these[n]);
  });
}

// --- the ledger ---

// Power of the lift, and power that drag takes, at the present velocities.
Basin::Energies Buoyancy::power() const
{
  constexpr std::size_t CHUNK = 1024;    // of particles, with sums of its own
  constexpr double NS_OF_CHUNK = 4e3;
  std::vector<Basin::Energies> of_chunk((wet.size() + CHUNK - 1) / CHUNK);
  threads.parts(static_cast<long>(of_chunk.size()), NS_OF_CHUNK, [&](long from, long to) {
    for (long k = from; k < to; ++k) {
      Basin::Energies sum;
      for (std::size_t n = k * CHUNK; n < std::min(wet.size(), (k + 1) * CHUNK); ++n) {
        const Vec3 v = vec3(atom->v[wet[n].i]);
        sum.work += dot(wet[n].push, v);
        sum.lost += wet[n].lambda * dot(v, v);
      }
      of_chunk[k] = sum;
    }
  });
  Basin::Energies now = in_passes;
  for (const Basin::Energies &sum : of_chunk) {
    now.work += sum.work;
    now.lost += sum.lost;
  }
  return now;
}

void Buoyancy::add_power(const Basin::Energies &of_passes, double more_seconds)
{
  in_passes = of_passes;
  seconds += more_seconds;
}

void Buoyancy::begin_ledger()
{
  if (!ledger_was_set) own.power = power();
  ledger_was_set = false;
}

// Velocities are those of whole steps here, eq. (3.10), the means of the half steps before and after: the trapezoidal rule gives
// the work exactly.
void Buoyancy::go_on_with_ledger()
{
  if (wet.empty() && in_passes.work == 0.0 && in_passes.lost == 0.0 && own.power.work == 0.0 && own.power.lost == 0.0) return;
  const Lap lap(seconds);
  const Basin::Energies now = power();
  own.sum.work += 0.5 * update->dt * (own.power.work + now.work);
  own.sum.lost += 0.5 * update->dt * (own.power.lost + now.lost);
  own.power = now;
  in_passes = {};
}

Basin::Ledger Buoyancy::ledger() const
{
  double all[] = {own.sum.work, own.sum.lost, own.power.work, own.power.lost};
  MPI_Allreduce(MPI_IN_PLACE, all, 4, MPI_DOUBLE, MPI_SUM, world);
  return {{all[0], all[1]}, {all[2], all[3]}};
}

void Buoyancy::set_ledger(const Basin::Ledger &ledger)
{
  own = comm->me == 0 ? ledger : Basin::Ledger{};
  ledger_was_set = true;
}

}    // namespace mdanim
