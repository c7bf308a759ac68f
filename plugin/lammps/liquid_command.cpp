// SPDX-License-Identifier: GPL-2.0-only
// Reads words, refuses those that do not fit together, and makes the basin.

#include "lammps/liquid_command.h"

#include "liquid/automaton/automaton_basin.h"
#include "liquid/waves/wave_basin.h"

#include "domain.h"
#include "error.h"
#include "fmt/format.h"
#include "force.h"
#include "region.h"
#include "utils.h"

#include <cmath>
#include <cstring>
#include <new>

using namespace LAMMPS_NS;

namespace mdanim {

LiquidCommand::LiquidCommand(LAMMPS *lmp, int narg, char **arg) : Pointers(lmp)
{
  need_words(lmp, STYLE, "fix ID group mdanim/liquid", "REGION rho grid NX NY NZ", narg - 3);
  region_id = arg[3];
  Region *region = domain->get_region_by_id(region_id);
  if (!region) error->all(FLERR, 3, "{}: there is no region {}; make it before this fix", STYLE, arg[3]);
  if (strcmp(region->style, "block") != 0 || !region->interior || region->dynamic_check() || !region->bboxflag)
    error->all(FLERR, 3, "{}: the basin must be a finite, resting region of style block, side in; {} is not", STYLE, arg[3]);
  density = positive(lmp, STYLE, "density", 4, arg);
  if (strcmp(arg[5], "grid") != 0) error->all(FLERR, 5, "{}: expected grid NX NY NZ after the density, got {}", STYLE, arg[5]);
  for (int d = 0; d < 3; ++d) {
    n[d] = utils::inumeric(FLERR, arg[6 + d], false, lmp);
    if (n[d] < 1) error->all(FLERR, 6 + d, "{}: grid must be >= 1 along every axis, got {}", STYLE, arg[6 + d]);
  }
}

std::vector<Keyword> LiquidCommand::keywords()
{
  const auto amount = [this](std::optional<double> &into, const char *what) {
    return [this, &into, what](int at, char **arg) { into = positive(lmp, STYLE, what, at + 1, arg); };
  };
  const auto maker = [this](int at, char **) { makers.push_back(at); };
  return {
      {"volume", "V", "", amount(volume, "volume")},
      {"level", "Z", "", [this](int at, char **arg) { level = utils::numeric(FLERR, arg[at + 1], false, lmp); }},
      {"fill", "REGION2", "",
       [this](int at, char **arg) {
         fill_id = arg[at + 1];
         if (!domain->get_region_by_id(fill_id)) error->all(FLERR, at + 1, "{}: there is no region {} to fill", STYLE, fill_id);
       }},
      {"gravity", "G", "", amount(gravity, "gravity, along -z,")},
      {"model", "surface|paper|waves", "",
       [this](int at, char **arg) {
         model = static_cast<Model>(choice(lmp, STYLE, "model must be", {"surface", "paper", "waves"}, at + 1, arg));
       }},
      {"calm", "T", "", [this](int at, char **arg) { calm = positive(lmp, STYLE, "calm", at + 1, arg); }},
      {"manning", "n", "", [this](int at, char **arg) { manning = positive(lmp, STYLE, "manning", at + 1, arg); }},
      {"drops", "share", "",
       [this](int at, char **arg) {
         spray = utils::numeric(FLERR, arg[at + 1], false, lmp);
         if (!(spray >= 0.0 && spray <= 1.0))
           error->all(FLERR, at + 1, "{}: drops must be a share from 0 to 1, got {}", STYLE, arg[at + 1]);
       }},
      {"wave", "SIDE a T", "", maker},
      {"current", "SIDE u", "", maker},
      {"inflow", "REGION2 q ux uy", "", maker},
      {"drain", "REGION2 q", "", maker},
      {"vertical", "lower|any", "",
       [this](int at, char **arg) { any_vertical = choice(lmp, STYLE, "vertical must be", {"lower", "any"}, at + 1, arg) == 1; }},
      {"seed", "N", "", [this](int at, char **arg) { seed = utils::bnumeric(FLERR, arg[at + 1], false, lmp); }}};
}

std::vector<Keyword> LiquidCommand::pace_keywords()
{
  const auto time = [this](double Basin::Pace::*which) {
    return [this, which](int at, char **arg) { pace.*which = positive(lmp, STYLE, arg[at], at + 1, arg); };
  };
  return {{"sweeps", "auto|N", "",
           [this](int at, char **arg) {
             pace.sweeps = strcmp(arg[at + 1], "auto") == 0 ? 0 : utils::inumeric(FLERR, arg[at + 1], false, lmp);
             if (strcmp(arg[at + 1], "auto") != 0 && (pace.sweeps < 1 || pace.sweeps > Basin::MOST_SWEEPS))
               error->all(FLERR, at + 1, "{}: sweeps must be auto or 1 to {}, got {}", STYLE, Basin::MOST_SWEEPS, arg[at + 1]);
           }},
          {"every", "N", "",
           [this](int at, char **arg) {
             pace.every = utils::inumeric(FLERR, arg[at + 1], false, lmp);
             if (pace.every < 1) error->all(FLERR, at + 1, "{}: every must be >= 1, got {}", STYLE, arg[at + 1]);
           }},
          {"stride", "s", "", time(&Basin::Pace::stride)},
          {"period", "p", "", time(&Basin::Pace::period)},
          {"faces", "", "write model waves, in which open hulls float by the air in them"}};
}

void LiquidCommand::read_keywords(const std::vector<Keyword> &of_parts, int narg, char **arg)
{
  std::vector<Keyword> known = keywords();
  known.insert(known.end(), of_parts.begin(), of_parts.end());
  for (int iarg = 9; iarg < narg;) iarg += take_keyword(lmp, STYLE, known, iarg, narg, arg);
  if (volume.has_value() == level.has_value())
    error->all(FLERR, "{}: write either volume V or level Z, {}", STYLE, level ? "not both" : "one of them");
  if (!gravity) error->all(FLERR, "{}: gravity G is missing; liquid lies flat only under gravity along -z", STYLE);
  const auto for_waves = [this](bool given, int at, const char *word) {
    if (given && model != Model::WAVES)
      error->all(FLERR, at, "{}: {} is for model waves; leave it out, or write model waves", STYLE, word);
  };
  for_waves(calm > 0.0, Error::NOPOINTER, "calm");
  for_waves(manning > 0.0, Error::NOPOINTER, "manning");
  for_waves(spray > 0.0, Error::NOPOINTER, "drops");
  if (!makers.empty()) for_waves(true, makers[0], arg[makers[0]]);
}

std::unique_ptr<Basin> LiquidCommand::make_basin(const RankSums &ranks, char **arg) const
{
  const Region *region = domain->get_region_by_id(region_id);
  const Vec3 low = {region->extent_xlo, region->extent_ylo, region->extent_zlo};
  const Vec3 cell = {(region->extent_xhi - low.x) / n[0], (region->extent_yhi - low.y) / n[1],
                     (region->extent_zhi - low.z) / n[2]};
  if (level && !(*level > low.z && *level <= region->extent_zhi))
    error->all(FLERR, "{}: level {} is not within the basin, {} to {}", STYLE, *level, low.z, region->extent_zhi);
  const Basin::Shape shape{n[0], n[1], n[2], low, cell};
  const std::string refused = model == Model::WAVES ? WaveBasin::unusable(shape) : AutomatonBasin::too_large(n[0], n[1], n[2]);
  if (!refused.empty()) error->all(FLERR, 6, "{}: {}", STYLE, refused);
  const double g = *gravity * force->ftm2v;    // from force/mass to an acceleration
  const auto key = static_cast<std::uint64_t>(seed);
  std::unique_ptr<Basin> basin;
  try {
    if (model == Model::WAVES) {
      auto waves =
          std::make_unique<WaveBasin>(shape, g, WaveSettings{calm > 0.0 ? calm_rate(calm) : 0.0, manning, spray, key}, ranks);
      const double area = cell.x * n[0] * cell.y * n[1];
      add_makers(*waves, level ? *level - low.z : *volume / area, arg);
      basin = std::move(waves);
    } else
      basin = std::make_unique<AutomatonBasin>(
          shape, g, key, any_vertical ? Vertical::ANY : Vertical::LOWER,
          model == Model::PAPER ? AutomatonBasin::Immersion::PAPER : AutomatonBasin::Immersion::SURFACE, ranks);
  } catch (const std::bad_alloc &) {
    error->one(FLERR, "{}: no memory for a grid of {:.3g} cells; use fewer, larger cells", STYLE, 1.0 * n[0] * n[1] * n[2]);
  }
  basin->pace = pace;
  return basin;
}

void LiquidCommand::add_makers(WaveBasin &waves, double depth, char **arg) const
{
  for (const int first : makers) {
    const char *const word = arg[first];
    const auto speed = [&](int at, int axis, double value) {
      const double most = waves.fastest(axis);
      if (!(std::fabs(value) <= most))
        error->all(FLERR, at, "{}: the {} comes at {}; in this basin liquid flows at {:.4g} at most", STYLE, word, arg[at], most);
      return value;
    };
    const auto above_0 = [&](int at) { return positive(lmp, STYLE, word, at, arg); };
    if (strcmp(word, "wave") == 0 || strcmp(word, "current") == 0) {
      const int side = choice(lmp, STYLE, (std::string(word) + " comes from").c_str(), {"-x", "+x", "-y", "+y"}, first + 1, arg);
      if (strcmp(word, "wave") == 0)
        waves.add_wave(side, above_0(first + 2), above_0(first + 3), depth);
      else
        waves.add_current(side, speed(first + 2, side / 2, above_0(first + 2)));
      continue;
    }
    const Region *region = domain->get_region_by_id(arg[first + 1]);
    if (!region || !region->bboxflag)
      error->all(FLERR, first + 1, "{}: there is no finite region {} for {}", STYLE, arg[first + 1], word);
    const Vec3 low = {region->extent_xlo, region->extent_ylo, region->extent_zlo};
    const Vec3 high = {region->extent_xhi, region->extent_yhi, region->extent_zhi};
    const double rate = above_0(first + 2);
    const auto along = [&](int axis) {
      return speed(first + 3 + axis, axis, utils::numeric(FLERR, arg[first + 3 + axis], false, lmp));
    };
    if (strcmp(word, "inflow") == 0)
      waves.add_flow(low, high, rate, along(0), along(1));
    else
      waves.add_flow(low, high, -rate, 0.0, 0.0);
  }
}

std::vector<std::uint8_t> LiquidCommand::cells_to_fill(const Basin &basin, const std::string &fix) const
{
  const Basin::Shape &shape = basin.shape;
  std::vector<std::uint8_t> within(static_cast<std::size_t>(shape.nx) * shape.ny * shape.nz, 1);
  if (fill_id.empty()) return within;
  Region *fill = domain->get_region_by_id(fill_id);
  if (!fill) error->all(FLERR, "{}: region {} has been deleted", fix, fill_id);
  fill->prematch();
  CellBox{{0, 0, 0}, {shape.nx, shape.ny, shape.nz}}.each([&](int x, int y, int z) {
    within[basin.cell_number(x, y, z)] =
        fill->match(shape.low.x + (x + 0.5) * shape.cell.x, shape.low.y + (y + 0.5) * shape.cell.y, basin.height(z + 0.5));
  });
  return within;
}

std::string LiquidCommand::amount_in_words() const
{ return level ? fmt::format("level {}", *level) : fmt::format("volume {}", *volume); }

}    // namespace mdanim
