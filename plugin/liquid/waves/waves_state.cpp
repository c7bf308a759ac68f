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
  each_span([&](long i) {
    spans.push_back(
        {content[i], arrays.full[i], arrays.rest[i], arrays.phi[i], arrays.delta[i], arrays.last_delta[i], arrays.yields[i]});
  });
  std::vector<LinkRecord> links;
  each_link([&](const LinkPlace &link) { links.push_back({arrays_of(link).u[link.at], arrays_of(link).q[link.at]}); });
  const bool walled = std::any_of(wall.part.begin(), wall.part.end(), [](std::uint16_t part) { return part != 0; });
  const WavesStateHead head{{nx, ny, nz},
                            static_cast<std::int64_t>(spans.size()),
                            static_cast<std::int64_t>(links.size()),
                            total(),
                            (resting ? RESTING : 0) | (walled ? WALLED : 0)};
  ByteWriter writer;
  writer.put(WAVES_VERSION).put(head).put_all(solid.part);
  if (walled) writer.put_all(wall.part);
  return writer.put_all(spans).put_all(links).take();
}

void Waves::set_state(const std::uint8_t *bytes, std::size_t size)
{
  ByteReader reader(bytes, size, "the state of the waves");
  reader.expect_version(WAVES_VERSION);
  const auto head = reader.get<WavesStateHead>();
  StateGrid{nx, ny, nz}.expect(head.grid, reader);
  const auto part = reader.get_all<std::uint16_t>(solid.part.size());
  const std::vector<std::uint16_t> walls =
      head.flags & WALLED ? reader.get_all<std::uint16_t>(part.size()) : std::vector<std::uint16_t>(part.size(), 0);
  Waves cut(nx, ny, nz);    // so that a damaged state changes nothing
  cut.set_walls(walls.data());
  cut.set_solids(part.data(), nullptr);
  std::int64_t span_count = 0, link_count = 0;
  cut.each_span([&](long) { ++span_count; });
  cut.each_link([&](const LinkPlace &) { ++link_count; });
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
  for (const LinkRecord &record : links) damaged = damaged || limited(record.u) != record.u || !std::isfinite(record.q);
  if (damaged) reader.is_damaged("it holds a value that is not a number, or liquid faster than " + std::to_string(law.fastest));
  if (held != head.units)
    reader.is_damaged("it holds " + std::to_string(held) + " units of liquid, not " + std::to_string(head.units));

  std::fill(content.begin(), content.end(), 0);    // empty spans lose nothing to solids
  set_walls(walls.data());
  set_solids(part.data(), nullptr);
  const SpanRecord *span_record = spans.data();
  each_span([&](long i) {
    const SpanRecord &record = *span_record++;
    content[i] = record.content;
    arrays.full[i] = record.full;
    arrays.rest[i] = record.rest;
    arrays.phi[i] = record.phi;
    arrays.delta[i] = record.delta;
    arrays.last_delta[i] = record.last_delta;
    arrays.yields[i] = record.yields;
    arrays.coming[i] = 0.0;
  });
  const LinkRecord *link_record = links.data();
  each_link([&](const LinkPlace &link) {
    arrays_of(link).u[link.at] = link_record->u;
    arrays_of(link).q[link.at] = link_record->q;
    ++link_record;
  });
  some_full = true;    // until the next update has checked
  resting = (head.flags & RESTING) != 0;
}

}    // namespace mdanim
