// The kernels for any processor.
#include "collision/body/ball_bound.h"
#include "collision/cpu/kernels.h"
#include "geometry/crossing.h"

namespace standoff::collision::portable {
namespace {

#include "collision/cpu/kernels/close_triangles.inl"
#include "collision/cpu/kernels/triangle_pairs.inl"

}  // namespace

extern const Kernels kKernels{"portable",  gaps,        gaps_at, overlaps, distances_sq,
                              place_faces, close_lanes, meet,    closest};

}  // namespace standoff::collision::portable
