// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace mdanim {

static constexpr double SMOOTH = 0.866;    // cosine between triangles above which the surface is smooth at their edge: 30 degrees
static constexpr double BLUNT = 0.7;       // the same of an edge without a ramp, as of polyhedra
static constexpr double ONE_PLANE = 1e-4;      // sine of the angle below which two triangles are one side
static constexpr double NEAR = 1e-6;           // over the size: how far a corner may be from the plane of its side
static constexpr double LEAST_AREA = 1e-14;    // over the square of the size

static double size_of(const std::vector<Vec3> &places)
{
  Box box;
  for (const Vec3 &at : places) box.include(&at.x);
  return box.diagonal();
}

TriangleMesh::TriangleMesh(std::vector<Vec3> places, const std::vector<Corners> &triangles) : places(std::move(places))
{
  join(triangles);
  find_sides();
  find_patches();
  find_borders();
  find_trees();
}

double TriangleMesh::bound() const
{
  double most = 0.0;
  for (const Triangle &one : all_triangles)
    for (int k = 0; k < 3; ++k) most = std::max(most, length(places[one.corner[k]]) + one.patch.bulge());
  return most;
}

void TriangleMesh::join(const std::vector<Corners> &corners)
{
  const double size = size_of(places);
  const auto which = [](std::size_t t) { return "triangle " + std::to_string(t + 1); };
  std::map<std::pair<int, int>, int> left_of;    // triangle to the left of an edge from one corner to the other
  for (std::size_t t = 0; t < corners.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = corners[t][k], b = corners[t][(k + 1) % 3];
      if (a < 0 || a >= static_cast<int>(places.size()) || a == b)
        throw std::runtime_error(which(t) + " has a corner that there is not, or one twice");
      if (!left_of.emplace(std::pair{a, b}, static_cast<int>(t)).second)
        throw std::runtime_error("two triangles have the same edge in the same sense");
    }
    const Vec3 &a = places[corners[t][0]];
    areas.push_back(0.5 * length(cross(places[corners[t][1]] - a, places[corners[t][2]] - a)));
    if (!(areas.back() > LEAST_AREA * size * size)) throw std::runtime_error(which(t) + " has no area");
    all_triangles.push_back({corners[t], {}, -1, {}});
  }
  if (corners.empty()) throw std::runtime_error("there is no triangle");
  for (Triangle &one : all_triangles)
    for (int k = 0; k < 3; ++k) {
      const auto other = left_of.find({one.corner[(k + 1) % 3], one.corner[k]});
      if (other == left_of.end())
        throw std::runtime_error("the edge between corners " + std::to_string(one.corner[k]) + " and " +
                                 std::to_string(one.corner[(k + 1) % 3]) + " has one triangle");
      one.beyond[k] = other->second;
    }
}

// The largest triangles begin: the plane of a narrow one is rounding.
void TriangleMesh::find_sides()
{
  const double near = NEAR * size_of(places);
  std::vector<int> order(all_triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [this](int a, int b) { return areas[a] > areas[b]; });
  for (const int seed : order) {
    if (all_triangles[seed].side >= 0) continue;
    const int number = static_cast<int>(all_sides.size());
    all_sides.emplace_back();
    MeshSide &side = all_sides.back();
    side.normal = unit(cross(place(seed, 1) - place(seed, 0), place(seed, 2) - place(seed, 0)));
    side.at = dot(side.normal, place(seed, 0));
    take_into(number, seed, near);
  }
}

void TriangleMesh::take_into(int number, int seed, double near)
{
  MeshSide &side = all_sides[number];
  all_triangles[seed].side = number;
  side.triangles.push_back(seed);
  side.area = areas[seed];
  for (std::size_t next = 0; next < side.triangles.size(); ++next)
    for (const int other : all_triangles[side.triangles[next]].beyond) {
      Triangle &one = all_triangles[other];
      if (one.side >= 0) continue;
      const Vec3 area = cross(place(other, 1) - place(other, 0), place(other, 2) - place(other, 0));
      const bool is_level = length(cross(area, side.normal)) < ONE_PLANE * length(area) && dot(area, side.normal) > 0.0;
      bool is_near = true;
      for (const int corner : one.corner) is_near = is_near && std::fabs(dot(side.normal, places[corner]) - side.at) <= near;
      if (!is_near || (!is_level && areas[other] > near * near)) continue;
      one.side = number;
      side.area += areas[other];
      side.triangles.push_back(other);
    }
  std::sort(side.triangles.begin(), side.triangles.end());
}

bool TriangleMesh::is_smooth(int triangle, int edge) const
{ return dot(normal_of(triangle), normal_of(all_triangles[triangle].beyond[edge])) > SMOOTH; }

std::vector<int> TriangleMesh::around(int triangle, int k) const
{
  return around(triangle, k, [](int, int) { return true; });
}

// The ones among them that are reached over edges that `passes` lets through.
template <class Passes> std::vector<int> TriangleMesh::around(int triangle, int k, const Passes &passes) const
{
  std::vector<int> found{triangle};
  const int corner = all_triangles[triangle].corner[k];
  for (std::size_t next = 0; next < found.size(); ++next) {
    const Triangle &one = all_triangles[found[next]];
    for (int edge = 0; edge < 3; ++edge) {
      if (one.corner[edge] != corner && one.corner[(edge + 1) % 3] != corner) continue;
      const int other = one.beyond[edge];
      if (std::find(found.begin(), found.end(), other) == found.end() && passes(found[next], edge)) found.push_back(other);
    }
  }
  return found;
}

// The normal at a corner of a triangle: the mean over the triangles around it up to the next creases, each with its angle there
// and the area of its side. Large flat sides stay flat beside narrow ones that round their edges.
Vec3 TriangleMesh::smooth_normal(int triangle, int k) const
{
  const int corner = all_triangles[triangle].corner[k];
  std::vector<int> around = this->around(triangle, k, [this](int t, int edge) { return is_smooth(t, edge); });
  std::sort(around.begin(), around.end());    // all of them find the same bits
  Vec3 sum;
  for (const int t : around) {
    const Triangle &one = all_triangles[t];
    const int own = one.corner[0] == corner ? 0 : one.corner[1] == corner ? 1 : 2;
    const Vec3 a = place(t, own + 1) - place(t, own), b = place(t, own + 2) - place(t, own);
    const double angle = std::acos(std::min(std::max(dot(a, b) / (length(a) * length(b)), -1.0), 1.0));
    sum += (angle * all_sides[one.side].area) * normal_of(t);
  }
  return unit(sum);
}

void TriangleMesh::find_patches()
{
  for (int t = 0; t < static_cast<int>(all_triangles.size()); ++t) {
    Vec3 corner[3], normal[3];
    bool is_straight[3];
    for (int k = 0; k < 3; ++k) {
      corner[k] = place(t, k);
      normal[k] = smooth_normal(t, k);
      is_straight[k] = !is_smooth(t, k);
    }
    all_triangles[t].patch = CurvedTriangle(corner, normal, is_straight);
  }
}

void TriangleMesh::find_borders()
{
  std::vector<Polyhedron::Corner> found(places.size());
  std::vector<Polyhedron::EdgeEnd> edge_ends;
  for (std::size_t p = 0; p < places.size(); ++p) found[p].at = places[p];
  for (int t = 0; t < static_cast<int>(all_triangles.size()); ++t)
    for (int k = 0; k < 3; ++k) {
      const int other = all_triangles[t].beyond[k], own_side = all_triangles[t].side, beyond = all_triangles[other].side;
      if (own_side == beyond) continue;
      const int a = all_triangles[t].corner[k], b = all_triangles[t].corner[(k + 1) % 3];
      const Vec3 way = places[b] - places[a], along = unit(way);
      const Vec3 &normal = normal_of(t), &normal_beyond = normal_of(other);
      const Vec3 into = unit(cross(normal, along)), into_beyond = unit(cross(along, normal_beyond));
      const bool is_convex = dot(into_beyond, normal) < 0.0;
      all_sides[own_side].borders.push_back(
          {places[a], along, -1.0 * into, length(way), beyond, is_convex, dot(normal, normal_beyond) <= BLUNT});
      found[a].ways.push_back(along);
      found[a].faces.push_back(own_side);
      if (all_sides[own_side].triangles.size() > 1) {
        edge_ends.push_back({a, own_side, along, into});
        edge_ends.push_back({b, own_side, -1.0 * along, into});
      }
      if (is_convex && a < b)
        all_edges.push_back({0.5 * (places[a] + places[b]), along, 0.5 * length(way), {into, into_beyond}, {own_side, beyond}});
    }
  Polyhedron::add_ways_between(found, std::move(edge_ends));
  for (Polyhedron::Corner &one : found)
    if (one.faces.size() >= 3) all_corners.push_back(std::move(one));
}

void TriangleMesh::find_trees()
{
  std::vector<Box> boxes(all_triangles.size()), of_corners(all_corners.size()), of_edges(all_edges.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    for (const int corner : all_triangles[t].corner) boxes[t].include(&places[corner].x);
    boxes[t] = boxes[t].grown(all_triangles[t].patch.bulge());
  }
  for (std::size_t c = 0; c < of_corners.size(); ++c) of_corners[c].include(&all_corners[c].at.x);
  for (std::size_t e = 0; e < of_edges.size(); ++e)
    for (const double end : {-1.0, 1.0}) {
      const Vec3 at = all_edges[e].middle + (end * all_edges[e].half) * all_edges[e].along;
      of_edges[e].include(&at.x);
    }
  tree = BoxTree(boxes);
  tree_of_corners = BoxTree(of_corners);
  tree_of_edges = BoxTree(of_edges);
}

std::vector<int> TriangleMesh::near(const BoxTree &tree, const Box &box)
{
  std::vector<int> found;
  tree.meeting(box, [&](int number) { found.push_back(number); });
  std::sort(found.begin(), found.end());
  return found;
}

// Whether a point is on a border as well as its place is known: then it has no way to it.
static bool distance_is_rounding(double square, const TriangleMesh::MeshBorder &border)
{
  constexpr double ROUNDING = 1e-9;
  return square <= (ROUNDING * border.length) * (ROUNDING * border.length);
}

// Where the nearest point is the common end of two borders, that one counts whose line is farther away.
TriangleMesh::Footprint TriangleMesh::footprint(int number, const Vec3 &x) const
{
  const MeshSide &side = all_sides[number];
  const Vec3 p = x - (dot(side.normal, x) - side.at) * side.normal;
  struct Nearest {
    double square = HUGE_VAL, line = 0.0;    // `line`: inward from the line of the border
    Vec3 away, outward;
    bool is_edge = false;
  } all, sharp;
  Vec3 at_end;    // where x is at the end of sharp borders: their sum and number
  int ends = 0;
  const auto take = [](Nearest &least, const MeshBorder &border, double square, double line, const Vec3 &away) {
    constexpr double SAME = 1e-12;
    const bool is_same = std::fabs(square - least.square) <= SAME * square;
    if (is_same ? std::fabs(line) > std::fabs(least.line) : square < least.square)
      least = {square, line, away, border.outward, border.is_convex && border.is_sharp};
  };
  for (const MeshBorder &border : side.borders) {
    const Vec3 from = p - border.from;
    const double s = std::min(std::max(dot(from, border.along), 0.0), border.length);
    const Vec3 away = from - s * border.along;
    const double square = dot(away, away), line = -dot(from, border.outward);
    take(all, border, square, line, away);
    if (!border.is_convex || !border.is_sharp) continue;
    take(sharp, border, square, line, away);
    if (distance_is_rounding(square, border)) at_end += border.outward, ++ends;
  }
  Footprint found{all.square < HUGE_VAL ? std::sqrt(all.square) : HUGE_VAL, HUGE_VAL, {}};
  const bool is_inside = all.line >= 0.0;
  if (!is_inside) found.inside = -found.inside;
  if (sharp.square == HUGE_VAL) return found;
  const double distance = std::sqrt(sharp.square), sign = is_inside || !all.is_edge ? 1.0 : -1.0;
  found.from_edge = sign * distance;
  found.inward = ends ? (-1.0 / ends) * at_end : (sign / distance) * sharp.away;
  return found;
}

}    // namespace mdanim
