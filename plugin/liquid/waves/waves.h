// SPDX-License-Identifier: GPL-2.0-only
// A liquid with momentum: spans of columns that hold whole units, joined by links with velocities. docs/physics-liquid.md,
// "Waves". The cell, g and the density of the liquid are 1, so times are in sqrt(cell/g).

#pragma once

#include "liquid/cell_box.h"
#include "liquid/waves/span.h"
#include "liquid/waves/waves_kernels.h"
#include "numbers/vec3.h"
#include "threads/team.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace mdanim {

// Every unit that leaves a span enters another one, so the sum never changes. Results depend on nothing but what is put in:
// neither on the instruction set nor on the way in which solids came to where they are.
//
// Spans have places in arrays: the lowest span of a column has a place in the grid, further ones come in rows behind it. A link
// of lowest spans has the place of its first span; further links come behind. What is regular, one plain span in each column
// around, is left to vector kernels. All else is computed once more in a general form, from the same laws.
class Waves {
 public:
  // Throws std::bad_alloc.
  Waves(int nx, int ny, int nz);
  Waves(const Waves &) = delete;    // arrays point into vectors
  Waves &operator=(const Waves &) = delete;

  // Sets the solid parts of all cells, as in SolidParts, and for each column the mass of floating bodies in it, in cells of
  // liquid, 0 where they are held (null: everywhere). Liquid makes way. Throws std::runtime_error when there is no room for it;
  // the waves cannot be used any more after that. `again`: the part of the change that will come once more in the next update.
  // Outside of a box `where` (null: the whole basin) nothing has changed.
  void set_solids(const std::uint16_t *part, const double *mass, double again = 1.0, const CellBox *where = nullptr);
  // Sets the held part of each cell, as in SolidParts: a wall, like the sides of the basin. Plates at such walls cut columns when
  // solids are set next.
  void set_walls(const std::uint16_t *held);
  // Fills all spans of each column up to a height; full spans get the pressure of that height. `from`: leaves out liquid below
  // this height. `hollow`: leaves out these spans.
  void pour(const double *height, const double *from = nullptr, const std::vector<std::uint8_t> &hollow = {});
  // Spans, by their places, that are dry at the start although they begin below a level: floating bodies enclose them, alone or
  // with others that they are open to below that level. `floats` says of a cell that is not open whether it is a part of a
  // floating body.
  std::vector<std::uint8_t> hollows(double level, const std::function<bool(int column, int z)> &floats) const;
  // Sets velocities of links, in the order of links(), also higher ones than liquid may have: for tests.
  void set_velocities(const double *u);
  // Returns the time by which the liquid has advanced. `share` is the part, now, of the motion that solids still have to make.
  double update(double dt, double share = 1.0);

  struct SpanNow {
    Span span;
    Units content;
    double head, phi;    // head of the surface, and the head that pushes
    bool full;
  };
  struct LinkNow {
    int a, b, direction;    // numbers of spans; 0 along x, 1 along y
    double u, height;
    Units units;    // units that passed in the last sub-update
  };
  // Columns in their order, each from the lowest span up.
  std::vector<SpanNow> spans() const;
  // Links along x, then links along y, by the columns of their first spans.
  std::vector<LinkNow> links() const;
  // Head of the topmost wet span of each column (the floor of the lowest where all are dry), and the column's volume.
  void surface(double *head, double *volume) const;
  Units total() const;

  // Adds the forces on solids. `owner` is the body of each cell, or negative; `force` has three numbers for each body.
  void add_forces(const std::int32_t *owner, double *force) const;
  // Energy of height, and of motion along the links.
  struct Energy {
    double height, motion;
  };
  Energy energy() const;
  Vec3 momentum() const;    // along the links
  // Momentum that the liquid has lost to walls and to friction since the last call; and momentum that has come and gone with
  // give() and take().
  Vec3 take_lost() { return std::exchange(lost, Vec3{}); }
  Vec3 take_came() { return std::exchange(came, Vec3{}); }

  // --- liquid that comes and goes between updates (waves_exchange.cpp) ---

  // Puts units, with a velocity limited to that of liquid, into the span of a column that holds a height, or else into the next
  // one below. Returns the number of units that found room.
  Units give(int column, double height, Units units, double ux, double uy);
  // Takes units out of such a span; a film stays. Returns their number.
  Units take(int column, double height, Units most);
  double held_below(int column, double height) const;    // content of such a span below a height
  double head_below(int column, double height) const;    // head of its surface
  // The topmost span of a column: its floor, surface and volume, the speed at which the surface has just risen, the mean velocity
  // of the liquid, and the speed at which the liquid around could shoot up there (Bernoulli).
  struct Top {
    double floor, head, volume, rising, u[2], jet;
  };
  Top top_of(int column) const;

  // --- for what floats in it (waves_coupling.cpp) ---

  // The n-th span of a column, from the lowest up.
  struct SpanView {
    int low, high;
    double floor, roof, phi, surface;    // phi: the head that pushes; surface: the visible one
    double volume, capacity;
    bool wet, full;
  };
  int spans_of(int column) const { return spans_in[column]; }
  SpanView span_view(int column, int n) const;
  // West, east, south and north of a span, through its widest wet link: how much higher the head that pushes is there, and the
  // velocity; 0 where there is no link.
  struct Sides {
    double rise[4], u[4];
  };
  Sides around(int column, int n) const;
  // Adds momentum along x and y to the liquid of each column, in cells of liquid. Liquid at rest stays at rest if it is
  // negligible. Momentum beyond the greatest velocity is lost.
  void add_impulse(const double *x, const double *y);
  const SolidParts &solids() const { return solid; }

  // Everything that later updates depend on, as it is between updates.
  std::vector<std::uint8_t> state() const;
  // Sets the state. Throws std::runtime_error, and changes nothing, when it is damaged or not of such a basin.
  void set_state(const std::uint8_t *bytes, std::size_t size);

  bool at_rest() const { return resting; }    // nothing will move before a solid does

  void use(const Threads &now) { threads = now; }    // for updates; the bits are the same for any number of them

  // For tests and benchmarks.
  void use(const WaveKernels &other) { kernels = &other; }
  void use_general_form();    // for all spans and links
  struct Counts {
    long updates = 0, sub_updates = 0, solutions = 0, iterations = 0, limited = 0;
    Units displaced = 0;    // units displaced by spans that closed
  } counts;

  WaveLaw law;
  double tolerance = 2e-3;    // of the solver
  int most_iterations = 200;
  double rest = 1.0 / 1024.0;    // differences of heads, and velocities, that count as none: those of a film

 private:
  // Place of a link among those of its direction.
  struct LinkPlace {
    int d;
    long at;
  };
  struct Ends {
    long a, b;
  };
  // A further link of a span, and the next one in its chain.
  struct LinkOfSpan {
    LinkPlace link;
    bool inward;    // whether flux along the link comes in
    long other;
    int next;
  };
  // The part of a span that lasts from update to update.
  struct SpanState {
    Span span;
    Units content;
    double level;    // of its surface
    double full, rest, phi, delta, last_delta, coming;
  };
  static constexpr SpanState NO_SPAN{{-1, 0, 0, 0, true, 0.0, 0.0, 0}, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  struct LinkState {
    int column;    // of the first span
    long a, b;
    bool layered;
    double edge, top, u, q;
  };
  // Liquid whose span has closed.
  struct Homeless {
    int column, z;
    Units units;
  };
  // The solid part of the face between two columns, or of the basin's side where `other` is -1, from one layer to another.
  struct WallFace {
    int column, other, low, high;
    double x, y;    // its direction from the column, times the part that is solid
  };
  // All links on one side of a span together.
  struct SideLinks {
    double q, u, height;
    long widest;    // the span at the other end of the widest link, or -1
  };
  enum SideOf { WEST, EAST, SOUTH, NORTH };

  // --- where things are ---
  long place(int column) const { return (1 + column / nx) * stride + column % nx; }
  long place(int column, int n) const { return n == 0 ? place(column) : further_start + further[column] + n - 1; }
  long along(int d) const { return d == 0 ? 1 : stride; }
  long end_row() const { return 1 + ny + further_rows; }
  // Calls f(first, end) for parts of all rows, shared among threads: no row writes where another reads or writes.
  template <class F> void rows(const F &f) const
  {
    constexpr double COLUMN = 2.0;    // [ns], approximately
    threads.parts(end_row() - 1, COLUMN * static_cast<double>(stride), [&](long from, long to) { f(1 + from, 1 + to); });
  }
  // Whether f(first, end) is true for any part.
  template <class F> bool any_row(const F &f) const
  {
    std::atomic<bool> any{false};
    rows([&](long first, long end) {
      if (f(first, end)) any.store(true, std::memory_order_relaxed);
    });
    return any;
  }
  // The same for all spans and links that are listed; f(one) writes only into its own.
  template <class All, class F> void each_listed(const All &all, const F &f) const
  {
    constexpr double ONE = 50.0;    // [ns], approximately
    threads.parts(static_cast<long>(all.size()), ONE, [&](long from, long to) {
      for (long n = from; n < to; ++n) f(all[n]);
    });
  }
  bool is_link(const LinkPlace &link) const { return arrays.links[link.d].edge[link.at] < WaveArrays::NOWHERE; }
  bool is_layered(const LinkPlace &link) const
  { return link.at < links_start ? layered[link.d][link.at] != 0 : further_links[link.d][link.at - links_start].layered; }
  Ends ends(const LinkPlace &link) const
  {
    if (link.at < links_start) return {link.at, link.at + along(link.d)};
    const LinkState &further_link = further_links[link.d][link.at - links_start];
    return {further_link.a, further_link.b};
  }
  const WaveLinks &arrays_of(const LinkPlace &link) const { return arrays.links[link.d]; }
  void lay_out(long rows, std::size_t most_further_links);
  // Calls f(place) for all spans, f(link) for all links, in their order outside; and f(link, other span, inward) for those of a
  // span, in the order in which they are summed.
  template <class F> void each_span(const F &f) const { spans_of_columns(0, nx * ny, f); }
  template <class F> void each_link(const F &f) const
  {
    for (int d = 0; d < 2; ++d) {
      links_of_grid(d, stride, further_start, f);
      further_links_of(d, f);
    }
  }
  // Rows of columns, from the first one to that before the last.
  struct RowRange {
    int first, last;
  };
  int row_of(long i) const { return span[i].column / nx; }
  // The same for spans in these rows and for links between two of them, in any order, shared among threads; f writes only into
  // the span or the link.
  template <class F> void each_span_in(const RowRange &rows, const F &f) const
  {
    constexpr double SPAN = 15.0;    // [ns], approximately
    const long before = static_cast<long>(rows.first) * nx;
    threads.parts((rows.last - rows.first) * nx, SPAN,
                  [&](long from, long to) { spans_of_columns(before + from, before + to, f); });
  }
  template <class F> void each_link_in(const RowRange &rows, const F &f) const
  {
    constexpr double LINK = 5.0;    // [ns], approximately
    const auto within = [&](long i) { return row_of(i) >= rows.first && row_of(i) < rows.last; };
    for (int d = 0; d < 2; ++d) {
      const long before = (1 + rows.first) * stride;
      threads.parts((rows.last - rows.first - d) * stride, LINK,
                    [&](long from, long to) { links_of_grid(d, before + from, before + to, f); });
      further_links_of(d, [&](const LinkPlace &link) {
        if (within(ends(link).a) && within(ends(link).b)) f(link);
      });
    }
  }
  template <class F> void spans_of_columns(long from, long to, const F &f) const
  {
    for (int column = static_cast<int>(from); column < to; ++column)
      for (int n = 0; n < spans_in[column]; ++n) f(place(column, n));
  }
  template <class F> void links_of_grid(int d, long from, long to, const F &f) const
  {
    for (long i = from; i < to; ++i)
      if (is_link({d, i})) f(LinkPlace{d, i});
  }
  template <class F> void further_links_of(int d, const F &f) const
  {
    for (std::size_t n = 0; n < further_links[d].size(); ++n) f(LinkPlace{d, links_start + static_cast<long>(n)});
  }
  template <class F> void each_link_of(long i, const F &f) const
  {
    f(LinkPlace{1, i - stride}, i - stride, true);
    f(LinkPlace{0, i - 1}, i - 1, true);
    f(LinkPlace{0, i}, i + 1, false);
    f(LinkPlace{1, i}, i + stride, false);
    for (int n = chain[i]; n >= 0; n = link_of_span[n].next)
      f(link_of_span[n].link, link_of_span[n].other, link_of_span[n].inward);
  }

  int span_below(int column, double height) const;
  Vec3 velocity_of(long i) const;
  double filled(const LinkPlace &link, double head, long other) const;

  // --- waves_walls.cpp ---
  void list_wall_faces();
  double pressure_on(int column, int low, int high) const;
  Vec3 force_on_walls() const;

  // --- waves_solids.cpp, waves_links.cpp ---
  void cut_anew(int column, std::vector<std::uint8_t> &marks) const;
  std::vector<int> differing(const std::uint16_t *part, const CellBox &where) const;
  std::vector<Homeless> carry_over(const std::vector<int> &columns, const std::vector<int> &changed,
                                   const std::vector<SpanState> &was);
  std::vector<SpanState> share_out(const std::vector<SpanState> &was, const std::vector<Span> &cut,
                                   std::vector<Homeless> &homeless) const;
  void find_homes(const std::vector<Homeless> &homeless);
  SpanState state_at(long i) const;
  void put(long i, const SpanState &state);
  void save_further_links();
  void join(const std::vector<int> &columns);
  void join_face(int d, int column, int other, const std::vector<LinkState> &was);
  void put_link(const LinkPlace &link, const LinkState &state);
  bool is_regular(int column) const;
  void list_irregular();

  // --- waves_update.cpp, waves_general.cpp, waves_solver.cpp, waves_limits.cpp, waves_rest.cpp ---
  bool hardly_flows() const;
  double fastest() const;
  void sub_update(double dt, double share);
  Vec3 moving() const;
  bool let_go();
  bool let_go(long first, long end);
  void solve(bool again);
  double sum_of_rows() const;
  RowRange balance();
  void limit(const RowRange &tight);
  void come_to_rest();
  void level_out(const std::vector<long> &body);
  void general_surface(long i);
  void general_opening(const LinkPlace &link);
  void general_advection(const LinkPlace &link);
  void general_assembly(long i);
  void general_coupling(const LinkPlace &link);
  double general_product(long i, const double *x) const;
  void general_push(const LinkPlace &link);
  SpanFluxes<double> fluxes_of(long i) const;
  double limited(double u) const { return std::clamp(u, -law.fastest, law.fastest); }
  double most_in(long i) const { return (arrays.capacity[i] + 0.25) * law.units_per_cell; }
  double opening(const LinkPlace &link, double level) const;
  SideLinks side_of(long i, SideOf side) const;

  const int nx, ny, nz;
  const long stride;
  const long further_start;    // place of the first further span
  long links_start = 0;        // place of the first further link
  long further_rows = 0;
  SolidParts solid, wall;                   // all solids; the held ones
  std::vector<std::uint8_t> walled_anew;    // columns that must be cut anew because walls have changed
  const WaveKernels *kernels;
  Threads threads;
  bool all_general = false, resting = false, some_full = false;
  Vec3 lost, came;    // see take_lost()
  std::vector<WallFace> wall_faces;

  std::vector<int> spans_in, further;    // of each column: the number of spans, and the number of its first further one
  std::vector<Span> span;                // of each place; column -1 where there is none
  std::vector<Units> content;
  std::vector<std::vector<double>> of_spans, of_links[2];    // behind `arrays`
  std::vector<std::uint8_t> layered[2];                      // links of the grid that go through partly solid cells
  std::vector<LinkState> further_links[2];                   // their places come behind those of the grid
  std::vector<int> chain;                                    // first further link of each place in `link_of_span`, or -1
  std::vector<LinkOfSpan> link_of_span;
  WaveArrays arrays;

  // Spans and links that the general form computes once more.
  std::vector<long> listed_spans, branched;
  std::vector<long> branched_rows;
  std::vector<LinkPlace> listed_links;
};

}    // namespace mdanim
