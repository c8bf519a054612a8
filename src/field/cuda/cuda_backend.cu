// The GPU backend on CUDA.
#include "field/cuda/backend.h"
#include "field/cuda/run_from_host.cuh"
#include "gpu/device_scope.cuh"

namespace standoff::cuda {

Counts run_tiles(const Job& job, Sink& sink) {
  const DeviceScope scope(job.device);
  return run(job, sink, Method::tiles);
}

Counts run_thesis(const Job& job, Sink& sink) {
  const DeviceScope scope(job.device);
  return run(job, sink, Method::thesis);
}

}  // namespace standoff::cuda
