// The kernels for any processor.
#include "cpu/kernels.h"
#include "cpu/simd/wide_portable.h"
#include "geometry/triangle_lines.h"

namespace standoff::cpu::portable {
namespace {

using namespace standoff::portable;
#include "cpu/kernels_body.h"
#include "cpu/kernels_candidates.h"
#include "cpu/kernels_cell_blocks.h"
#include "cpu/kernels_cells.h"
#include "cpu/kernels_crowded.h"
#include "cpu/kernels_cull.h"
#include "cpu/kernels_nearest.h"

}  // namespace

extern const Kernels kKernels{"portable",         clear,           gather_band_any, band_tiles, write_tile,
                              nearest_to_lattice, nearest_in_pack, cull_boxes,      cull_packs, gather_tile_any,
                              gather_crowded_any};

}  // namespace standoff::cpu::portable
