// SPDX-License-Identifier: Apache-2.0
// The devices of queries at points.
#include <array>

#include "backends/no_emulation.h"
#include "gpu/devices.h"
#include "points/cuda/points.h"
#include "standoff/error.h"
#include "standoff/testing/emulation.h"

namespace standoff {
namespace {

constexpr std::array kPointRows{
    PointDevice{Backend::cuda, cuda::available, cuda::find_nearest},
#ifdef STANDOFF_HAVE_EMULATION
    PointDevice{testing::kEmulated, [] { return true; }, emulated::find_nearest},
#endif
};

// A copy to the GPU and back must be worth it. The value is a guess: it was not measured.
constexpr std::size_t kLeastForDevice = 100'000;

}  // namespace

const PointDevice* find_point_device(Backend backend, std::size_t points) {
  const bool automatic = backend == Backend::automatic;
  if (automatic && points < kLeastForDevice) return nullptr;
  for (const PointDevice& row : kPointRows)
    if (row.backend == (automatic ? Backend::cuda : backend) && row.available()) return &row;
  if (backend == Backend::cuda) throw Error(ErrorCode::device, cuda::why_not_available());
  if (backend == testing::kEmulated) throw_no_emulation("points");
  return nullptr;
}

}  // namespace standoff
