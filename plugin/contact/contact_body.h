// SPDX-License-Identifier: GPL-2.0-only
// The body of an object in contact: its undeformed lattice, points of its drawn surface, and the depth below that surface. Places
// in it are lattice coordinates X: cells from the low corner of its grid, along each axis.

#pragma once

#include "contact/contact_push.h"
#include "contact/point_carriers.h"
#include "contact/rigid_map.h"

#include "geometry/boxes.h"

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace mdanim {

enum class PointKind : std::uint8_t {
  FLAT = 0,     // inside a side of a cuboid
  SHARP = 1,    // on an edge of a cuboid or in a corner
  DENSE = 2,    // of any other shape
  FINE = 3,     // closer to each other, for a round shape of few cells, which acts on flat surfaces with these only
  INNER = 4     // at a particle inside of a body that may tear: none before a tear lays it bare (TornBody)
};

// A point of the drawn surface and the area that it stands for.
struct SurfacePoint {
  int cell[3];        // cell that carries the point
  Vec3 at, centre;    // X of the point and of the centre of its area
  Vec3 normal;        // outward, body frame
  double area;        // [m^2]
  PointKind kind;
};

// Along the axes of a grid, X.
struct Ellipsoid {
  Vec3 middle, half;    // half of its axes
};

// The points that a cell carries.
struct PointCell {
  int place;                // of its low corner in the grid
  int first, fine, last;    // range of ContactBody::points_by_cell(); fine points from `fine` on
  Vec3 low, high;           // a box around their X, from that corner
};

// The open part of a side that other bodies cover, in X along the first and the second axis across it; empty where low is beyond
// high.
struct OpenPart {
  int side;
  double low[2], high[2];
};
constexpr int SHARERS = 3;         // particles that share a point of a sheet between them
constexpr int OPEN_NUMBERS = 5;    // of one part: side, low and high along the first axis, then along the second

// The arguments of mdanim_contact_body().
struct ContactBodyArrays {
  const std::int32_t *count;
  const double *edge;
  int particles;
  const std::int32_t *node;
  const std::uint8_t *filled;
  int points;
  const std::int32_t *cell;
  const double *at, *centre, *normal, *area;
  const std::uint8_t *kind;
  const double *depth;    // null for a cuboid
  std::size_t depths = 0;
  int open = 0;
  const double *open_part = nullptr;    // OPEN_NUMBERS for each part
  // A body that does not deform has a frame, others null: numbers of four particles, and X of each. `node` is then not read.
  const std::int32_t *frame = nullptr;
  const double *frame_at = nullptr;
  // Above 0: a line of round particles of this radius. Each is the point of its own number, in a cell of its own in one row;
  // `node` is not read. Points behind these, in cells that follow, lie between particles: three that share each, ascending, and
  // their weights; none is farther from one of them than `spread` [m].
  double radius = 0.0;
  double hardness = 1.0;    // stiffness with which a line touches other bodies, over that which its material gives
  double spread = 0.0;
  int between = 0;
  const std::int32_t *sharer = nullptr;
  const double *share = nullptr;
  bool tears = false;    // its particles inside have points, too
};

// The margin of a grid of these cells with so many coefficients of its depth; 0 where no margin has as many.
int depth_margin(const int (&cells)[3], std::size_t depths);

class ContactBody {
 public:
  // Throws std::runtime_error when the arrays are not those of a body.
  explicit ContactBody(const ContactBodyArrays &arrays);

  bool operator==(const ContactBody &other) const;    // the same arrays
  bool is_cuboid() const { return depth_grid.empty() && !is_line(); }
  // A line of round particles touches others with its points, and is never a host.
  bool is_line() const { return radius_of_points > 0.0; }
  // Curved everywhere, as a ball: no two of its points have one normal, so a plane meets them one after the other.
  bool is_round() const { return around.has_value(); }
  const std::optional<Ellipsoid> &ellipsoid() const { return around; }    // around the surface of a round body
  double radius() const { return radius_of_points; }    // of the surface around each point [m]; 0 where points lie on the surface
  double hardness() const { return hardness_of_line; }                // of a line against other bodies, over that by its material
  const std::optional<RigidFrame> &frame() const { return rigid; }    // none of a body that deforms
  int sides() const { return is_cuboid() ? 6 : 1; }
  int count(int axis) const { return cells[axis]; }
  double edge(int axis) const { return edges[axis]; }
  double spacing() const { return mean_edge; }    // cube root of a cell's volume [m]
  // How much a cell is pressed: 1 where it is not, else at least half of the smallest stretch.
  double pressed(const Spot<double> &spot) const { return mdanim::pressed(steep, spot); }
  double steepness() const { return steep; }    // square of the gradient of X where the body is undeformed [1/m^2]
  // Whether other held bodies cover parts of its sides.
  bool has_covers() const { return !open_parts.empty(); }
  int particles() const { return number; }
  // Inline, so that code that asks for one of its fields does not fill the others.
  Lattice lattice() const
  {
    return {{cells[0], cells[1], cells[2]},
            filled.data(),
            {edges[0], edges[1], edges[2]},
            mean_edge,
            row(),
            layer(),
            is_cuboid() ? nullptr : depth_grid.data(),
            margin};
  }
  const std::vector<SurfacePoint> &points() const { return surface; }
  // The particles with a weight in a point. All objects of a body share them, so that they stay in the cache.
  PointCarriers carriers_of(int point) const
  {
    const int *const at = &first_carrier[2 * point];
    return {&point_carriers[at[0]], &point_carriers[at[1]], &point_carriers[at[2]]};
  }
  BodyCarriers all_carriers() const { return {point_carriers.data(), first_carrier.data()}; }
  const double *areas() const { return area.data(); }    // of points
  const PointFacing *facings() const { return facing.data(); }
  const std::vector<PointCell> &point_cells() const { return carriers; }
  const std::vector<int> &points_by_cell() const { return by_cell; }
  // The first and the end of the points of a cell that act on a plane or a cuboid, or on a shape that is not flat. Points of a
  // cuboid are a cell apart, too few for a curved shape, whose own points are dense.
  std::pair<int, int> acting(const PointCell &cell, bool on_flat) const
  {
    if (on_flat) return {has_fine ? cell.fine : cell.first, cell.last};
    return {cell.first, is_cuboid() ? cell.first : cell.fine};
  }
  bool carries(int node) const { return rigid ? slot_of(node) >= 0 : is_carrier[node]; }    // points, with their cells
  // Whether each point is at one particle, as those of a cuboid that deforms and cannot tear.
  bool points_are_particles() const { return at_particles; }
  // Corners of a box around the grid and all points, X.
  const Vec3 &least() const { return low; }
  const Vec3 &most() const { return high; }
  // How far the drawn surface extends beyond the cells [m], of a body that deforms.
  double overhang() const { return stands_out; }
  // How far a point may move while its particles move by 1 at most: the sum of the absolute values of their weights, 1 within
  // cells.
  double leverage() const { return lever; }

  // Places of the grid, x fastest, and the number of the particle at each, -1 for none.
  int row() const { return cells[0] + 1; }
  int layer() const { return (cells[0] + 1) * (cells[1] + 1); }
  int places() const { return layer() * (cells[2] + 1); }
  int place(int i, int j, int k) const { return i + row() * j + layer() * k; }
  Vec3 grid_place(int place) const
  { return {1.0 * (place % row()), 1.0 * (place % layer() / row()), 1.0 * (place / layer())}; }    // X
  // Places of particles that contact knows: those of the grid, or those of the frame; and that of a particle, -1 for none.
  int slots() const { return rigid ? RigidFrame::PARTICLES : places(); }
  int slot_of(int node) const;

  bool is_filled(int i, int j, int k) const { return mdanim::is_filled(lattice(), i, j, k); }
  bool is_outer(int i, int j, int k) const;    // filled, with a neighbour across a face that is not
  long filled_cells() const;

  // Below a side; sides of a cuboid are -x, +x, -y, +y, -z, +z.
  Depth<double> depth(int side, const Vec3 &X) const;
  // How far X is outside of the open part of a side, in cells; negative where the side acts.
  double covered(int side, const Vec3 &X) const;
  std::size_t bytes() const;

 private:
  void need_particles_of_cells() const;
  void take_line(const ContactBodyArrays &given);
  void take_frame(const ContactBodyArrays &given);
  void take_open_parts(const ContactBodyArrays &given);
  void add_point(const SurfacePoint &point);
  void add_carriers(const SurfacePoint &point, const Vec3 &X);
  void find_carriers();
  void sort_points();

  int cells[3];
  double edges[3], mean_edge, steep = 0.0;    // square of the gradient of X where the body is undeformed [1/m^2]
  int number;                                 // of particles
  std::vector<int> place_of_node;             // empty for a rigid body
  std::optional<RigidFrame> rigid;
  Vec3 low, high;
  std::vector<std::uint8_t> filled;
  std::vector<SurfacePoint> surface;
  std::vector<double> area;                    // of points, also here: kernels read no SurfacePoint
  std::vector<PointFacing> facing;             // the same
  std::vector<PointCarrier> point_carriers;    // of all points, one after the other, and one more
  std::vector<int> first_carrier;              // of each point, then of the centre of its area; at the end, the number of all
  std::vector<PointCell> carriers;
  std::vector<int> by_cell;        // numbers of points, cell by cell, ascending in each
  std::vector<char> is_carrier;    // of particles
  bool at_particles = true;        // each point
  bool has_fine = false;           // points
  std::optional<Ellipsoid> around;
  double stands_out = 0.0, lever = 1.0, radius_of_points = 0.0, hardness_of_line = 1.0;
  std::vector<PointCarrier> sharers;    // three of each point between particles of a line
  std::vector<OpenPart> open_parts;     // sides without an open part act everywhere
  std::vector<double> depth_grid;       // coefficients of quadratic B-splines on nodes -margin to n + margin
  int margin = 0;
};

}    // namespace mdanim
