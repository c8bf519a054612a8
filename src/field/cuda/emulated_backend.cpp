// The GPU backend emulated on the CPU, for debugging and for tests where there is no GPU.
#include "field/cuda/backend.h"
#include "field/cuda/emulated.h"
#include "field/cuda/run_from_host.cuh"

namespace standoff::emulated {

Counts run_tiles(const Job& job, Sink& sink) { return run(job, sink, Method::tiles); }
Counts run_thesis(const Job& job, Sink& sink) { return run(job, sink, Method::thesis); }

std::int64_t scratch_bytes(std::int64_t triangles, const Grid& grid, double thickness, int) {
  const std::int64_t entries = gpu::likely_entries(triangles, grid, thickness, Method::tiles);
  constexpr std::int64_t tile_bytes = 2 * 4 * kTileSamples, mesh_bytes = 9 * 8 + 3 * 4;
  return gpu::host_scratch_bytes(grid) + tile_count(grid.size) * (tile_bytes + 4) + triangles * mesh_bytes +
         std::max(workspace_bytes(triangles, grid, thickness, Method::tiles, entries),
                  workspace_bytes(triangles, grid, thickness, Method::thesis, 0));
}

}  // namespace standoff::emulated
