// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions over drops and over the makers of waves, for tests.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "liquid/waves/drops.h"
#include "liquid/waves/wave_makers.h"
#include "liquid/waves/waves.h"

#include <algorithm>
#include <cstdint>

using mdanim::Drops;
using mdanim::guarded;
using mdanim::WaveMakers;
using mdanim::Waves;

static Waves &waves(void *w) { return *static_cast<Waves *>(w); }
static Drops &drops(void *d) { return *static_cast<Drops *>(d); }
static WaveMakers &makers(void *m) { return *static_cast<WaveMakers *>(m); }

MDANIM_EXPORT void *mdanim_drops_new(int nx, int ny, double share, std::int64_t most)
{
  auto *made = new Drops(nx, ny, 7);
  made->share = share;
  made->most = static_cast<std::size_t>(most);
  return made;
}

MDANIM_EXPORT void mdanim_drops_free(void *d) { delete &drops(d); }

MDANIM_EXPORT void mdanim_drops_update(void *d, void *w, double dt, std::int64_t when)
{ drops(d).update(waves(w), dt, static_cast<std::uint64_t>(when)); }

MDANIM_EXPORT std::int64_t mdanim_drops_count(void *d) { return static_cast<std::int64_t>(drops(d).all().size()); }

// The state is that of all drops: place and velocity, six numbers, and units.
MDANIM_EXPORT void mdanim_drops_state(void *d, std::uint8_t *bytes)
{
  const std::vector<std::uint8_t> state = drops(d).state();
  std::copy(state.begin(), state.end(), bytes);
}

// 0, or 1 with a message.
MDANIM_EXPORT int mdanim_drops_set_state(void *d, const std::uint8_t *bytes, std::int64_t size, char *error, int error_size)
{
  int failed = 1;
  guarded(error, error_size, [&] {
    drops(d).set_state(bytes, static_cast<std::size_t>(size));
    failed = 0;
  });
  return failed;
}

MDANIM_EXPORT void *mdanim_makers_new(int nx, int ny) { return new WaveMakers(nx, ny); }

MDANIM_EXPORT void mdanim_makers_free(void *m) { delete &makers(m); }

// `columns`: from and to along x and y. Negative rates drain.
MDANIM_EXPORT void mdanim_makers_flow(void *m, const int *columns, double height, double rate, double ux, double uy)
{
  const WaveMakers::Mouth mouth{{columns[0], columns[2]}, {columns[1], columns[3]}, height};
  if (rate < 0.0)
    makers(m).add_drain(mouth, -rate);
  else
    makers(m).add_inflow(mouth, rate, ux, uy);
}

MDANIM_EXPORT void mdanim_makers_paddle(void *m, int side, double amplitude, double period, double depth)
{ makers(m).add_paddle(static_cast<mdanim::SideOf>(side), amplitude, period, depth); }

MDANIM_EXPORT void mdanim_makers_current(void *m, int side, double speed)
{ makers(m).add_current(static_cast<mdanim::SideOf>(side), speed); }

MDANIM_EXPORT void mdanim_makers_apply(void *m, void *w, double dt) { makers(m).apply(waves(w), dt); }

MDANIM_EXPORT void mdanim_makers_account(void *m, std::int64_t *in_and_out)
{
  in_and_out[0] = makers(m).in();
  in_and_out[1] = makers(m).out();
}

MDANIM_EXPORT std::int64_t mdanim_makers_state_size(void *m) { return static_cast<std::int64_t>(makers(m).state().size()); }

MDANIM_EXPORT void mdanim_makers_state(void *m, std::uint8_t *bytes)
{
  const std::vector<std::uint8_t> state = makers(m).state();
  std::copy(state.begin(), state.end(), bytes);
}

// 0, or 1 with a message.
MDANIM_EXPORT int mdanim_makers_set_state(void *m, const std::uint8_t *bytes, std::int64_t size, char *error, int error_size)
{
  int failed = 1;
  guarded(error, error_size, [&] {
    makers(m).set_state(bytes, static_cast<std::size_t>(size));
    failed = 0;
  });
  return failed;
}
