// The kernels for AVX2.
#ifdef __AVX2__

#include "collision/ball_bound.h"
#include "collision/crossing.h"
#include "collision/kernels.h"

#include <immintrin.h>

namespace standoff::collision::avx2 {
namespace {

#include "collision/kernels_body.h"
#include "collision/kernels_pairs.h"

}  // namespace

extern const Kernels kKernels{"avx2", gaps, gaps_at, overlaps, distances_sq, place_faces, close_lanes, meet, closest};

}  // namespace standoff::collision::avx2

#endif
