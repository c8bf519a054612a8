// The kernels for AVX-512.
#ifdef __AVX512F__

#include "collision/body/sphere_bound.h"
#include "collision/cpu/kernels.h"
#include "geometry/overlap_penetration.h"

#include <immintrin.h>

namespace standoff::collision::avx512 {
namespace {

#include "collision/cpu/kernels_body.h"
#include "collision/cpu/kernels_pairs.h"

}  // namespace

extern const Kernels kKernels{"avx512",    gaps,          gaps_at, overlaps, distances_sq, transform_triangles,
                              close_pairs, overlap_pairs, closest};

}  // namespace standoff::collision::avx512

#endif
