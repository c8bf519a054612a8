// The kernels for AVX512.
#ifdef __AVX512F__

#include "cpu/kernels.h"
#include "cpu/simd/wide_avx512.h"
#include "geometry/triangle_lines.h"

namespace standoff::cpu::avx512 {
namespace {

using namespace standoff::avx512;
#include "cpu/kernels_body.h"
#include "cpu/kernels_candidates.h"
#include "cpu/kernels_cell_blocks.h"
#include "cpu/kernels_cells.h"
#include "cpu/kernels_crowded.h"
#include "cpu/kernels_cull.h"
#include "cpu/kernels_nearest.h"

}  // namespace

extern const Kernels kKernels{"avx512",           clear,           gather_band_any, band_tiles, write_tile,
                              nearest_to_lattice, nearest_in_pack, cull_boxes,      cull_packs, gather_tile_any,
                              gather_crowded_any};

}  // namespace standoff::cpu::avx512

#endif
