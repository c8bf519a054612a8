// The kernels for AVX2.
#ifdef __AVX2__

#include "collision/body/ball_bound.h"
#include "collision/cpu/kernels.h"
#include "geometry/crossing.h"

#include <immintrin.h>

namespace standoff::collision::avx2 {
namespace {

#include "collision/cpu/kernels/close_triangles.inl"
#include "collision/cpu/kernels/triangle_pairs.inl"

}  // namespace

extern const Kernels kKernels{"avx2", gaps, gaps_at, overlaps, distances_sq, place_faces, close_lanes, meet, closest};

}  // namespace standoff::collision::avx2

#endif
