// SPDX-License-Identifier: GPL-2.0-only
// Tells the world of contact of links that fix mdanim/tear takes away.

#pragma once

#include "contact/contact_world.h"
#include "lammps/fix_mdanim_tear.h"

#include <cstddef>
#include <vector>

namespace mdanim {

class TornEnds {
 public:
  void init(LAMMPS_NS::LAMMPS *lmp) { fix = LAMMPS_NS::FixMdanimTear::of(lmp); }
  // At the setup of a run.
  void tell_all(ContactWorld &world)
  {
    known = 0;
    world.tear(news(), nullptr);
  }
  // In a run: whether links have gone since the last time, after which new lists are needed.
  template <class PlacesNow> bool tell(ContactWorld &world, const PlacesNow &places_now)
  {
    const Ends ends = news();
    if (ends.empty()) return false;
    const Coordinates now = places_now();
    world.tear(ends, &now);
    return true;
  }

 private:
  // Both ends of all links of objects of which some have gone since the last time, counted from the lowest tag of the object, 0.
  using Ends = ContactWorld::TornEnds;
  Ends news()
  {
    Ends found;
    if (!fix) return found;
    for (const std::vector<LAMMPS_NS::GoneLink> &gone = fix->gone(); known < gone.size(); ++known) found[gone[known].object];
    if (found.empty()) return found;
    for (const LAMMPS_NS::GoneLink &one : fix->gone())
      if (const auto of = found.find(one.object); of != found.end()) of->second.insert(of->second.end(), {one.low, one.high});
    return found;
  }

  const LAMMPS_NS::FixMdanimTear *fix = nullptr;    // null where nothing tears
  std::size_t known = 0;                            // of its links
};

}    // namespace mdanim
