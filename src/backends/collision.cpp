// SPDX-License-Identifier: Apache-2.0
#include "collision/device.h"

#include <array>

#include "backends/missing.h"
#include "gpu/devices.h"
#include "standoff/error.h"
#include "standoff/testing/emulation.h"

namespace standoff::collision {
namespace {

constexpr std::array kCollisionRows{
    DeviceRow{Backend::cuda, cuda::available, cuda::device_name, cuda::collide, cuda::sweep},
#ifdef STANDOFF_HAVE_EMULATION
    DeviceRow{testing::kEmulated, [] { return true; }, [](int) { return std::string("emulated on the CPU"); },
              emulated::collide, emulated::sweep},
#endif
};

// Smaller batches are not worth a copy to the GPU and back. The value is a guess: it was not measured.
constexpr std::size_t kSmallBatch = 10'000;

}  // namespace

const DeviceRow* find_device(Backend backend, std::size_t count) {
  return find_device_row(kCollisionRows, backend, count < kSmallBatch, "batch");
}

}  // namespace standoff::collision
