// SPDX-License-Identifier: GPL-2.0-only
// Points of particles become lanes of rows, and back.

#include "passes/plane_blocks.h"

#include <limits>

namespace mdanim {

static constexpr double OUT_OF_REACH = -1e30;

// The draft of a row of a block in which this particle can be at one more plane: behind all rows that it is in, but that rows
// across other axes change nothing where there is no friction, and those across one axis follow each other then. `first` has the
// first draft of each block, or -1.
int PlaneBlocks::draft_for(const Lane &at, const PlaneRow &like, std::vector<int> &first)
{
  const bool is_rough = laws.first_of(like.law)->law.friction > 0.0;
  int found = -1, *end = &first[at.block], *behind_axis = nullptr;
  while (*end >= 0) {
    const int number = *end;
    Draft &one = drafts[number];
    const bool is_alike = one.row.provider == like.provider && one.row.axis == like.axis;
    end = &one.next;
    if (is_alike) behind_axis = end;
    if (one.is_taken[at.lane] && (is_rough || is_alike))
      found = -1;
    else if (found < 0 && is_alike && one.row.law == like.law)
      found = number;
  }
  if (found >= 0) return found;
  if (!is_rough && behind_axis) end = behind_axis;
  const int number = static_cast<int>(drafts.size()), next = *end;
  *end = number;
  drafts.push_back({like, next, std::vector<char>(lanes), std::vector<double>(PLANE_COEFFICIENTS * lanes)});
  for (int lane = 0; lane < lanes; ++lane) {
    drafts.back().coefficients[SIGN * lanes + lane] = 1.0;
    drafts.back().coefficients[AT * lanes + lane] = OUT_OF_REACH;
  }
  return number;
}

// Rows of a block come one after the other; places, which are in drafts, become those in rows.
void PlaneBlocks::put_in_order(std::vector<Block> &all, const std::vector<int> &first)
{
  std::vector<int> row_of(drafts.size());
  int numbers = 0;
  for (std::size_t b = 0; b < all.size(); ++b) {
    all[b].planes = first[b] < 0 ? -1 : static_cast<int>(rows.size());
    for (int n = first[b]; n >= 0; n = drafts[n].next) {
      const Draft &one = drafts[n];
      PlaneRow row = one.row;
      row.coefficients = coefficients.find_or_add(one.coefficients.data(), one.coefficients.size());
      row.kept = numbers;
      row.is_last = one.next < 0;
      numbers += laws.first_of(row.law)->law.friction > 0.0 ? ROUGH_NUMBERS : SMOOTH_NUMBERS;
      row_of[n] = static_cast<int>(rows.size());
      rows.push_back(row);
      ++many[row.provider];
    }
  }
  for (InRow &place : places) place.row = row_of[place.row];
  kept.assign(static_cast<std::size_t>(numbers) * lanes);
}

void PlaneBlocks::take_in(const OfProviders &points, std::vector<Block> &all, const Where &where)
{
  drafts.clear(), rows.clear(), places.clear();
  laws = {}, coefficients = {};
  many.assign(points.size(), 0);
  std::vector<int> first(all.size(), -1);
  for (std::size_t provider = 0; provider < points.size(); ++provider)
    for (const PointsAtPlane &some : points[provider]) {
      const PlaneLaw of_some = {some.law, some.radius};
      const unsigned law = laws.find_or_add(&of_some, 1);
      for (const PointAtPlane &point : some.points) {
        const Lane at = where(point.particle);
        const int draft = draft_for(at, {some.axis, law, 0, 0, static_cast<int>(provider), false}, first);
        drafts[draft].is_taken[at.lane] = 1;
        double *const own = drafts[draft].coefficients.data() + at.lane;
        own[SIGN * lanes] = some.sign, own[AT * lanes] = some.at, own[AREA * lanes] = point.area;
        places.push_back({draft, at.lane});
      }
    }
  put_in_order(all, first);
  drafts.clear();
  auto place = places.begin();
  for (const auto &of_provider : points)
    for (const PointsAtPlane &some : of_provider)
      for (const PointAtPlane &point : some.points) {
        const auto put = [&](int number, double value) { *number_at(*place, number) = value; };
        const auto put_vector = [&](int number, const Vec3 &value) {
          put(number, value.x), put(number + 1, value.y), put(number + 2, value.z);
        };
        const ContactMemory<double> &memory = point.state.memory;
        const bool touches = memory.depth > 0.0;
        put(OFFSET, !touches && point.was_below ? std::numeric_limits<double>::infinity() : memory.offset);
        put(DEPTH, memory.depth);
        put_vector(ANCHOR, point.state.anchor);
        if (some.law.friction > 0.0) {
          put(DAMPING, memory.damping), put(STICK, memory.stick), put(STICK_ENERGY, memory.stick_energy);
          put_vector(PULL, memory.pull), put_vector(DRAG, memory.drag);
          put(HEAT, point.heat), put(DAMPED, point.damped);
        }
        ++place;
      }
}

void PlaneBlocks::give_out(OfProviders &points) const
{
  auto place = places.begin();
  for (auto &of_provider : points)
    for (PointsAtPlane &some : of_provider)
      for (PointAtPlane &point : some.points) {
        const auto of = [&](int number) { return *number_at(*place, number); };
        const auto vector_of = [&](int number) { return Vec3{of(number), of(number + 1), of(number + 2)}; };
        ContactMemory<double> &memory = point.state.memory;
        memory.offset = of(OFFSET), memory.depth = of(DEPTH);
        point.state.anchor = vector_of(ANCHOR);
        point.deepest = of(DEEPEST);
        if (some.law.friction > 0.0) {
          memory.damping = of(DAMPING), memory.stick = of(STICK), memory.stick_energy = of(STICK_ENERGY);
          memory.pull = vector_of(PULL), memory.drag = vector_of(DRAG);
          point.heat = of(HEAT), point.damped = of(DAMPED);
        }
        ++place;
      }
}

PlaneRows PlaneBlocks::filled(double dt) { return {rows.data(), laws.data(), coefficients.data(), kept.data(), dt}; }

std::size_t PlaneBlocks::bytes() const
{
  return rows.capacity() * sizeof(PlaneRow) + laws.bytes() + coefficients.bytes() + kept.bytes() +
         places.capacity() * sizeof(InRow) + drafts.capacity() * sizeof(Draft);
}

}    // namespace mdanim
