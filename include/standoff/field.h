// SPDX-License-Identifier: Apache-2.0
// Distance fields: sparse 8x8x8 tiles over a grid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/vec.h"

namespace standoff {

/// Where a field came from. Every file format stores it.
struct Provenance {
  std::string method;           ///< "tiles", "thesis", or empty if unknown
  std::uint64_t mesh_hash = 0;  ///< content_hash of the mesh, 0 if unknown
  std::string version;          ///< version of standoff that computed it
  std::string sign;             ///< how it got its sign (docs/sign_methods.md): "winding odd inverted"; empty: no sign
  std::optional<Axis> up = {};  ///< the axis of the mesh that points up in pictures; none if unknown
};

/// What a field answers at a point outside its grid, of which it knows nothing. A point within a thousandth of the
/// spacing of the grid counts as on its border, for coordinates are rounded.
enum class Outside {
  nan,     ///< NaN, in each number of the answer
  border,  ///< what it answers at the nearest point of the grid
  /// Where the mesh lies in the grid's box and outside is not negative, a lower bound of the distance: the length of
  /// the hypotenuse over the way to the nearest point of the grid, and the least distance that the mesh may have there.
  bound,
};

class TilePool;

/// The distance to the nearest triangle at every sample of a grid, clamped to the thickness. In a signed field, samples
/// inside are negative. Samples are stored in tiles of 8x8x8. All samples of a tile that is not stored have the same
/// value, background(): the thickness outside, -thickness deep inside. Moves are cheap; copies are deep.
class STANDOFF_API DistanceField {
 public:
  static constexpr int kTileSide = 8;
  static constexpr int kTileSamples = kTileSide * kTileSide * kTileSide;

  /// The values of one tile, x fastest. Samples beyond the grid have the thickness as their value.
  using TileValues = std::span<const float, kTileSamples>;
  /// The nearest-triangle indices of one tile, x fastest; kNoTriangle for a sample that has none.
  using TileNearest = std::span<const std::uint32_t, kTileSamples>;

  /// The entry in slots() of a tile that is not stored and whose samples are all +thickness.
  static constexpr std::int32_t kOutside = -1;
  /// The entry in slots() of a tile that is not stored and whose samples are all -thickness.
  static constexpr std::int32_t kInside = -2;

  /// An empty field: one sample at the origin, whose value is infinite. It cannot store tiles. A moved-from field is an
  /// empty field too.
  DistanceField();
  /// A field without stored tiles: every value is `thickness` (world units, positive, may be infinite). `with_nearest`:
  /// the field also stores a nearest-triangle index for every stored sample.
  /// Errors: usage (grid, thickness), limit (memory, 2^31 tiles or more).
  DistanceField(const Grid& grid, double thickness, bool with_nearest = false);
  /// Re-initialises like the constructor, but reuses allocated tile memory: allocating it again can take as long as
  /// filling it. Errors: as the constructor; if memory runs out, the field has no tiles and cannot store any.
  void reset(const Grid& grid, double thickness, bool with_nearest = false);
  /// A field from one value per sample, x fastest. A tile is not stored if none of its samples has a nearest triangle,
  /// and all values are at least the thickness or all at most -thickness. Without nearest triangles, a distance that
  /// equals the thickness counts as clamped. Errors: as the constructor; usage also unless there is one value per
  /// sample.
  static DistanceField from_dense(const Grid& grid, double thickness, std::span<const float> values,
                                  std::span<const std::uint32_t> nearest = {});

  DistanceField(DistanceField&&) noexcept;
  DistanceField& operator=(DistanceField&&) noexcept;
  DistanceField(const DistanceField&);
  DistanceField& operator=(const DistanceField&);
  ~DistanceField();

  const Grid& grid() const { return grid_; }
  /// Half-width of the band, world units. No value is larger in magnitude.
  double thickness() const { return thickness_; }
  bool has_nearest() const { return with_nearest_; }
  /// Whether values are negative inside something: the provenance names a sign, or a value is negative. Takes a look at
  /// all stored values where the provenance says nothing.
  bool has_sign() const;
  /// Where the field came from; empty unless standoff filled the field. reset() clears it.
  const Provenance& provenance() const { return provenance_; }
  void set_provenance(Provenance provenance) { provenance_ = std::move(provenance); }

  /// The value at sample (i,j,k), world units. Errors: usage (the grid has no such sample).
  float value(std::int64_t i, std::int64_t j, std::int64_t k) const;
  /// The triangle nearest to sample (i,j,k), or kNoTriangle. Errors: usage (the grid has no such sample, or the field
  /// has no nearest triangles).
  std::uint32_t nearest(std::int64_t i, std::int64_t j, std::int64_t k) const;
  /// The trilinear interpolation at a point (world units). If the cells are cubic and no corner of the point's cell is
  /// clamped to the thickness, the result differs from the distance by at most (sqrt(3)/2) * spacing. Outside the grid
  /// the result is NaN, or, if asked for, that at the border: where it is not negative and the mesh lies inside the
  /// grid's box, a lower bound of the distance, within the same error. Outside::bound is a larger one, and holds
  /// without that error. Errors: usage (a coordinate is not a number).
  double interpolate(Vec3 point, Outside outside = Outside::nan) const;
  /// The gradient of the trilinear interpolation at a point (world units), by its analytic derivative; zero along axes
  /// with one sample. Outside the grid it is NaN, or the one-sided gradient at the border, which is not the gradient of
  /// interpolate(): that is constant there along the outward axes; with Outside::bound, the gradient of the bound.
  /// Errors: usage (a coordinate is not a number).
  Vec3 gradient(Vec3 point, Outside outside = Outside::nan) const;
  /// The same at many points, on the CPU: out[n] is the result for points[n]. Errors: usage, also if the lengths differ
  /// or `execution` is invalid; `out` is then unspecified.
  void interpolate(std::span<const Vec3> points, std::span<double> out, const Execution& execution = {},
                   Outside outside = Outside::nan) const;
  void gradient(std::span<const Vec3> points, std::span<Vec3> out, const Execution& execution = {},
                Outside outside = Outside::nan) const;

  /// Tiles per axis; the last ones may extend beyond the grid.
  Size3 tile_count() const;
  /// Tiles per axis of a field on a grid of `samples` samples per axis, each at least 1.
  static constexpr Size3 tiles_of(const Size3& samples) {
    constexpr std::int64_t more = kTileSide - 1;
    return {(samples.x + more) / kTileSide, (samples.y + more) / kTileSide, (samples.z + more) / kTileSide};
  }
  std::int64_t stored_tiles() const;
  /// The values of a tile. nullopt if it is not stored: then all its values are background(). Errors: usage (no such
  /// tile).
  std::optional<TileValues> tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;
  /// The nearest triangles of a tile; nullopt if it is not stored. Errors: usage (no such tile, or a field without
  /// nearest triangles).
  std::optional<TileNearest> tile_nearest(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;
  /// The value of every sample of a tile that is not stored: the thickness, or -thickness after mark_inside(). For a
  /// stored tile it is the thickness, the value of its samples beyond the grid. Errors: usage (no such tile).
  float background(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;

  /// A stored tile, in tiles().
  struct Tile {
    std::int64_t index;                      ///< its index in slots()
    Size3 at;                                ///< its index per axis; its first sample is 8 * at
    TileValues values;                       ///< x fastest
    std::span<const std::uint32_t> nearest;  ///< 512 indices; empty in a field without nearest triangles
  };
  class TileRange;
  /// The stored tiles, x fastest: for (const DistanceField::Tile& tile : field.tiles()). Valid until the field is
  /// changed.
  TileRange tiles() const;

  /// Stores a tile with undefined content, and returns its values for the caller to write. The span is valid until a
  /// tile is erased, or the field is reset or destroyed. Safe to call from many threads for different tiles. Errors:
  /// usage (the tile is stored already, no such tile, or an empty field); limit (memory): the field is then unchanged.
  std::span<float, kTileSamples> store_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz);
  /// The nearest triangles of a stored tile, for the caller to write. Errors: usage (the tile is not stored, or the
  /// field has no nearest triangles).
  std::span<std::uint32_t, kTileSamples> store_nearest(std::int64_t tx, std::int64_t ty, std::int64_t tz);
  /// The values of a stored tile, for the caller to change. Errors: usage (the tile is not stored).
  std::span<float, kTileSamples> edit_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz);
  /// Sets the background() of a tile that is not stored to -thickness. Safe to call from many threads for different
  /// tiles. Errors: usage (the tile is stored, no such tile, or an empty field).
  void mark_inside(std::int64_t tx, std::int64_t ty, std::int64_t tz);
  /// Sets it to the thickness again. Errors: as mark_inside().
  void mark_outside(std::int64_t tx, std::int64_t ty, std::int64_t tz);
  /// Removes a stored tile; its background() is then the thickness. The tile in the last slot moves into the free slot,
  /// which invalidates spans of its values. Takes one pass over slots(). Errors: usage (the tile is not stored).
  void erase_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz);
  /// The same for many tiles, each named by its index per axis, with one pass over slots() for all. Errors: usage (a
  /// tile is not stored, or is named twice), limit (memory); the field is then unchanged.
  void erase_tiles(std::span<const Size3> tiles);
  /// Removes the nearest triangles, if there are any; has_nearest() is then false.
  void erase_nearest();

  /// The stored tiles as flat arrays, without a copy. slots() has one entry per tile of the grid, x fastest: the tile's
  /// slot, or kOutside or kInside if the tile is not stored. The values of a tile begin at 512 * slot in tile_values(),
  /// and its nearest triangles at 512 * slot in tile_nearest_values(). Slots are 0 to stored_tiles() - 1, in the order
  /// in which tiles were stored, which may differ from run to run. cuda::DeviceOutput has the same layout. The spans
  /// are valid until the field is changed.
  std::span<const std::int32_t> slots() const { return slots_; }
  std::span<const float> tile_values() const;
  /// Errors: usage (the field has no nearest triangles).
  std::span<const std::uint32_t> tile_nearest_values() const;
  /// The index along x, y and z of the tile in each slot. Takes one pass over slots(). Errors: limit.
  std::vector<std::array<std::int32_t, 3>> tile_coordinates() const;

  /// Writes the dense values of the slices k in [first, first + count), x fastest.
  /// Errors: usage (slices outside the grid, or out.size() != size.x * size.y * count).
  void copy_slices(std::int64_t first, std::int64_t count, std::span<float> out) const;
  /// The same for nearest triangles. Errors: usage, also if the field has no nearest triangles.
  void copy_nearest_slices(std::int64_t first, std::int64_t count, std::span<std::uint32_t> out) const;
  /// All values, x fastest. Errors: limit.
  std::vector<float> to_dense() const;
  /// Bytes of the stored tiles and of slots().
  std::int64_t memory_bytes() const;

 private:
  static constexpr Grid kEmptyGrid{{1, 1, 1}, {}, {1, 1, 1}};
  static constexpr double kEmptyThickness = std::numeric_limits<double>::infinity();

  std::int64_t tile_index(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;
  std::int32_t slot_of(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;
  float background_of(std::int32_t slot) const;
  void expect_sample(std::int64_t i, std::int64_t j, std::int64_t k) const;
  std::int32_t& entry_of(std::int64_t tx, std::int64_t ty, std::int64_t tz);
  Tile tile_at(std::int64_t index) const;

  Provenance provenance_;
  Grid grid_ = kEmptyGrid;
  double thickness_ = kEmptyThickness;
  bool with_nearest_ = false;
  std::vector<std::int32_t> slots_;
  std::unique_ptr<TilePool> pool_;
};

class DistanceField::TileRange {
 public:
  class Iterator {
   public:
    using value_type = Tile;
    using difference_type = std::ptrdiff_t;
    using iterator_concept = std::forward_iterator_tag;

    Iterator() = default;
    Iterator(const DistanceField& field, std::int64_t index) : field_(&field), index_(index) { to_stored(); }
    Tile operator*() const { return field_->tile_at(index_); }
    Iterator& operator++() {
      ++index_;
      to_stored();
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    friend bool operator==(const Iterator&, const Iterator&) = default;

   private:
    void to_stored() {
      const std::span<const std::int32_t> slots = field_->slots();
      while (index_ < std::ssize(slots) && slots[static_cast<std::size_t>(index_)] < 0) ++index_;
    }
    const DistanceField* field_ = nullptr;
    std::int64_t index_ = 0;
  };

  explicit TileRange(const DistanceField& field) : field_(&field) {}
  Iterator begin() const { return {*field_, 0}; }
  Iterator end() const { return {*field_, std::ssize(field_->slots())}; }

 private:
  const DistanceField* field_;
};

inline DistanceField::TileRange DistanceField::tiles() const { return TileRange(*this); }

}  // namespace standoff
