// The kernels for AVX2.
#ifdef __AVX2__

#include "field/cpu/kernels.h"
#include "geometry/triangle_lines.h"
#include "simd/wide_avx2.h"

namespace standoff::cpu::avx2 {
namespace {

using namespace standoff::avx2;
#include "field/cpu/kernels_body.h"
#include "field/cpu/kernels_candidates.h"
#include "field/cpu/kernels_cell_blocks.h"
#include "field/cpu/kernels_cells.h"
#include "field/cpu/kernels_crowded.h"
#include "field/cpu/kernels_cull.h"
#include "field/cpu/kernels_nearest.h"

}  // namespace

extern const Kernels kKernels{
    "avx2",          clear,      gather_band_any, band_tiles,      write_tile,        nearest_to_lattice,
    nearest_in_pack, cull_boxes, cull_packs,      gather_tile_any, gather_crowded_any};

}  // namespace standoff::cpu::avx2

#endif
