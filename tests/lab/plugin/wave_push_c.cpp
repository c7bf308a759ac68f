// SPDX-License-Identifier: GPL-2.0-only
// A plain C function over the push of waves, for tests. Cells are (nz, ny, nx), columns (ny, nx).

#include "c_api/abi.h"
#include "liquid/waves/wave_push.h"

using mdanim::WavePush;
using mdanim::Waves;

// Arrays by cell: 1 if the push is known, head, share, over, on_top, along_x, along_y, beside.
MDANIM_EXPORT void mdanim_wave_push(void *waves, int nx, int ny, int nz, const double *mass, double *out)
{
  WavePush push(nx, ny, nz);
  std::vector<mdanim::AddedMass::Solids> solids;
  for (int c = 0; c < nx * ny; ++c) solids.push_back({mass[c], 0.0});
  push.find(*static_cast<Waves *>(waves), solids.data(), 1.0, 0.0);
  for (std::size_t cell = 0; cell < static_cast<std::size_t>(nx) * ny * nz; ++cell, out += 8) {
    const int n = push.number_of(cell);
    using On = WavePush::OnCell;
    const On on = n < 0 ? On{} : push.all()[n];
    const double found[] = {n < 0 ? 0.0 : 1.0,  on.head,           on.of[On::SHARE],
                            on.of[On::OVER],    on.of[On::ON_TOP], on.of[On::ALONG_X],
                            on.of[On::ALONG_Y], on.of[On::BESIDE]};
    for (int k = 0; k < 8; ++k) out[k] = found[k];
  }
}
