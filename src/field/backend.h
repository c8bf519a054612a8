// SPDX-License-Identifier: Apache-2.0
// The seam between the pipeline and the backends: one job in, tiles into a sink, counts out.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "core/progress.h"
#include "field/tile_writer.h"
#include "standoff/compute.h"

namespace standoff {

/// The input of a backend. The mesh is valid and holds at least one triangle.
struct Job {
  MeshView mesh;
  /// The triangles to use, ascending indices into mesh.triangles; empty when all are used. (The skip rule's
  /// compaction.)
  std::span<const std::uint32_t> kept;
  Grid grid;
  double thickness;
  int threads;  ///< at least 1
  Simd simd;
  ProgressMeter& progress;
  int device = 0;  ///< which GPU

  std::int64_t triangle_count() const {
    return static_cast<std::int64_t>(kept.empty() ? mesh.triangles.size() : kept.size());
  }
  /// The mesh index of the n-th triangle to use.
  std::uint32_t triangle(std::int64_t n) const {
    return kept.empty() ? static_cast<std::uint32_t>(n) : kept[static_cast<std::size_t>(n)];
  }
};

struct Counts {
  std::int64_t samples_examined = 0;
  std::int64_t samples_band = 0;
};

/// Layers [begin, end) of bricks along z: of 16 samples each, but for the last one of a grid.
struct BrickLayers {
  std::int64_t begin, end;
};

/// A job that is done part by part. What all parts need is made once, before the first; the values are those of the
/// whole job, bit for bit.
class LayerGather {
 public:
  LayerGather() = default;
  LayerGather(const LayerGather&) = delete;
  LayerGather& operator=(const LayerGather&) = delete;
  virtual ~LayerGather() = default;

  /// Fills the tiles of these layers. The first call begins with layer 0, each other one where the last one ended.
  /// Throws Error{interrupted}.
  virtual void gather(const BrickLayers& layers, Sink& sink) = 0;
  /// Of all calls so far.
  virtual Counts counts() = 0;
};

/// A method on a backend. Backends add rows to the table in src/backends/fields.cpp.
struct BackendRow {
  Backend backend;
  Method method;
  const char* backend_name;
  const char* method_name;
  bool (*available)();
  std::string (*device)(Simd requested, int device);  ///< what ComputeReport::device says
  Counts (*run)(const Job&, Sink&);
  /// Bytes of scratch in the worst case, the output not counted.
  std::int64_t (*scratch_bytes)(std::int64_t triangles, const Grid&, double thickness, int threads);
  /// The same job in parts, with the same scratch; nullptr where a method needs the whole grid at once. The job must
  /// stay where it is.
  std::unique_ptr<LayerGather> (*in_layers)(const Job&) = nullptr;
};

/// The row for a job of this size; Backend::automatic takes a GPU that is there if the job is large enough for it.
/// Throws Error{device} when nothing fits.
const BackendRow& find_backend(Backend backend, Method method, std::int64_t triangles, const Grid& grid);

}  // namespace standoff
