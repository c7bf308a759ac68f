// SPDX-License-Identifier: GPL-2.0-only
// Arrays are checked once; then numbers in them are taken as they are.

#include "contact/contact_body.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace mdanim {

static constexpr int MARGIN = 2;    // nodes of the depth's grid beyond the body's, at either end of an axis

static void need(bool good, const char *what)
{
  if (!good) throw std::runtime_error(std::string("the arrays are not those of a contact body: ") + what);
}

static bool are_finite(const double *values, std::size_t n)
{
  return std::all_of(values, values + n, [](double value) { return std::isfinite(value); });
}

ContactBody::ContactBody(const ContactBodyArrays &given)
{
  need(given.particles > 0 && given.points >= 0, "it has no particles, or less than no points");
  std::size_t volume = 1, nodes = 1, coefficients = 1;
  double product = 1.0;
  for (int d = 0; d < 3; ++d) {
    cells[d] = given.count[d];
    edges[d] = given.edge[d];
    need(cells[d] > 0 && cells[d] < (1 << 20), "a count of cells is out of range");
    need(edges[d] > 0.0 && std::isfinite(edges[d]), "an edge of the cells is no length");
    volume *= cells[d];
    nodes *= cells[d] + 1;
    coefficients *= cells[d] + 1 + 2 * MARGIN;
    product *= edges[d];
  }
  need(nodes < (std::size_t{1} << 31), "it has too many places");
  mean_edge = std::cbrt(product);
  filled.assign(given.filled, given.filled + volume);
  place_of_node.assign(given.node, given.node + given.particles);
  for (int n = 0; n < given.particles; ++n)
    need(given.node[n] >= 0 && given.node[n] < static_cast<int>(nodes) && (n == 0 || given.node[n - 1] < given.node[n]),
         "places of particles do not ascend");
  need_particles_of_cells();
  if (given.depth) {
    need(are_finite(given.depth, coefficients), "a depth is no number");
    depth_grid.assign(given.depth, given.depth + coefficients);
  } else {
    need(given.particles == static_cast<int>(nodes), "a cuboid has a particle in each place");
    need(std::find(filled.begin(), filled.end(), 0) == filled.end(), "a cuboid has no empty cells");
  }
  surface.reserve(given.points);
  for (int p = 0; p < given.points; ++p) {
    need(given.cell[p] >= 0 && given.cell[p] < static_cast<int>(volume) && filled[given.cell[p]], "a point is in no filled cell");
    need(given.area[p] > 0.0 && std::isfinite(given.area[p]) && given.kind[p] <= 2, "a point has no area or is of no kind");
    need(are_finite(given.at + 3 * p, 3) && are_finite(given.centre + 3 * p, 3), "a point is nowhere");
    const Vec3 normal = vec3(given.normal + 3 * p);
    need(std::fabs(dot(normal, normal) - 1.0) < 1e-6, "a normal has not length 1");
    surface.push_back({{given.cell[p] % cells[0], given.cell[p] / cells[0] % cells[1], given.cell[p] / (cells[0] * cells[1])},
                       vec3(given.at + 3 * p),
                       vec3(given.centre + 3 * p),
                       vec3(given.normal + 3 * p),
                       given.area[p],
                       static_cast<PointKind>(given.kind[p])});
  }
}

// Particles are at the corners of filled cells, and nowhere else.
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

int ContactBody::cells_around(int node) const
{
  const int at = place_of_node[node], i = at % row(), j = at / row() % (cells[1] + 1), k = at / layer();
  int sum = 0;
  for (int corner = 0; corner < 8; ++corner) sum += is_filled(i - (corner & 1), j - (corner >> 1 & 1), k - (corner >> 2));
  return sum;
}

// Of a point at `x`, the first of three nodes and their weights: centred quadratic B-splines.
static int spline(double x, int nodes, double (&w)[3], double (&slope)[3])
{
  const int middle = std::clamp(static_cast<int>(std::floor(x + 0.5)), 1, nodes - 2);
  const double u = std::clamp(x - middle, -0.5, 0.5), p = 0.5 - u, q = 0.5 + u;
  w[0] = 0.5 * p * p, w[1] = 0.75 - u * u, w[2] = 0.5 * q * q;
  slope[0] = -p, slope[1] = -2.0 * u, slope[2] = q;
  return middle - 1;
}

Depth ContactBody::depth(int side, const Vec3 &X) const
{
  const double at[3] = {X.x, X.y, X.z};
  Depth found{0.0, {}};
  if (is_cuboid()) {
    const int axis = side / 2;
    const bool high = side & 1;
    found.value = edges[axis] * (high ? cells[axis] - at[axis] : at[axis]);
    const double slope = high ? -edges[axis] : edges[axis];
    found.slope = {axis == 0 ? slope : 0.0, axis == 1 ? slope : 0.0, axis == 2 ? slope : 0.0};
    return found;
  }
  double w[3][3], s[3][3];
  int first[3];
  for (int d = 0; d < 3; ++d) first[d] = spline(at[d] + MARGIN, cells[d] + 1 + 2 * MARGIN, w[d], s[d]);
  const std::size_t nx = cells[0] + 1 + 2 * MARGIN, ny = cells[1] + 1 + 2 * MARGIN;
  for (int k = 0; k < 3; ++k) {
    double sum = 0.0, sum_x = 0.0, sum_y = 0.0;
    for (int j = 0; j < 3; ++j) {
      const double *c = &depth_grid[first[0] + nx * ((first[1] + j) + ny * (first[2] + k))];
      const double line = (w[0][0] * c[0] + w[0][1] * c[1]) + w[0][2] * c[2];
      sum += w[1][j] * line;
      sum_x += w[1][j] * ((s[0][0] * c[0] + s[0][1] * c[1]) + s[0][2] * c[2]);
      sum_y += s[1][j] * line;
    }
    found.value += w[2][k] * sum;
    found.slope += {w[2][k] * sum_x, w[2][k] * sum_y, s[2][k] * sum};
  }
  return found;
}

std::size_t ContactBody::bytes() const
{
  return place_of_node.capacity() * sizeof(int) + filled.capacity() + surface.capacity() * sizeof(SurfacePoint) +
         depth_grid.capacity() * sizeof(double);
}

}    // namespace mdanim
