// SPDX-License-Identifier: GPL-2.0-only
// Contacts of points with a plane.

#include "contact/plane_field.h"

#include "contact/contact_kernel.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace mdanim {

void PlaneField::list(const FieldLists &with)
{
  owner = host = &with.owner;
  const double reach = REACH * with.skin + plane.ahead(with.skin);
  list_points(with, plane.within(reach + owner->body->radius()), true, reach, AT_ONCE,
              [this](const Vec3 &x) { return -depth_at(x); });
  are_particles = std::all_of(near.begin(), near.end(), [this](int point) {
    const PointCarriers by = owner->carriers_of(point);
    return by.middle - by.first == 1 && by.first->weight == 1.0;
  });
}

bool PlaneField::look_at(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  const Vec3 x = owner->place_of(near[q], arrays.place());
  const double depth = depth_at(x);
  const bool was_below = known[q];
  known[q] = depth > 0.0;
  if (depth <= 0.0 || !may_begin) {
    wake.set(q, budget - std::min(depth, 0.0));
    return false;
  }
  PlaneContact contact{};
  contact.point = near[q];
  contact.plane = number;
  contact.state.anchor = x - plane.shift;
  contact.state.memory.depth = depth;
  contact.state.memory.offset = was_below ? depth : 0.0;
  begin(q, contact);
  return true;
}

// Ends contacts of points that are replaced.
void PlaneField::owner_tears(const TornBody *before, const ContactArrays &arrays, ContactAccount &account)
{
  const auto ends = [&](PlaneContact &one) {
    if (!owner->has_changed(one.point, before)) return false;
    const PointCarriers by = before ? before->carriers_of(one.point) : owner->body->carriers_of(one.point);
    const double area = before ? before->areas()[one.point] : owner->body->areas()[one.point];
    const Vec3 moved = owner->place_by(by, arrays.place()) - owner->place_by(by, arrays.place_before());
    const ContactForce<double> last = contact_pressure(law, area, 1.0, one.state.memory.depth, 0.0, one.state.memory);
    // Its last forces still did work in half of this step, as leap-frog counts it.
    const double deeper = -dot(plane.normal(), moved);
    account.heat += one.state.memory.stick_energy - 0.5 * dot(one.state.memory.pull + one.state.memory.drag, moved);
    account.damped += last_damping_work(one.state.memory, one.state.memory.depth + deeper);
    account.let_go += last.surface_energy + 0.5 * last.press * deeper;
    return true;
  };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), ends), contacts.end());
}

// --- in passes ---

// Springs of contacts that had friction before are left to the field.
bool PlaneField::fits_passes() const
{
  if (!may_be_in_passes()) return false;
  const auto has_springs = [](const PlaneContact &one) {
    return one.state.memory.stick != 0.0 || one.state.memory.damping != 0.0;
  };
  return law.friction > 0.0 || (!(law.damping > 0.0) && std::none_of(contacts.begin(), contacts.end(), has_springs));
}

PointsAtPlane PlaneField::hand_over() const
{
  PointsAtPlane all = {law, owner->body->radius(), plane.axis, plane.sign, plane.at, {}};
  all.points.reserve(near.size());
  for (std::size_t q = 0; q < near.size(); ++q)
    all.points.push_back({owner->slot[owner->carriers_of(near[q]).first->slot], owner->areas()[near[q]], known[q] != 0});
  for (std::size_t c = 0; c < contacts.size(); ++c) all.points[of_contact[c]].state = contacts[c].state;
  auto loss = losses.begin();
  for (std::size_t q = 0; q < near.size(); ++q) {
    while (loss != losses.end() && loss->point < near[q]) ++loss;
    if (loss != losses.end() && loss->point == near[q]) all.points[q].heat = loss->heat, all.points[q].damped = loss->damped;
  }
  return all;
}

void PlaneField::take_back(const PointsAtPlane &now, ContactAccount &account)
{
  contacts.clear(), of_contact.clear();
  std::vector<LossOfPoint> of_near;
  for (std::size_t q = 0; q < near.size(); ++q) {
    const PointAtPlane &point = now.points[q];
    if (point.heat != 0.0 || point.damped != 0.0) of_near.push_back({near[q], point.heat, point.damped});
    account.deepest = std::max(account.deepest, point.deepest);
    known[q] = point.state.memory.depth > 0.0;
    wake.set(q, AT_ONCE);
    if (!known[q]) continue;
    wake.set(q, NEVER);
    of_contact.push_back(q);
    contacts.push_back({near[q], number, point.state});
  }
  std::vector<LossOfPoint> all;    // of points that are not near any more, too
  std::set_union(of_near.begin(), of_near.end(), losses.begin(), losses.end(), std::back_inserter(all),
                 [](const LossOfPoint &one, const LossOfPoint &other) { return one.point < other.point; });
  losses = std::move(all);
}

// By ascending points.
void PlaneField::add_losses(const std::vector<LossOfPoint> &more)
{
  std::vector<LossOfPoint> all;
  auto one = losses.begin();
  for (const LossOfPoint &other : more) {
    if (other.heat == 0.0 && other.damped == 0.0) continue;
    while (one != losses.end() && one->point < other.point) all.push_back(*one++);
    const bool is_known = one != losses.end() && one->point == other.point;
    all.push_back(is_known ? LossOfPoint{other.point, one->heat + other.heat, one->damped + other.damped} : other);
    if (is_known) ++one;
  }
  if (all.empty()) return;
  all.insert(all.end(), one, losses.end());
  losses = std::move(all);
}

// Cost of a point, of a field with contacts, and of a contact.
int PlaneField::cost() const
{
  constexpr std::size_t POINT = 2, SOME_CONTACTS = 600, CONTACT = 80;
  return static_cast<int>(POINT * near.size() + (contacts.empty() ? 0 : SOME_CONTACTS + CONTACT * contacts.size()));
}

void PlaneField::begin_step(const ContactArrays &)
{
  on_plane = {};
  ahead.clear();
}

// One contact; one that is over stays as it is.
PlanePush<double> PlaneField::push(PlaneContact &contact, std::size_t q, const ContactArrays &arrays, double dt) const
{
  const Vec3 x = owner->place_of(near[q], arrays.place());
  const double depth = depth_at(x);
  PlanePush<double> over;
  over.depth = depth;
  if (depth <= 0.0) return over;
  return push_at_plane(law, dt, owner->areas()[near[q]], -1.0 * plane.normal(), x - plane.shift, depth, contact.state);
}

void PlaneField::push_all(const ContactArrays &arrays, double dt)
{
  ahead.resize(contacts.size());
  if (arrays.kernels)
    arrays.kernels->push_at_plane(
        {law, dt, plane.axis, plane.sign, plane.at, plane.shift, owner->body->radius(), owner->points_at(arrays.place())},
        contacts.data(), static_cast<int>(contacts.size()), ahead.data());
  else
    for (std::size_t c = 0; c < contacts.size(); ++c) ahead[c] = push(contacts[c], of_contact[c], arrays, dt);
}

void PlaneField::work_ahead(const ContactArrays &arrays, double dt) { push_all(arrays, dt); }

void PlaneField::end(const PlaneContact &contact, std::size_t q, double depth, LossOfPoint &loss)
{
  loss.heat = contact.state.memory.stick_energy;
  loss.damped = last_damping_work(contact.state.memory, depth);
  known[q] = 0;
  wake.set(q, budget - depth);
}

void PlaneField::add_forces(ContactArrays &arrays, double dt, ContactAccount &account)
{
  const bool moves = dt > 0.0;
  std::vector<PlaneContact> copies;    // in which nothing changes at a setup
  if (!moves) {
    copies = contacts;
    for (std::size_t c = 0; c < copies.size(); ++c) ahead.push_back(push(copies[c], of_contact[c], arrays, dt));
  } else if (ahead.empty()) {
    push_all(arrays, dt);
  }
  const std::vector<PlaneContact> &now = moves ? contacts : copies;
  if (arrays.kernels)
    arrays.kernels->add_at_plane(owner->points_at(arrays.place()), now.data(), static_cast<int>(now.size()), ahead.data(),
                                 arrays.force());
  ContactAccount sums;
  std::vector<LossOfPoint> of_step;
  std::size_t left = 0;
  for (std::size_t c = 0; c < now.size(); ++c) {
    const PlanePush<double> &found = ahead[c];
    LossOfPoint loss = {now[c].point, found.heat, found.damped};
    if (found.depth <= 0.0 && moves) end(now[c], of_contact[c], found.depth, loss);
    if (may_be_in_passes())
      of_step.push_back(loss);
    else
      sums.heat += loss.heat, sums.damped += loss.damped;
    if (found.depth <= 0.0) continue;
    if (!arrays.kernels) owner->push_point(now[c].point, found.force, arrays.force());
    on_plane -= found.force;
    sums.energy += found.energy;
    sums.stick_energy += now[c].state.memory.stick_energy;
    sums.deepest = std::max(sums.deepest, found.depth);
    ++sums.touching;
    if (moves) keep(c, left);
  }
  if (moves) keep_first(left);
  add_losses(of_step);
  account.add(sums);
  if (!plane.moves) return;
  // -F dx with the mean of the forces before and after the step; at the setup of a run nothing has moved.
  if (moves) account.work -= 0.5 * dot(kept_force() + on_plane, plane.of_step);
  if (moves || !before) before = on_plane;
}

}    // namespace mdanim
