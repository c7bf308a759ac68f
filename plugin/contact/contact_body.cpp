// SPDX-License-Identifier: GPL-2.0-only
// Arrays are checked once; after that their numbers are used without checks.

#include "contact/contact_body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace mdanim {

static void need(bool good, const char *what)
{
  if (!good) throw std::runtime_error(std::string("the arrays are not those of a contact body: ") + what);
}

static bool are_finite(const double *values, std::size_t n)
{
  return std::all_of(values, values + n, [](double value) { return std::isfinite(value); });
}

int depth_margin(const int (&cells)[3], std::size_t depths)
{
  constexpr int LEAST = 2, MOST = 1 << 10;
  for (int margin = LEAST; margin <= MOST; ++margin) {
    double nodes = 1.0;    // their product may not fit an integer
    for (const int n : cells) nodes *= n + 1.0 + 2.0 * margin;
    if (nodes >= static_cast<double>(depths)) return nodes == static_cast<double>(depths) ? margin : 0;
  }
  return 0;
}

// Calls visit(i, j, k) for each corner of eight filled cells.
template <class Visit> static void each_inside(const Lattice &grid, const Visit &visit)
{
  for (int k = 1; k < grid.cells[2]; ++k)
    for (int j = 1; j < grid.cells[1]; ++j)
      for (int i = 1; i < grid.cells[0]; ++i) {
        bool is_inside = true;
        for (int c = 0; c < 8 && is_inside; ++c) is_inside = is_filled(grid, i - (c & 1), j - (c >> 1 & 1), k - (c >> 2));
        if (is_inside) visit(i, j, k);
      }
}

// Whether the normals of points of a kind differ.
static bool normals_differ(const std::vector<SurfacePoint> &surface, PointKind kind)
{
  constexpr double SAME = 1e-6;    // square of the difference of two normals: neighbours of a ball of 100 cells across have 4e-5
  std::vector<Vec3> normal;
  for (const SurfacePoint &point : surface)
    if (point.kind == kind) normal.push_back(point.normal);
  std::sort(normal.begin(), normal.end(), [](const Vec3 &a, const Vec3 &b) { return a.x < b.x; });
  for (std::size_t i = 0; i < normal.size(); ++i)
    for (std::size_t j = i + 1; j < normal.size() && (normal[j].x - normal[i].x) * (normal[j].x - normal[i].x) < SAME; ++j) {
      const Vec3 apart = normal[j] - normal[i];
      if (dot(apart, apart) < SAME) return false;
    }
  return true;
}

// An ellipsoid around a round surface, with the proportions of a box around the body.
static Ellipsoid ellipsoid_around(const std::vector<SurfacePoint> &surface, const Vec3 &low, const Vec3 &high)
{
  constexpr double BETWEEN = 0.1;    // cells that a round surface extends beyond its points, at most
  const Vec3 middle = 0.5 * (low + high), half = 0.5 * (high - low);
  double square = 0.0;
  for (const SurfacePoint &point : surface) {
    const Vec3 from = point.at - middle, v = {from.x / half.x, from.y / half.y, from.z / half.z};
    square = std::max(square, dot(v, v));
  }
  return {middle, (std::sqrt(square) + BETWEEN / std::min({half.x, half.y, half.z})) * half};
}

ContactBody::ContactBody(const ContactBodyArrays &given)
{
  need(given.particles > 0 && given.points >= 0, "it has no particles, or less than no points");
  std::size_t volume = 1, nodes = 1;
  double product = 1.0;
  for (int d = 0; d < 3; ++d) {
    cells[d] = given.count[d];
    edges[d] = given.edge[d];
    need(cells[d] > 0 && cells[d] < (1 << 20), "a count of cells is out of range");
    need(edges[d] > 0.0 && std::isfinite(edges[d]), "an edge of the cells is not a length");
    volume *= cells[d];
    nodes *= cells[d] + 1;
    product *= edges[d];
  }
  need(nodes < (std::size_t{1} << 31), "it has too many places");
  mean_edge = std::cbrt(product);
  for (int d = 0; d < 3; ++d) steep += 1.0 / (edges[d] * edges[d]);
  filled.assign(given.filled, given.filled + volume);
  number = given.particles;
  if (given.frame) {
    take_frame(given);
  } else if (given.radius != 0.0) {
    take_line(given);
  } else {
    place_of_node.assign(given.node, given.node + number);
    for (int n = 0; n < number; ++n)
      need(given.node[n] >= 0 && given.node[n] < static_cast<int>(nodes) && (n == 0 || given.node[n - 1] < given.node[n]),
           "places of particles do not ascend");
    need_particles_of_cells();
  }
  if (given.depth) {
    margin = depth_margin(cells, given.depths);
    need(margin > 0, "a body of these counts has another number of depths");
    need(are_finite(given.depth, given.depths), "a depth is not a number");
    depth_grid.assign(given.depth, given.depth + given.depths);
    depth_grid.push_back(0.0);    // kernels read three numbers and one more
  } else if (is_cuboid()) {
    need(rigid || number == static_cast<int>(nodes), "a cuboid has a particle in each place");
    need(std::find(filled.begin(), filled.end(), 0) == filled.end(), "a cuboid has no empty cells");
  }
  surface.reserve(given.points);
  for (int p = 0; p < given.points; ++p) {
    need(given.cell[p] >= 0 && given.cell[p] < static_cast<int>(volume) && filled[given.cell[p]], "a point is in no filled cell");
    need(given.area[p] > 0.0 && std::isfinite(given.area[p]) && given.kind[p] <= 3, "a point has no area or is of no kind");
    need(are_finite(given.at + 3 * p, 3) && are_finite(given.centre + 3 * p, 3), "a point is nowhere");
    const Vec3 normal = vec3(given.normal + 3 * p);
    need(std::fabs(dot(normal, normal) - 1.0) < 1e-6, "a normal has not length 1");
    add_point({{given.cell[p] % cells[0], given.cell[p] / cells[0] % cells[1], given.cell[p] / (cells[0] * cells[1])},
               vec3(given.at + 3 * p),
               vec3(given.centre + 3 * p),
               vec3(given.normal + 3 * p),
               given.area[p],
               static_cast<PointKind>(given.kind[p])});
  }
  need(!given.tears || (!is_line() && !rigid), "what does not deform, and a line, has no particles inside");
  if (given.tears)    // a particle inside stands for a cell's share of a face
    each_inside(lattice(), [this](int i, int j, int k) {
      const Vec3 X = {1.0 * i, 1.0 * j, 1.0 * k};
      add_point({{i, j, k}, X, X, {0.0, 0.0, 1.0}, mean_edge * mean_edge, PointKind::INNER});
    });
  take_open_parts(given);
  find_carriers();
  sort_points();
  if (!is_cuboid() && !is_line() && normals_differ(surface, PointKind::DENSE) && normals_differ(surface, PointKind::FINE))
    around = ellipsoid_around(surface, low, high);
}

void ContactBody::add_point(const SurfacePoint &point)
{
  const Vec3 &normal = point.normal;
  surface.push_back(point);
  area.push_back(point.area);
  facing.push_back(
      {{normal.x * edges[0], normal.y * edges[1], normal.z * edges[2]}, place(point.cell[0], point.cell[1], point.cell[2])});
  has_fine |= point.kind == PointKind::FINE;
}

void ContactBody::take_line(const ContactBodyArrays &given)
{
  need(given.radius > 0.0 && std::isfinite(given.radius), "the radius of its particles is not a length");
  need(!given.depth && given.open == 0, "a line is not a host");
  const int all = number + given.between;
  need(given.between >= 0 && cells[0] == all && cells[1] == 1 && cells[2] == 1 && given.points == all,
       "a line has a cell and a point a particle");
  for (int n = 0; n < all; ++n) need(given.cell[n] == n, "points of a line do not ascend");
  need(given.hardness > 0.0 && std::isfinite(given.hardness), "the hardness of a line is not a number above 0");
  need(given.spread >= 0.0 && std::isfinite(given.spread), "the spread of points between particles is not a length");
  radius_of_points = given.radius;
  hardness_of_line = given.hardness;
  stands_out = given.spread;
  for (int n = 0; n < SHARERS * given.between; ++n) {
    const int one = given.sharer[n];
    need(one >= 0 && one < number && (n % SHARERS == 0 || given.sharer[n - 1] < one), "sharers of a point do not ascend");
    need(given.share[n] >= 0.0 && given.share[n] < 1.0, "a share of a point is not from 0 to 1");
    sharers.push_back({one, given.share[n]});
  }
  place_of_node.resize(number);
  std::iota(place_of_node.begin(), place_of_node.end(), 0);
}

void ContactBody::take_frame(const ContactBodyArrays &given)
{
  constexpr int N = RigidFrame::PARTICLES;
  constexpr double FLAT = 1e-6;    // volume of a frame over that of a cube of its longest side
  RigidFrame &frame = rigid.emplace();
  need(are_finite(given.frame_at, 3 * N), "a particle of its frame is nowhere");
  double longest = 0.0;
  Vec3 side[N];
  for (int k = 0; k < N; ++k) {
    frame.particle[k] = given.frame[k];
    need(given.frame[k] >= 0 && given.frame[k] < number && (k == 0 || given.frame[k - 1] < given.frame[k]),
         "particles of its frame do not ascend");
    side[k] = vec3(given.frame_at + 3 * k) - vec3(given.frame_at);
    longest = std::max(longest, std::sqrt(dot(side[k], side[k])));
  }
  const Vec3 across[N] = {{}, cross(side[2], side[3]), cross(side[3], side[1]), cross(side[1], side[2])};
  const double volume = dot(side[1], across[1]);
  need(std::fabs(volume) > FLAT * longest * longest * longest, "its frame is flat");
  frame.slope[0] = {}, frame.at_zero[0] = 1.0;
  for (int k = 1; k < N; ++k) {
    frame.slope[k] = (1.0 / volume) * across[k];
    frame.at_zero[k] = -dot(frame.slope[k], vec3(given.frame_at));
    frame.slope[0] -= frame.slope[k];
    frame.at_zero[0] -= frame.at_zero[k];
  }
}

int ContactBody::slot_of(int node) const
{
  if (!rigid) return place_of_node[node];
  const int *const end = rigid->particle + RigidFrame::PARTICLES, *const found = std::find(rigid->particle, end, node);
  return found == end ? -1 : static_cast<int>(found - rigid->particle);
}

void ContactBody::take_open_parts(const ContactBodyArrays &given)
{
  need(given.open >= 0 && (given.open == 0 || is_cuboid()), "sides of a cuboid alone are covered");
  for (int n = 0; n < given.open; ++n) {
    const double *const part = given.open_part + OPEN_NUMBERS * n;
    need(are_finite(part, OPEN_NUMBERS), "an open part is nowhere");
    need(part[0] >= 0.0 && part[0] <= 5.0 && part[0] == std::floor(part[0]), "a side is of no number from 0 to 5");
    open_parts.push_back({static_cast<int>(part[0]), {part[1], part[3]}, {part[2], part[4]}});
  }
}

bool ContactBody::operator==(const ContactBody &other) const
{
  const auto same = [](const Vec3 &a, const Vec3 &b) { return a.x == b.x && a.y == b.y && a.z == b.z; };
  const auto same_points = [&](const SurfacePoint &a, const SurfacePoint &b) {
    return std::equal(a.cell, a.cell + 3, b.cell) && same(a.at, b.at) && same(a.centre, b.centre) && same(a.normal, b.normal) &&
           a.area == b.area && a.kind == b.kind;
  };
  const auto same_parts = [](const OpenPart &a, const OpenPart &b) {
    return a.side == b.side && std::equal(a.low, a.low + 2, b.low) && std::equal(a.high, a.high + 2, b.high);
  };
  const auto same_frame = [&] {
    if (!rigid || !other.rigid) return !rigid && !other.rigid;
    const auto same_weights = [&](int k) {
      return rigid->particle[k] == other.rigid->particle[k] && rigid->at_zero[k] == other.rigid->at_zero[k] &&
             same(rigid->slope[k], other.rigid->slope[k]);
    };
    return same_weights(0) && same_weights(1) && same_weights(2) && same_weights(3);
  };
  return std::equal(cells, cells + 3, other.cells) && std::equal(edges, edges + 3, other.edges) && number == other.number &&
         same_frame() && radius_of_points == other.radius_of_points && hardness_of_line == other.hardness_of_line &&
         stands_out == other.stands_out && place_of_node == other.place_of_node &&
         std::equal(sharers.begin(), sharers.end(), other.sharers.begin(), other.sharers.end(),
                    [](const PointCarrier &a, const PointCarrier &b) { return a.slot == b.slot && a.weight == b.weight; }) &&
         filled == other.filled && depth_grid == other.depth_grid &&
         std::equal(open_parts.begin(), open_parts.end(), other.open_parts.begin(), other.open_parts.end(), same_parts) &&
         std::equal(surface.begin(), surface.end(), other.surface.begin(), other.surface.end(), same_points);
}

void ContactBody::add_carriers(const SurfacePoint &point, const Vec3 &X)
{
  if (is_line()) {
    const int first = SHARERS * (point.cell[0] - number);
    if (first < 0) point_carriers.push_back({point.cell[0], 1.0});
    for (int n = first; n >= 0 && n < first + SHARERS; ++n)
      if (sharers[n].weight != 0.0) point_carriers.push_back(sharers[n]);
    return;
  }
  if (rigid) {
    for (int k = 0; k < RigidFrame::PARTICLES; ++k) point_carriers.push_back({k, rigid->weight(k, X)});
    return;
  }
  Weights<double> axis;
  for (int d = 0; d < 3; ++d) linear_weights<double>(component(X, d), point.cell[d], axis[d]);
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i)
        if (const double weight = axis[0].w[i] * axis[1].w[j] * axis[2].w[k]; weight != 0.0)
          point_carriers.push_back({place(point.cell[0] + i, point.cell[1] + j, point.cell[2] + k), weight});
}

void ContactBody::find_carriers()
{
  const auto now = [this] { return static_cast<int>(point_carriers.size()); };
  for (const SurfacePoint &point : surface) {
    first_carrier.push_back(now());
    if (point.kind != PointKind::INNER) add_carriers(point, point.at);
    first_carrier.push_back(now());
    at_particles &= now() - first_carrier[first_carrier.size() - 2] == 1;
    if (point.kind == PointKind::SHARP) add_carriers(point, point.centre);
  }
  first_carrier.push_back(now());
  point_carriers.push_back({});    // the end of the last point has an address
  point_carriers.shrink_to_fit();
}

void ContactBody::sort_points()
{
  const auto low_corner = [this](int p) { return place(surface[p].cell[0], surface[p].cell[1], surface[p].cell[2]); };
  by_cell.resize(surface.size());
  std::iota(by_cell.begin(), by_cell.end(), 0);
  const auto is_fine = [this](int p) { return surface[p].kind == PointKind::FINE; };
  std::stable_sort(by_cell.begin(), by_cell.end(), [&](int p, int q) {
    return low_corner(p) != low_corner(q) ? low_corner(p) < low_corner(q) : is_fine(p) < is_fine(q);
  });
  std::vector<char> is_corner(places(), 0);
  low = {}, high = {1.0 * cells[0], 1.0 * cells[1], 1.0 * cells[2]};
  for (int n = 0; n < static_cast<int>(by_cell.size()); ++n) {
    const int p = by_cell[n], first = low_corner(p);
    const Vec3 &at = surface[p].at;
    low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
    if (carriers.empty() || carriers.back().place != first) {
      carriers.push_back({first, n, n, n, {}, {}});
      for (int corner = 0; corner < 8 && !at_particles; ++corner)
        is_corner[first + (corner & 1) + row() * (corner >> 1 & 1) + layer() * (corner >> 2)] = 1;
    }
    if (at_particles) is_corner[carriers_of(p).first->slot] = 1;
    PointCell &cell = carriers.back();
    const Vec3 from_corner = surface[p].at - Vec3{1.0 * surface[p].cell[0], 1.0 * surface[p].cell[1], 1.0 * surface[p].cell[2]};
    if (cell.first == n) cell.low = cell.high = from_corner;
    cell.last = n + 1;
    if (!is_fine(p)) cell.fine = cell.last;
    const auto unite = [&](double at, double &least, double &most, double edge) {
      least = std::min(least, at), most = std::max(most, at);
      stands_out = std::max({stands_out, -least * edge, (most - 1.0) * edge});
    };
    const auto weights = [](double at) { return std::fabs(at) + std::fabs(1.0 - at); };
    lever = std::max(lever, weights(from_corner.x) * weights(from_corner.y) * weights(from_corner.z));
    unite(from_corner.x, cell.low.x, cell.high.x, edges[0]);
    unite(from_corner.y, cell.low.y, cell.high.y, edges[1]);
    unite(from_corner.z, cell.low.z, cell.high.z, edges[2]);
  }
  for (const int at : place_of_node) is_carrier.push_back(is_corner[at]);
  if (rigid) stands_out = 0.0;    // boxes of rigid objects are around their surfaces
}

// Throws unless particles are exactly at the corners of filled cells.
void ContactBody::need_particles_of_cells() const
{
  std::vector<char> is_corner(places(), 0);
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i)
        if (is_filled(i, j, k))
          for (int corner = 0; corner < 8; ++corner)
            is_corner[place(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2))] = 1;
  for (const int at : place_of_node) {
    need(is_corner[at], "a particle is at no filled cell");
    is_corner[at] = 0;
  }
  need(std::find(is_corner.begin(), is_corner.end(), 1) == is_corner.end(), "a filled cell lacks a particle");
}

bool ContactBody::is_outer(int i, int j, int k) const
{
  return is_filled(i, j, k) && !(is_filled(i - 1, j, k) && is_filled(i + 1, j, k) && is_filled(i, j - 1, k) &&
                                 is_filled(i, j + 1, k) && is_filled(i, j, k - 1) && is_filled(i, j, k + 1));
}

long ContactBody::filled_cells() const { return static_cast<long>(filled.size() - std::count(filled.begin(), filled.end(), 0)); }

Depth<double> ContactBody::depth(int side, const Vec3 &X) const
{
  const Lattice grid = lattice();
  if (is_cuboid()) return depth_below<double>({static_cast<double>(side / 2), static_cast<double>(side & 1)}, grid, X);
  const std::size_t nx = depth_row(grid, 0), ny = depth_row(grid, 1), step[3] = {1, nx, nx * ny};
  const double *first = grid.depth;
  Weights<double> weights;
  for (int d = 0; d < 3; ++d) {
    const double x = component(X, d) + grid.margin;
    const int middle = middle_node(x, depth_row(grid, d) - 1);
    depth_weights<double>(x, middle, weights[d]);
    first += (middle - 1) * step[d];
  }
  return depth_by_splines(weights, [&](int j, int k) { return vec3(first + nx * (j + ny * k)); });
}

double ContactBody::covered(int side, const Vec3 &X) const
{
  constexpr double FAR = std::numeric_limits<double>::infinity();
  double least = FAR;
  for (const OpenPart &part : open_parts) {
    if (part.side != side) continue;
    const double a = side < 2 ? X.y : X.x, b = side < 4 ? X.z : X.y;
    least = std::min(least, std::max({part.low[0] - a, a - part.high[0], part.low[1] - b, b - part.high[1]}));
  }
  return least < FAR ? least : -FAR;
}

std::size_t ContactBody::bytes() const
{
  return place_of_node.capacity() * sizeof(int) + filled.capacity() + surface.capacity() * sizeof(SurfacePoint) +
         depth_grid.capacity() * sizeof(double) + open_parts.capacity() * sizeof(OpenPart) + area.capacity() * sizeof(double) +
         facing.capacity() * sizeof(PointFacing) + point_carriers.capacity() * sizeof(PointCarrier) +
         first_carrier.capacity() * sizeof(int) + carriers.capacity() * sizeof(PointCell) + by_cell.capacity() * sizeof(int) +
         is_carrier.capacity() + sharers.capacity() * sizeof(PointCarrier);
}

}    // namespace mdanim
