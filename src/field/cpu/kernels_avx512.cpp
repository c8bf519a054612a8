// The kernels for AVX512.
#ifdef __AVX512F__

#include "field/cpu/kernels.h"
#include "geometry/triangle_lines.h"
#include "simd/wide_avx512.h"

namespace standoff::cpu::avx512 {
namespace {

using namespace standoff::avx512;
// Each rests on those before it.
// clang-format off
#include "field/cpu/kernels/gather_band.inl"
#include "field/cpu/kernels/cell_candidates.inl"
#include "field/cpu/kernels/block_candidates.inl"
#include "field/cpu/kernels/gather_cells.inl"
#include "field/cpu/kernels/gather_crowded.inl"
#include "field/cpu/kernels/cull_boxes.inl"
#include "field/cpu/kernels/nearest_box.inl"
// clang-format on

}  // namespace

extern const Kernels kKernels{"avx512",           clear,           gather_band_any, band_tiles, write_tile,
                              nearest_to_lattice, nearest_in_pack, cull_boxes,      cull_packs, gather_tile_any,
                              gather_crowded_any};

}  // namespace standoff::cpu::avx512

#endif
