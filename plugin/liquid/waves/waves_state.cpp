// SPDX-License-Identifier: GPL-2.0-only
// All that later updates depend on, as bytes.

#include "liquid/waves/waves.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace mdanim {

namespace {

constexpr std::int64_t WAVES_VERSION = 4;
constexpr std::int64_t RESTING = 1, WALLED = 2;    // flags

struct WavesStateHead {
  std::int64_t version, nx, ny, nz, spans, links, units, flags;
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
  const WavesStateHead head{WAVES_VERSION,
                            nx,
                            ny,
                            nz,
                            static_cast<std::int64_t>(spans.size()),
                            static_cast<std::int64_t>(links.size()),
                            total(),
                            (resting ? RESTING : 0) | (walled ? WALLED : 0)};
  std::vector<std::uint8_t> bytes;
  const auto add = [&](const void *from, std::size_t size) {
    const auto *first = static_cast<const std::uint8_t *>(from);
    bytes.insert(bytes.end(), first, first + size);
  };
  add(&head, sizeof head);
  add(solid.part.data(), solid.part.size() * sizeof solid.part[0]);
  if (walled) add(wall.part.data(), wall.part.size() * sizeof wall.part[0]);
  add(spans.data(), spans.size() * sizeof spans[0]);
  add(links.data(), links.size() * sizeof links[0]);
  return bytes;
}

void Waves::set_state(const std::uint8_t *bytes, std::size_t size)
{
  const std::string whose = "the state of the waves ";
  WavesStateHead head;
  const std::size_t parts = solid.part.size() * sizeof solid.part[0];
  if (size < sizeof head + parts) throw std::runtime_error(whose + "has " + std::to_string(size) + " bytes, that is too few");
  std::memcpy(&head, bytes, sizeof head);
  if (head.version != WAVES_VERSION)
    throw std::runtime_error(whose + "has another version than " + std::to_string(WAVES_VERSION) +
                             "; it was written by another version of the plugin");
  if (head.nx != nx || head.ny != ny || head.nz != nz)
    throw std::runtime_error(whose + "is of a grid of " + std::to_string(head.nx) + " x " + std::to_string(head.ny) + " x " +
                             std::to_string(head.nz) + " cells, this one has " + std::to_string(nx) + " x " + std::to_string(ny) +
                             " x " + std::to_string(nz));

  const std::size_t of_parts = head.flags & WALLED ? 2 * parts : parts;
  if (size < sizeof head + of_parts) throw std::runtime_error(whose + "has " + std::to_string(size) + " bytes, that is too few");
  std::vector<std::uint16_t> part(solid.part.size()), walls(solid.part.size(), 0);
  std::memcpy(part.data(), bytes + sizeof head, parts);
  if (head.flags & WALLED) std::memcpy(walls.data(), bytes + sizeof head + parts, parts);
  Waves cut(nx, ny, nz);    // so that a damaged state changes nothing
  cut.set_walls(walls.data());
  cut.set_solids(part.data(), nullptr);
  std::int64_t span_count = 0, link_count = 0;
  cut.each_span([&](long) { ++span_count; });
  cut.each_link([&](const LinkPlace &) { ++link_count; });
  std::vector<SpanRecord> spans(span_count);
  std::vector<LinkRecord> links(link_count);
  const std::size_t of_spans = spans.size() * sizeof(SpanRecord), of_links = links.size() * sizeof(LinkRecord);
  if (head.spans != span_count || head.links != link_count || size != sizeof head + of_parts + of_spans + of_links)
    throw std::runtime_error(whose + "is damaged: its solids have " + std::to_string(span_count) + " spans and " +
                             std::to_string(link_count) + " links, not " + std::to_string(head.spans) + " and " +
                             std::to_string(head.links));
  std::memcpy(spans.data(), bytes + sizeof head + of_parts, of_spans);
  std::memcpy(links.data(), bytes + sizeof head + of_parts + of_spans, of_links);
  Units held = 0;
  bool damaged = false;
  for (const SpanRecord &record : spans) {
    if (record.content < 0)
      throw std::runtime_error(whose + "is damaged: a span holds " + std::to_string(record.content) + " units");
    held += record.content;
    damaged =
        damaged || !std::isfinite(record.full + record.rest + record.phi + record.delta + record.last_delta + record.yields);
  }
  for (const LinkRecord &record : links) damaged = damaged || limited(record.u) != record.u || !std::isfinite(record.q);
  if (damaged)
    throw std::runtime_error(whose + "is damaged: it holds a value that is not a number, or liquid faster than " +
                             std::to_string(law.fastest));
  if (held != head.units)
    throw std::runtime_error(whose + "is damaged: it holds " + std::to_string(held) + " units of liquid, not " +
                             std::to_string(head.units));

  std::fill(content.begin(), content.end(), 0);    // what is empty loses nothing to solids
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
  some_full = true;    // until the next update has looked
  resting = (head.flags & RESTING) != 0;
}

}    // namespace mdanim
