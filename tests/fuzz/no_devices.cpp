// Stands for the backends, which are not linked: nothing is computed where files are read, and fuzzers ask the CPU.
#include <cstdlib>
#include <span>

#include "collision/device.h"
#include "standoff/compute.h"

namespace standoff {

ComputeResult compute(MeshView, const Grid&, double, const ComputeOptions&) { std::abort(); }
ComputeReport compute_into(MeshView, const Grid&, double, std::span<float>, std::span<std::uint32_t>,
                           const ComputeOptions&) {
  std::abort();
}

namespace collision {

// The table is src/backends/collision.cpp.
const DeviceRow* find_device(Backend, std::size_t) { return nullptr; }

}  // namespace collision
}  // namespace standoff
