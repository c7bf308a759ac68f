// SPDX-License-Identifier: GPL-2.0-only
// Particles and springs put into tag order.

#include "passes/tag_order.h"

#include <algorithm>
#include <numeric>

namespace mdanim {

namespace {

// Whether an array indexed by tags would be far longer than the number of tags: tags may have any gaps.
bool is_sparse(int lowest, int highest, std::size_t many)
{
  constexpr std::int64_t SPARSE = 16, ALWAYS = 1024;
  return static_cast<std::int64_t>(highest) - lowest > SPARSE * static_cast<std::int64_t>(many) + ALWAYS;
}

// Places of tags in ascending order: in an array with a place for each tag from the lowest to the highest, or, where that would
// be far too long, for the existing tags only.
class TagPlaces {
 public:
  // each_tag(visit) visits all tags.
  template <class Each> TagPlaces(int lowest, int highest, std::size_t many, const Each &each_tag) : lowest(lowest)
  {
    if (is_sparse(lowest, highest, many)) {
      each_tag([this](int tag) { tags.push_back(tag); });
      std::sort(tags.begin(), tags.end());
      tags.erase(std::unique(tags.begin(), tags.end()), tags.end());
    }
    places = tags.empty() ? highest - lowest + 1 : static_cast<int>(tags.size());
  }
  int size() const { return places; }
  int place(int tag) const
  { return tags.empty() ? tag - lowest : static_cast<int>(std::lower_bound(tags.begin(), tags.end(), tag) - tags.begin()); }
  int tag(int place) const { return tags.empty() ? lowest + place : tags[place]; }

 private:
  int lowest, places;
  std::vector<int> tags;    // empty where every tag in between has a place
};

}    // namespace

// Sorts own particles by tags.
void TagOrder::sort(const Bonded &known)
{
  const int *const tag = known.tag;
  const auto [lowest, highest] = std::minmax_element(tag, tag + known.own);
  ordered.clear();
  if (known.own == 0) return;
  if (is_sparse(*lowest, *highest, known.own)) {
    ordered.resize(known.own);
    std::iota(ordered.begin(), ordered.end(), 0);
    std::sort(ordered.begin(), ordered.end(), [tag](int i, int j) { return tag[i] < tag[j]; });
    return;
  }
  std::vector<int> of_tag(*highest - *lowest + 1, -1);
  for (int i = 0; i < known.own; ++i) of_tag[tag[i] - *lowest] = i;
  for (const int i : of_tag)
    if (i >= 0) ordered.push_back(i);
}

void TagOrder::take(const Bonded &known)
{
  const int *const tag = known.tag;
  sort(known);

  std::vector<Run> runs;
  for (int n = 0; n < known.own; ++n) {
    const int object = known.object[ordered[n]];
    if (runs.empty() || runs.back().object != object) runs.push_back({n, n, object});
    runs.back().end = n + 1;
  }
  if (!take_by_objects(known, runs)) {    // objects are mixed, or have springs between them
    all.clear();
    all.push_back(made(known, {0, known.own, 0}));
    differs = true;
  }

  index.clear();
  auto own = ordered.begin();
  for (const Piece &piece : all)
    for (const int one : piece.tag) {
      const bool mine = own != ordered.end() && tag[*own] == one;
      index.push_back(mine ? *own++ : known.find(one));
      if (index.back() < 0) refuse_lost_partner(known, one);
    }
}

void TagOrder::refuse_lost_partner(const Bonded &known, int partner)
{
  for (int i = 0; i < known.own; ++i)
    if (std::find(known.partner[i], known.partner[i] + known.bonds[i], partner) != known.partner[i] + known.bonds[i])
      known.lost(i, partner);
  known.lost(-1, partner);
}

// Whether there is a piece for each object; no particle of an object is among those of another.
bool TagOrder::take_by_objects(const Bonded &known, const std::vector<Run> &runs)
{
  std::unordered_map<int, Piece *> before;    // by object
  for (Piece &piece : all)
    if (!piece.own.empty()) before.emplace(piece.object.front(), &piece);
  differs = all.size() != runs.size();
  std::vector<Piece> now;
  int last = 0;    // tag
  for (const Run &run : runs) {
    const auto found = before.find(run.object);
    const auto same = [&](const std::vector<int> &tags) {
      return std::equal(tags.begin(), tags.end(), &ordered[run.begin], &ordered[run.begin] + (run.end - run.begin),
                        [&](int one, int i) { return one == known.tag[i]; });
    };
    if (found != before.end() && same(found->second->own)) {
      differs = differs || now.size() >= all.size() || found->second != &all[now.size()];
      now.push_back(std::move(*found->second));
      before.erase(found);
    } else {
      differs = true;
      now.push_back(made(known, run));
    }
    const Piece &piece = now.back();
    const bool alone = std::all_of(piece.object.begin(), piece.object.end(), [&](int object) { return object == run.object; });
    if (!alone || piece.tag.front() <= last) return false;
    last = piece.tag.back();
  }
  all = std::move(now);
  return true;
}

// A spring belongs to its lower end, which may be on another rank. From the highest own particle down all partners come in
// descending order.
TagOrder::Piece TagOrder::made(const Bonded &known, const Run &run) const
{
  int lowest = known.tag[ordered[run.begin]], highest = known.tag[ordered[run.end - 1]];
  const auto each_bond = [&](auto visit) {    // visit(n, i, tag of the partner, type)
    for (int n = run.end - 1; n >= run.begin; --n) {
      const int i = ordered[n];
      for (int b = known.bonds[i] - 1; b >= 0; --b)
        if (known.type[i][b] > 0) visit(n, i, known.partner[i][b], known.type[i][b]);
    }
  };
  each_bond([&](int, int, int partner, int) { lowest = std::min(lowest, partner), highest = std::max(highest, partner); });
  const TagPlaces places(lowest, highest, run.end - run.begin, [&](const auto &visit) {
    for (int n = run.begin; n < run.end; ++n) visit(known.tag[ordered[n]]);
    each_bond([&](int, int, int partner, int) { visit(partner); });
  });
  constexpr int ABSENT = -1;
  std::vector<int> of_tag(places.size(), ABSENT);    // an index in LAMMPS's arrays, then a place in the piece
  for (int n = run.begin; n < run.end; ++n) of_tag[places.place(known.tag[ordered[n]])] = ordered[n];
  each_bond([&](int, int i, int partner, int) {
    int &found = of_tag[places.place(partner)];
    if (found == ABSENT) found = known.find(partner);
    if (found < 0) known.lost(i, partner);
  });

  Piece piece;
  std::vector<bool> own;
  for (int t = 0; t < places.size(); ++t) {
    const int i = of_tag[t];
    if (i == ABSENT) continue;
    of_tag[t] = static_cast<int>(piece.tag.size());
    piece.tag.push_back(places.tag(t));
    piece.object.push_back(known.object[i]);
    own.push_back(i < known.own);
    if (own.back()) piece.own.push_back(piece.tag.back());
  }

  std::vector<SpringRows::Row> row(piece.tag.size());
  each_bond([&](int n, int, int partner, int type) {
    const int here = of_tag[places.place(known.tag[ordered[n]])], there = of_tag[places.place(partner)];
    if (there > here)
      row[here].link.push_back({there - here, type});
    else if (!own[there])
      row[there].link.push_back({here - there, type});
  });
  const auto farther = [](const SpringRows::Link &a, const SpringRows::Link &b) { return a.offset > b.offset; };
  piece.rows = SpringRows(static_cast<int>(row.size()));
  for (SpringRows::Row &r : row) {
    if (!std::is_sorted(r.link.begin(), r.link.end(), farther)) std::stable_sort(r.link.begin(), r.link.end(), farther);
    piece.rows.add(r);
  }
  piece.rows.close();
  return piece;
}

std::size_t TagOrder::bytes() const
{
  std::size_t sum = (index.capacity() + ordered.capacity()) * sizeof(int);
  for (const Piece &piece : all)
    sum += (piece.own.capacity() + piece.tag.capacity() + piece.object.capacity()) * sizeof(int) + piece.rows.bytes() +
           piece.cut.bytes();
  return sum;
}

}    // namespace mdanim
