// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/glue.h"

#include "records/line_words.h"

namespace mdanim {

static constexpr double RIGHT = 1e-6;    // how far axes may be from right angles

// A B side side strength area  I1 I2  W1 W2 Wn  x y z  n  e1, or A B weld x y z
std::vector<GlueFace> read_glue(const std::string &name, const std::string &text)
{
  std::vector<GlueFace> found;
  each_line(name, text, [&](LineWords &words) {
    GlueFace face;
    face.a = words.molecule();
    face.b = words.molecule();
    if (face.a >= face.b) words.fail("the molecule ID with the lower number stands first");
    if (words.takes("weld")) {
      face.at = words.vector("the place of the weld");
      words.expect_end();
      found.push_back(face);
      return;
    }
    face.side_a = words.number<int>("the side of the first piece");
    face.side_b = words.number<int>("the side of the second piece");
    face.strength = words.positive("the strength");
    face.area = words.positive("the area");
    face.second.x = words.positive("a second moment of area");
    face.second.y = words.positive("a second moment of area");
    face.second.z = face.second.x + face.second.y;
    face.section.x = words.positive("a section modulus");
    face.section.y = words.positive("a section modulus");
    face.section.z = words.positive("a section modulus");
    face.at = words.vector("the middle of the face");
    face.axis[0] = words.vector("the normal");
    face.axis[1] = words.vector("an axis of the face");
    const auto is_off = [](double value, double wanted) { return std::fabs(value - wanted) > RIGHT; };
    if (is_off(dot(face.axis[0], face.axis[0]), 1.0) || is_off(dot(face.axis[1], face.axis[1]), 1.0) ||
        is_off(dot(face.axis[0], face.axis[1]), 0.0))
      words.fail("the normal and the axis of the face are not unit vectors at right angles");
    face.axis[2] = cross(face.axis[0], face.axis[1]);
    words.expect_end();
    found.push_back(face);
  });
  return found;
}

}    // namespace mdanim
