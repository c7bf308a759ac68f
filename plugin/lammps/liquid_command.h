// SPDX-License-Identifier: GPL-2.0-only
// The command of fix mdanim/liquid: its words, and the basin that they describe.

#pragma once

#include "lammps/keywords.h"
#include "liquid/basin.h"

#include "pointers.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mdanim {

class WaveBasin;

// fix ID group mdanim/liquid REGION rho grid NX NY NZ volume V | level Z gravity G keyword values ...
class LiquidCommand : protected LAMMPS_NS::Pointers {
 public:
  static constexpr const char *STYLE = "fix mdanim/liquid";
  enum class Model { SURFACE, PAPER, WAVES };

  // Reads the words before the keywords. Raises a LAMMPS error, as all functions do.
  LiquidCommand(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);
  // Reads all keywords: its own and those `of_parts` of the fix.
  void read_keywords(const std::vector<Keyword> &of_parts, int narg, char **arg);
  std::vector<Keyword> pace_keywords();    // when the liquid is updated; fix_modify takes them as well
  std::unique_ptr<Basin> make_basin(const RankSums &ranks, char **arg) const;
  // Marks cells whose middle is in the region to fill; all where there is none. `fix` begins messages.
  std::vector<std::uint8_t> cells_to_fill(const Basin &basin, const std::string &fix) const;
  Basin::Amount amount() const { return {level.has_value(), level ? *level : *volume, !fill_id.empty()}; }
  std::string amount_in_words() const;
  std::string place_in_words() const { return fill_id.empty() ? "the basin" : "the region to fill"; }

  double density = 0.0;
  Model model = Model::SURFACE;
  Basin::Pace pace;

 private:
  std::vector<Keyword> keywords();
  void add_makers(WaveBasin &waves, double depth, char **arg) const;

  std::string region_id, fill_id;
  int n[3];    // cells along each axis
  std::optional<double> volume, level, gravity;
  double calm = 0.0, manning = 0.0, spray = 0.0;
  bool any_vertical = false;
  std::int64_t seed = 1;
  std::vector<int> makers;    // places of the words of each
};

}    // namespace mdanim
