// SPDX-License-Identifier: GPL-2.0-only
// Forces along the one coordinate that a joint leaves free, its angle or way q with the rate q' (the length of a spring).

#pragma once

#include <algorithm>
#include <cmath>

namespace mdanim {

// A spring and a dashpot.
struct SpringLaw {
  double k = 0.0, c = 0.0;
};

// A motor that drives towards the speed w with at most M; dry friction is the motor of speed 0. Its spring goes from an anchor
// that moves on with the speed, and is dragged along where the spring would be stronger than M:
//   s = clip(anchor - q, +-M/k),   F = clip(k s + c (w - q'), +-M).
// The speed that it has at first is that of q; it goes from there to its own by `rise` in a unit of time, and so to 0 where the
// anchor comes to an end of the range in which it stays.
struct Drive {
  double speed = 0.0, most = HUGE_VAL, rise = HUGE_VAL;
  double low = -HUGE_VAL, high = HUGE_VAL;
};

struct DriveState {
  double anchor = 0.0, stretch = 0.0, force = 0.0, speed = 0.0;
};

// After the time dt; `begins` where nothing was before.
inline DriveState driven(const Drive &drive, const SpringLaw &law, const DriveState &before, double q, double rate, double dt,
                         bool begins)
{
  const double next = before.anchor + drive.speed * dt;
  double speed = next < drive.low || next > drive.high ? 0.0 : drive.speed;
  if (drive.rise < HUGE_VAL)
    speed = begins ? rate : before.speed + std::clamp(speed - before.speed, -drive.rise * dt, drive.rise * dt);
  const double anchor = std::clamp(before.anchor + speed * dt, drive.low, drive.high);
  const double s = std::clamp(anchor - q, -drive.most / law.k, drive.most / law.k);
  return {q + s, s, std::clamp(law.k * s + law.c * (speed - rate), -drive.most, drive.most), speed};
}

// A dashpot beside other forces, taken implicitly over the step that follows: with the mobility y of q, force to acceleration,
// its force is -c q' at the middle of the step if nothing else acts, whatever c.
inline double implicit(double c, double y, double dt) { return c / (1.0 + 0.5 * dt * c * y); }

// Stops at both ends of a range: springs that push and do not pull.
struct Stop {
  double depth = 0.0;    // negative below the range
  double force = 0.0;
};

inline Stop stopped(double low, double high, const SpringLaw &law, double q, double rate)
{
  if (q < low) return {q - low, std::max(0.0, law.k * (low - q) - law.c * rate)};
  if (q > high) return {q - high, std::min(0.0, law.k * (high - q) - law.c * rate)};
  return {};
}

// Tension of a spring that is longer by `more` than its own length; one that only pulls has none where it is shorter.
inline double tension(const SpringLaw &law, double more, double rate, bool pulls_only)
{
  if (!pulls_only) return law.k * more + law.c * rate;
  return more > 0.0 ? std::max(0.0, law.k * more + law.c * rate) : 0.0;
}

}    // namespace mdanim
