// The kernels for AVX2.
#ifdef __AVX2__

#include "cpu/kernels.h"
#include "cpu/simd/wide_avx2.h"
#include "geometry/triangle_lines.h"

namespace standoff::cpu::avx2 {
namespace {

using namespace standoff::avx2;
#include "cpu/kernels_body.h"
#include "cpu/kernels_candidates.h"
#include "cpu/kernels_cell_blocks.h"
#include "cpu/kernels_cells.h"
#include "cpu/kernels_crowded.h"
#include "cpu/kernels_cull.h"
#include "cpu/kernels_nearest.h"

}  // namespace

extern const Kernels kKernels{
    "avx2",          clear,      gather_band_any, band_tiles,      write_tile,        nearest_to_lattice,
    nearest_in_pack, cull_boxes, cull_packs,      gather_tile_any, gather_crowded_any};

}  // namespace standoff::cpu::avx2

#endif
