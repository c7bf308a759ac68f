// SPDX-License-Identifier: GPL-2.0-only
// Rank 0 reads and sends.

#include "lammps/shared_file.h"

#include "comm.h"
#include "error.h"
#include "lammps.h"

#include <filesystem>
#include <fstream>
#include <mpi.h>

using namespace LAMMPS_NS;

static constexpr int LARGEST_FILE = 1 << 30;    // bytes

std::string mdanim::read_shared_file(LAMMPS *lmp, const std::string &style, const std::string &what, const char *file)
{
  std::string text;
  int bytes = -1;
  if (lmp->comm->me == 0) {
    std::error_code none;
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    const bool is_file = in && std::filesystem::is_regular_file(file, none);
    const std::streamoff size = is_file ? static_cast<std::streamoff>(in.tellg()) : -1;
    if (size > LARGEST_FILE) lmp->error->one(FLERR, "{}: {} has {} bytes, more than {}", style, file, size, LARGEST_FILE);
    if (size >= 0) text.resize(size);
    if (size >= 0 && in.seekg(0).read(text.data(), size)) bytes = static_cast<int>(size);
  }
  MPI_Bcast(&bytes, 1, MPI_INT, 0, lmp->world);
  if (bytes < 0) lmp->error->all(FLERR, "{}: cannot read the {} in {}", style, what, file);
  text.resize(bytes);
  MPI_Bcast(text.data(), bytes, MPI_CHAR, 0, lmp->world);
  return text;
}
