// SPDX-License-Identifier: GPL-2.0-only
// The checks of the driver in every frame, as plain C functions over arrays in the order of tags: whether numbers are finite,
// where objects are, whether cells are turned inside out, whether objects are inside each other.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "geometry/boxes.h"
#include "numbers/vec3.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

using namespace mdanim;

namespace {

// M objects as N particles and C lattice cells; those of object m are [first[m], first[m+1]) of each. The same stands in
// engine/geometry.py.
struct SystemArrays {
  long long count;
  const long long *first_particle;
  const unsigned char *boundary;    // whether a particle is on the surface, and not outside the drawn one, (N)
  const long long *first_cell;
  const int *corner;             // VTK order, (C, 8)
  const unsigned char *deep;     // whether a cell has no corner on the surface, (C)
  const double *spacing;         // (M)
  const double *mass;            // (N)
  const unsigned char *still;    // whether an object never moves, (M)
  long long pairs;
  const int *passing;        // pairs of objects that may be in each other, the lower one first, ascending, (pairs, 2)
  const long long *faces;    // rows of `face`, begin and end, that bound an object of one cell inside of it, (M, 2)
  const double
      *face;    // outward normals n and levels c, n s <= c inside; s from -1/2 to 1/2 along the edges of the cell, (F, 4)
};

// Asked where the centre of the first object is in a cell of the second one, which has no faces: whether it is below the surface,
// beyond which cells reach.
using IsBelow = int (*)(int, int);

// The same objects with their present positions.
struct Objects : SystemArrays {
  const double *x;    // (N, 3)

  Vec3 at(int i) const { return vec3(x + 3 * static_cast<std::size_t>(i)); }
  Vec3 middle(long long c) const { return 0.5 * (at(corner[8 * c]) + at(corner[8 * c + 6])); }
};

Box box_of(const Objects &o, int m)
{
  Box box;
  for (long long i = o.first_particle[m]; i < o.first_particle[m + 1]; ++i) box.include(o.x + 3 * i);
  return box;
}

// The mean of a cell's edges along each of its axes, four times.
struct Edges {
  Vec3 u, v, w;
};

Edges edges(const int *corner, const double *x)
{
  Vec3 p[8];
  for (int k = 0; k < 8; ++k) p[k] = vec3(x + 3 * static_cast<std::size_t>(corner[k]));
  const Vec3 d06 = p[6] - p[0], d17 = p[7] - p[1], d24 = p[4] - p[2], d35 = p[5] - p[3];    // the diagonals
  return {(d06 - d17) - (d24 - d35), (d06 + d17) - (d24 + d35), (d06 + d17) + (d24 + d35)};
}

bool inside_out(const int *corner, const double *x)
{
  const Edges e = edges(corner, x);
  return !(dot(cross(e.u, e.v), e.w) > 0.0);
}

// Whether a point lies in a cell, taken as the parallelepiped of its mean edges: so a squeezed body counts as no deeper than a
// relaxed one.
bool in_cell(const Objects &o, long long c, const Vec3 &point)
{
  const Vec3 d = point - o.middle(c);
  const Edges e = edges(o.corner + 8 * c, o.x);
  const Vec3 vw = cross(e.v, e.w), wu = cross(e.w, e.u), uv = cross(e.u, e.v);
  const double half = 0.125 * (1.0 + 1e-6) * std::fabs(dot(e.u, vw));    // the edges are those of 4 cells
  return std::fabs(dot(d, vw)) <= half && std::fabs(dot(d, wu)) <= half && std::fabs(dot(d, uv)) <= half;
}

// Boundary particles of object a that are deeper in object b than its outermost layer of cells.
long long sunk(const Objects &o, int a, int b, const Box &both)
{
  const double reach = o.spacing[b];    // distance of points in a cell from its middle: at most 0.87 unless it is stretched
  const Box around = both.grown(reach);
  std::vector<long long> cell;
  std::vector<Vec3> middle;
  for (long long c = o.first_cell[b]; c < o.first_cell[b + 1]; ++c) {
    if (!o.deep[c]) continue;
    const Vec3 x = o.middle(c);
    if (!around.contains(&x.x)) continue;
    cell.push_back(c);
    middle.push_back(x);
  }
  if (cell.empty()) return 0;
  const Grid grid([&](int n) { return &middle[n].x; }, static_cast<int>(middle.size()), reach);
  long long count = 0;
  for (long long i = o.first_particle[a]; i < o.first_particle[a + 1]; ++i) {
    if (!o.boundary[i] || !both.contains(o.x + 3 * i)) continue;
    const Vec3 p = o.at(static_cast<int>(i));
    bool hit = false;
    grid.around(&p.x, [&](int slot) { hit = hit || in_cell(o, cell[grid.order()[slot]], p); });
    count += hit;
  }
  return count;
}

bool has_faces(const Objects &o, int m) { return o.faces[2 * m] < o.faces[2 * m + 1]; }

// Whether a point in a cell of an object lies behind all of the object's faces, if it has any.
bool behind_faces(const Objects &o, int m, long long c, const Vec3 &point)
{
  const long long begin = o.faces[2 * m], end = o.faces[2 * m + 1];
  if (!has_faces(o, m)) return true;
  const Vec3 d = point - o.middle(c);
  const Edges e = edges(o.corner + 8 * c, o.x);    // four times as long
  const Vec3 vw = cross(e.v, e.w), wu = cross(e.w, e.u), uv = cross(e.u, e.v);
  const Vec3 s = (4.0 / dot(e.u, vw)) * Vec3{dot(d, vw), dot(d, wu), dot(d, uv)};
  for (long long k = begin; k < end; ++k)
    if (dot(vec3(o.face + 4 * k), s) > o.face[4 * k + 3]) return false;
  return true;
}

bool holds(const Objects &o, int m, const Vec3 &point)
{
  for (long long c = o.first_cell[m]; c < o.first_cell[m + 1]; ++c) {
    const Vec3 d = point - o.middle(c);
    if (dot(d, d) <= o.spacing[m] * o.spacing[m] && in_cell(o, c, point) && behind_faces(o, m, c, point)) return true;
  }
  return false;
}

// Whether the centre of object a, if it lies in its own body, lies in that of b.
bool centre_inside(const Objects &o, int a, int b, const Box &both)
{
  Vec3 sum;
  double all = 0.0;
  for (long long i = o.first_particle[a]; i < o.first_particle[a + 1]; ++i) {
    sum += o.mass[i] * o.at(static_cast<int>(i));
    all += o.mass[i];
  }
  const Vec3 centre = (1.0 / all) * sum;
  return both.contains(&centre.x) && holds(o, b, centre) && holds(o, a, centre);
}

// Whether two objects may be in each other.
bool may_be_inside(const Objects &o, int a, int b)
{
  const auto pair = [&](long long n) { return std::pair{o.passing[2 * n], o.passing[2 * n + 1]}; };
  const std::pair<int, int> wanted = std::minmax(a, b);
  long long low = 0, high = o.pairs;
  while (low < high) {
    const long long middle = low + (high - low) / 2;
    if (pair(middle) < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return low < o.pairs && pair(low) == wanted;
}

// The pair, among n objects, with the most points of one in the other; returns the number of these points.
long long deepest_pair(const Objects &o, int n, const int *objects, IsBelow is_below, int *pair)
{
  std::vector<Box> boxes;
  for (int k = 0; k < n; ++k) boxes.push_back(box_of(o, objects[k]));
  long long most = 0;
  for (const auto &[first, second] : meeting_pairs(boxes, 0.0)) {
    const int a = objects[first], b = objects[second];
    if ((o.still[a] && o.still[b]) || may_be_inside(o, a, b)) continue;
    const Box both = intersection(boxes[first], boxes[second]);
    for (const auto &[in, out] : {std::pair{a, b}, std::pair{b, a}}) {
      const bool centre = centre_inside(o, in, out, both) && (has_faces(o, out) || is_below(in, out));
      const long long found = sunk(o, in, out, both) + centre;
      if (found <= most) continue;
      most = found;
      pair[0] = in;
      pair[1] = out;
    }
  }
  return most;
}

// Number of the first particle whose position or velocity is not finite, -1 where all are finite; x, v (n, 3).
long long not_finite(long long n, const double *x, const double *v)
{
  // Infinities and NaN have all bits of the exponent set: adding one carries into the sign bit. Without branches this runs at the
  // speed of memory.
  constexpr std::uint64_t EXPONENT = 0x7ff0000000000000u, ONE = 0x0010000000000000u;
  std::uint64_t carried = 0;
  for (const double *values : {x, v})
    for (long long k = 0; k < 3 * n; ++k) {
      std::uint64_t bits;
      std::memcpy(&bits, values + k, sizeof bits);
      carried |= (bits & EXPONENT) + ONE;
    }
  if (!(carried >> 63)) return -1;
  for (long long k = 0; k < 3 * n; ++k)
    if (!std::isfinite(x[k]) || !std::isfinite(v[k])) return k / 3;
  return -1;
}

}    // namespace

// Number of the first particle whose position or velocity is not finite, -1 where all are finite; x, v (n, 3).
MDANIM_EXPORT long long mdanim_not_finite(long long n, const double *x, const double *v) noexcept { return not_finite(n, x, v); }

// Whether each cell is turned inside out: the volume spanned by the mean of its edges along each axis is not positive. corner (n,
// 8) in VTK order, inverted (n). Returns the number of such cells.
MDANIM_EXPORT long long mdanim_inverted(long long n, const int *corner, const double *x, unsigned char *inverted) noexcept
{
  long long count = 0;
  for (long long c = 0; c < n; ++c) {
    inverted[c] = inside_out(corner + 8 * c, x);
    count += inverted[c];
  }
  return count;
}

// Checks n objects of a model whose x and v are (N, 3). Returns 1 when some number is not finite, 2 when some cell is inside out,
// else 0. Unless it returns 1, it writes how far each object reaches along x, y, z, -x, -y, -z: reach (n, 6), the corners of eq.
// (3.14).
MDANIM_EXPORT int mdanim_glance(const SystemArrays *model, int n, const int *objects, const double *x, const double *v,
                                double *reach) noexcept
{
  const Objects o{*model, x};
  for (int k = 0; k < n; ++k) {
    const long long first = o.first_particle[objects[k]], count = o.first_particle[objects[k] + 1] - first;
    if (not_finite(count, x + 3 * first, v + 3 * first) >= 0) return 1;
  }
  for (int k = 0; k < n; ++k) {
    const Box box = box_of(o, objects[k]);
    for (int d = 0; d < 3; ++d) {
      reach[6 * k + d] = box.high(d);
      reach[6 * k + 3 + d] = -box.low(d);
    }
  }
  for (int k = 0; k < n; ++k)
    for (long long c = o.first_cell[objects[k]]; c < o.first_cell[objects[k] + 1]; ++c)
      if (inside_out(o.corner + 8 * c, x)) return 2;
  return 0;
}

// Largest absolute component of the velocities v (N, 3) of n objects of a model: speed (n).
MDANIM_EXPORT void mdanim_largest_components(const SystemArrays *model, int n, const int *objects, const double *v,
                                             double *speed) noexcept
{
  for (int k = 0; k < n; ++k) {
    double most = 0.0;
    for (long long i = 3 * model->first_particle[objects[k]]; i < 3 * model->first_particle[objects[k] + 1]; ++i)
      most = std::max(most, std::fabs(v[i]));
    speed[k] = most;
  }
}

// Finds two of n objects that are inside each other, deeper than contact ever allows: boundary particles of one below the
// outermost layer of cells of the other, or the centre of one in the body of the other. Writes the object that is inside, and the
// other, into `pair` and returns the number of its points that are inside; 0 where there is no such pair, -1 without memory.
// Pairs of objects that never move are skipped, and those that may be in each other.
MDANIM_EXPORT long long mdanim_sunk(const SystemArrays *model, int n, const int *objects, const double *x, IsBelow is_below,
                                    int *pair)
{
  return guarded(-1LL, [=] { return deepest_pair({*model, x}, n, objects, is_below, pair); });
}
