// The kernels for any processor.
#include "cpu/kernels.h"
#include "cpu/simd/wide_portable.h"
#include "geometry/triangle_lines.h"

namespace difi::cpu::portable {
namespace {

using namespace difi::portable;
#include "cpu/kernels_body.h"
#include "cpu/kernels_candidates.h"
#include "cpu/kernels_cell_blocks.h"
#include "cpu/kernels_cells.h"
#include "cpu/kernels_cull.h"

}  // namespace

extern const Kernels kKernels{"portable",  clear,      gather_band_any, band_tiles,     write_tile,
                              nearest_box, cull_boxes, cull_packs,      gather_tile_any};

}  // namespace difi::cpu::portable
