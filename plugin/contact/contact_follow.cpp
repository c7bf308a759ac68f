// SPDX-License-Identifier: GPL-2.0-only
// The kernel does the same for several contacts where no search is needed (contact_kernel_of_set.cpp).

#include "contact/contact_follow.h"

#include <array>
#include <cmath>

namespace mdanim {

namespace {

// A contact that continues in another cell in a step: how far the point has moved against the host in the cell that it leaves
// [m], and the difference between X and its place there.
struct Hop {
  bool happened = false;
  Vec3 moved, jump;
};

// Beyond the filled cells of a round host X is not continuous from cell to cell. The contact continues as if it were: a jump of
// its depth would create energy. The mean force of leap-frog acts half along the normal of the old cell and half along that of
// the new one, and the depth grows accordingly in this step.
void go_on(FieldContact &contact, const Hop &hop, const ContactBody &host, double radius, const Spot<double> &spot)
{
  ContactState<double> &state = contact.state;
  Depth<double> here = host.depth(contact.side, state.X);
  here.value += radius;
  const double grown = host.depth(contact.side, state.X - hop.jump).value + radius - state.memory.depth;
  const double grown_here = dot(spot.to_material(hop.moved), here.slope);
  const double deeper = here.value - (state.memory.depth + 0.5 * (grown + grown_here));
  state.memory.offset += deeper;
  state.memory.depth += deeper;
  state.anchor += hop.jump;
  state.change -= hop.jump;
}

}    // namespace

bool follow(FieldContact &contact, const PushTask &task, const ContactBody &host, const Vec3 &x, MapWeights &weights,
            Spot<double> &spot, Vec3 &off)
{
  constexpr int MOST = 12;
  const Placed at = {host, task.slot, task.place};
  const MaterialSearch search(at);
  std::array<int, 3> cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
  Vec3 X = contact.state.X + contact.state.change, left_at;
  bool again = true, has_left = false;
  Hop hop;
  for (int step = 0; again; ++step) {
    if (step == MOST) return false;
    again = false;
    weights = task.is_smooth ? smooth(X, at.body) : trilinear(X, cell, at.body);
    if (!evaluate(at, weights, spot)) return false;
    if (search.is_collapsed(spot)) {    // the search starts at the last place, then from the cells around
      if (task.is_smooth) return false;
      Vec3 from = contact.state.X;
      cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
      if (step > 0 || !(search.solve(x, cell, from) || search.solve_around(x, cell, from))) return false;
      X = from, again = true;
      continue;
    }
    off = spot.to_material(x - spot.x);
    const double square = dot(off, off);
    if (square > SAME_PLACE * SAME_PLACE) {
      X += (square > 1.0 ? 1.0 / std::sqrt(square) : 1.0) * off;
      again = true;
      continue;
    }
    if (has_left) hop.jump += (X + off) - left_at;
    has_left = !task.is_smooth && search.step_to_neighbour(cell, X + off, LEFT);
    if (has_left) {
      X += off;
      if (!hop.happened) hop = {true, spot.to_space(X - contact.state.X), {}};
      left_at = X;
      again = true;
    }
  }
  for (int d = 0; d < 3; ++d) contact.cell[d] = cell[d];
  X += off;
  contact.state.change = X - contact.state.X;
  contact.state.X = X;
  if (!host.is_cuboid() && hop.happened) go_on(contact, hop, host, task.radius, spot);
  return true;
}

}    // namespace mdanim
