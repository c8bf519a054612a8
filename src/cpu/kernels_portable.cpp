// The kernels for any processor.
#include "cpu/kernels.h"
#include "cpu/simd/wide_portable.h"
#include "geometry/triangle_lines.h"

namespace difi::cpu::portable {
namespace {

using namespace difi::portable;
#include "cpu/kernels_body.h"

}  // namespace

extern const Kernels kKernels{"portable", clear, gather_band_any, band_tiles, write_tile};

}  // namespace difi::cpu::portable
