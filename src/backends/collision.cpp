// SPDX-License-Identifier: Apache-2.0
// The tables of devices for batches of collision queries, and for Algorithm 2 of the thesis.
#include "collision/device.h"

#include <array>
#include <string>

#include "backends/missing.h"
#include "gpu/devices.h"
#include "standoff/error.h"
#include "standoff/testing/emulation.h"
#include "thesis/algorithm_2.h"

namespace standoff::collision {
namespace {

constexpr std::array kCollisionRows{
    DeviceRow{Backend::cuda, cuda::available, cuda::device_name, cuda::collide, cuda::sweep, cuda::distance},
#ifdef STANDOFF_HAVE_EMULATION
    DeviceRow{testing::kEmulated, [] { return true; }, [](int) { return std::string("emulated on the CPU"); },
              emulated::collide, emulated::sweep, emulated::distance},
#endif
};

// Smaller batches are not worth a copy to the GPU and back. The value is a guess: it was not measured.
constexpr std::size_t kSmallBatch = 10'000;

}  // namespace

const DeviceRow* find_device(Backend backend, std::size_t count) {
  return find_device_row(kCollisionRows, backend, count < kSmallBatch, "batch");
}

}  // namespace standoff::collision

namespace standoff::thesis {
namespace {

constexpr std::array kAlgorithm2Rows{
    Algorithm2Row{Backend::cpu, [] { return true; }, [](int) { return std::string(); }, cpu::kAlgorithm2},
    Algorithm2Row{Backend::cuda, cuda::available, cuda::device_name, cuda::kAlgorithm2},
#ifdef STANDOFF_HAVE_EMULATION
    Algorithm2Row{testing::kEmulated, [] { return true; }, [](int) { return std::string("emulated on the CPU"); },
                  emulated::kAlgorithm2},
#endif
};

}  // namespace

const Algorithm2Row& find_algorithm_2(Backend backend) {
  const Backend wanted = backend == Backend::automatic ? Backend::cpu : backend;
  for (const Algorithm2Row& row : kAlgorithm2Rows)
    if (row.backend == wanted && row.available()) return row;
  throw_if_missing(backend, "collide");
  // The CPU is always there, and the execution was checked before.
  throw Error(ErrorCode::internal, "collide: no row for this device; this is a bug in standoff, please report it");
}

}  // namespace standoff::thesis
