// SPDX-License-Identifier: GPL-2.0-only
// Words of a table of contact bodies. No more memory is allocated than the rest of the text can fill with numbers.

#include "contact/bodies_file.h"

#include <charconv>
#include <limits>
#include <stdexcept>

namespace mdanim {

namespace {

class Words {
 public:
  Words(const std::string &name, std::string_view text) : name(name), text(text) {}

  // The next word, empty at the end.
  std::string_view next()
  {
    while (at < text.size() && (is_space(text[at]) || text[at] == '#')) {
      if (text[at] == '#')
        while (at < text.size() && text[at] != '\n') ++at;
      else
        line_now += text[at++] == '\n';
    }
    const std::size_t from = at;
    while (at < text.size() && !is_space(text[at]) && text[at] != '#') ++at;
    return text.substr(from, at - from);
  }
  void expect(const char *wanted)
  {
    const std::string_view word = next();
    if (word != wanted) fail(std::string("'") + wanted + "' is needed here" + got(word));
  }
  // Which one of some words follows, from 0.
  template <std::size_t N> std::size_t choice(const char *const (&words)[N])
  {
    const std::string_view word = next();
    std::string all;
    for (std::size_t n = 0; n < N; ++n) {
      if (word == words[n]) return n;
      all += std::string(n == 0 ? "'" : n + 1 < N ? "', '" : "' or '") + words[n];
    }
    fail(all + "' is needed here" + got(word));
  }
  template <class Number> Number number(const char *what)
  {
    const std::string_view word = next();
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || end != word.data() + word.size())
      fail(std::string(what) + " must be a " + (std::numeric_limits<Number>::is_integer ? "whole " : "") + "number" + got(word));
    return value;
  }
  // The number of elements that follow.
  int many(const char *what, int numbers_of_each = 1)
  {
    const int n = number<int>(what);
    if (n < 0 || static_cast<std::size_t>(n) > (text.size() - at) / (2 * numbers_of_each))
      fail(std::string("the rest of the file cannot hold ") + std::to_string(n) + " " + what);
    return n;
  }
  int line() const { return line_now; }
  [[noreturn]] void fail(const std::string &why, int line) const
  { throw std::runtime_error(name + ":" + std::to_string(line) + ": " + why); }
  [[noreturn]] void fail(const std::string &why) const { fail(why, line_now); }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  static std::string got(std::string_view word)
  { return word.empty() ? ", the file ends" : ", got '" + std::string(word.substr(0, 40)) + "'"; }

  const std::string &name;
  std::string_view text;
  std::size_t at = 0;
  int line_now = 1;
};

ContactBody read_body(Words &words)
{
  const int line = words.line();
  std::int32_t count[3];
  double edge[3];
  words.expect("cells");
  for (std::int32_t &n : count) n = words.number<std::int32_t>("a count of cells");
  words.expect("edge");
  for (double &length : edge) length = words.number<double>("an edge of the cells");
  // Doubles: their product may not fit an integer.
  const double volume = 1.0 * count[0] * count[1] * count[2];

  std::vector<std::int32_t> node, frame;
  std::vector<double> frame_at;
  int particles = 0;
  double radius = 0.0, hardness = 1.0, spread = 0.0;
  std::vector<std::int32_t> sharer;
  std::vector<double> share;
  int between = 0;
  const std::size_t is = words.choice({"particles", "rigid", "line", "tears"});
  constexpr std::size_t RIGID = 1, LINE = 2, TEARS = 3;
  if (is == LINE) {
    particles = words.number<int>("the number of particles");
    radius = words.number<double>("the radius of particles");
    if (!(radius > 0.0)) words.fail("the radius of particles must be above 0");
    hardness = words.number<double>("the hardness of a line");
    spread = words.number<double>("the spread of points between particles");
    between = words.many("points between particles", 2 * SHARERS);
    for (int n = 0; n < between; ++n) {
      for (int k = 0; k < SHARERS; ++k) sharer.push_back(words.number<std::int32_t>("a particle that shares a point"));
      for (int k = 0; k < SHARERS; ++k) share.push_back(words.number<double>("a share of a point"));
    }
  } else if (is != RIGID) {
    node.resize(particles = words.many("particles"));
    for (std::int32_t &n : node) n = words.number<std::int32_t>("the place of a particle");
  } else {
    particles = words.number<int>("the number of particles");
    for (int k = 0; k < RigidFrame::PARTICLES; ++k) {
      frame.push_back(words.number<std::int32_t>("a particle of the frame"));
      for (int d = 0; d < 3; ++d) frame_at.push_back(words.number<double>("a coordinate of a particle"));
    }
  }

  words.expect("filled");
  std::vector<std::uint8_t> filled(words.many("cells"));
  if (static_cast<double>(filled.size()) != volume) words.fail("a body of these counts has another number of cells");
  for (std::uint8_t &cell : filled) {
    const int value = words.number<int>("whether a cell is filled");
    if (value != 0 && value != 1) words.fail("a cell is filled, 1, or not, 0");
    cell = static_cast<std::uint8_t>(value);
  }

  constexpr int NUMBERS = 12;    // of a point
  words.expect("points");
  const int points = words.many("points", NUMBERS);
  std::vector<std::int32_t> cell(points);
  std::vector<std::uint8_t> kind(points);
  std::vector<double> area(points), at(3 * points), centre(3 * points), normal(3 * points);
  for (int p = 0; p < points; ++p) {
    cell[p] = words.number<std::int32_t>("the cell of a point");
    const int value = words.number<int>("the kind of a point");
    if (value < 0 || value > 3) words.fail("the kind of a point is 0, 1, 2 or 3");
    kind[p] = static_cast<std::uint8_t>(value);
    area[p] = words.number<double>("the area of a point");
    for (std::vector<double> *values : {&at, &centre, &normal})
      for (int d = 0; d < 3; ++d) (*values)[3 * p + d] = words.number<double>("a coordinate of a point");
  }

  words.expect("depth");
  std::vector<double> depth(words.many("depths"));
  if (!depth.empty() && depth_margin(count, depth.size()) == 0) words.fail("a body of these counts has another number of depths");
  for (double &value : depth) value = words.number<double>("a depth");

  words.expect("open");
  const int parts = words.many("open parts of sides", OPEN_NUMBERS);
  std::vector<double> open(OPEN_NUMBERS * static_cast<std::size_t>(parts));
  for (double &value : open) value = words.number<double>("a number of an open part");
  try {
    return ContactBody({count,
                        edge,
                        particles,
                        node.data(),
                        filled.data(),
                        points,
                        cell.data(),
                        at.data(),
                        centre.data(),
                        normal.data(),
                        area.data(),
                        kind.data(),
                        depth.empty() ? nullptr : depth.data(),
                        depth.size(),
                        parts,
                        open.data(),
                        frame.empty() ? nullptr : frame.data(),
                        frame_at.data(),
                        radius,
                        hardness,
                        spread,
                        between,
                        sharer.data(),
                        share.data(),
                        is == TEARS});
  } catch (const std::runtime_error &problem) {
    words.fail(problem.what(), line);
  }
}

}    // namespace

std::map<int, ContactBody> read_bodies(const std::string &name, std::string_view text)
{
  std::map<int, ContactBody> found;
  Words words(name, text);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word != "body") words.fail("'body' and its number are needed here, got '" + std::string(word.substr(0, 40)) + "'");
    const int number = words.number<int>("the number of a body");
    if (number < 0 || found.count(number)) words.fail("the number of a body is at least 0 and comes once");
    found.emplace(number, read_body(words));
  }
  if (found.empty()) words.fail("there is no body");
  return found;
}

}    // namespace mdanim
