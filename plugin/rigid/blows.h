// SPDX-License-Identifier: GPL-2.0-only
// Blows: two bodies, or one and a plane, which meet by all of their contacts at once.

#pragma once

#include "rigid/solid.h"

#include <utility>
#include <vector>

namespace mdanim {

struct SolidPair;
struct Touch;
struct TouchAccount;

// A contact in its blow, of two bodies, or of one and a plane: it pushes `a` along n, and `b`, if there is one, against it.
struct InBlow {
  Solid *a = nullptr, *b = nullptr;
  SolidPair *pair = nullptr;
  int plane = 0;
  Touch *touch = nullptr;          // none: a contact of these bodies has begun or ended
  Vec3 n{}, from_a{}, from_b{};    // from the centres of both

  // Adds to the force of the contact on `a`, and to that of planes where it is at one.
  void push(const Vec3 &force) const;
};

// Bodies of which a contact has begun or ended in a step, and all that are glued, as these touch by other pieces, too.
class Blows {
 public:
  // Takes all contacts of two bodies, or of one and a plane, as they are after the step; `changed`: one has begun or ended.
  void hold(std::vector<Touch> &touches, const InBlow &of, bool changed);
  // Takes those of another, as if they had been held here.
  void take(const Blows &other) { all.insert(all.end(), other.all.begin(), other.all.end()); }
  // Damps contacts of each two bodies, or of one and a plane, as the one blow that they are. Returns those that have just begun,
  // with what that adds to the force on `a` in this step.
  std::vector<std::pair<InBlow, Vec3>> share(TouchAccount &account) const;

 private:
  std::vector<InBlow> all;
};

}    // namespace mdanim
