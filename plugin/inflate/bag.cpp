// SPDX-License-Identifier: GPL-2.0-only

#include "inflate/bag.h"

#include "records/line_words.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace mdanim {

void BagSurface::finish()
{
  std::vector<std::pair<int, int>> edges;
  for (const Corners &t : triangles) {
    needed.insert(needed.end(), t.begin(), t.end());
    for (int k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto &[from, to] = edges[e];
    const bool is_twice = e > 0 && edges[e - 1] == edges[e];
    if (is_twice || !std::binary_search(edges.begin(), edges.end(), std::make_pair(to, from)))
      throw std::runtime_error("the surface is open at the edge from particle " + std::to_string(from + 1) + " to particle " +
                               std::to_string(to + 1) + ", or its triangles are not all counter-clockwise seen from outside");
  }
  std::sort(needed.begin(), needed.end());
  needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
  for (Corners &t : triangles)
    for (int &one : t) one = static_cast<int>(std::lower_bound(needed.begin(), needed.end(), one) - needed.begin());
}

double BagSurface::volume(const std::vector<Vec3> &x) const
{
  double sum = 0.0;
  for (const auto &[a, b, c] : triangles) sum += sixth_of_volume(x[a] - x[0], x[b] - x[0], x[c] - x[0]);
  return sum / 6.0;
}

void BagSurface::find_areas(const std::vector<Vec3> &x, std::vector<Vec3> &areas) const
{
  areas.assign(needed.size(), {});
  for (const Corners &t : triangles) {
    const Vec3 part = (1.0 / 6.0) * twice_area(x[t[0]], x[t[1]], x[t[2]]);
    for (const int corner : t) areas[corner] += part;
  }
}

// --- the file ---

namespace {

// The object whose lines are being read.
struct BagReading {
  int molecule = 0;
  std::shared_ptr<BagSurface> surface;    // none of an object that has the triangles of another one
};

GasLaw read_gas(LineWords &words)
{
  const double over = words.number<double>("the pressure above that of what is outside");
  const double volume = words.positive("the volume");
  const double outside = words.at_least_zero("the pressure outside");
  if (!(over + outside > 0.0)) words.fail("there is no gas: the pressure inside must be above 0");
  return {outside, (over + outside) * volume, volume};
}

void read_triangle(LineWords &words, BagSurface &surface)
{
  BagSurface::Corners corners{};
  for (int &one : corners) {
    one = words.number<int>("a particle of the object, from 1") - 1;
    if (one < 0) words.fail("particles of an object count from 1, got " + std::to_string(one + 1));
  }
  surface.append(corners);
}

}    // namespace

std::map<int, Bag> read_bags(const std::string &name, const std::string &text)
{
  std::map<int, Bag> found;
  BagReading now;
  const auto end_object = [&] {
    if (!now.surface) return;
    const std::string where = name + ": object " + std::to_string(now.molecule);
    if (now.surface->is_empty()) throw std::runtime_error(where + " has no triangle");
    try {
      now.surface->finish();
    } catch (const std::runtime_error &open) {
      throw std::runtime_error(where + ": " + open.what());
    }
  };
  each_line(name, text, [&](LineWords &words) {
    const std::string kind = words.word("object");
    if (kind == "triangle") {
      if (!now.surface) words.fail("triangle belongs behind a line object MOLECULE P V P0");
      read_triangle(words, *now.surface);
    } else if (kind == "object") {
      end_object();
      now = {words.molecule(), nullptr};
      if (found.count(now.molecule)) words.fail("object " + std::to_string(now.molecule) + " is there already");
      const GasLaw gas = read_gas(words);
      if (words.is_at_end()) {
        now.surface = std::make_shared<BagSurface>();
        found[now.molecule] = {gas, now.surface};
      } else {
        if (const std::string word = words.word("like"); word != "like")
          words.fail("behind the pressure outside comes like N or nothing, got " + word);
        const auto other = found.find(words.molecule());
        if (other == found.end()) words.fail("the object whose triangles it has stands before it");
        found[now.molecule] = {gas, other->second.surface};
      }
    } else {
      words.fail("a line begins with object or triangle, got " + kind);
    }
    words.expect_end();
  });
  end_object();
  return found;
}

}    // namespace mdanim
