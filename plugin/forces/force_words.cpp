// SPDX-License-Identifier: GPL-2.0-only

#include "forces/force_words.h"

#include "records/line_words.h"

#include <cmath>

namespace mdanim {

static ForceWindows read_words(LineWords &words)
{
  ForceWindows found;
  while (!words.is_at_end()) {
    const std::string kind = words.word("a force");
    if (kind == "force" || kind == "torque") {
      ForceWindow one;
      (kind == "force" ? one.force : one.torque) = words.vector(kind == "force" ? "the force" : "the torque");
      found.all.push_back(one);
    } else if ((kind == "from" || kind == "to") && !found.all.empty()) {
      ForceWindow &last = found.all.back();
      double &edge = kind == "from" ? last.from : last.to;
      if (std::isfinite(edge)) words.fail(kind + " stands twice behind one force");
      edge = words.number<double>("a time");
      if (!(last.to > last.from))
        words.fail("a force ends after it begins, got " + LineWords::short_form(edge) + " behind " + kind);
    } else {
      words.fail("a force is force or torque, then from and to; got " + kind);
    }
  }
  if (found.all.empty()) words.fail("there is no force; write force fx fy fz, or torque tx ty tz");
  return found;
}

ForceWindows read_force(const std::string &text, const std::string &where)
{
  LineWords words(text, where);
  return read_words(words);
}

std::map<int, ForceWindows> read_forces(const std::string &name, const std::string &text)
{ return by_molecule(name, text, read_words); }

}    // namespace mdanim
