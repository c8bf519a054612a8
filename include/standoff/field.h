// Distance fields: sparse 8x8x8 tiles over a grid.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/vec.h"

namespace standoff {

/// Where a field came from; travels with it into every file format.
struct Provenance {
  std::string method;           ///< "tiles", "thesis", or empty when unknown
  std::uint64_t mesh_hash = 0;  ///< content_hash of the mesh, 0 when unknown
  std::string version;          ///< version of standoff that computed it
};

/// Values on a grid: min(distance, thickness) at every sample. Samples live in tiles of 8x8x8; a tile without a band
/// sample, one whose distance is at most `thickness`, need not be stored, and compute() stores none. Moves are cheap;
/// copies are deep.
class DistanceField {
 public:
  static constexpr int kTileSide = 8;
  static constexpr int kTileSamples = kTileSide * kTileSide * kTileSide;

  /// An empty field: one sample at the origin, infinitely far from everything, and no room for tiles: tile() is
  /// nullptr. A field that was moved from is the same.
  DistanceField();
  /// A field without stored tiles: every value is `thickness` (which may be infinite). Validates the grid.
  /// `with_nearest` reserves a nearest-triangle index beside every stored sample.
  DistanceField(const Grid& grid, double thickness, bool with_nearest = false);
  /// Makes the field what that constructor would, and keeps the memory of its tiles for those to come, as far as the
  /// grid may need it: to get memory anew can take as long as to fill it. Errors: as the constructor; when memory runs
  /// out, the field has no tiles and no room for any.
  void reset(const Grid& grid, double thickness, bool with_nearest = false);
  /// A field from one value per sample, x fastest. Tiles in which no value is below the thickness and no sample has a
  /// nearest triangle are not stored: without nearest triangles a distance that equals the thickness cannot be told
  /// from one beyond it. Errors: usage when the number of values is not the number of samples.
  static DistanceField from_dense(const Grid& grid, double thickness, std::span<const float> values,
                                  std::span<const std::uint32_t> nearest = {});

  DistanceField(DistanceField&&) noexcept;
  DistanceField& operator=(DistanceField&&) noexcept;
  DistanceField(const DistanceField&);
  DistanceField& operator=(const DistanceField&);
  ~DistanceField();

  const Grid& grid() const { return grid_; }
  double thickness() const { return thickness_; }
  bool has_nearest() const { return with_nearest_; }
  Provenance provenance;

  /// The value at sample (i,j,k), world units. Errors: usage (no sample of the grid).
  float value(std::int64_t i, std::int64_t j, std::int64_t k) const;
  /// The triangle nearest to sample (i,j,k), or kNoTriangle. Errors: usage (no sample of the grid, or no nearest
  /// triangles).
  std::uint32_t nearest(std::int64_t i, std::int64_t j, std::int64_t k) const;
  /// The trilinear interpolation at a point (world units); outside the grid, that of the nearest point of the grid.
  /// Within (sqrt(3)/2) * spacing of the distance where no corner is clamped by the thickness (cubic cells).
  double interpolate(Vec3 point) const;
  /// The gradient of the trilinear interpolation, by its analytic derivative; zero along axes with one sample. Outside
  /// the grid, that of the nearest point of the grid, from within: interpolate() itself does not change there along the
  /// axes on which the point lies outside.
  Vec3 gradient(Vec3 point) const;

  /// Tiles per axis; the last ones may reach past the grid.
  Size3 tile_count() const;
  std::int64_t stored_tiles() const;
  /// The 512 values of a stored tile, x fastest, or nullptr. Samples past the grid hold the thickness. Errors: usage
  /// (not one of tile_count()).
  const float* tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;
  /// The 512 nearest-triangle indices of a stored tile, or nullptr. Errors: usage (not one of tile_count(), or no
  /// nearest triangles).
  const std::uint32_t* tile_nearest(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;

  /// Stores a tile with undefined content and returns its 512 values to fill in. Safe to call from many threads for
  /// different tiles. Errors: usage, when the tile is stored already or not one of tile_count(), and when the field is
  /// empty; limit, when memory runs out: the field is then as it was.
  float* store_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz);
  /// The indices of a stored tile to fill in. Errors: usage, when it is not stored, and without nearest triangles.
  std::uint32_t* store_nearest(std::int64_t tx, std::int64_t ty, std::int64_t tz);

  /// Writes the dense values of the slices k in [first, first + count), x fastest.
  /// Errors: usage, for slices there are not, and unless out.size() == size.x * size.y * count.
  void copy_slices(std::int64_t first, std::int64_t count, std::span<float> out) const;
  void copy_nearest_slices(std::int64_t first, std::int64_t count, std::span<std::uint32_t> out) const;
  /// All values, x fastest. Errors: limit.
  std::vector<float> to_dense() const;
  /// Bytes of the stored tiles and of their table.
  std::int64_t memory_bytes() const;

 private:
  struct Pool;
  static constexpr Grid kEmptyGrid{{1, 1, 1}, {}, {1, 1, 1}};
  static constexpr double kEmptyThickness = std::numeric_limits<double>::infinity();

  std::int64_t tile_index(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;
  void expect_sample(std::int64_t i, std::int64_t j, std::int64_t k) const;
  std::int32_t& entry_of(std::int64_t tx, std::int64_t ty, std::int64_t tz);

  Grid grid_ = kEmptyGrid;
  double thickness_ = kEmptyThickness;
  bool with_nearest_ = false;
  std::vector<std::int32_t> slots_;  // per tile, x fastest: its slot in the pool, or kNotStored
  std::unique_ptr<Pool> pool_;
};

}  // namespace standoff
