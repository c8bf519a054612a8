// The kernels for any processor.
#include "collision/ball_bound.h"
#include "collision/crossing.h"
#include "collision/kernels.h"

namespace standoff::collision::portable {
namespace {

#include "collision/kernels_body.h"
#include "collision/kernels_pairs.h"

}  // namespace

extern const Kernels kKernels{"portable",  gaps,        gaps_at, overlaps, distances_sq,
                              place_faces, close_lanes, meet,    closest};

}  // namespace standoff::collision::portable
