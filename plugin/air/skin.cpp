// SPDX-License-Identifier: GPL-2.0-only

#include "air/skin.h"

#include <algorithm>

namespace mdanim {

void AirSkin::append_point(const Weights &weights)
{
  for (const auto &[particle, part] : weights) {
    node.push_back(particle);
    weight.push_back(part);
  }
  first.push_back(node.size());
}

void AirSkin::finish()
{
  for (const double part : weight) largest_weight = std::max(largest_weight, std::fabs(part));
  needed = node;
  std::sort(needed.begin(), needed.end());
  needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
  for (int &one : node) one = static_cast<int>(std::lower_bound(needed.begin(), needed.end(), one) - needed.begin());
}

std::size_t AirSkin::bytes() const
{
  return first.capacity() * sizeof(std::size_t) + (node.capacity() + needed.capacity()) * sizeof(int) +
         weight.capacity() * sizeof(double) + triangles.capacity() * sizeof(triangles[0]) +
         cylinders.capacity() * sizeof(Cylinder) + balls.capacity() * sizeof(Ball) + panels.capacity() * sizeof(Panel);
}

void AirSkin::find_points(AirScratch &with) const
{
  with.place.resize(points());
  with.velocity.resize(points());
  for (int p = 0; p < points(); ++p) {
    Vec3 place, velocity;
    for (std::size_t k = first[p]; k < first[p + 1]; ++k) {
      place += weight[k] * with.x[node[k]];
      velocity += weight[k] * with.v[node[k]];
    }
    with.place[p] = place;
    with.velocity[p] = velocity;
  }
}

Vec3 AirSkin::area_of(const Points &t, const AirScratch &with)
{
  const Vec3 &a = with.place[t[0]], &b = with.place[t[1]], &c = with.place[t[2]];
  return 0.5 * cross(b - a, c - a);
}

AirSkin::Areas AirSkin::areas_of_frame(const AirScratch &with) const
{
  if (!has_frame()) return {};
  const Vec3 &from = with.place[frame[0]];
  const Vec3 x = with.place[frame[1]] - from, y = with.place[frame[2]] - from, z = with.place[frame[3]] - from;
  return {cross(y, z), cross(z, x), cross(x, y)};
}

// Whether a particle carries one of these points.
template <std::size_t N> bool AirSkin::needs(const std::array<int, N> &of, int particle) const
{
  return std::any_of(of.begin(), of.end(), [&](int p) {
    return std::any_of(node.begin() + first[p], node.begin() + first[p + 1], [&](int one) { return needed[one] == particle; });
  });
}

void AirSkin::open(int low, int high, Holes &holes) const
{
  holes.triangle.resize(triangles.size(), 0);
  holes.cylinder.resize(cylinders.size(), 0);
  for (std::size_t n = 0; n < triangles.size(); ++n)
    if (needs(triangles[n], low) && needs(triangles[n], high)) holes.triangle[n] = 1;
  for (std::size_t n = 0; n < cylinders.size(); ++n)
    if (const std::array<int, 2> ends = {cylinders[n].from, cylinders[n].to}; needs(ends, low) && needs(ends, high))
      holes.cylinder[n] = 1;
}

static bool is_hole(const std::vector<char> &holes, std::size_t n) { return !holes.empty() && holes[n]; }

void AirSkin::find_faces(const Holes &holes, AirScratch &with) const
{
  const std::size_t rods = triangles.size() + cylinders.size(), round = rods + balls.size();
  with.face.resize(triangles.size() + panels.size());
  with.size.resize(round + panels.size());
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    with.face[n] = is_hole(holes.triangle, n) ? Vec3{} : area_of(triangles[n], with);
    with.size[n] = length(with.face[n]);
  }
  for (std::size_t n = 0; n < cylinders.size(); ++n) {
    const double way = length(with.place[cylinders[n].to] - with.place[cylinders[n].from]);
    const bool gone = is_hole(holes.cylinder, n) || way > cylinders[n].most;
    with.size[triangles.size() + n] = gone ? 0.0 : cylinders[n].diameter * way;
  }
  for (std::size_t n = 0; n < balls.size(); ++n) with.size[rods + n] = AirLaw::face_of_ball(balls[n].diameter);
  const Areas areas = areas_of_frame(with);
  for (std::size_t n = 0; n < panels.size(); ++n) {
    with.face[triangles.size() + n] = areas.of(panels[n].part);
    with.size[round + n] = length(with.face[triangles.size() + n]);
  }
}

// Part of the surface of each point.
void AirSkin::find_areas(AirScratch &with) const
{
  with.area.assign(points(), 0.0);
  auto size = with.size.begin();
  for (const Points &t : triangles) {
    const double third = *size++ / 3.0;
    for (const int p : t) with.area[p] += third;
  }
  for (const Cylinder &one : cylinders) {
    const double half = 0.5 * *size++;
    with.area[one.from] += half;
    with.area[one.to] += half;
  }
  for (const Ball &one : balls) with.area[one.at] += *size++;
  for (const Panel &one : panels) with.area[one.at] += *size++;
}

// Largest area over mass of the nodes of each point, where a node carries the areas of its points by its weights.
void AirSkin::find_loads(AirScratch &with) const
{
  std::vector<double> &of_node = with.load_of_node;
  of_node.assign(needed.size(), 0.0);
  for (int p = 0; p < points(); ++p)
    for (std::size_t k = first[p]; k < first[p + 1]; ++k) of_node[node[k]] += std::fabs(weight[k]) * with.area[p];
  for (std::size_t n = 0; n < needed.size(); ++n) of_node[n] /= with.mass[n];
  with.load.assign(points(), 0.0);
  for (int p = 0; p < points(); ++p)
    for (std::size_t k = first[p]; k < first[p + 1]; ++k) with.load[p] = std::max(with.load[p], of_node[node[k]]);
}

// Whether a force may have to be lowered, by a load above that of any point: all of the surface on the lightest node.
bool AirSkin::may_be_lowered(const AirLaw &law, const AirScratch &with) const
{
  double all = 0.0, fastest = 0.0;
  for (const double size : with.size) all += size;
  for (const Vec3 &v : with.velocity) fastest = std::max(fastest, dot(law.wind - v, law.wind - v));
  const double lightest = *std::min_element(with.mass.begin(), with.mass.end());
  return law.half * std::sqrt(fastest) * law.dt * largest_weight * all > AirLaw::MOST * lightest;
}

template <class Push> void AirSkin::each_force(const AirLaw &law, double above, const AirScratch &with, const Push &push) const
{
  const std::vector<Vec3> &x = with.place, &v = with.velocity;
  const std::vector<double> &load = with.load;
  const double *size = with.size.data();
  const Vec3 *face = with.face.data();
  for (const Points &t : triangles) {
    const Vec3 &area = *face++;
    const double its_size = *size++;
    const auto [a, b, c] = t;
    if (its_size == 0.0 || (x[a].z + x[b].z + x[c].z) / 3.0 < above) continue;
    const Vec3 velocity = (1.0 / 3.0) * (v[a] + v[b] + v[c]);
    push(law.on_surface(area, its_size, velocity, sides, std::max({load[a], load[b], load[c]})), t, 1.0 / 3.0);
  }
  for (const Cylinder &one : cylinders) {
    const std::array<int, 2> ends = {one.from, one.to};
    if (*size++ == 0.0 || 0.5 * (x[one.from].z + x[one.to].z) < above) continue;
    const Vec3 velocity = 0.5 * (v[one.from] + v[one.to]);
    push(law.on_cylinder(x[one.to] - x[one.from], one.diameter, velocity, std::max(load[one.from], load[one.to])), ends, 0.5);
  }
  for (const Ball &one : balls)
    if (x[one.at].z >= above) push(law.on_ball(one.diameter, v[one.at], load[one.at]), std::array<int, 1>{one.at}, 1.0);
  size += balls.size();
  for (const Panel &one : panels) {
    const Vec3 &area = *face++;
    const double its_size = *size++;
    if (x[one.at].z >= above)
      push(law.on_surface(area, its_size, v[one.at], sides, load[one.at]), std::array<int, 1>{one.at}, 1.0);
  }
}

Vec3 AirSkin::push(const AirLaw &law, double above, const Holes &holes, AirScratch &with) const
{
  find_points(with);
  find_faces(holes, with);
  if (may_be_lowered(law, with)) {
    find_areas(with);
    find_loads(with);
  } else {
    with.load.assign(points(), 0.0);
  }
  with.push.assign(points(), {});
  with.force.assign(needed.size(), {});
  Vec3 sum;
  each_force(law, above, with, [&](const Vec3 &force, const auto &at, double part) {
    sum += force;
    for (const int p : at) with.push[p] += part * force;
  });
  for (int p = 0; p < points(); ++p) {
    const Vec3 force = with.push[p];
    if (force.x == 0.0 && force.y == 0.0 && force.z == 0.0) continue;    // half of a solid, where air leaves it
    for (std::size_t k = first[p]; k < first[p + 1]; ++k) with.force[node[k]] += weight[k] * force;
  }
  return sum;
}

}    // namespace mdanim
