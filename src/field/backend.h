// SPDX-License-Identifier: Apache-2.0
// The seam between the pipeline and the backends: a backend takes a job, writes tiles into a sink, and returns counts.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/progress.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/field.h"
#include "standoff/sign.h"

namespace standoff {

/// Memory for the samples of one tile: sample (x,y,z) of the tile is at values[x + row * y + slice * z].
/// Only `size` samples per axis may be written: tiles at the far faces of a dense grid are cut.
struct TileTarget {
  float* values = nullptr;
  std::uint32_t* nearest = nullptr;  ///< nullptr when nearest triangles are not asked for
  std::int64_t row = 0;
  std::int64_t slice = 0;
  Size3 size;
};

/// The destination of finished tiles: the sparse tiles of a DistanceField, or the caller's dense memory. Backends call
/// `open` once for each tile with a band sample (distance <= thickness), from any thread, and write every sample of it.
/// Tiles never opened read as the thickness, without a nearest triangle.
class Sink {
 public:
  explicit Sink(DistanceField& field) : grid_(field.grid()), field_(&field), with_nearest_(field.has_nearest()) {}
  /// Tiles go into dense memory, which the caller has filled with the thickness and kNoTriangle.
  Sink(const Grid& grid, std::span<float> values, std::span<std::uint32_t> nearest)
      : grid_(grid), values_(values.data()), nearest_(nearest.data()), with_nearest_(!nearest.empty()) {}

  /// The same destination for who counts tiles from another sample of the whole grid: from the beginning of `from`
  /// instead of that of `grid`. Both begin at tiles.
  Sink of_window(const Grid& grid, const Grid& from) const {
    Sink moved = *this;
    for (std::size_t axis = 0; axis < 3; ++axis)
      moved.offset_[axis] += (from.first[axis] - grid.first[axis]) / DistanceField::kTileSide;
    return moved;
  }

  bool with_nearest() const { return with_nearest_; }

  /// All samples of a tile that is never opened are inside.
  void mark_inside(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
    if (field_) return field_->mark_inside(tx + offset_.x, ty + offset_.y, tz + offset_.z);
    const TileTarget tile = open(tx, ty, tz);
    for (std::int64_t z = 0; z < tile.size.z; ++z)
      for (std::int64_t y = 0; y < tile.size.y; ++y) {
        float* const row = tile.values + tile.row * y + tile.slice * z;
        std::transform(row, row + tile.size.x, row, std::negate());
      }
  }

  TileTarget open(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
    constexpr std::int64_t side = DistanceField::kTileSide;
    tx += offset_.x, ty += offset_.y, tz += offset_.z;
    if (field_) {
      TileTarget target{field_->store_tile(tx, ty, tz).data(), nullptr, side, side * side, {side, side, side}};
      if (with_nearest_) target.nearest = field_->store_nearest(tx, ty, tz).data();
      return target;
    }
    const std::int64_t x = tx * side, y = ty * side, z = tz * side, at = grid_.index(x, y, z);
    const Size3& n = grid_.size;
    return {values_ + at,
            with_nearest_ ? nearest_ + at : nullptr,
            n.x,
            n.x * n.y,
            {std::min(side, n.x - x), std::min(side, n.y - y), std::min(side, n.z - z)}};
  }

 private:
  const Grid& grid_;
  DistanceField* field_ = nullptr;
  Size3 offset_;  // added to the numbers of tiles
  float* values_ = nullptr;
  std::uint32_t* nearest_ = nullptr;
  bool with_nearest_ = false;
};

/// The share of the work after which a backend that decides the sign has done its own: the rest is planning the sign,
/// if that is left to the host.
inline constexpr double kDistancesDoneBeforeSign = 0.9;

/// The input of a backend. The mesh is valid and holds at least one triangle.
struct Job {
  MeshView mesh;
  /// The triangles that the skip rule keeps: ascending indices into mesh.triangles; empty if all are used.
  std::span<const std::uint32_t> kept;
  Grid grid;
  double thickness;
  int threads;  ///< at least 1
  Simd simd;
  ProgressMeter& progress;
  std::span<const int> devices = {};  ///< the GPUs that share the work; none: the first one
  /// A byte for each tile of the grid, x fastest: what comes of those with 0 does not matter. Empty: all matter.
  std::span<const std::uint8_t> wanted = {};
  /// The sign asked for; null: none. A backend that decides signs may leave some or all samples without it.
  const SignOptions* sign = nullptr;

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
  std::int64_t samples_signed = 0;  ///< that have got the sign asked for; the values of all others are magnitudes

  Counts& operator+=(const Counts& other) {
    samples_examined += other.samples_examined;
    samples_band += other.samples_band;
    samples_signed += other.samples_signed;
    return *this;
  }
};

/// A job that is done window by window, in any order, on the threads of one TBB arena. The constructor prepares the
/// data that all windows share; the values equal the whole job's, bit for bit.
class WindowGather {
 public:
  WindowGather() = default;
  WindowGather(const WindowGather&) = delete;
  WindowGather& operator=(const WindowGather&) = delete;
  virtual ~WindowGather() = default;

  /// Fills the tiles of a window of the job's grid, which begins at a brick of it; the sink's first tile is the
  /// window's. Counts its bricks as progress. Throws Error{interrupted}.
  virtual Counts gather(const Grid& window, Sink& sink, ProgressMeter& progress) = 0;
  /// Whether some triangle may be within the thickness of such a window, where that takes no search.
  virtual std::optional<bool> is_reached(const Grid&) const { return std::nullopt; }
};

/// How much a mesh is for the scratch memory of a method.
struct MeshLoad {
  std::int64_t triangles;
  /// An upper bound of the number of pairs of a triangle and a brick of the grid that its box grown by the thickness
  /// reaches.
  double brick_refs = std::numeric_limits<double>::infinity();
  bool with_sign = false;  ///< the backend decides the sign
};

/// A method on a backend. Backends add rows to the table in src/backends/fields.cpp.
struct BackendRow {
  Backend backend;
  Method method;
  bool (*available)();
  std::string (*device)(Simd requested, int device);  ///< the value of ComputeReport::device
  Counts (*run)(const Job&, Sink&);
  /// Bytes of scratch memory in the worst case, without the output.
  std::int64_t (*scratch_bytes)(const MeshLoad&, const Grid&, double thickness, int threads);
  /// The same job by windows, where that is better than a job for the triangles that reach a window; nullptr, also as
  /// what it returns, where it is not. The job must outlive the result.
  std::unique_ptr<WindowGather> (*in_windows)(const Job&) = nullptr;
  bool on_several_devices = false;  ///< Job::devices may name several
  bool decides_signs = false;       ///< Job::sign may be set
  /// Whether in_windows may prepare the whole grid, with the scratch memory of that; if not, its result is nullptr.
  bool (*prepares_whole)(std::int64_t triangles, const Grid&, double thickness) = nullptr;
};

/// Throws Error{input}: the method begins at samples near the surface, and there are none.
[[noreturn]] inline void throw_no_seeds() {
  throw Error(ErrorCode::input,
              "compute: the method found no sample near the surface, so that it has nothing to begin with; take a grid "
              "around the mesh, or the method tiles");
}

/// The row for a job of this size; Backend::automatic takes a GPU if there is one and the job is large enough for it.
/// Throws Error{device} if no row fits.
const BackendRow& find_backend(Backend backend, Method method, std::int64_t triangles, const Grid& grid);

}  // namespace standoff
