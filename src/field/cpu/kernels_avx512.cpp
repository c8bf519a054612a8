// The kernels for AVX512.
#ifdef __AVX512F__

#include "field/cpu/kernels.h"
#include "geometry/triangle_lines.h"
#include "simd/wide_avx512.h"

namespace standoff::cpu::avx512 {
namespace {

using namespace standoff::avx512;
#include "field/cpu/kernels_body.h"
#include "field/cpu/kernels_candidates.h"
#include "field/cpu/kernels_cell_blocks.h"
#include "field/cpu/kernels_cells.h"
#include "field/cpu/kernels_crowded.h"
#include "field/cpu/kernels_cull.h"
#include "field/cpu/kernels_nearest.h"

}  // namespace

extern const Kernels kKernels{"avx512",           clear,           gather_band_any, band_tiles, write_tile,
                              nearest_to_lattice, nearest_in_pack, cull_boxes,      cull_packs, gather_tile_any,
                              gather_crowded_any};

}  // namespace standoff::cpu::avx512

#endif
