// SPDX-License-Identifier: GPL-2.0-only
// What fixes between objects need of the run and of the box.

#ifndef MDANIM_OBJECT_BOX_H
#define MDANIM_OBJECT_BOX_H

namespace LAMMPS_NS {
class Fix;
class LAMMPS;
}    // namespace LAMMPS_NS

namespace mdanim {

// Raises a LAMMPS error unless objects (molecule IDs) are told apart in an orthogonal box without periodic sides, and lists are
// rebuilt in time; `missed` tells what may happen between two rebuilds otherwise.
void need_objects_in_open_box(const LAMMPS_NS::Fix *fix, LAMMPS_NS::LAMMPS *lmp, const char *missed);

// Raises a LAMMPS error unless the local particle i, in which the fix has a part, belongs to an object. `or_else`: another way
// out.
void need_object(const LAMMPS_NS::Fix *fix, LAMMPS_NS::LAMMPS *lmp, int i, const char *or_else = "");

}    // namespace mdanim

#endif
