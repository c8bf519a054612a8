// The kernels for any processor.
#include "collision/body/sphere_bound.h"
#include "collision/cpu/kernels.h"
#include "geometry/overlap_penetration.h"

namespace standoff::collision::portable {
namespace {

#include "collision/cpu/kernels_body.h"
#include "collision/cpu/kernels_pairs.h"

}  // namespace

extern const Kernels kKernels{"portable",          gaps,        gaps_at,       overlaps, distances_sq,
                              transform_triangles, close_pairs, overlap_pairs, closest};

}  // namespace standoff::collision::portable
