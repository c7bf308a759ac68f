// SPDX-License-Identifier: GPL-2.0-only
// State of fix mdanim/contact: records of its contacts (contact/contact_records.cpp).

#include "lammps/fix_mdanim_contact.h"

using namespace LAMMPS_NS;
using namespace mdanim;

StateRecords FixMdanimContact::pack() const { return restarted ? *restarted : world_of_contact.records(); }

void FixMdanimContact::unpack(const StateRecords &records)
{
  take_objects(Contacts::ARE_REPLACED);
  world_of_contact.restore(records);
  restarted.reset();
}

void FixMdanimContact::write_restart(FILE *file) { mdanim::write_restart(*this, lmp, name(), file); }

void FixMdanimContact::restart(char *buffer)
{
  mdanim::read_restart([this](const StateRecords &all) { restarted = all; }, lmp, name(), buffer);
}
