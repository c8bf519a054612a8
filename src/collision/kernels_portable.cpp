// The kernels for any processor.
#include "collision/kernels.h"

namespace difi::collision::portable {
namespace {

#include "collision/kernels_body.h"

}  // namespace

extern const Kernels kKernels{"portable", gaps, gaps_at, overlaps, distances_sq, place_faces, not_parted};

}  // namespace difi::collision::portable
