// SPDX-License-Identifier: GPL-2.0-only

#include "tearing/bend_file.h"

#include "records/line_words.h"

#include <algorithm>

namespace mdanim {

namespace {

int read_particle(LineWords &words)
{
  const int particle = words.number<int>("a particle of the object, from 1");
  if (particle < 1) words.fail("particles of an object count from 1, got " + std::to_string(particle));
  return particle - 1;
}

BendRing read_ring(LineWords &words)
{
  BendRing ring;
  ring.of.push_back(read_particle(words));
  ring.slot = words.number<int>("the place of its first line, from 0");
  if (ring.slot < 0) words.fail("places of lines count from 0");
  ring.is_closed = words.takes("closed");
  if (!ring.is_closed && !words.takes("open")) words.fail("a ring is closed or open");
  ring.area = words.positive("twice the area of its triangles");
  while (!words.is_at_end()) ring.of.push_back(read_particle(words));
  if (ring.of.size() < 3) words.fail("a ring has two particles or more around its middle");
  return ring;
}

BendLine read_line(LineWords &words, const BendRing &ring)
{
  BendLine line{words.positive("the stiffness of a line"), words.positive("the curvature that it bears"),
                words.number<double>("its curvature without load")};
  for (; !words.is_at_end(); ++line.count) {
    if (line.count == BendLine::MOST) words.fail("a line has four particles at most");
    const auto found = std::find(ring.of.begin(), ring.of.end(), read_particle(words));
    if (found == ring.of.end()) words.fail("particles of a line are those of its ring");
    line.at[line.count] = static_cast<int>(found - ring.of.begin());
    line.weight[line.count] = words.number<double>("a weight");
  }
  if (line.count < 3) words.fail("a line has three particles or more, and their weights");
  return line;
}

}    // namespace

std::map<int, std::vector<BendRing>> read_bends(const std::string &name, const std::string &text)
{
  std::map<int, std::vector<BendRing>> found;
  std::vector<BendRing> *now = nullptr;
  each_line(name, text, [&](LineWords &words) {
    const std::string kind = words.word("object");
    if (kind == "object") {
      const int molecule = words.molecule();
      if (found.count(molecule)) words.fail("object " + std::to_string(molecule) + " is there already");
      now = &found[molecule];
    } else if (kind == "ring") {
      if (!now) words.fail("ring belongs behind a line object MOLECULE");
      now->push_back(read_ring(words));
    } else if (kind == "line") {
      if (!now || now->empty()) words.fail("line belongs behind a line ring ..");
      now->back().lines.push_back(read_line(words, now->back()));
    } else {
      words.fail("a line begins with object, ring or line, got " + kind);
    }
    words.expect_end();
  });
  return found;
}

}    // namespace mdanim
