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
    ContactAccount of_step;    // of the forces that it adds in this step
  };

  void clear();
  void add(int a, int b, ContactField *field, const Zone *host_zone) { active.push_back({a, b, field, host_zone, {}}); }
  const std::vector<Active> &all() const { return active; }
  // To be called when all fields have their lists.
  void weigh();
  // Points of all fields, whose contacts passes are to compute, where these can do so for each field; else nothing. They come in
  // the order of sums. And these points with what has become of them.
  std::vector<PointsAtPlane> hand_over() const;
  void take_back(const std::vector<PointsAtPlane> &points, ContactAccount &account);
  // The forces of all fields in a step, on `objects`; dt = 0 at the setup of a run.
  void step(std::vector<ContactObject> &objects, ContactArrays &arrays, const Threads &threads, double dt,
            ContactAccount &account);

 private:
  // A field's budget. Until it exceeds `until` a step does not look at the field: what a step needs of resting fields is all
  // here.
  struct Rest {
    int a, b;
    const ContactPlane *at_plane;    // null for a field of two objects
    double budget, until;
  };
  // A field with forces to add in this step, and the number of fields that come before it on each of its objects.
  struct OrderedField {
    std::size_t number;
    int on_a, on_b;
  };
  static bool goes_on_resting(Rest &rest, const std::vector<ContactObject> &objects);
  void add_forces(std::size_t k, std::vector<ContactObject> &objects, ContactArrays &arrays, double dt);
  template <class Work>
  void look(std::size_t first, std::size_t end, const std::vector<ContactObject> &objects, const ContactArrays &arrays, double dt,
            const Work &work);
  void look_and_work_ahead(const std::vector<ContactObject> &objects, const ContactArrays &arrays, const Threads &threads,
                           double ns, double dt);
  void find_order(std::size_t objects);
  void add_side_by_side(std::vector<ContactObject> &objects, ContactArrays &arrays, const Threads &threads, double dt);

  std::vector<Active> active;                            // in the order of sums,
  std::vector<Rest> rests;                               // the same,
  std::vector<char> has_something;                       // whether each has forces to add in this step,
  std::vector<long> costs = {0};                         // and the cost of all before each of them; at the end, that of all
  double looks_before = 0.0;                             // at points of objects, in the last step
  std::vector<OrderedField> ordered;                     // in an order in which no field waits for a later one
  std::vector<std::vector<OrderedField>> after_chain;    // fields that wait for chains of n others, for each n
};

}    // namespace mdanim
