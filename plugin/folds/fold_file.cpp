// SPDX-License-Identifier: GPL-2.0-only

#include "folds/fold_object.h"
#include "records/line_words.h"

#include <algorithm>

namespace mdanim {

namespace {

int read_molecule(LineWords &words)
{
  const int id = words.number<int>("a molecule ID");
  if (id < 1) words.fail(std::to_string(id) + " is not a molecule ID");
  return id;
}

// An entry of the particles of the object so far.
int read_corner(LineWords &words, const FoldObject &object)
{
  const int number = words.number<int>("the number of a particle of the object");
  const int count = static_cast<int>(object.particles.size());
  if (number < 1 || number > count)
    words.fail("there is no particle " + std::to_string(number) + "; its object has " + std::to_string(count) + " so far");
  return number - 1;
}

void read_part(LineWords &words, const std::string &kind, FoldObject &object)
{
  if (kind == "particle") {
    const int number = words.number<int>("a particle of the object, from 1");
    if (number < 1 || (!object.particles.empty() && number - 1 <= object.particles.back()))
      words.fail("particles of an object count from 1 and ascend, got " + std::to_string(number));
    object.particles.push_back(number - 1);
    object.rest.push_back(words.vector("its place without load"));
    object.weight.push_back(words.positive("its weight"));
  } else if (kind == "triangle") {
    if (!object.segments.empty() || !object.cells.empty()) words.fail("an object has cells, triangles or segments");
    const int a = read_corner(words, object), b = read_corner(words, object), c = read_corner(words, object);
    object.triangles.push_back({a, b, c});
  } else if (kind == "segment") {
    if (!object.triangles.empty() || !object.cells.empty()) words.fail("an object has cells, triangles or segments");
    const int a = read_corner(words, object), b = read_corner(words, object);
    object.segments.push_back({a, b});
  } else if (kind == "cell") {
    if (!object.segments.empty() || !object.triangles.empty()) words.fail("an object has cells, triangles or segments");
    std::array<int, 8> corners;
    for (int &corner : corners) corner = read_corner(words, object);
    object.cells.push_back(corners);
  } else {
    words.fail("a line begins with object, particle, cell, triangle, segment or pair, got " + kind);
  }
}

FoldPair read_pair(LineWords &words, const FoldTable &table)
{
  FoldPair pair{};
  pair.first = read_molecule(words);
  pair.second = read_molecule(words);
  for (const int id : {pair.first, pair.second}) {
    const auto found = table.objects.find(id);
    if (found == table.objects.end()) words.fail("there is no object " + std::to_string(id) + " before this pair");
    if (found->second.triangles.empty() && found->second.segments.empty() && found->second.cells.empty())
      words.fail("object " + std::to_string(id) + " has no cell, triangle or segment");
  }
  pair.law.reach = words.positive("the reach of a pair");
  pair.law.stiffness = words.positive("the stiffness of a pair");
  pair.law.friction = words.at_least_zero("the friction of a pair");
  pair.law.damping = words.at_least_zero("the damping of a pair");
  if (pair.first == pair.second && !words.is_at_end())
    pair.apart = words.positive("the distance from which on an object touches itself");
  return pair;
}

}    // namespace

void FoldObject::cut_faces()
{
  constexpr int FACES[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  std::map<std::array<int, 4>, std::size_t> known;    // the first triangle of each face, by its corners
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const auto &face : FACES) {
      std::array<int, 4> corner, sorted;
      for (int k = 0; k < 4; ++k) corner[k] = sorted[k] = cells[c][face[k]];
      std::sort(sorted.begin(), sorted.end());
      const auto [at, is_new] = known.emplace(sorted, triangles.size());
      if (!is_new) {
        sides[at->second][1] = sides[at->second + 1][1] = static_cast<int>(c);
        continue;
      }
      triangles.push_back({corner[0], corner[1], corner[2]});
      triangles.push_back({corner[0], corner[2], corner[3]});
      sides.insert(sides.end(), 2, {static_cast<int>(c), -1});
    }
}

FoldTable read_folds(const std::string &name, const std::string &text)
{
  FoldTable table;
  FoldObject *now = nullptr;
  each_line(name, text, [&](LineWords &words) {
    const std::string kind = words.word("object");
    if (kind == "object") {
      const int id = read_molecule(words);
      if (table.objects.count(id)) words.fail("object " + std::to_string(id) + " is there already");
      now = &table.objects[id];
    } else if (kind == "pair") {
      table.pairs.push_back(read_pair(words, table));
    } else {
      if (!now) words.fail(kind + " belongs behind a line object MOLECULE");
      read_part(words, kind, *now);
    }
    words.expect_end();
  });
  for (auto &[id, object] : table.objects) object.cut_faces();
  return table;
}

}    // namespace mdanim
