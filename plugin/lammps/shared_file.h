// SPDX-License-Identifier: GPL-2.0-only
// A file that one rank reads for all.

#pragma once

#include <string>

namespace LAMMPS_NS {
class LAMMPS;
}

namespace mdanim {

// The bytes of a file, on all ranks. `style` begins messages, `what` says what is in the file. Raises a LAMMPS error when it
// cannot be read or has more than 2^30 bytes.
std::string read_shared_file(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const std::string &what, const char *file);

}    // namespace mdanim
