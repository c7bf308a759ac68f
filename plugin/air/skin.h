// SPDX-License-Identifier: GPL-2.0-only
// The surface of an object that air pushes at: points that are weighted sums of its particles, and what is at these.

#pragma once

#include "air/law.h"
#include "numbers/vec3.h"

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mdanim {

// The parts of a step that all skins use.
struct AirScratch {
  std::vector<Vec3> x, v;                     // of nodes, which the caller fills
  std::vector<double> mass;                   // of nodes, which the caller fills
  std::vector<Vec3> force;                    // on nodes, the result
  std::vector<Vec3> place, velocity, push;    // of points
  std::vector<double> area, load;             // of points
  std::vector<Vec3> face;                     // of triangles, then of panels: their areas with directions
  std::vector<double> size;                   // of triangles, cylinders, balls and panels
  std::vector<double> load_of_node;
};

class AirSkin {
 public:
  using Weights = std::vector<std::pair<int, double>>;    // particles, counted from the lowest tag of the object, and weights
  using Points = std::array<int, 3>;
  struct Cylinder {
    int from, to;
    double diameter;
    double most;    // length from which on it is torn: air goes through
  };
  struct Ball {
    int at;
    double diameter;
  };
  // A part of the surface of what does not deform. With the edges e from the first point of the frame to the others its area is
  // part.x e2 x e3 + part.y e3 x e1 + part.z e1 x e2, with the direction of the outward normal.
  struct Panel {
    int at;
    Vec3 part;
  };

  explicit AirSkin(AirSides sides) : sides(sides) {}
  void append_point(const Weights &weights);
  // Numbers of points count from 0.
  void append_triangle(int a, int b, int c) { triangles.push_back({a, b, c}); }
  void append_cylinder(const Cylinder &one) { cylinders.push_back(one); }
  void append_ball(const Ball &one) { balls.push_back(one); }
  void set_frame(const std::array<int, 4> &points) { frame = points; }
  bool has_frame() const { return frame[0] >= 0; }
  void append_panel(const Panel &one) { panels.push_back(one); }
  // Numbers the particles that points need; to be called once, when all is there.
  void finish();

  int points() const { return static_cast<int>(first.size()) - 1; }
  bool has_surface() const { return !(triangles.empty() && cylinders.empty() && balls.empty() && panels.empty()); }
  // Particles that it needs, ascending; these are its nodes.
  const std::vector<int> &nodes() const { return needed; }
  std::size_t bytes() const;

  // Triangles and cylinders that air goes through; none at first.
  struct Holes {
    std::vector<char> triangle, cylinder;
  };
  // Adds those that the link between these particles held together, which is gone.
  void open(int low, int high, Holes &holes) const;
  // Forces on nodes, by their places, velocities and masses. Returns the sum of all.
  Vec3 push(const AirLaw &law, double above, const Holes &holes, AirScratch &with) const;

 private:
  // The matrix from the part of a panel to its area.
  struct Areas {
    Vec3 x, y, z;
    Vec3 of(const Vec3 &part) const { return part.x * x + part.y * y + part.z * z; }
  };
  void find_points(AirScratch &with) const;
  template <std::size_t N> bool needs(const std::array<int, N> &of, int particle) const;
  void find_faces(const Holes &holes, AirScratch &with) const;    // what is a hole or torn has no size
  void find_areas(AirScratch &with) const;
  bool may_be_lowered(const AirLaw &law, const AirScratch &with) const;
  void find_loads(AirScratch &with) const;
  Areas areas_of_frame(const AirScratch &with) const;
  static Vec3 area_of(const Points &t, const AirScratch &with);
  // Calls push(force, points that share it, part of each).
  template <class Push> void each_force(const AirLaw &law, double above, const AirScratch &with, const Push &push) const;

  AirSides sides;
  std::vector<std::size_t> first{0};    // weights of each point, and the end
  std::vector<int> node;                // a particle, after finish() the number of a node
  std::vector<double> weight;
  double largest_weight = 0.0;
  std::vector<Points> triangles;
  std::vector<Cylinder> cylinders;
  std::vector<Ball> balls;
  std::vector<Panel> panels;
  std::array<int, 4> frame{-1, -1, -1, -1};
  std::vector<int> needed;
};

// Skins of objects from a text, by molecule IDs; objects may share one. Throws std::runtime_error with the line: `name` names the
// file (docs/fix_mdanim_air.md).
std::map<int, std::shared_ptr<const AirSkin>> read_skins(const std::string &name, const std::string &text);

}    // namespace mdanim
