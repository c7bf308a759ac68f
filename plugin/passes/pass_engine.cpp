// SPDX-License-Identifier: GPL-2.0-only
// Decides which cuts are made anew, and when.

#include "passes/pass_engine.h"

#include <algorithm>
#include <utility>

namespace mdanim {

RangeCut PassEngine::ranges_of(Cut &cut)
{
  const int many = threads.many() > 1 ? threads.most(ns_of_pass(cut.particles, cutter.damped())) : 1;
  return cut_into_ranges(cutter, cut, many);
}

bool PassEngine::begin_run(const Kernels &now)
{
  const bool others = kernels != &now;
  if (others) cut_for = NONE;
  kernels = &now;
  motion_for = NONE;
  crew.equip(*kernels, threads);
  return others;
}

void PassEngine::forget_springs() { line.forget(); }

bool PassEngine::cut(int particles, const int *object)
{
  HalfBonds half;
  if (!crew.springs->halves(half)) return false;
  const bool other_objects =
      motion_for == NONE && object &&
      !(static_cast<int>(objects.size()) == particles && std::equal(objects.begin(), objects.end(), object));
  if (cut_for == crew.springs->version() && !other_objects) return blocks.has_value();
  objects.assign(particles, 1);
  if (object) std::copy_n(object, particles, objects.begin());
  cut_for = crew.springs->version();
  motion_for = NONE;
  blocks.reset();
  cutter.start(kernels->lanes);
  Cut all = cutter.cut(half, objects.data());
  if (!cutter.use(all).worth_it()) return false;
  RangeCut ranges = ranges_of(all);
  blocks.emplace(cutter, std::move(all), std::move(ranges));
  return blocks.has_value();
}

LaneUse PassEngine::cut(const Bonded &known)
{
  line.take(known);
  if (cut_for == NONE || coeffs != crew.springs->coeffs() || cutter.rows_pile_up()) {
    cut_for = 0;    // of ranks each looks at its own springs
    coeffs = crew.springs->coeffs();
    blocks.reset();
    cutter.start(kernels->lanes);
    for (TagOrder::Piece &piece : line.pieces()) piece.is_cut = false;
  }
  if (line.changed() || !blocks) {
    std::vector<const Cut *> cuts;
    for (TagOrder::Piece &piece : line.pieces()) {
      if (!piece.is_cut) piece.cut = cutter.cut({&piece.rows, coeffs.data()}, piece.object.data());
      piece.is_cut = true;
      cuts.push_back(&piece.cut);
    }
    motion_for = NONE;
    Cut all = cutter.join(cuts);
    use = cutter.use(all);
    RangeCut ranges = ranges_of(all);
    blocks.emplace(cutter, std::move(all), std::move(ranges), line.places(), known.own);
  } else {
    blocks->lay_out_at(line.places(), known.own);
  }
  return use;
}

PassRun &PassEngine::start(const AtomArrays &atoms, double dt, bool positions, long long build)
{
  run.emplace(*blocks, *kernels, threads, crew, atoms, dt, PassRun::Fresh{positions, motion_for != build});
  motion_for = build;
  return *run;
}

void PassEngine::leave()
{
  run->leave();
  moved_alone += run->held_back();
  run.reset();
}

std::size_t PassEngine::bytes() const
{ return line.bytes() + cutter.bytes() + (blocks ? blocks->bytes() : 0) + objects.capacity() * sizeof(int); }

}    // namespace mdanim
