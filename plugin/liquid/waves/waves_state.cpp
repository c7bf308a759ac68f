// SPDX-License-Identifier: GPL-2.0-only
// Everything that later updates depend on, as bytes.

#include "liquid/waves/waves.h"

#include "liquid/state_kind.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace mdanim {

namespace {

constexpr std::int64_t WAVES_VERSION = 4;
constexpr std::int64_t RESTING = 1, WALLED = 2;    // flags

struct WavesStateHead {    // after the version
  StateGrid grid;
  std::int64_t spans, links, units, flags;
};

struct SpanRecord {
  Units content;
  double full, rest, phi, delta, last_delta, yields;
};

struct LinkRecord {
  double u, q;
};

}    // namespace

// The head, solid parts of all cells, held ones where there are any, spans, links.
std::vector<std::uint8_t> Waves::state() const
{
  std::vector<SpanRecord> spans;
  columns.each_span([&](long i) {
    spans.push_back({columns.content[i], columns.arrays.full[i], columns.arrays.rest[i], columns.arrays.phi[i],
                     columns.arrays.delta[i], columns.arrays.last_delta[i], columns.arrays.yields[i]});
  });
  std::vector<LinkRecord> links;
  columns.each_link(
      [&](const LinkPlace &link) { links.push_back({columns.arrays_of(link).u[link.at], columns.arrays_of(link).q[link.at]}); });
  const bool walled =
      std::any_of(columns.wall.part.begin(), columns.wall.part.end(), [](std::uint16_t part) { return part != 0; });
  const WavesStateHead head{{columns.nx, columns.ny, columns.nz},
                            static_cast<std::int64_t>(spans.size()),
                            static_cast<std::int64_t>(links.size()),
                            total(),
                            (run.resting ? RESTING : 0) | (walled ? WALLED : 0)};
  ByteWriter writer;
  writer.put(WAVES_VERSION).put(head).put_all(columns.solid.part);
  if (walled) writer.put_all(columns.wall.part);
  return writer.put_all(spans).put_all(links).take();
}

void Waves::set_state(const std::uint8_t *bytes, std::size_t size)
{
  ByteReader reader(bytes, size, "the state of the waves");
  reader.expect_version(WAVES_VERSION);
  const auto head = reader.get<WavesStateHead>();
  StateGrid{columns.nx, columns.ny, columns.nz}.expect(head.grid, reader);
  const auto part = reader.get_all<std::uint16_t>(columns.solid.part.size());
  const std::vector<std::uint16_t> walls =
      head.flags & WALLED ? reader.get_all<std::uint16_t>(part.size()) : std::vector<std::uint16_t>(part.size(), 0);
  Waves empty(columns.nx, columns.ny, columns.nz);    // so that a damaged state changes nothing
  empty.set_walls(walls.data());
  empty.set_solids(part.data(), nullptr);
  std::int64_t span_count = 0, link_count = 0;
  empty.columns.each_span([&](long) { ++span_count; });
  empty.columns.each_link([&](const LinkPlace &) { ++link_count; });
  const std::size_t expected = span_count * sizeof(SpanRecord) + link_count * sizeof(LinkRecord);
  if (head.spans != span_count || head.links != link_count || reader.left() != expected)
    reader.is_damaged("its solids have " + std::to_string(span_count) + " spans and " + std::to_string(link_count) +
                      " links, not " + std::to_string(head.spans) + " and " + std::to_string(head.links));
  const auto spans = reader.get_all<SpanRecord>(span_count);
  const auto links = reader.get_all<LinkRecord>(link_count);
  Units held = 0;
  bool damaged = false;
  for (const SpanRecord &record : spans) {
    if (record.content < 0) reader.is_damaged("a span holds " + std::to_string(record.content) + " units");
    held += record.content;
    damaged =
        damaged || !std::isfinite(record.full + record.rest + record.phi + record.delta + record.last_delta + record.yields);
  }
  for (const LinkRecord &record : links) damaged = damaged || run.limited(record.u) != record.u || !std::isfinite(record.q);
  if (damaged)
    reader.is_damaged("it holds a value that is not a number, or liquid faster than " + std::to_string(run.law.fastest));
  if (held != head.units)
    reader.is_damaged("it holds " + std::to_string(held) + " units of liquid, not " + std::to_string(head.units));

  std::fill(columns.content.begin(), columns.content.end(), 0);    // empty spans lose nothing to solids
  set_walls(walls.data());
  set_solids(part.data(), nullptr);
  const SpanRecord *span_record = spans.data();
  columns.each_span([&](long i) {
    const SpanRecord &record = *span_record++;
    columns.content[i] = record.content;
    columns.arrays.full[i] = record.full;
    columns.arrays.rest[i] = record.rest;
    columns.arrays.phi[i] = record.phi;
    columns.arrays.delta[i] = record.delta;
    columns.arrays.last_delta[i] = record.last_delta;
    columns.arrays.yields[i] = record.yields;
    columns.arrays.coming[i] = 0.0;
  });
  const LinkRecord *link_record = links.data();
  columns.each_link([&](const LinkPlace &link) {
    columns.arrays_of(link).u[link.at] = link_record->u;
    columns.arrays_of(link).q[link.at] = link_record->q;
    ++link_record;
  });
  run.some_full = true;    // until the next update has checked
  run.resting = (head.flags & RESTING) != 0;
}

}    // namespace mdanim
