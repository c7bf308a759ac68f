// SPDX-License-Identifier: GPL-2.0-only
// Limits of this machine, on one core: bandwidth of a triad in memory and in cache, throughput of square root
// and division, and of the loads and stores of a spring. Prints JSON. Built by bench/limits.py with -O3 -march=native.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

static double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

template <class Work> static double least(int rounds, Work work)
{
  double best = 1e300;
  for (int n = 0; n < rounds; ++n) {
    const double start = now();
    work();
    best = std::min(best, now() - start);
  }
  return best;
}

// GB/s of a = b + s c: two reads and a write of 8 bytes each.
static double triad(size_t n, int repeats)
{
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  const double seconds = least(7, [&] {
    for (int k = 0; k < repeats; ++k) {
      const double s = 1.0 + k;
      for (size_t i = 0; i < n; ++i) a[i] = b[i] + s * c[i];
      asm volatile("" : : "r"(a.data()) : "memory");
    }
  });
  return 24e-9 * n * repeats / seconds;
}

// ns of one square root and one division by it, in vectors.
static double divider()
{
  const size_t n = 2048;
  const int repeats = 200;    // a short time, in which nothing else may use the divider, many times
  std::vector<double> a(n, 2.0), b(n, 0.0);
  const double seconds = least(100, [&] {
    for (int k = 0; k < repeats; ++k) {
      for (size_t i = 0; i < n; ++i) b[i] = 1.0 / std::sqrt(a[i]);
      asm volatile("" : : "r"(b.data()) : "memory");
    }
  });
  return 1e9 * seconds / n / repeats;
}

// ns of eight loads and three stores of a double, in vectors and in the nearest cache: a pass loads three coordinates, three sums
// of forces and two coefficients for a spring, and stores three sums.
static double moves()
{
  const size_t n = 256, row = 288;    // no two rows are 4096 bytes apart, or nearly
  const int repeats = 1000;
  std::vector<double> rows(8 * row, 1e-9);
  double *const r = rows.data();
  const double seconds = least(100, [&] {
    for (int k = 0; k < repeats; ++k) {
#pragma GCC ivdep
      for (size_t i = 0; i < n; ++i) {
        r[i] -= r[3 * row + i] + r[4 * row + i];
        r[row + i] -= r[5 * row + i] + r[6 * row + i];
        r[2 * row + i] -= r[7 * row + i];
      }
      asm volatile("" : : "r"(r) : "memory");
    }
  });
  return 1e9 * seconds / n / repeats;
}

int main()
{
  std::printf("{\"triad_memory\": %.4g, \"triad_cache\": %.4g, \"divider\": %.4g, \"moves\": %.4g}\n", triad(size_t(8) << 20, 1),
              triad(24 << 10, 300), divider(), moves());
}
