// SPDX-License-Identifier: GPL-2.0-only

#include "contact/contact_kernel.h"

#include <cstring>

namespace mdanim {

extern const ContactKernels contact_kernels_common;
#if defined(__x86_64__)
extern const ContactKernels contact_kernels_avx2, contact_kernels_avx512;
#endif

const ContactKernels &contact_kernels(const char *name)
{
#if defined(__x86_64__)
  if (std::strcmp(name, contact_kernels_avx2.name) == 0) return contact_kernels_avx2;
  if (std::strcmp(name, contact_kernels_avx512.name) == 0) return contact_kernels_avx512;
#endif
  return contact_kernels_common;
}

}    // namespace mdanim
