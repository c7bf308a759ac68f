// SPDX-License-Identifier: GPL-2.0-only

#include "air/skin.h"
#include "records/line_words.h"

#include <cmath>

namespace mdanim {

namespace {

// The object whose lines are being read.
struct SkinReading {
  int molecule = 0;
  std::shared_ptr<AirSkin> skin;    // none of an object that is like another
};

int read_molecule(LineWords &words)
{
  const int id = words.number<int>("a molecule ID");
  if (id < 1) words.fail(std::to_string(id) + " is not a molecule ID");
  return id;
}

int read_point(LineWords &words, const AirSkin &skin)
{
  const int number = words.number<int>("the number of a point");
  if (number < 1 || number > skin.points())
    words.fail("there is no point " + std::to_string(number) + "; its object has " + std::to_string(skin.points()) + " so far");
  return number - 1;
}

AirSkin::Weights read_weights(LineWords &words)
{
  AirSkin::Weights found;
  while (!words.is_at_end()) {
    const int particle = words.number<int>("a particle of the object, from 1");
    if (particle < 1) words.fail("particles of an object count from 1, got " + std::to_string(particle));
    found.emplace_back(particle - 1, words.number<double>("a weight"));
  }
  if (found.empty()) words.fail("a point has particles and weights");
  return found;
}

void read_part(LineWords &words, const std::string &kind, AirSkin &skin)
{
  if (kind == "point") {
    skin.append_point(read_weights(words));
  } else if (kind == "triangle") {
    const int a = read_point(words, skin), b = read_point(words, skin), c = read_point(words, skin);
    skin.append_triangle(a, b, c);
  } else if (kind == "cylinder") {
    const int from = read_point(words, skin), to = read_point(words, skin);
    const double diameter = words.positive("the diameter of a cylinder");
    const double most = words.is_at_end() ? HUGE_VAL : words.positive("the length from which on a cylinder is torn");
    skin.append_cylinder({from, to, diameter, most});
  } else if (kind == "ball") {
    const int at = read_point(words, skin);
    skin.append_ball({at, words.positive("the diameter of a ball")});
  } else if (kind == "frame") {
    std::array<int, 4> of{};
    for (int &one : of) one = read_point(words, skin);
    skin.set_frame(of);
  } else if (kind == "panel") {
    if (!skin.has_frame()) words.fail("a panel belongs behind the frame of its object");
    const int at = read_point(words, skin);
    skin.append_panel({at, words.vector("the area of a panel")});
  } else {
    words.fail("a line begins with object, point, triangle, cylinder, ball, frame or panel, got " + kind);
  }
  words.expect_end();
}

}    // namespace

std::map<int, std::shared_ptr<const AirSkin>> read_skins(const std::string &name, const std::string &text)
{
  std::map<int, std::shared_ptr<const AirSkin>> found;
  SkinReading now;
  const auto end_object = [&] {
    if (now.skin) now.skin->finish();
    if (now.skin && !now.skin->has_surface())
      throw std::runtime_error(name + ": object " + std::to_string(now.molecule) +
                               " has no surface: no triangle, cylinder, ball or panel");
  };
  each_line(name, text, [&](LineWords &words) {
    const std::string kind = words.word("object");
    if (kind != "object") {
      if (!now.skin) words.fail(kind + " belongs behind a line object MOLECULE outer|both");
      read_part(words, kind, *now.skin);
      return;
    }
    end_object();
    now.molecule = read_molecule(words);
    now.skin = nullptr;
    if (found.count(now.molecule)) words.fail("object " + std::to_string(now.molecule) + " is there already");
    const std::string how = words.word("outer, both or like");
    if (how == "like") {
      const auto other = found.find(read_molecule(words));
      if (other == found.end()) words.fail("an object is like one of those before it");
      found[now.molecule] = other->second;
    } else if (how == "outer" || how == "both") {
      now.skin = std::make_shared<AirSkin>(how == "both" ? AirSides::BOTH : AirSides::OUTER);
      found[now.molecule] = now.skin;
    } else {
      words.fail("air pushes at the outer side or at both, or an object is like another one, got " + how);
    }
    words.expect_end();
  });
  end_object();
  return found;
}

}    // namespace mdanim
