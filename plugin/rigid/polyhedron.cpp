// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/polyhedron.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace mdanim {

static constexpr double BLUNT = 0.7;         // cosine between the normals of two faces above which their edge has no ramp
static constexpr double ROUNDING = 1e-9;     // over the size
static constexpr double ONE_PLACE = 1e-6;    // the same: corners that are nearer to each other are one

Polyhedron Polyhedron::box(const Vec3 &half)
{
  std::vector<Vec3> corners;
  for (int q = 0; q < 8; ++q) corners.push_back({q & 1 ? half.x : -half.x, q & 2 ? half.y : -half.y, q & 4 ? half.z : -half.z});
  return Polyhedron(corners, {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}});
}

Polyhedron::Polyhedron(const std::vector<Vec3> &corners, const std::vector<std::vector<int>> &loops)
{
  for (const Vec3 &at : corners) all_corners.push_back({at, {}, {}});
  check_corners();
  find_faces(loops);
  find_edges();
}

double Polyhedron::size() const
{
  double size = 0.0;
  for (const Corner &corner : all_corners) size = std::max(size, length(corner.at - all_corners[0].at));
  return size;
}

void Polyhedron::check_corners() const
{
  const double least = ONE_PLACE * size();
  for (std::size_t b = 0; b < all_corners.size(); ++b)
    for (std::size_t a = 0; a < b; ++a)
      if (!(length(all_corners[b].at - all_corners[a].at) > least))
        throw std::runtime_error("corners " + std::to_string(a) + " and " + std::to_string(b) +
                                 " are at one place; make them one, and leave out the edge between them");
}

void Polyhedron::find_faces(const std::vector<std::vector<int>> &loops)
{
  const double size = this->size();
  for (const std::vector<int> &loop : loops) {
    const std::string which = "face " + std::to_string(all_faces.size() + 1);
    Vec3 area;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const int a = loop[k], b = loop[(k + 1) % loop.size()];
      if (a < 0 || a >= static_cast<int>(all_corners.size()) || a == b || b < 0 || b >= static_cast<int>(all_corners.size()))
        throw std::runtime_error(which + " has a corner that there is not, or one twice");
      area += cross(all_corners[a].at - all_corners[loop[0]].at, all_corners[b].at - all_corners[loop[0]].at);
    }
    if (!(length(area) > ROUNDING * size * size)) throw std::runtime_error(which + " has no area");
    Face face{unit(area), 0.0, loop, {}, {}};
    for (const int corner : loop) face.at += dot(face.normal, all_corners[corner].at) / static_cast<double>(loop.size());
    for (const int corner : loop)
      if (std::fabs(dot(face.normal, all_corners[corner].at) - face.at) > 1e3 * ROUNDING * size)
        throw std::runtime_error(which + " is not flat");
    for (const Corner &corner : all_corners)
      if (dot(face.normal, corner.at) - face.at > 1e3 * ROUNDING * size)
        throw std::runtime_error(which +
                                 " has a corner of the body before it: the body is not convex, or the corners of the face "
                                 "are not counter-clockwise from outside");
    for (const int corner : loop) all_corners[corner].faces.push_back(static_cast<int>(all_faces.size()));
    all_faces.push_back(std::move(face));
  }
}

void Polyhedron::find_edges()
{
  std::map<std::pair<int, int>, int> left_of;    // face to the left of an edge from one corner to the other
  std::vector<EdgeEnd> edge_ends;
  for (std::size_t f = 0; f < all_faces.size(); ++f) {
    const std::vector<int> &loop = all_faces[f].corners;
    for (std::size_t k = 0; k < loop.size(); ++k)
      if (!left_of.emplace(std::pair{loop[k], loop[(k + 1) % loop.size()]}, static_cast<int>(f)).second)
        throw std::runtime_error("two faces have the same edge in the same sense");
  }
  if (left_of.empty()) throw std::runtime_error("there is no face");
  for (const auto &[ends, left] : left_of) {
    const auto [a, b] = ends;
    const auto other = left_of.find({b, a});
    if (other == left_of.end())
      throw std::runtime_error("the edge between corners " + std::to_string(a) + " and " + std::to_string(b) + " has one face");
    if (a > b) continue;
    const Vec3 way = all_corners[b].at - all_corners[a].at, along = unit(way);
    Face &one = all_faces[left], &two = all_faces[other->second];
    // Counter-clockwise from outside: a face is to the left of its edges.
    const Vec3 into_one = cross(one.normal, along), into_two = cross(along, two.normal);
    if (dot(one.normal, two.normal) > 1.0 - ROUNDING) throw std::runtime_error("two faces are in one plane; make them one");
    all_edges.push_back(
        {0.5 * (all_corners[a].at + all_corners[b].at), along, 0.5 * length(way), {into_one, into_two}, {left, other->second}});
    all_corners[a].ways.push_back(along);
    all_corners[b].ways.push_back(-1.0 * along);
    for (const auto &[face, into] : {std::pair(left, into_one), std::pair(other->second, into_two)}) {
      edge_ends.push_back({a, face, along, into});
      edge_ends.push_back({b, face, -1.0 * along, into});
    }
    if (dot(one.normal, two.normal) > BLUNT) {
      one.next.push_back(other->second);
      two.next.push_back(left);
    } else {
      one.bounds.push_back({-1.0 * into_one, -dot(into_one, all_corners[a].at)});
      two.bounds.push_back({-1.0 * into_two, -dot(into_two, all_corners[a].at)});
    }
    const bool is_new = std::none_of(all_directions.begin(), all_directions.end(),
                                     [&](const Vec3 &known) { return std::fabs(dot(known, along)) > 1.0 - ROUNDING; });
    if (is_new) all_directions.push_back(along);
  }
  for (const Corner &corner : all_corners)
    if (corner.ways.size() < 3) throw std::runtime_error("a corner has fewer than three edges");
  add_ways_between(all_corners, edge_ends);
  for (Face &face : all_faces) find_outlines(face.bounds);
  // Euler: corners - edges + faces is 2 for each closed convex surface.
  if (all_corners.size() + all_faces.size() != all_edges.size() + 2)
    throw std::runtime_error("the " + std::to_string(all_faces.size()) +
                             " faces are more than one closed surface; give each of them as an object of its own");
}

void Polyhedron::add_ways_between(std::vector<Corner> &corners, std::vector<EdgeEnd> ends)
{
  constexpr double IN_LINE = -0.875;    // cosine between two ways; 30 degrees off the line they still say enough
  std::stable_sort(ends.begin(), ends.end(),
                   [](const EdgeEnd &a, const EdgeEnd &b) { return std::pair(a.corner, a.face) < std::pair(b.corner, b.face); });
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t j = i + 1; j < ends.size() && ends[j].corner == ends[i].corner && ends[j].face == ends[i].face; ++j) {
      const Vec3 between = ends[i].way + ends[j].way;
      if (dot(ends[i].way, ends[j].way) < IN_LINE && dot(between, ends[i].into) > 0.0 && dot(between, ends[j].into) > 0.0)
        corners[ends[i].corner].ways.push_back(unit(between));
    }
}

// Along an outline of many short edges the ramps of neighbours are one: their product would leave little within it.
void Polyhedron::find_outlines(std::vector<Bound> &bounds)
{
  constexpr double ONE_CURVE = 0.8;    // cosine between two bounds
  for (std::size_t k = 0; k < bounds.size(); ++k) bounds[k].outline = static_cast<int>(k);
  for (std::size_t i = 0; i < bounds.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const int first = std::min(bounds[i].outline, bounds[j].outline), second = std::max(bounds[i].outline, bounds[j].outline);
      if (first == second || dot(bounds[i].outward, bounds[j].outward) < ONE_CURVE) continue;
      for (Bound &one : bounds)
        if (one.outline == second) one.outline = first;
    }
  std::stable_sort(bounds.begin(), bounds.end(), [](const Bound &a, const Bound &b) { return a.outline < b.outline; });
}

void Polyhedron::cover(int face)
{
  all_faces[face].covered = true;
  for (Edge &edge : all_edges) edge.covered = edge.covered || edge.faces[0] == face || edge.faces[1] == face;
  for (const int corner : all_faces[face].corners) all_corners[corner].covered = true;
}

void Polyhedron::cover(const std::vector<char> &faces)
{
  const auto closes = [&](const auto &of) {
    const auto has = [&](char wanted) {
      return std::any_of(std::begin(of), std::end(of), [&](int f) { return faces[f] == wanted; });
    };
    return has(1) && !has(2);
  };
  for (std::size_t f = 0; f < all_faces.size(); ++f) all_faces[f].covered = faces[f] == 1;
  for (Edge &edge : all_edges) edge.covered = closes(edge.faces);
  for (Corner &corner : all_corners) corner.covered = closes(corner.faces);
}

double Polyhedron::area(int face) const
{
  const std::vector<int> &loop = all_faces[face].corners;
  Vec3 twice;
  for (std::size_t k = 2; k < loop.size(); ++k)
    twice += cross(all_corners[loop[k - 1]].at - all_corners[loop[0]].at, all_corners[loop[k]].at - all_corners[loop[0]].at);
  return 0.5 * dot(twice, all_faces[face].normal);
}

double Polyhedron::outside(const Vec3 &x) const
{
  double most = -HUGE_VAL;
  for (const Face &face : all_faces) most = std::max(most, dot(face.normal, x) - face.at);
  return most;
}

double Polyhedron::reach(const Vec3 &n) const
{
  double most = -HUGE_VAL;
  for (const Corner &corner : all_corners) most = std::max(most, dot(n, corner.at));
  return most;
}

double Polyhedron::thickness() const
{
  double least = HUGE_VAL;
  for (const Face &face : all_faces) least = std::min(least, face.at + reach(-1.0 * face.normal));
  return least;
}

Polyhedron::Foot Polyhedron::nearest(const Vec3 &x) const
{
  Foot inside{{}, -HUGE_VAL};
  double square = HUGE_VAL;
  Vec3 from;
  for (const Face &face : all_faces) {
    const double above = dot(face.normal, x) - face.at;
    if (above > inside.distance) inside = {face.normal, above};
    if (above <= 0.0 || above * above >= square) continue;
    // The closest point of the face: below x, or on the edges that x is beyond.
    bool is_beyond = false;
    for (std::size_t k = 0; k < face.corners.size(); ++k) {
      const Vec3 &a = all_corners[face.corners[k]].at, &b = all_corners[face.corners[(k + 1) % face.corners.size()]].at;
      const Vec3 way = b - a, r = x - a;
      if (dot(cross(way, face.normal), r) <= 0.0) continue;
      is_beyond = true;
      const double s = std::min(std::max(dot(way, r) / dot(way, way), 0.0), 1.0);
      const Vec3 away = r - s * way;
      if (dot(away, away) < square) square = dot(away, away), from = away;
    }
    if (!is_beyond) square = above * above, from = above * face.normal;
  }
  if (inside.distance <= 0.0) return inside;
  const double distance = std::sqrt(square);
  return {(1.0 / distance) * from, distance};
}

}    // namespace mdanim
