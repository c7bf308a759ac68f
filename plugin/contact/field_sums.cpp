// SPDX-License-Identifier: GPL-2.0-only

#include "contact/field_sums.h"

#include "contact/look_batches.h"
#include "threads/waiting.h"

#include <algorithm>
#include <atomic>

namespace mdanim {

static constexpr int FIELD_COST = 20;    // cost of a field without points [ns], approximately
// Cost of a look at a point of an object without a contact [ns], which comes beside the costs of fields.
static constexpr double LOOK_COST = 300.0;
// A step has something to do with few of the fields, and cannot know beforehand with which.
static constexpr int PARTS_OF_THREAD = 8;

void FieldSums::clear()
{
  for (std::size_t k = 0; k < rests.size(); ++k) active[k].field->rest(rests[k].budget);
  active.clear(), rests.clear(), has_something.clear(), costs.assign(1, 0);
}

void FieldSums::weigh()
{
  costs.assign(1, 0);
  rests.clear();
  for (const Active &one : active) {
    costs.push_back(costs.back() + FIELD_COST + one.field->cost());
    rests.push_back({one.a, one.b, one.field->at_plane(), one.field->budget_now(), one.field->rests_until()});
  }
  has_something.assign(active.size(), false);
}

std::vector<PointsAtPlane> FieldSums::hand_over() const
{
  std::vector<PointsAtPlane> found;
  if (!std::all_of(active.begin(), active.end(), [](const Active &one) { return one.field->fits_passes(); })) return found;
  for (const Active &one : active) found.push_back(one.field->hand_over());
  return found;
}

void FieldSums::take_back(const std::vector<PointsAtPlane> &points, ContactAccount &account)
{
  for (std::size_t k = 0; k < points.size(); ++k) {
    active[k].field->take_back(points[k], account);
    rests[k].until = active[k].field->rests_until();
  }
}

// Adds what has come nearer in this step to the budget.
bool FieldSums::goes_on_resting(Rest &rest, const std::vector<ContactObject> &objects)
{
  rest.budget += rest.at_plane ? nearer(objects[rest.a], rest.at_plane->normal(), rest.at_plane->way)
                               : nearer(objects[rest.a], objects[rest.b]);
  return !(rest.until < rest.budget || (objects[rest.b].is_crushed && !rest.at_plane));
}

void FieldSums::add_forces(std::size_t k, std::vector<ContactObject> &objects, ContactArrays &arrays, double dt)
{
  Active &one = active[k];
  one.of_step = {};
  one.field->add_forces(arrays, dt, one.of_step);
  if (!one.field->is_idle()) objects[one.a].is_pushed = objects[one.b].is_pushed = true;
  rests[k].until = one.field->rests_until();
}

void FieldSums::step(std::vector<ContactObject> &objects, ContactArrays &arrays, const Threads &threads, double dt,
                     ContactAccount &account)
{
  if (active.empty()) return;
  const double ns = static_cast<double>(costs.back()) + LOOK_COST * looks_before, looks = account.looks;
  if (dt > 0.0 && threads.pays(ns)) {
    look_and_work_ahead(objects, arrays, threads, ns, dt);
    add_side_by_side(objects, arrays, threads, dt);
  } else {
    look(0, active.size(), objects, arrays, dt, [&](std::size_t k) { add_forces(k, objects, arrays, dt); });
  }
  for (std::size_t k = 0; k < active.size(); ++k)
    if (has_something[k]) account.add(active[k].of_step);
  looks_before = account.looks - looks;
}

// Has what a step reads of a field brought into the cache, some fields ahead: of most fields a step reads little, and waits for
// it.
template <class Fetch> static void fetch_ahead(const std::vector<ContactField *> &awake, std::size_t n, const Fetch &fetch)
{
  constexpr std::size_t AHEAD = 4, LINE = 64, LINES = 6;
  if (n + 2 * AHEAD < awake.size()) {
    const char *const field = reinterpret_cast<const char *>(awake[n + 2 * AHEAD]);
    for (std::size_t line = 0; line < LINES; ++line) __builtin_prefetch(field + LINE * line);
  }
  if (n + AHEAD < awake.size()) fetch(*awake[n + AHEAD]);
}

// Looks at the points that are due, of fields from `first` to `end` - 1 that do not rest. Then calls work(k) for each of these
// fields.
template <class Work>
void FieldSums::look(std::size_t first, std::size_t end, const std::vector<ContactObject> &objects, const ContactArrays &arrays,
                     double dt, const Work &work)
{
  std::vector<ContactField *> awake;
  std::vector<std::size_t> number;
  for (std::size_t k = first; k < end; ++k) {
    has_something[k] = !goes_on_resting(rests[k], objects) || dt == 0.0;
    if (!has_something[k]) continue;
    awake.push_back(active[k].field), number.push_back(k);
  }
  for (std::size_t n = 0; n < awake.size(); ++n) {
    fetch_ahead(awake, n, [](const ContactField &field) { field.fetch_wakes(); });
    if (dt == 0.0) awake[n]->settle(arrays);
    awake[n]->find_due(dt, rests[number[n]].budget);
  }
  LookBatches batches(arrays);
  for (ContactField *field : awake) field->look(arrays, batches);
  batches.finish();
  for (std::size_t n = 0; n < awake.size(); ++n) {
    fetch_ahead(awake, n, [](const ContactField &field) { field.fetch_contacts(); });
    awake[n]->end_looks(arrays);
    work(number[n]);
  }
}

// The work that fields do independently. Their contributions to shared particles and sums are added afterwards, in one order.
void FieldSums::look_and_work_ahead(const std::vector<ContactObject> &objects, const ContactArrays &arrays,
                                    const Threads &threads, double ns, double dt)
{
  const auto number = [&](long cost) { return std::lower_bound(costs.begin(), costs.end() - 1, cost) - costs.begin(); };
  const auto of_costs = [&](long from, long to) {    // costs are in ns, approximately
    look(number(from), number(to), objects, arrays, dt, [&](std::size_t k) {
      ContactField &field = *active[k].field;
      field.work_ahead(arrays, dt);
      has_something[k] = field.has_something();
      if (!has_something[k]) rests[k].until = field.rests_until();
    });
  };
  threads.parts(costs.back(), ns / static_cast<double>(costs.back()), of_costs, PARTS_OF_THREAD);
}

// On each object fields are added in the order of sums. First come those that wait for none, then those that wait for one of
// them, and so on.
void FieldSums::find_order(std::size_t objects)
{
  std::vector<int> before(objects, 0), longest(objects, 0);    // number of fields so far, and the longest chain of them
  for (auto &some : after_chain) some.clear();
  for (std::size_t k = 0; k < active.size(); ++k) {
    if (!has_something[k]) continue;
    const Rest &one = rests[k];
    const int chain = std::max(longest[one.a], longest[one.b]);
    if (static_cast<std::size_t>(chain) == after_chain.size()) after_chain.emplace_back();
    after_chain[chain].push_back({k, before[one.a], before[one.b]});
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
  find_order(objects.size());
  std::vector<std::atomic<int>> added(objects.size());
  std::atomic<std::size_t> next{0};
  threads.each(threads.many(), PART * static_cast<double>(costs.back()), [&](int) {
    for (std::size_t n = next++; n < ordered.size(); n = next++) {
      const OrderedField &turn = ordered[n];
      const Active &one = active[turn.number];
      wait_until([&] {
        return added[one.a].load(std::memory_order_acquire) == turn.on_a &&
               added[one.b].load(std::memory_order_acquire) == turn.on_b;
      });
      add_forces(turn.number, objects, arrays, dt);
      added[one.a].store(turn.on_a + 1, std::memory_order_release);
      if (one.b != one.a) added[one.b].store(turn.on_b + 1, std::memory_order_release);
    }
  });
}

}    // namespace mdanim
