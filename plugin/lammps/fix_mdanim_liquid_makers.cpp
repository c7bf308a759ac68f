// SPDX-License-Identifier: GPL-2.0-only
// Words of fix mdanim/liquid for makers of waves.

#include "lammps/fix_mdanim_liquid.h"
#include "liquid/waves/wave_basin.h"

#include "domain.h"
#include "error.h"
#include "region.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

using namespace LAMMPS_NS;
using namespace mdanim;

bool FixMdanimLiquid::is_maker(const char *word)
{ return strcmp(word, "wave") == 0 || strcmp(word, "current") == 0 || strcmp(word, "inflow") == 0 || strcmp(word, "drain") == 0; }

void FixMdanimLiquid::add_maker(WaveBasin &waves, int iarg, char **arg, double depth)
{
  const char *word = arg[iarg];
  const auto number = [&](int k, bool positive) {
    const double value = utils::numeric(FLERR, arg[iarg + k], false, lmp);
    if (positive && !(value > 0.0)) error->all(FLERR, iarg + k, "fix mdanim/liquid: {} must be > 0, got {}", word, arg[iarg + k]);
    return value;
  };
  const auto speed = [&](int k, int axis, bool positive) {
    const double value = number(k, positive), most = waves.fastest(axis);
    if (!(std::fabs(value) <= most))
      error->all(FLERR, iarg + k, "fix mdanim/liquid: the {} comes at {}; in this basin liquid flows at {:.4g} at most", word,
                 arg[iarg + k], most);
    return value;
  };
  if (strcmp(word, "wave") == 0 || strcmp(word, "current") == 0) {
    static const char *const sides[] = {"-x", "+x", "-y", "+y"};
    const auto *const side =
        std::find_if(std::begin(sides), std::end(sides), [&](const char *s) { return strcmp(s, arg[iarg + 1]) == 0; });
    if (side == std::end(sides))
      error->all(FLERR, iarg + 1, "fix mdanim/liquid: {} comes from -x, +x, -y or +y, got {}", word, arg[iarg + 1]);
    const int number_of_side = static_cast<int>(side - std::begin(sides));
    if (strcmp(word, "wave") == 0)
      waves.add_wave(number_of_side, number(2, true), number(3, true), depth);
    else
      waves.add_current(number_of_side, speed(2, number_of_side / 2, true));
    return;
  }
  const Region *region = domain->get_region_by_id(arg[iarg + 1]);
  if (!region || !region->bboxflag)
    error->all(FLERR, iarg + 1, "fix mdanim/liquid: there is no finite region {} for {}", arg[iarg + 1], word);
  const Vec3 low = {region->extent_xlo, region->extent_ylo, region->extent_zlo};
  const Vec3 high = {region->extent_xhi, region->extent_yhi, region->extent_zhi};
  if (strcmp(word, "inflow") == 0)
    waves.add_flow(low, high, number(2, true), speed(3, 0, false), speed(4, 1, false));
  else
    waves.add_flow(low, high, -number(2, true), 0.0, 0.0);
}
