// SPDX-License-Identifier: GPL-2.0-only
// A plain C function for ctypes: bodies for fix mdanim/contact. All ranks call it alike. No exception leaves it.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "lammps/fix_mdanim_contact.h"

#include "lammps.h"
#include "modify.h"

#include <stdexcept>
#include <string>

using namespace LAMMPS_NS;
using mdanim::guarded;

MDANIM_EXPORT int mdanim_contact_body(void *handle, const char *fix, int kind, const std::int32_t *count, const double *edge,
                                      int particles, const std::int32_t *node, const std::uint8_t *filled, int points,
                                      const std::int32_t *cell, const double *at, const double *centre, const double *normal,
                                      const double *area, const std::uint8_t *point_kind, const double *depth,
                                      std::int64_t depths, int open, const double *open_part, const std::int32_t *frame,
                                      const double *frame_at, double radius, double hardness, double spread, int between,
                                      const std::int32_t *sharer, const double *share, int tears, char *error, int size) noexcept
{
  return guarded(error, size, [&] {
    auto *found = dynamic_cast<FixMdanimContact *>(static_cast<LAMMPS *>(handle)->modify->get_fix_by_id(fix));
    if (!found) throw std::runtime_error(std::string("there is no fix ") + fix + " of style mdanim/contact");
    found->take_body(kind, {count,   edge,      particles, node,      filled,     points,   cell,
                            at,      centre,    normal,    area,      point_kind, depth,    static_cast<std::size_t>(depths),
                            open,    open_part, frame,     frame_at,  radius,     hardness, spread,
                            between, sharer,    share,     tears != 0});
  });
}
