// SPDX-License-Identifier: GPL-2.0-only
// Two bodies of any shapes.

#include "rigid/pair.h"

#include <algorithm>

namespace mdanim {

void touch_solids(const TouchStep &step, SolidPair &pair, Solid &a, Solid &b, const TouchLaw &law)
{
  const auto is = [](const Solid &one, SolidShape::ShapeKind kind) { return one.shape.kind() == kind; };
  const bool is_ball = is(a, SolidShape::BALL), is_other_ball = is(b, SolidShape::BALL);
  const bool is_mesh = is(a, SolidShape::MESH), is_other_mesh = is(b, SolidShape::MESH);
  if (is_ball && is_other_mesh)
    touch_ball_and_mesh(step, pair, a, b, law);
  else if (is_other_ball && is_mesh)
    touch_ball_and_mesh(step, pair, b, a, law);
  else if (is(a, SolidShape::ELLIPSOID) && is_other_mesh)
    touch_ellipsoid_and_mesh(step, pair, a, b, law);
  else if (is(b, SolidShape::ELLIPSOID) && is_mesh)
    touch_ellipsoid_and_mesh(step, pair, b, a, law);
  else if (is_ball && is_other_ball)
    touch_balls(step, pair, a, b, law);
  else if (is_ball)
    touch_ball_and_other(step, pair, a, b, law);
  else if (is_other_ball)
    touch_ball_and_other(step, pair, b, a, law);
  else if (is(a, SolidShape::TORUS) || is(b, SolidShape::TORUS))
    touch_with_curves(step, pair, a, b, law);
  else if (is(a, SolidShape::ELLIPSOID))
    touch_ellipsoid_and_other(step, pair, a, b, law);
  else if (is(b, SolidShape::ELLIPSOID))
    touch_ellipsoid_and_other(step, pair, b, a, law);
  else if ((is_mesh || is(a, SolidShape::POLYHEDRON)) && (is_other_mesh || is(b, SolidShape::POLYHEDRON)))
    touch_polyhedra(step, pair, a, b, law);
  else
    touch_with_curves(step, pair, a, b, law);
}

double overlap(Solid &a, Solid &b)
{
  TouchAccount account;
  SolidPair pair;
  touch_solids(TouchStep(0.0, 1.0, account), pair, a, b, {1.0, 0.0, 0.0});
  double deepest = 0.0;
  for (const Touch &touch : pair.touches) deepest = std::max(deepest, touch.memory.offset);
  return deepest;
}

}    // namespace mdanim
