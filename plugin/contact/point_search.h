// SPDX-License-Identifier: GPL-2.0-only
// X of a point in a host, in lattice coordinates, from where it was found last.

#pragma once

#include "contact/contact_judge.h"
#include "contact/contact_object.h"
#include "contact/material_map.h"

#include <array>
#include <cstdint>
#include <limits>

namespace mdanim {

// Knowledge of a point without a contact.
struct alignas(64) PointTrack {
  std::array<int, 3> cell = {-1, -1, -1};    // where it was found last, -1 for nowhere
  std::array<int, 3> start = cell;           // this cell on the surface or one around it is the nearest one
  double trusted = 0.0;                      // up to this budget
  Vec3 X;
  double certain = -std::numeric_limits<double>::infinity();    // up to this budget it is in this cell

  void move_to(const std::array<int, 3> &to, const Vec3 &place)
  {
    if (to != cell) certain = -std::numeric_limits<double>::infinity();
    cell = to, X = place;
  }
};

// A host with its particles where they are now.
class PointSearch {
 public:
  PointSearch(const ContactObject &host, const Moment &when) : at{*host.body, host.host_slots().data(), when.place} {}

  // The nearest of the cells on the surface among one of them and those around it. `away`: how far its middle is from x [m].
  std::array<int, 3> outer_around(const Vec3 &x, const std::array<int, 3> &cell, double &away) const;
  // X of a point at x by one step of Newton's method from where it was found last. `off`: its distance from there in cells; 1 and
  // more where the step tells nothing. It takes a small part of the work of find(). `by_splines`: by the smooth map.
  void guess(PointTrack &known, const Vec3 &x, double budget, bool by_splines, Spot<double> &spot, Vec3 &X, double &off) const;
  // Whether the cell that a point at x was found in is the one that a search would find; otherwise nothing changes.
  bool confirm_cell(PointTrack &known, const Vec3 &x, double budget) const;
  // X of a point at x from a cell near by; the last search begins in the middle of the cell that X lies in. False where it cannot
  // be found.
  bool find(PointTrack &known, const Vec3 &x, double budget, bool by_splines, Spot<double> &spot, Vec3 &X) const;

 private:
  std::array<int, 3> cell_of(const Vec3 &X) const;
  template <class See> void each_around(const Vec3 &x, const std::array<int, 3> &cell, const See &see) const;
  bool is_cell_of(const Vec3 &x, const std::array<int, 3> &cell, const std::array<int, 3> &start, double &room) const;
  std::array<int, 3> cell_nearest(const Vec3 &x, std::array<int, 3> cell, double &room) const;

  Placed at;
};

}    // namespace mdanim
