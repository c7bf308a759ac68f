// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/moments_file.h"

#include "records/line_words.h"

namespace mdanim {

std::map<int, Inertia> read_moments(const std::string &name, const std::string &text)
{
  return by_molecule(name, text, [](LineWords &words) {
    Inertia inertia;
    for (double *one : {&inertia.xx, &inertia.yy, &inertia.zz, &inertia.xy, &inertia.xz, &inertia.yz})
      *one = words.number<double>("a moment of Ixx Iyy Izz Ixy Ixz Iyz");
    words.expect_end();
    const Vec3 moments = principal_axes(inertia).moments;
    if (!(moments.x > 0.0 && moments.x + moments.y >= (1.0 - 1e-9) * moments.z))
      words.fail("no body has the principal moments " + LineWords::short_form(moments.x) + ", " +
                 LineWords::short_form(moments.y) + " and " + LineWords::short_form(moments.z) +
                 ", which must be positive, none above the sum of the other two");
    return inertia;
  });
}

}    // namespace mdanim
