// SPDX-License-Identifier: GPL-2.0-only
// Sums of what contacts do to bodies and add to the account, which are kept until they are added up. So threads look at pairs
// side by side, and each sum has the terms, and the order of them, that it has with one thread.

#pragma once

#include "rigid/blows.h"
#include "rigid/solid.h"
#include "threads/team.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace mdanim {

struct SolidPair;
struct TouchAccount;

// Pushes of a contact: `force` on `a` and against it on `b`, with the torques of both. `b` is null at a plane.
struct TouchPush {
  Solid *a, *b;
  Vec3 force, on_a, on_b;

  void add() const
  {
    add_to_a();
    if (b) add_to_b();
  }
  void add_to_a() const { a->force += force, a->torque += on_a; }
  void add_to_b() const { b->force -= force, b->torque -= on_b; }
};

// Terms of a contact in the sums of the bound on the step of a body, and to the number of its contacts.
struct TouchBound {
  Solid *one;
  double stiffness, damping;
  int contacts;

  void add() const
  {
    one->stiffness_sum += stiffness;
    one->damping_sum += damping;
    one->touching += contacts;
  }
};

class alignas(64) LateSums {    // threads write to some that are side by side
 public:
  void clear();
  // Not inlined: a step by one thread, which adds all at once, never comes here.
  void add(const TouchPush &one);
  void add(const TouchBound &one);
  void add(double &sum, double more);
  void deepen(double depth) { deepest = depth > deepest ? depth : deepest; }
  void carry(Solid &one) { carried.push_back(&one); }
  // The pushes from number `from` on are those of a pair that keeps what it gives (SolidPair::keep).
  std::size_t size() const { return pushes.size(); }
  void end_kept(SolidPair &pair, std::size_t from) { kept.push_back({&pair, from, pushes.size()}); }
  // Adds all of it.
  void settle(std::vector<Solid> &solids, TouchAccount &account) const;
  // The same in parts, which threads take side by side where no pair keeps what it gives: what bodies in [first, end) get, and
  // the rest, none of which is a sum of a body.
  bool comes_in_parts() const { return kept.empty(); }
  void settle_bodies(const Solid *first, const Solid *end) const;
  void settle_rest(TouchAccount &account) const;

 private:
  struct AccountTerm {
    double *sum;
    double more;
  };
  struct KeptPair {
    SolidPair *pair;
    std::size_t from, end;
  };
  std::vector<TouchPush> pushes;
  std::vector<TouchBound> bounds;
  std::vector<AccountTerm> terms;    // of the account
  std::vector<KeptPair> kept;
  std::vector<Solid *> carried;
  double deepest = 0.0;
};

// Threads that take parts of a step.
class TouchThreads {
 public:
  void use(const Threads &now) { threads = now; }
  const Threads &all() const { return threads; }
  // Calls work(step, first, end) for parts of the numbers from 0 to size - 1, all of which take about `ns` nanoseconds. What it
  // adds up by its step is added afterwards, part by part, so that each sum has its terms in the order of numbers.
  template <class Step, class Work>
  void share(const Step &step, std::vector<Solid> &solids, TouchAccount &account, long size, double ns, const Work &work)
  {
    constexpr int PARTS_OF_THREAD = 4;
    const int parts = static_cast<int>(std::min<long>({size, PARTS_OF_THREAD * threads.most(ns), Team::MOST_TASKS}));
    if (parts < 2 || !threads.pays(ns)) return work(step, 0L, size);
    if (late.size() < static_cast<std::size_t>(parts)) late.resize(parts);
    std::vector<Blows> blows(parts);
    threads.each(parts, ns, [&](int n) {
      late[n].clear();
      const Step of_some = step.with(late[n]);
      work(of_some, size * n / parts, size * (n + 1) / parts);
      blows[n] = of_some.held_blows();
    });
    settle(parts, solids, account);
    for (const Blows &of_part : blows) step.take(of_part);
  }

 private:
  void settle(int parts, std::vector<Solid> &solids, TouchAccount &account) const;

  Threads threads;
  std::vector<LateSums> late;    // of the parts
};

}    // namespace mdanim
