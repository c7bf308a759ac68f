// SPDX-License-Identifier: GPL-2.0-only

#include "drives/motion_words.h"

#include "records/line_words.h"

#include <cmath>

namespace mdanim {

static void read_key(LineWords &words, DrivenMotion &motion)
{
  const double time = words.number<double>("the time of a key");
  if (!motion.path.empty() && !(time > motion.path.last_time()))
    words.fail("times of keys ascend, got " + LineWords::short_form(time) + " behind " +
               LineWords::short_form(motion.path.last_time()));
  const Vec3 way = words.vector("the displacement of a key");
  motion.path.append({time, way, words.vector("the rotation of a key")});
}

static DrivenMotion read_words(LineWords &words)
{
  DrivenMotion motion;
  bool turns = false, any = false;
  for (; !words.is_at_end(); any = true) {
    const std::string kind = words.word("a motion");
    if (kind == "velocity") {
      motion.velocity += words.vector("the velocity");
    } else if (kind == "turn") {
      if (turns) words.fail("a second turn; angular velocities about one point add up, write their sum");
      turns = true;
      motion.turn = words.vector("the angular velocity of a turn");
      motion.centre = words.vector("the point of a turn");
    } else if (kind == "oscillation") {
      Oscillation one;
      one.way = words.vector("the amplitude of an oscillation");
      one.frequency = words.at_least_zero("the frequency of an oscillation");
      one.phase = words.number<double>("the phase of an oscillation");
      motion.oscillations.push_back(one);
    } else if (kind == "until") {
      if (std::isfinite(motion.until)) words.fail("until stands twice");
      motion.until = words.at_least_zero("the time of a release");
    } else if (kind == "pivot") {
      motion.pivot = words.vector("the pivot of keys");
    } else if (kind == "key") {
      read_key(words, motion);
    } else {
      words.fail("a motion is velocity, turn, oscillation, pivot, key or until, got " + kind);
    }
  }
  if (!any) words.fail("there is no motion; write velocity, turn, oscillation or key");
  return motion;
}

DrivenMotion read_motion(const std::string &text, const std::string &where)
{
  LineWords words(text, where);
  return read_words(words);
}

std::map<int, DrivenMotion> read_motions(const std::string &name, const std::string &text)
{ return by_molecule(name, text, read_words); }

}    // namespace mdanim
