// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions for ctypes: particles and springs of a LAMMPS instance.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "lammps/bond_mdanim_harmonic.h"

#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "force.h"
#include "lammps.h"
#include "library.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

using namespace LAMMPS_NS;
using mdanim::guarded;

namespace {

struct Bonds {
  const long long *first;    // bonds of particle i are [first[i], first[i+1])
  const int *partner;        // tags
  const int *type;
};

[[noreturn]] void fail(const std::string &message) { throw std::runtime_error(message); }

std::string number(long long n) { return std::to_string(n); }

void check_bonds(const Atom *atom, int n, const int *tag, const Bonds &bonds)
{
  if (!bonds.first || bonds.first[n] == 0) return;
  if (!atom->num_bond) fail("the atom style has no bonds; use 'atom_style bond'");
  for (int i = 0; i < n; ++i) {
    const long long count = bonds.first[i + 1] - bonds.first[i];
    if (count < 0 || count > atom->bond_per_atom)
      fail("particle " + number(tag[i]) + " has " + number(count) + " bonds, there is room for " + number(atom->bond_per_atom) +
           "; raise extra/bond/per/atom of create_box");
  }
  for (long long b = 0; b < bonds.first[n]; ++b)
    if (bonds.type[b] < 1 || bonds.type[b] > atom->nbondtypes)
      fail("bond type " + number(bonds.type[b]) + " is not within 1 and " + number(atom->nbondtypes) +
           "; raise bond/types of create_box");
  if (bonds.first[n] % 2) fail("bonds must be given at both ends, got an odd number of entries: " + number(bonds.first[n]));
}

double *custom_property(Atom *atom, const char *name)
{
  int is_double = 0, columns = 0;
  const int index = atom->find_custom(name, is_double, columns);
  if (index < 0 || !is_double || columns)
    fail(std::string("there is no per-particle property d_") + name + "; use 'fix ID all property/atom d_" + name + "'");
  return atom->dvector[index];
}

void insert(LAMMPS *lmp, int n, const int *tag, const int *type, const int *molecule, const double *x, const double *v,
            const double *rmass, int properties, const char *const *name, const double *property, const Bonds &bonds)
{
  Atom *atom = lmp->atom;
  if (atom->map_style == Atom::MAP_NONE && atom->map_user == Atom::MAP_NONE)
    fail("an atom map is needed; put 'atom_modify map array' before the box is made");
  if (lmp->force->newton_bond) fail("bonds are stored at both ends; put 'newton off' before the box is made");
  if (molecule && !atom->molecule) fail("the atom style has no molecule IDs; use 'atom_style bond'");
  if (rmass && !atom->rmass) fail("particles have no mass of their own; use 'fix ID all property/atom rmass'");
  check_bonds(atom, n, tag, bonds);
  for (int p = 0; p < properties; ++p) custom_property(atom, name[p]);

  const bigint before = atom->natoms;
  const int first = atom->nlocal;
  lammps_create_atoms(lmp, n, tag, type, x, v, nullptr, 1);
  if (lammps_has_error(lmp)) {
    char text[512];
    lammps_get_last_error_message(lmp, text, sizeof text);
    fail(text);
  }
  if (atom->natoms != before + n)
    fail("LAMMPS took " + number(atom->natoms - before) + " of " + number(n) + " particles; the others lie outside the box");
  atom->data_fix_compute_variable(first,
                                  atom->nlocal);    // values that fixes keep per particle get their initial value

  std::vector<double *> column;
  for (int p = 0; p < properties; ++p) column.push_back(custom_property(atom, name[p]));
  for (int i = 0; i < n; ++i) {
    const int here = atom->map(tag[i]);
    if (here < first || here >= atom->nlocal) continue;    // on another rank
    if (molecule) atom->molecule[here] = molecule[i];
    if (rmass) atom->rmass[here] = rmass[i];
    for (int p = 0; p < properties; ++p) column[p][here] = property[static_cast<size_t>(p) * n + i];
    if (!bonds.first || !atom->num_bond) continue;
    const int count = static_cast<int>(bonds.first[i + 1] - bonds.first[i]);
    atom->num_bond[here] = count;
    for (int b = 0; b < count; ++b) {
      atom->bond_atom[here][b] = bonds.partner[bonds.first[i] + b];
      atom->bond_type[here][b] = bonds.type[bonds.first[i] + b];
    }
  }
  if (bonds.first) atom->nbonds += bonds.first[n] / 2;    // LAMMPS counts a bond once, wherever it is stored
}

void give_springs(LAMMPS *lmp, int springs, const int *pair, const int *type)
{
  auto *bond = dynamic_cast<BondMdanimHarmonic *>(lmp->force->bond);
  if (!bond) fail("springs need 'bond_style mdanim/harmonic'");
  if (lmp->comm->nprocs > 1) fail("particles of several ranks must have their bonds themselves; give them to mdanim_insert");
  const int n = lmp->atom->nlocal, types = lmp->atom->nbondtypes;
  mdanim::SpringRows rows(n);
  mdanim::SpringRows::Row row;
  int b = 0;
  for (int i = 0; i < n; ++i) {
    row.link.clear();
    for (; b < springs && pair[2 * b] == i; ++b) {
      const int offset = pair[2 * b + 1] - i;
      if (offset < 1 || i + offset >= n || (!row.link.empty() && row.link.back().offset >= offset)) break;
      if (type[b] < 1 || type[b] > types)
        fail("bond type " + number(type[b]) + " is not within 1 and " + number(types) + "; raise bond/types of create_box");
      row.link.push_back({offset, type[b]});
    }
    std::reverse(row.link.begin(), row.link.end());
    rows.add(row);
  }
  if (b < springs)
    fail("springs must be sorted pairs of two of the " + number(n) + " particles, the lower first; spring " + number(b) + " is " +
         number(pair[2 * b]) + ", " + number(pair[2 * b + 1]));
  bond->take(std::move(rows));
}

// Null with another bond style.
BondMdanimHarmonic *bond_of(void *handle)
{ return dynamic_cast<BondMdanimHarmonic *>(static_cast<LAMMPS *>(handle)->force->bond_match("mdanim/harmonic")); }

}    // namespace

// Create n particles in the given order, with masses, custom properties and bonds (both ends, 1-based tags).
// The box exists: create_box … bond/types B extra/bond/per/atom M. Arrays: tag, type, molecule (n); x, v (n,
// 3); rmass (n) or null; property (properties, n) for names without their d_; bond_first (n + 1) or null for no bonds. Every rank
// calls it with the same arguments. Returns 0, or 1 with a message in `error`; after an error the instance is
// to be closed.
MDANIM_EXPORT int mdanim_insert(void *handle, int n, const int *tag, const int *type, const int *molecule, const double *x,
                                const double *v, const double *rmass, int properties, const char *const *name,
                                const double *property, const long long *bond_first, const int *bond_partner,
                                const int *bond_type, char *error, int error_size)
{
  return guarded(error, error_size, [&] {
    insert(static_cast<LAMMPS *>(handle), n, tag, type, molecule, x, v, rmass, properties, name, property,
           {bond_first, bond_partner, bond_type});
  });
}

// Springs of all particles, for a process that is alone: bond_style mdanim/harmonic keeps them itself. The particles' own bonds,
// which take 200 bytes per particle of a lattice, are not used any more. Arrays: pair (springs, 2), particles from 0 in the order
// of their tags, i < j, sorted; type (springs). The particles and the bond style must exist. Returns 0, or 1 with a message in
// `error`.
MDANIM_EXPORT int mdanim_give_springs(void *handle, int springs, const int *pair, const int *type, char *error, int error_size)
{
  return guarded(error, error_size, [&] { give_springs(static_cast<LAMMPS *>(handle), springs, pair, type); });
}

// Wall seconds that bond_style mdanim/harmonic has spent on this rank; 0 with another bond style.
MDANIM_EXPORT double mdanim_bond_seconds(void *handle) noexcept
{
  const BondMdanimHarmonic *bond = bond_of(handle);
  return bond ? bond->wall_seconds() : 0.0;
}

// Energy that its dashpots have taken on this rank; 0 with another bond style.
MDANIM_EXPORT double mdanim_bond_lost(void *handle) noexcept
{
  const BondMdanimHarmonic *bond = bond_of(handle);
  return bond ? bond->lost() : 0.0;
}
