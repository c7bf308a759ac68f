// SPDX-License-Identifier: GPL-2.0-only
// For files named NAME_of_set.cpp, which are compiled once for each set of instructions, with the flags of the set (sets.txt),
// MDANIM_SET and MDANIM_LANES. None of their inline functions may be linked into the rest of the program, which runs on
// processors without these instructions: all that they include is always inlined or in an unnamed namespace.

#pragma once

#define MDANIM_JOINED(name, set) name##_##set
#define MDANIM_EXPANDED(name, set) MDANIM_JOINED(name, set)
// The name for this set: wave_kernels_avx2 for wave_kernels.
#define MDANIM_OF_SET(name) MDANIM_EXPANDED(name, MDANIM_SET)
