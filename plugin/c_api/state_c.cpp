// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions for ctypes: the state of fixes as records (lammps/stateful.h), by the ID of the fix. All ranks call them
// together. No exception leaves them.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "lammps/stateful.h"

#include "fix.h"
#include "lammps.h"
#include "modify.h"

#include <stdexcept>
#include <string>

using namespace LAMMPS_NS;
using mdanim::guarded;
using mdanim::Stateful;

static Stateful &stateful(void *handle, const char *fix)
{
  Fix *found = static_cast<LAMMPS *>(handle)->modify->get_fix_by_id(fix);
  if (!found) throw std::runtime_error(std::string("there is no fix ") + fix);
  auto *state = dynamic_cast<Stateful *>(found);
  if (!state) throw std::runtime_error(std::string("fix ") + fix + " " + found->style + " has no state of its own");
  return *state;
}

// ID of the n-th (from 0) fix that has a state of its own, valid until fixes come or go; a null pointer after the last. Returns
// 0, or 1 with a message in `error`.
MDANIM_EXPORT int mdanim_stateful(void *handle, int n, const char **id, char *error, int error_size)
{
  return guarded(error, error_size, [=] {
    *id = nullptr;
    int left = n;
    for (Fix *fix : static_cast<LAMMPS *>(handle)->modify->get_fix_list())
      if (dynamic_cast<Stateful *>(fix) && left-- == 0) {
        *id = fix->id;
        return;
      }
  });
}

// Packs the state for mdanim_state_get, and gives the numbers of its records and of their bytes. Returns 0, or 1 with a message
// in `error`.
MDANIM_EXPORT int mdanim_state_pack(void *handle, const char *fix, long long *records, long long *bytes, char *error,
                                    int error_size)
{
  return guarded(error, error_size, [&] {
    Stateful &state = stateful(handle, fix);
    state.packed = state.pack();
    *records = static_cast<long long>(state.packed->size());
    *bytes = mdanim::bytes_of(*state.packed);
  });
}

// Copies the state that mdanim_state_pack has packed, once only: keys (records, 2), sorted; first (records + 1), where the bytes
// of each record begin; data (bytes). Returns 0, or 1 with a message in `error`.
MDANIM_EXPORT int mdanim_state_get(void *handle, const char *fix, std::int32_t *key, std::int64_t *first, std::uint8_t *data,
                                   char *error, int error_size)
{
  return guarded(error, error_size, [&] {
    Stateful &state = stateful(handle, fix);
    if (!state.packed) throw std::runtime_error(std::string("call mdanim_state_pack before, for fix ") + fix);
    mdanim::flatten(*state.packed, key, first, data);
    state.packed.reset();
  });
}

// Sets the state; arrays as in mdanim_state_get. All particles must exist, and the setup of a run must follow. Returns 0, or 1
// with a message in `error`; then nothing has changed.
MDANIM_EXPORT int mdanim_state_put(void *handle, const char *fix, long long records, const std::int32_t *key,
                                   const std::int64_t *first, const std::uint8_t *data, char *error, int error_size)
{
  return guarded(error, error_size, [&] {
    Stateful &state = stateful(handle, fix);
    try {
      state.unpack(mdanim::unflatten({records, key, first, data}));
    } catch (const std::exception &problem) {
      throw std::runtime_error(std::string("fix ") + fix + ": " + problem.what());
    }
  });
}
