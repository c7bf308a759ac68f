// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/moving_planes.h"

#include "lammps/fix_mdanim_drive.h"

#include "error.h"
#include "lammps.h"
#include "modify.h"
#include "update.h"

namespace mdanim {

void MovingPlanes::init(const std::string &fix)
{
  for (Moving &one : all) {
    one.drive = dynamic_cast<LAMMPS_NS::FixMdanimDrive *>(lmp->modify->get_fix_by_id(one.id));
    if (!one.drive) lmp->error->all(FLERR, "{}: moving {} is not the ID of a fix mdanim/drive", fix, one.id);
    if (!one.drive->shifts())
      lmp->error->all(FLERR, "{}: fix {} gives no displacement of planes; {}", fix, one.id,
                      "write its motion in the command, without a turn");
  }
}

Vec3 MovingPlanes::velocity(double ago) const
{
  const LAMMPS_NS::FixMdanimDrive &drive = *all.front().drive;
  const double dt = lmp->update->dt;
  const DrivenPlace before = drive.place_before(ago + dt), behind = drive.place_before(ago - dt);
  return (0.5 / dt) * ((behind.to - behind.from) - (before.to - before.from));
}

Vec3 MovingPlanes::shift(const Moving &one, int step) const
{
  const LAMMPS_NS::FixMdanimDrive::Ways &ways = *one.drive->ways_of(0);
  const DrivenPlace &place = step < 0 ? ways.before : step ? ways.next : ways.now;
  return place.to - place.from;
}

}    // namespace mdanim
