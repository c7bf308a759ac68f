// SPDX-License-Identifier: GPL-2.0-only

#include "contact/field_sums.h"

#include "threads/waiting.h"

#include <algorithm>
#include <atomic>

namespace mdanim {

static constexpr int FIELD_COST = 20;    // cost of a field without points [ns], approximately

void FieldSums::weigh()
{
  costs.assign(1, 0);
  for (const Active &one : active) costs.push_back(costs.back() + FIELD_COST + one.field->cost());
}

static void add_forces(FieldSums::Active &one, std::vector<ContactObject> &objects, ContactArrays &arrays, double dt)
{
  one.of_step = {};
  one.field->add_forces(arrays, dt, one.of_step);
  if (!one.field->is_idle()) objects[one.a].is_pushed = objects[one.b].is_pushed = true;
}

void FieldSums::step(std::vector<ContactObject> &objects, ContactArrays &arrays, const Threads &threads, double dt,
                     ContactAccount &account)
{
  if (dt > 0.0 && threads.pays(static_cast<double>(costs.back()))) {
    look_and_work_ahead(arrays, threads, dt);
    add_side_by_side(objects, arrays, threads, dt);
  } else {
    for (Active &one : active) {
      if (dt == 0.0) one.field->settle(arrays);
      one.field->look(arrays, dt);
      one.has_something = true;
      add_forces(one, objects, arrays, dt);
    }
  }
  for (const Active &one : active)
    if (one.has_something) account.add(one.of_step);
}

// The work that fields do independently. Their contributions to shared particles and sums are added afterwards, in one order.
void FieldSums::look_and_work_ahead(const ContactArrays &arrays, const Threads &threads, double dt)
{
  threads.parts(costs.back(), 1.0, [&](long from, long to) {    // costs are in ns, approximately
    const auto number = [&](long cost) { return std::lower_bound(costs.begin(), costs.end() - 1, cost) - costs.begin(); };
    for (long k = number(from), end = number(to); k < end; ++k) {
      Active &one = active[k];
      one.field->look(arrays, dt);
      one.field->work_ahead(arrays, dt);
      one.has_something = one.field->has_something();
    }
  });
}

// On each object fields are added in the order of sums. First come those that wait for none, then those that wait for one of
// them, and so on.
void FieldSums::order(std::size_t objects)
{
  std::vector<int> before(objects, 0), longest(objects, 0);    // number of fields so far, and the longest chain of them
  for (auto &some : after_chain) some.clear();
  for (Active &one : active) {
    if (!one.has_something) continue;
    const int chain = std::max(longest[one.a], longest[one.b]);
    if (static_cast<std::size_t>(chain) == after_chain.size()) after_chain.emplace_back();
    after_chain[chain].push_back({&one, before[one.a], before[one.b]});
    ++before[one.a];
    if (one.b != one.a) ++before[one.b];
    longest[one.a] = longest[one.b] = chain + 1;
  }
  ordered.clear();
  for (const auto &some : after_chain) ordered.insert(ordered.end(), some.begin(), some.end());
}

// Threads take fields in that order, so a thread waits only for a field that another thread is working on.
void FieldSums::add_side_by_side(std::vector<ContactObject> &objects, ContactArrays &arrays, const Threads &threads, double dt)
{
  constexpr double PART = 0.3;    // of the cost
  order(objects.size());
  std::vector<std::atomic<int>> added(objects.size());
  std::atomic<std::size_t> next{0};
  threads.each(threads.many(), PART * static_cast<double>(costs.back()), [&](int) {
    for (std::size_t n = next++; n < ordered.size(); n = next++) {
      const OrderedField &turn = ordered[n];
      Active &one = *turn.field;
      wait_until([&] {
        return added[one.a].load(std::memory_order_acquire) == turn.on_a &&
               added[one.b].load(std::memory_order_acquire) == turn.on_b;
      });
      add_forces(one, objects, arrays, dt);
      added[one.a].store(turn.on_a + 1, std::memory_order_release);
      if (one.b != one.a) added[one.b].store(turn.on_b + 1, std::memory_order_release);
    }
  });
}

}    // namespace mdanim
