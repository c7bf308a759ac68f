// SPDX-License-Identifier: GPL-2.0-only
// The fields of a step, whose forces are added up in one order, whatever threads do: pairs by ascending ids, within each the
// points of the lower one first; then planes.

#pragma once

#include "contact/contact_field.h"
#include "threads/team.h"

#include <cstddef>
#include <vector>

namespace mdanim {

class FieldSums {
 public:
  // A field of points of object a against object b, by their numbers; against a plane b is a.
  struct Active {
    int a, b;
    ContactField *field;
    const Zone *host_zone;     // for lists
    bool has_something;        // whether it has forces to add in this step,
    ContactAccount of_step;    // and the account of these
  };

  void clear() { active.clear(), costs.assign(1, 0); }
  void add(int a, int b, ContactField *field, const Zone *host_zone) { active.push_back({a, b, field, host_zone, false, {}}); }
  const std::vector<Active> &all() const { return active; }
  // To be called when all fields have their lists.
  void weigh();
  // The forces of all fields in a step, on `objects`; dt = 0 at the setup of a run.
  void step(std::vector<ContactObject> &objects, ContactArrays &arrays, const Threads &threads, double dt,
            ContactAccount &account);

 private:
  // A field with forces to add in this step, and the number of fields that come before it on each of its objects.
  struct OrderedField {
    Active *field;
    int on_a, on_b;
  };
  void look_and_work_ahead(const ContactArrays &arrays, const Threads &threads, double dt);
  void order(std::size_t objects);
  void add_side_by_side(std::vector<ContactObject> &objects, ContactArrays &arrays, const Threads &threads, double dt);

  std::vector<Active> active;                            // in the order of sums,
  std::vector<long> costs = {0};                         // and the cost of all before each of them; at the end, that of all
  std::vector<OrderedField> ordered;                     // in an order in which no field waits for a later one
  std::vector<std::vector<OrderedField>> after_chain;    // fields that wait for chains of n others, for each n
};

}    // namespace mdanim
