// The kernels for AVX2.
#ifdef __AVX2__

#include "field/cpu/kernels.h"
#include "geometry/triangle_lines.h"
#include "simd/wide_avx2.h"

namespace standoff::cpu::avx2 {
namespace {

using namespace standoff::avx2;
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

extern const Kernels kKernels{
    "avx2",          clear,      gather_band_any, band_tiles,      write_tile,        nearest_to_lattice,
    nearest_in_pack, cull_boxes, cull_packs,      gather_tile_any, gather_crowded_any};

}  // namespace standoff::cpu::avx2

#endif
