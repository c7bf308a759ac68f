// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions over waves, for tests and benchmarks. Solid parts of cells are (ny, nx, nz), owners of cells (nz, ny, nx),
// columns (ny, nx).

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "simd/kernels.h"
#include "waves_probe.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <ctime>

using mdanim::guarded;
using mdanim::Waves;
using mdanim::WavesProbe;

static Waves &waves(void *w) { return *static_cast<Waves *>(w); }

// Null, with a message, where there is no memory for it.
MDANIM_EXPORT void *mdanim_waves_new(int nx, int ny, int nz, char *error, int error_size)
{
  Waves *made = nullptr;
  guarded(error, error_size, [&] { made = new Waves(nx, ny, nz); });
  return made;
}

MDANIM_EXPORT void mdanim_waves_free(void *w) { delete &waves(w); }

// False for a name that is none. `calm_time` sets the rate `calm`.
MDANIM_EXPORT int mdanim_waves_set(void *w, const char *name, double value)
{
  Waves &it = waves(w);
  if (std::strcmp("calm_time", name) == 0) {
    it.run.law.calm = mdanim::calm_rate(value);
    return 1;
  }
  const struct {
    const char *name;
    double *value;
  } all[] = {{"viscosity", &it.run.law.viscosity},
             {"calm", &it.run.law.calm},
             {"bed", &it.run.law.bed},
             {"inertia", &it.run.law.inertia},
             {"quick", &it.run.law.quick},
             {"breaking", &it.run.law.breaking},
             {"overfull", &it.run.law.overfull},
             {"mean_over", &it.run.law.mean_over},
             {"tolerance", &it.run.tolerance},
             {"rest", &it.run.rest}};
  for (const auto &one : all)
    if (std::strcmp(one.name, name) == 0) {
      *one.value = value;
      return 1;
    }
  return 0;
}

// False where this processor lacks the instruction set of this number.
// Kernels of a number, the widest first; 0 where this processor has not so many sets of instructions.
MDANIM_EXPORT int mdanim_waves_use(void *w, int number)
{
  const auto &here = mdanim::kernels_here();
  if (number >= static_cast<int>(here.size())) return 0;
  waves(w).use(here[number]->waves);
  return 1;
}

// Updates by so many threads, of which each takes one row or more.
MDANIM_EXPORT void mdanim_waves_threads(void *w, int threads) { waves(w).use(mdanim::Threads(threads)); }

MDANIM_EXPORT void mdanim_waves_use_general_form(void *w) { WavesProbe(waves(w)).use_general_form(); }

// 0, or 1 with a message.
MDANIM_EXPORT int mdanim_waves_solids(void *w, const std::uint16_t *part, const double *mass, char *error, int error_size)
{
  int failed = 1;
  guarded(error, error_size, [&] {
    waves(w).set_solids(part, mass);
    failed = 0;
  });
  return failed;
}

// `from` null: from the floor.
MDANIM_EXPORT void mdanim_waves_pour(void *w, const double *height, const double *from) { waves(w).pour(height, from); }

MDANIM_EXPORT void mdanim_waves_set_velocities(void *w, const double *u) { WavesProbe(waves(w)).set_velocities(u); }

// Returns the processor's time in seconds.
MDANIM_EXPORT double mdanim_waves_update(void *w, double dt, int count)
{
  const std::clock_t start = std::clock();
  for (int n = 0; n < count; ++n) waves(w).update(dt);
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

MDANIM_EXPORT int mdanim_waves_at_rest(void *w) { return waves(w).at_rest(); }

MDANIM_EXPORT std::int64_t mdanim_waves_total(void *w) { return waves(w).total(); }

MDANIM_EXPORT int mdanim_waves_count_spans(void *w) { return static_cast<int>(WavesProbe(waves(w)).spans().size()); }

MDANIM_EXPORT int mdanim_waves_count_links(void *w) { return static_cast<int>(WavesProbe(waves(w)).links().size()); }

// Columns, cells from and to, whether they are full: four numbers for each; floor, roof, head, phi; content.
MDANIM_EXPORT void mdanim_waves_spans(void *w, int *numbers, double *heights, std::int64_t *content)
{
  for (const WavesProbe::SpanNow &now : WavesProbe(waves(w)).spans()) {
    for (const int number : {now.span.column, now.span.low, now.span.high, now.full ? 1 : 0}) *numbers++ = number;
    for (const double height : {now.span.floor, now.span.roof, now.head, now.phi}) *heights++ = height;
    *content++ = now.content;
  }
}

// Spans, and direction: three numbers for each; velocity, wetted height; units that passed.
MDANIM_EXPORT void mdanim_waves_links(void *w, int *numbers, double *values, std::int64_t *units)
{
  for (const WavesProbe::LinkNow &now : WavesProbe(waves(w)).links()) {
    for (const int number : {now.a, now.b, now.direction}) *numbers++ = number;
    for (const double value : {now.u, now.height}) *values++ = value;
    *units++ = now.units;
  }
}

MDANIM_EXPORT std::int64_t mdanim_waves_state_size(void *w) { return static_cast<std::int64_t>(waves(w).state().size()); }

MDANIM_EXPORT void mdanim_waves_state(void *w, std::uint8_t *bytes)
{
  const std::vector<std::uint8_t> state = waves(w).state();
  std::copy(state.begin(), state.end(), bytes);
}

// 0, or 1 with a message.
MDANIM_EXPORT int mdanim_waves_set_state(void *w, const std::uint8_t *bytes, std::int64_t size, char *error, int error_size)
{
  int failed = 1;
  guarded(error, error_size, [&] {
    waves(w).set_state(bytes, static_cast<std::size_t>(size));
    failed = 0;
  });
  return failed;
}

MDANIM_EXPORT void mdanim_waves_surface(void *w, double *head, double *volume) { WavesProbe(waves(w)).surface(head, volume); }

MDANIM_EXPORT void mdanim_waves_add_forces(void *w, const std::int32_t *owner, double *force)
{ WavesProbe(waves(w)).add_forces(owner, force); }

MDANIM_EXPORT void mdanim_waves_walls(void *w, const std::uint16_t *held) { waves(w).set_walls(held); }

MDANIM_EXPORT void mdanim_waves_add_impulse(void *w, const double *x, const double *y) { waves(w).exchange.add_impulse(x, y); }

// Momentum now; what was lost, and what came, since this was asked last; each along x and y.
MDANIM_EXPORT void mdanim_waves_momenta(void *w, double *momenta)
{
  for (const mdanim::Vec3 &of : {waves(w).momentum(), waves(w).take_lost(), waves(w).take_came()}) {
    *momenta++ = of.x;
    *momenta++ = of.y;
  }
}

MDANIM_EXPORT void mdanim_waves_energy(void *w, double *height_and_motion)
{
  const Waves::Energy energy = waves(w).energy();
  height_and_motion[0] = energy.height;
  height_and_motion[1] = energy.motion;
}

MDANIM_EXPORT void mdanim_waves_counts(void *w, std::int64_t *counts)
{
  const mdanim::WaveRun::Counts &c = waves(w).run.counts;
  for (const std::int64_t count : {std::int64_t{c.updates}, std::int64_t{c.sub_updates}, std::int64_t{c.solutions},
                                   std::int64_t{c.iterations}, std::int64_t{c.limited}, c.displaced})
    *counts++ = count;
}
