// SPDX-License-Identifier: GPL-2.0-only
// The particles at planes whose contacts passes compute.

#pragma once

#include "contact/points_at_plane.h"
#include "geometry/aligned_array.h"
#include "passes/pass.h"
#include "springs/distinct_rows.h"

#include <functional>
#include <vector>

namespace mdanim {

class PlaneBlocks {
 public:
  // Where a particle is; `block` is negative for a ghost.
  struct Lane {
    int block, lane;
  };
  using Where = std::function<Lane(int i)>;
  using OfProviders = std::vector<std::vector<PointsAtPlane>>;    // of each that gives forces to passes

  explicit PlaneBlocks(int lanes) : lanes(lanes) {}

  // Takes in the points of each provider, in the order in which planes act, and sets `planes` of all blocks. No particle
  // is a ghost.
  void take_in(const OfProviders &points, std::vector<Block> &all, const Where &where);
  PlaneRows filled(double dt);
  void give_out(OfProviders &points) const;    // sets what has become of these points
  long points() const { return static_cast<long>(places.size()); }
  // Particles in the rows of a provider, idle lanes among them.
  double particles_of(std::size_t provider) const { return static_cast<double>(many[provider]) * lanes; }
  double particles() const { return static_cast<double>(rows.size()) * lanes; }
  std::size_t bytes() const;

 private:
  // A row that is not in its place among all rows yet.
  struct Draft {
    PlaneRow row;
    int next;    // of the same block; -1 for none
    std::vector<char> is_taken;
    std::vector<double> coefficients;
  };
  // Where the numbers of a point are.
  struct InRow {
    int row, lane;
  };

  int draft_for(const Lane &at, const PlaneRow &like, std::vector<int> &first);
  void put_in_order(std::vector<Block> &all, const std::vector<int> &first);
  double *number_at(const InRow &of, int number) { return kept.data() + (rows[of.row].kept + number) * lanes + of.lane; }
  const double *number_at(const InRow &of, int number) const
  { return kept.data() + (rows[of.row].kept + number) * lanes + of.lane; }

  const int lanes;
  std::vector<Draft> drafts;
  std::vector<PlaneRow> rows;
  DistinctRows<PlaneLaw> laws;
  DistinctRows<double> coefficients;
  Doubles kept;
  std::vector<InRow> places;        // of all points
  std::vector<std::size_t> many;    // rows of each provider
};

}    // namespace mdanim
