// The kernels for any processor.
#include "collision/body/ball_bound.h"
#include "collision/cpu/kernels.h"
#include "geometry/crossing.h"

namespace standoff::collision::portable {
namespace {

#include "collision/cpu/kernels_body.h"
#include "collision/cpu/kernels_pairs.h"

}  // namespace

extern const Kernels kKernels{"portable",  gaps,        gaps_at, overlaps, distances_sq,
                              place_faces, close_lanes, meet,    closest};

}  // namespace standoff::collision::portable
