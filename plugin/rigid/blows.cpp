// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/blows.h"

#include "rigid/touch.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace mdanim {

void InBlow::push(const Vec3 &force) const
{
  a->force += force;
  a->torque += cross(from_a, force);
  if (b) {
    b->force -= force;
    b->torque -= cross(from_b, force);
  } else {
    a->force_at_planes += force;
    a->torque_at_planes += cross(from_a, force);
  }
}

void Blows::hold(std::vector<Touch> &touches, const InBlow &of, bool changed)
{
  const bool is_glued = of.a->whole != Solid::ALONE || (of.b && of.b->whole != Solid::ALONE);    // touches by other pieces too
  if (changed) all.push_back(of);
  if (!changed && !is_glued) return;
  for (Touch &one : touches)
    if (one.shares != 0.0 && one.rests == 0.0 && one.parted == 0.0)
      all.push_back({of.a, of.b, of.pair, of.plane, &one, one.n, one.at - of.a->centre, of.b ? one.at - of.b->centre : Vec3()});
}

// A contact that has just begun has had its dashpot as if it were alone. Returns what is to be added to the force of this step.
static double take_share(Touch &touch, double share, TouchAccount &account)
{
  const double more = touch.followed == 1.0 ? (share / touch.shared - 1.0) * touch.memory.damping : 0.0;
  touch.shared = share;
  touch.memory.damping += more;
  touch.press += more;
  account.damped += 0.5 * more * (touch.memory.depth - touch.earlier);
  return more;
}

// The depth of contact i of a blow yields to all contacts j that press with it by the sum of k_j part_j lambda_ij: a log on both
// ends yields half as much as on one, a slender rod on the corners of its end several times as much. Each has the dashpot of a
// contact that yields so, at most that of MOST_DAMPING, until it rests, when it has its own. What is laid down has its own from
// the beginning: with that stacks come to rest.
static std::vector<double> shares_of(std::vector<InBlow> &blow)
{
  const auto mark = std::remove_if(blow.begin(), blow.end(), [](const InBlow &one) { return !one.touch; });
  if (mark == blow.end()) return {};
  blow.erase(mark, blow.end());
  SolidPush on_a, on_b;
  for (const InBlow &one : blow) {
    const Vec3 push = (one.touch->stiffness * one.touch->part) * one.n;
    on_a.add(*one.a, one.from_a, push);
    if (one.b) on_b.add(*one.b, one.from_b, push);
  }
  std::vector<double> shares;
  for (const InBlow &one : blow) {
    const Touch &touch = *one.touch;
    const double of_a = on_a.moves(*one.a, one.from_a, one.n), of_b = one.b ? on_b.moves(*one.b, one.from_b, one.n) : 0.0,
                 alone = touch.stiffness * touch.alone, all = of_a + of_b + (1.0 - touch.part) * alone;
    const double most = 2.0 * Material::MOST_DAMPING / (touch.damping * std::sqrt(alone));
    shares.push_back(all > 0.0 ? std::min(std::sqrt(alone / all), most) : most);
  }
  return shares;
}

std::vector<std::pair<InBlow, Vec3>> Blows::share(TouchAccount &account) const
{
  using Body = std::pair<int, int>;
  const auto body = [](const Solid &one) {
    return Body{one.whole != Solid::ALONE, one.whole != Solid::ALONE ? one.whole : one.id};
  };
  std::map<std::pair<Body, Body>, std::vector<InBlow>> blows;
  for (InBlow one : all) {
    Body a = body(*one.a), b = one.b ? body(*one.b) : Body{-1, one.plane};
    if (one.b && b < a) {
      std::swap(a, b);
      std::swap(one.a, one.b);
      std::swap(one.from_a, one.from_b);
      one.n = -1.0 * one.n;
    }
    blows[{a, b}].push_back(one);
  }
  std::vector<std::pair<InBlow, Vec3>> changed;
  for (auto &[bodies, blow] : blows) {
    const std::vector<double> shares = shares_of(blow);
    for (std::size_t k = 0; k < shares.size(); ++k)
      if (const double more = take_share(*blow[k].touch, shares[k], account); more != 0.0)
        changed.emplace_back(blow[k], more * blow[k].n);
  }
  return changed;
}

}    // namespace mdanim
