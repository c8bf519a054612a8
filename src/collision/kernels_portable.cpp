// The kernels for any processor.
#include "collision/kernels.h"

namespace difi::collision::portable {
namespace {

#include "collision/kernels_body.h"

}  // namespace

extern const Kernels kKernels{"portable", gaps, gaps_at, overlaps, distances_sq};

}  // namespace difi::collision::portable
