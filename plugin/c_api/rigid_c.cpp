// SPDX-License-Identifier: GPL-2.0-only
// A plain C function for ctypes: how deep shapes of rigid bodies are in each other. No exception leaves it.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "numbers/matrix3.h"
#include "rigid/rigid_contact.h"
#include "rigid/shapes_file.h"

#include <map>

using mdanim::guarded;
using mdanim::Solid;
using mdanim::Vec3;

// `text` is a file of shapes, `pairs` two molecule IDs of each of `count` pairs, `moved` how far the second one is from its place
// there; writes the depth of each pair.
MDANIM_EXPORT int mdanim_rigid_overlaps(const char *text, int count, const int *pairs, const double *moved, double *depths,
                                        char *error, int size) noexcept
{
  return guarded(error, size, [&] {
    std::map<int, Solid> solids;
    for (const auto &[id, given] : mdanim::read_shapes("shapes", text)) {
      Solid &one = solids[id];
      one.held = true;
      one.shape = given.shape.placed({});
      one.move_to(given.pose.place, mdanim::matrix(given.pose.q));
    }
    for (int k = 0; k < count; ++k) {
      Solid &second = solids.at(pairs[2 * k + 1]);
      const Vec3 place = second.centre, move{moved[3 * k], moved[3 * k + 1], moved[3 * k + 2]};
      second.move_to(place + move, second.turn);
      depths[k] = mdanim::overlap(solids.at(pairs[2 * k]), second);
      second.move_to(place, second.turn);
    }
  });
}
